//! Cameras: pictures that belong to the captures of the tracker board.
//!
//! The tracker board strobes its cameras and offers a capture for each strobe. A [`Camera`] is notified of
//! the captures as they come, and gives for each of them, in their order, either its picture or "lost".

#[cfg(feature = "aravis")]
mod aravis;
pub mod calibrate;
mod folder;
mod frame;
mod gige;
mod matching;
pub mod measure;
mod picture_queue;
mod picture_writer;
mod png;
mod recorder;
mod walls;

#[cfg(feature = "aravis")]
pub use aravis::GigeCamera;
pub use folder::{Folder, Recorded, parse_captures};
pub use frame::CameraFrame;
pub use gige::{GigeConfig, OpenCamera, real};
pub use matching::{Match, Matching, Strobe};
pub use picture_queue::{PictureQueue, RecordingCamera};
pub use picture_writer::{PictureWriter, WrittenPictures};
pub use png::{PngError, parse_grey, read_grey, write_grey, write_rgb};
pub use recorder::Recorder;
pub use walls::{nominal_slopes, walls};

use config::table::TableError;
use std::time::Duration;
use thiserror::Error;
use vision::{Image, ImageError, OpticsError};

/// A picture of one camera, 8 bits a pixel, taken at a strobe of the tracker board.
///
/// One that is handed to [`Camera::next`] again and again keeps its room: nothing is allocated from the second picture on.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Picture {
    /// Number of the capture.
    pub capture: u32,
    /// Time of the strobe, by the clock of [`Camera::strobed`] \[µs\].
    pub time_us: u64,
    /// Rows of pixels, from the top.
    pub rows: usize,
    /// Pixels a row.
    pub columns: usize,
    /// The pixels, row after row.
    pub pixels: Vec<u8>,
}

impl Picture {
    /// The picture as it is measured.
    pub fn image(&self) -> Result<Image<'_>, ImageError> {
        Image::new(&self.pixels, self.rows, self.columns)
    }
}

/// What a camera gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrival {
    /// The picture that was filled.
    Picture,
    /// There will be no picture of this capture.
    Lost {
        /// Number of the capture.
        capture: u32,
    },
    /// No answer within the time given.
    Nothing,
}

/// A source of pictures.
pub trait Camera: Send {
    /// The tracker board has strobed the camera for this capture; `time_us` is when, on any one clock.
    fn strobed(&mut self, capture: u32, time_us: u64);

    /// The next answer to a strobe, in the order of the captures; waits at most `timeout` for it. `picture` is overwritten
    /// only by a picture that has arrived.
    fn next(&mut self, timeout: Duration, picture: &mut Picture) -> Result<Arrival, CameraError>;
}

/// Why there are no more pictures from a camera. Reads as one sentence.
#[derive(Debug, Error)]
pub enum CameraError {
    /// A picture cannot be rendered.
    #[error("a picture cannot be rendered: {0}")]
    Rendered(Box<dyn std::error::Error + Send + Sync>),
    /// Textured work cannot be made for a camera like that.
    #[error(transparent)]
    Optics(#[from] OpticsError),
    /// A file of a picture cannot be used.
    #[error(transparent)]
    Png(#[from] PngError),
    /// The list of captures in a folder cannot be used.
    #[error(transparent)]
    Captures(#[from] TableError),
    /// Pictures cannot be kept.
    #[error("cannot keep pictures in {file}: {source}; choose another folder")]
    Record {
        /// The list of captures.
        file: String,
        /// What the system said.
        source: std::io::Error,
    },
    /// Pictures are not kept among others.
    #[error("{folder} holds pictures already; choose another folder")]
    Holds {
        /// The folder.
        folder: String,
    },
    /// The machine file names no cameras.
    #[error(
        "the machine file has no [cameras.gige]: name the two GigE Vision cameras there, or say --camera geometric to try the boards without pictures"
    )]
    NotTold,
    /// This program cannot talk to cameras.
    #[error(
        "camera {camera} cannot be opened: this seamwright was built without GigE Vision; build it with `--features aravis`"
    )]
    NotBuilt {
        /// Its name in the machine file.
        camera: String,
    },
    /// There is no such camera.
    #[error(
        "camera {camera} cannot be opened: {reason}; is it powered and in this network? `arv-tool-0.8` lists all cameras"
    )]
    NotFound {
        /// Its name in the machine file.
        camera: String,
        /// What Aravis said.
        reason: String,
    },
    /// A camera does not take a setting.
    #[error("camera {camera} refuses {what}: {reason}; change [cameras] in the machine file")]
    Refused {
        /// Its name in the machine file.
        camera: String,
        /// The setting.
        what: String,
        /// What Aravis said.
        reason: String,
    },
    /// It was there and is not any more.
    #[error("camera {camera} was lost: {reason}; check its power and its cable, then restart the job")]
    Gone {
        /// Its name in the machine file.
        camera: String,
        /// What Aravis said.
        reason: String,
    },
    /// It answers, but gives no pictures.
    #[error(
        "camera {camera} has given no picture for {strobes} strobes; check the wire from the strobe of the tracker board to its trigger, and the trigger in the machine file"
    )]
    NoPictures {
        /// Its name in the machine file.
        camera: String,
        /// Strobes since its last picture.
        strobes: usize,
    },
}
