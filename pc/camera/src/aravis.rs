//! GigE Vision cameras through the library Aravis.

use crate::matching::{Match, Matching, Strobe};
use crate::{Arrival, Camera, CameraError, GigeConfig, Picture};
use ::aravis::glib::object::CastNone;
use ::aravis::prelude::*;
use ::aravis::{
    AcquisitionMode, Auto, Buffer, BufferStatus, GvDevice, GvStreamOption, PixelFormat, RangeCheckPolicy,
    Stream, glib,
};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// Pictures the stream has room for.
const BUFFERS: usize = 32;

/// Strobes without any frame after which the camera is said to give none: a second at 200 strobes a second.
const STROBES_WITHOUT_FRAME: usize = 200;

/// A frame that had come this long before the count of frames began belongs to an earlier strobe.
const STALE: Duration = Duration::from_millis(500);

/// Name of the trigger that the PC gives.
const SOFTWARE: &str = "Software";

/// A GigE Vision camera. How its frames are matched with the captures stands at the head of `matching.rs`.
#[derive(Debug)]
pub struct GigeCamera {
    /// Its name in the machine file.
    name: String,
    rows: usize,
    columns: usize,
    software: bool,
    stream: Stream,
    camera: ::aravis::Camera,
    /// Aravis has received nothing from the camera for seconds.
    gone: Arc<AtomicBool>,
    matching: Matching,
    /// When the strobe was notified with which the count of frames began.
    began: Option<SystemTime>,
    /// A frame whose strobe is not known yet.
    early: Option<Buffer>,
    /// What went wrong at a strobe.
    failed: Option<CameraError>,
}

impl GigeCamera {
    /// Opens the camera that Aravis finds by `name`, and has it wait for triggers. Its pictures are taken from the middle of
    /// the sensor.
    pub fn open(name: &str, config: &GigeConfig, rows: usize, columns: usize) -> Result<Self, CameraError> {
        let camera = ::aravis::Camera::new(Some(name)).map_err(|error| CameraError::NotFound {
            camera: name.to_owned(),
            reason: error.message().to_owned(),
        })?;
        // Aravis leaves it to the camera to refuse a value, and not every camera does.
        camera.set_range_check_policy(RangeCheckPolicy::Enable);
        let set = |what: String, result: Result<(), glib::Error>| {
            result.map_err(|error| CameraError::Refused {
                camera: name.to_owned(),
                what,
                reason: error.message().to_owned(),
            })
        };
        let binning = config.binning as i32;
        if binning != 1 {
            set(
                format!("a binning of {binning} × {binning}"),
                camera.set_binning(binning, binning),
            )?;
        }
        set(
            "pixels of 8 bits".to_owned(),
            camera.set_pixel_format(PixelFormat::MONO_8),
        )?;
        let size = format!("pictures of {columns} × {rows} pixels");
        set(
            size.clone(),
            centre(&camera, binning, rows as i32, columns as i32),
        )?;
        let set_size = camera.region().map(|(_, _, width, height)| [width, height]);
        if set_size.as_ref().ok() != Some(&[columns as i32, rows as i32]) {
            return Err(CameraError::Refused {
                camera: name.to_owned(),
                what: size,
                reason: format!("it set {set_size:?}"),
            });
        }
        // A picture that the camera has adjusted measures something else.
        if matches!(camera.is_exposure_auto_available(), Ok(true)) {
            set(
                "a fixed exposure".to_owned(),
                camera.set_exposure_time_auto(Auto::Off),
            )?;
        }
        if matches!(camera.is_gain_auto_available(), Ok(true)) {
            set("a fixed gain".to_owned(), camera.set_gain_auto(Auto::Off))?;
        }
        set(
            format!("an exposure of {} µs", config.exposure_us),
            camera.set_exposure_time(config.exposure_us),
        )?;
        set(
            format!("the trigger {}", config.trigger),
            camera.set_trigger(&config.trigger),
        )?;
        set(
            "pictures without end".to_owned(),
            camera.set_acquisition_mode(AcquisitionMode::Continuous),
        )?;
        let stream = start(&camera).map_err(|error| CameraError::Refused {
            camera: name.to_owned(),
            what: "a stream of pictures".to_owned(),
            reason: error.message().to_owned(),
        })?;
        let gone = Arc::new(AtomicBool::new(false));
        if let Some(device) = camera.device() {
            let gone = Arc::clone(&gone);
            device.connect_control_lost(move |_| gone.store(true, Ordering::Relaxed));
        }
        Ok(Self {
            name: name.to_owned(),
            rows,
            columns,
            software: config.trigger == SOFTWARE,
            stream,
            camera,
            gone,
            matching: Matching::default(),
            began: None,
            early: None,
            failed: None,
        })
    }

    /// The next frame: one that was early, or one that comes until `deadline`.
    fn frame(&mut self, deadline: Instant) -> Option<Buffer> {
        if let Some(buffer) = self.early.take() {
            return Some(buffer);
        }
        let left = deadline.saturating_duration_since(Instant::now());
        if left.is_zero() {
            self.stream.try_pop_buffer()
        } else {
            self.stream.timeout_pop_buffer(left.as_micros() as u64)
        }
    }

    /// Whether a frame belongs to a strobe before the one with which the count begins: however late it is looked at.
    fn is_stale(&self, buffer: &Buffer) -> bool {
        let began = self.began.filter(|_| self.matching.waiting() > 0);
        let began = began.unwrap_or_else(SystemTime::now);
        let came_ns = buffer.system_timestamp();
        let came = UNIX_EPOCH + Duration::from_nanos(came_ns);
        // 0: its first packet was lost, and with it when it came.
        came_ns != 0 && began.duration_since(came).is_ok_and(|before| before > STALE)
    }

    /// Takes the pixels of a frame and gives its room back to the stream. Nothing of a frame that is not whole.
    fn take(&mut self, buffer: Buffer, strobe: Strobe, picture: &mut Picture) -> Arrival {
        let mut arrival = Arrival::Lost {
            capture: strobe.capture,
        };
        if buffer.status() == BufferStatus::Success {
            // The binding copies the pixels into a vector of its own; it replaces the picture's.
            let pixels = buffer.image_data();
            if pixels.len() == self.rows * self.columns {
                *picture = Picture {
                    capture: strobe.capture,
                    time_us: strobe.time_us,
                    rows: self.rows,
                    columns: self.columns,
                    pixels,
                };
                arrival = Arrival::Picture;
            }
        }
        self.stream.push_buffer(buffer);
        arrival
    }
}

impl Camera for GigeCamera {
    fn strobed(&mut self, capture: u32, time_us: u64) {
        if self.matching.strobed(Strobe { capture, time_us }) {
            self.began = Some(SystemTime::now());
        }
        if self.software
            && let Err(error) = self.camera.software_trigger()
        {
            self.failed = Some(CameraError::Gone {
                camera: self.name.clone(),
                reason: error.message().to_owned(),
            });
        }
    }

    fn next(&mut self, timeout: Duration, picture: &mut Picture) -> Result<Arrival, CameraError> {
        let deadline = Instant::now() + timeout;
        loop {
            if let Some(capture) = self.matching.lost() {
                return Ok(Arrival::Lost { capture });
            }
            if let Some(error) = self.failed.take() {
                return Err(error);
            }
            if self.gone.load(Ordering::Relaxed) {
                return Err(CameraError::Gone {
                    camera: self.name.clone(),
                    reason: "it has not answered for seconds".to_owned(),
                });
            }
            let Some(buffer) = self.frame(deadline) else {
                let waiting = self.matching.waiting();
                if waiting >= STROBES_WITHOUT_FRAME {
                    return Err(CameraError::NoPictures {
                        camera: self.name.clone(),
                        strobes: waiting,
                    });
                }
                return Ok(Arrival::Nothing);
            };
            if !self.matching.counts() && self.is_stale(&buffer) {
                self.stream.push_buffer(buffer);
                continue;
            }
            match self.matching.frame(buffer.frame_id()) {
                Match::Of(strobe) => return Ok(self.take(buffer, strobe, picture)),
                Match::After(capture) => {
                    self.early = Some(buffer);
                    return Ok(Arrival::Lost { capture });
                }
                Match::NotYet => {
                    self.early = Some(buffer);
                    return Ok(Arrival::Nothing);
                }
                Match::Stray => self.stream.push_buffer(buffer),
            }
        }
    }
}

impl Drop for GigeCamera {
    fn drop(&mut self) {
        if !self.gone.load(Ordering::Relaxed) {
            // There is no caller left for the error.
            self.camera.stop_acquisition().ok();
        }
    }
}

/// Sets the size of the pictures, from the middle of the sensor.
fn centre(camera: &::aravis::Camera, binning: i32, rows: i32, columns: i32) -> Result<(), glib::Error> {
    let (width, height) = camera.sensor_size()?;
    // Some cameras refuse an offset that the old size does not leave room for: the size comes first.
    camera.set_region(0, 0, columns, rows)?;
    let offset = |whole: i32, part: i32, step: i32| {
        let step = step.max(1);
        ((whole / binning - part) / 2).max(0) / step * step
    };
    let x = offset(width, columns, camera.x_offset_increment()?);
    let y = offset(height, rows, camera.y_offset_increment()?);
    camera.set_region(x, y, columns, rows)
}

/// Starts pictures, as they are triggered.
fn start(camera: &::aravis::Camera) -> Result<Stream, glib::Error> {
    if let Some(device) = camera.device().and_downcast::<GvDevice>() {
        // Aravis takes a raw socket where the program is root's: it lost packets on a loaded machine, and a PC is seldom root's.
        device.set_stream_options(GvStreamOption::PACKET_SOCKET_DISABLED);
    }
    let stream = camera.create_stream()?;
    let bytes = camera.payload()? as usize;
    for _ in 0..BUFFERS {
        stream.push_buffer(Buffer::new_allocate(bytes));
    }
    camera.start_acquisition()?;
    Ok(stream)
}
