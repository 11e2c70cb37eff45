//! What reads an input, and how.

use super::planned;
use camera::calibrate::parse_list;
use camera::{Picture, parse_captures, parse_grey};
use config::calibration::Calibration;
use config::machine::MachineFile;
use config::table;
use config::weld_data::WeldData;
use dual_beam::{parse_main_curve, parse_other_curve};
use nc::{Options, explain};
use parts::{PartFile, check_curve};
use shared::protocol::framing::{decode_datagram, decode_message, message_length};
use shared::protocol::{Request, Response};
use std::io::Cursor;
use std::path::Path;
use teach::seam::parse_seam_points;
use teach::{parse_points, parse_tip_points};
use world::{Deviation, SceneFile};

/// What reads an input. Programs and parts are planned for the machine of this name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reader {
    /// An NC program.
    Program(&'static str),
    /// Deviation of real seams.
    Deviation,
    /// Seam 1 of a rib.
    MainCurve,
    /// Seam 2 of a rib.
    OtherCurve,
    /// Taught seams of a rib.
    TaughtSeam,
    /// Taught points of a panel.
    PanelPoints,
    /// Taught points of a saddle.
    SaddlePoints,
    /// Taught places of a seam.
    Places,
    /// Pictures of a folder.
    Captures,
    /// Pictures to calibrate from.
    KnownPictures,
    /// A machine file.
    Machine,
    /// A part file.
    Part(&'static str),
    /// Weld data.
    WeldData,
    /// A scene file.
    Scene,
    /// A calibration file.
    Calibration,
    /// The curve of a bead.
    Curve,
    /// A picture.
    Picture,
    /// Requests and responses, with their lengths.
    Stream,
    /// A datagram.
    Datagram,
}

impl Reader {
    /// Reads `bytes` as a command does.
    ///
    /// # Errors
    /// What is said of them.
    pub fn read(self, bytes: &[u8]) -> Result<(), String> {
        match self {
            Self::Stream => return stream(bytes),
            Self::Datagram => return decode_datagram(bytes).map(drop).map_err(said),
            Self::Picture => {
                return parse_grey("a.png", Cursor::new(bytes), &mut Picture::default()).map_err(said);
            }
            _ => {}
        }
        // What a file that is no text says, the standard library does.
        let text = std::str::from_utf8(bytes).map_err(said)?;
        match self {
            // Reads it as `interpret` does, and tells what it read.
            Self::Program(_) => explain(text, Options::default(), drop).map(drop).map_err(said),
            Self::Deviation => Deviation::parse("a.csv", text).map(drop).map_err(said),
            Self::MainCurve => parse_main_curve("a.csv", text).map(drop).map_err(said),
            Self::OtherCurve => parse_other_curve("a.csv", text).map(drop).map_err(said),
            Self::TaughtSeam => parse_seam_points("a.csv", text).map(drop).map_err(said),
            Self::PanelPoints => parse_points("a.csv", text).map(drop).map_err(said),
            Self::SaddlePoints => table::parse("a.csv", text, ["X_mm", "Z_mm", "B_deg", "C_deg"])
                .map(drop)
                .map_err(said),
            Self::Places => parse_tip_points("a.csv", text).map(drop).map_err(said),
            Self::Captures => parse_captures("a.csv", Path::new(""), text)
                .map(drop)
                .map_err(said),
            Self::KnownPictures => parse_list("a.csv", text, ["u_mm", "v_mm"])
                .map(drop)
                .map_err(said),
            Self::Machine => MachineFile::parse("a.toml", text).map(drop).map_err(said),
            Self::Part(_) => PartFile::parse(Path::new("a.toml"), text).map(drop).map_err(said),
            Self::WeldData => WeldData::parse("a.toml", text).map(drop).map_err(said),
            Self::Scene => SceneFile::parse("a.toml", text).map(drop).map_err(said),
            Self::Calibration => Calibration::parse("a.toml", text).map(drop).map_err(said),
            Self::Curve => check_curve("a.json", text).map_err(said),
            Self::Picture | Self::Stream | Self::Datagram => Ok(()),
        }
    }

    /// Does with `bytes`, which were read, what a command does next.
    ///
    /// # Errors
    /// What is said of them.
    pub fn plan(self, bytes: &[u8]) -> Result<(), String> {
        let text = || String::from_utf8_lossy(bytes);
        let planned = match self {
            Self::Program(machine) => planned::program(machine, &text()),
            Self::Deviation => planned::deviation(&text()),
            Self::MainCurve => planned::rib("seam_1", &text()),
            Self::OtherCurve => planned::rib("seam_2", &text()),
            Self::TaughtSeam => planned::rib("taught", &text()),
            Self::PanelPoints => planned::panel(&text()),
            Self::SaddlePoints => planned::saddle(&text()),
            Self::Places => planned::places(&text()),
            Self::Machine => planned::machine(&text()),
            Self::Part(machine) => planned::part(machine, &text()),
            Self::WeldData => planned::weld_data(&text()),
            Self::Scene => planned::scene(&text()),
            Self::Calibration => planned::calibration(&text()),
            Self::Curve => planned::bead(&text()),
            Self::Picture => planned::picture(bytes),
            Self::Captures | Self::KnownPictures | Self::Stream | Self::Datagram => Ok(()),
        };
        planned.map_err(|error| format!("{error:#}"))
    }
}

fn said(error: impl ToString) -> String {
    error.to_string()
}

/// Takes messages from a stream as both ends do.
fn stream(mut bytes: &[u8]) -> Result<(), String> {
    while let Some(length) = message_length(bytes) {
        let Some(body) = bytes.get(2..2 + length) else {
            return Err("the rest is missing".to_owned());
        };
        let request = decode_message::<Request>(body).map(drop);
        let response = decode_message::<Response>(body).map(drop);
        request.or(response).map_err(said)?;
        bytes = &bytes[2 + length..];
    }
    Ok(())
}
