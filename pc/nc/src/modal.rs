//! Modal state: settings that hold until the program changes them.

use super::claims::Claims;
use super::codes::Code;
use super::error::{NcError, Problem, SourcePosition};
use super::parser::Block;
use super::program::{Blend, FeedRate, PathControl, Plane};

/// How F is meant.
#[derive(Clone, Copy, PartialEq)]
enum FeedMode {
    PerMinute,
    InverseTime,
}

/// Modes of a program.
#[derive(Clone)]
pub(super) struct Modal {
    /// G0, G1, G2 or G3; none after a NURBS.
    pub(super) motion: Option<Code>,
    /// The last motion was a G6.2, which a G6.3 may close once more.
    pub(super) closed: bool,
    /// G43.4.
    pub(super) tip: bool,
    pub(super) plane: Plane,
    pub(super) control: PathControl,
    feed_mode: FeedMode,
    /// G94 \[mm/min\].
    feed: Option<f64>,
}

impl Default for Modal {
    fn default() -> Self {
        Self {
            motion: None,
            closed: false,
            tip: false,
            plane: Plane::default(),
            control: PathControl::Blend(Blend::default()),
            feed_mode: FeedMode::PerMinute,
            feed: None,
        }
    }
}

impl Modal {
    /// Takes up the modal codes of `block`, and F.
    pub(super) fn block(&mut self, block: &Block, claims: &Claims) -> Result<(), NcError> {
        for code in &block.codes {
            match code.code {
                Code::TipOn => self.tip = true,
                Code::TipOff => self.tip = false,
                Code::PlaneXy => self.plane = Plane::Xy,
                Code::PlaneZx => self.plane = Plane::Zx,
                Code::PlaneYz => self.plane = Plane::Yz,
                Code::ExactPath => self.control = PathControl::ExactPath,
                Code::ExactStop => self.control = PathControl::ExactStop,
                Code::Continuous => self.control = blend(claims)?,
                Code::InverseTime => self.set_feed_mode(FeedMode::InverseTime),
                Code::PerMinute => self.set_feed_mode(FeedMode::PerMinute),
                Code::Rapid
                | Code::Feed
                | Code::ArcClockwise
                | Code::ArcCounterClockwise
                | Code::UniformNurbs
                | Code::KnotNurbs => self.motion = Some(code.code),
                Code::UniformNurbsEnd | Code::KnotNurbsEnd => {
                    // All of a G6.2 may have been said before its G6.3.
                    if !(std::mem::take(&mut self.closed) && code.code == Code::KnotNurbsEnd) {
                        return Err(Problem::NothingToClose(code.name).at(code.place));
                    }
                    self.motion = None;
                }
                // These have their own places.
                Code::OutputOn
                | Code::OutputOff
                | Code::OutputOnNow
                | Code::OutputOffNow
                | Code::WaitForInput
                | Code::Analog
                | Code::AnalogNow
                | Code::SpindleClockwise
                | Code::SpindleCounterClockwise
                | Code::SpindleOff
                | Code::Dwell
                | Code::MachineAxes
                | Code::End => {}
                // These confirm the only state there is.
                Code::Millimetres | Code::CompensationOff | Code::WorldOffset | Code::Absolute => {}
            }
        }
        if let Some(f) = block.word("F") {
            if f.value <= 0.0 {
                return Err(f.value_error("the feed must be above 0"));
            }
            if self.feed_mode == FeedMode::PerMinute {
                self.feed = Some(f.value);
            }
        }
        Ok(())
    }

    /// A feed of the other mode means nothing any more.
    fn set_feed_mode(&mut self, mode: FeedMode) {
        if self.feed_mode != mode {
            self.feed_mode = mode;
            self.feed = None;
        }
    }

    /// F for a motion of `mode` in `block`, which begins at `place`.
    pub(super) fn feed_rate(
        &self,
        block: &Block,
        mode: Code,
        place: SourcePosition,
    ) -> Result<FeedRate, NcError> {
        match self.feed_mode {
            FeedMode::PerMinute => {
                let feed = self.feed.ok_or(Problem::NoFeed(mode.name()).at(place))?;
                Ok(FeedRate::PerMinute(feed))
            }
            FeedMode::InverseTime => {
                let f = block.word("F");
                let f = f.ok_or(Problem::NoInverseTime(mode.name()).at(place))?;
                Ok(FeedRate::InverseTime(f.value))
            }
        }
    }

    /// With G93, F in a block that does not feed means nothing.
    pub(super) fn check_no_feed(&self, block: &Block) -> Result<(), NcError> {
        match (self.feed_mode, block.word("F")) {
            (FeedMode::InverseTime, Some(f)) => Err(Problem::InverseTimeAlone.at(f.place)),
            _ => Ok(()),
        }
    }
}

/// G64 with its P and Q.
fn blend(claims: &Claims) -> Result<PathControl, NcError> {
    let [p, q] = ["P", "Q"].map(|word| claims.word(Code::Continuous, word));
    if let Some(p) = p.filter(|p| p.value <= 0.0) {
        return Err(p.value_error("the tolerance must be above 0 mm; for none write G61"));
    }
    if let Some(q) = q.filter(|q| q.value < 0.0) {
        return Err(q.value_error(
            "short lines cannot be smoothed by less than 0 mm; write Q0 to leave them as they are",
        ));
    }
    Ok(PathControl::Blend(Blend {
        tolerance: p.map(|p| p.value),
        smoothing: q.map(|q| q.value),
    }))
}
