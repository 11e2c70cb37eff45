//! Files and messages with something wrong in them, and what reads them: shipped ones and small ones of every form,
//! mutated in the same way in every run.
//!
//! The suite tries many of each kind (`tests/bad_input.rs`), `cargo fuzz` as many as it is given time for (`fuzz/`).

mod mutate;
mod planned;
mod readers;
mod samples;

pub use mutate::mutated;
pub use readers::Reader;
pub use samples::{Sample, samples};

/// What an input is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// NC programs.
    Nc,
    /// Tables: seams, deviations, taught points, lists of pictures.
    Csv,
    /// Machine, part, scene and calibration files.
    Toml,
    /// Curves of beads.
    Json,
    /// Pictures.
    Png,
    /// Messages between PC and boards.
    Framing,
}

impl Kind {
    /// Whether it is text.
    pub fn is_text(self) -> bool {
        !matches!(self, Self::Png | Self::Framing)
    }

    /// Reads `bytes` as everything of this kind, and plans what was understood.
    pub fn try_all(self, bytes: &[u8]) {
        for reader in self.readers() {
            if reader.read(bytes).is_ok() {
                // Refusing it is as good.
                let _ = reader.plan(bytes);
            }
        }
    }

    /// Everything that reads such inputs.
    pub fn readers(self) -> &'static [Reader] {
        match self {
            Self::Nc => &[Reader::Program("dual-beam-gantry")],
            Self::Csv => &[
                Reader::Deviation,
                Reader::MainCurve,
                Reader::OtherCurve,
                Reader::TaughtSeam,
                Reader::PanelPoints,
                Reader::SaddlePoints,
                Reader::Places,
                Reader::Captures,
                Reader::KnownPictures,
            ],
            Self::Toml => &[
                Reader::Machine,
                Reader::Part("dual-beam-gantry"),
                Reader::WeldData,
                Reader::Scene,
                Reader::Calibration,
            ],
            Self::Json => &[Reader::Curve],
            Self::Png => &[Reader::Picture],
            Self::Framing => &[Reader::Stream, Reader::Datagram],
        }
    }
}
