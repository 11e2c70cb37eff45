//! Modal state: settings that hold until the program changes them.

use super::block::Block;
use super::claims::Claims;
use super::codes::Code;
use super::error::{NcError, Problem, SourcePosition};
use super::program::{Blend, FeedRate, PathControl, Plane};
use super::setup::Setup;

/// mm of an inch.
pub(super) const INCH: f64 = 25.4;

/// How F is meant.
#[derive(Clone, Copy, Debug, PartialEq)]
enum FeedMode {
    PerMinute,
    PerRevolution,
    InverseTime,
}

/// F of G94 and G95.
#[derive(Clone, Copy, Debug)]
struct Feed {
    /// As it is written, in degrees a minute where only rotary axes turn.
    written: f64,
    /// In a minute or in a revolution.
    mm: f64,
}

/// Modes of a program.
#[derive(Clone, Debug)]
pub(super) struct Modal {
    /// G0, G1, G2, G3, G5, G5.1 or a cycle; none after a NURBS, and after G80 where no cycle was on.
    pub(super) motion: Option<Code>,
    /// A motion code was said.
    motion_said: bool,
    /// G0 or G1 before a cycle: G80 goes back to it.
    before_cycle: Option<Code>,
    /// The last motion was a G6.2, which a G6.3 may close once more.
    pub(super) closed: bool,
    /// X Y Z are the tip.
    pub(super) tip: bool,
    /// G43.5: I J K of straight motions are the direction of the tool.
    pub(super) vectors: bool,
    pub(super) plane: Plane,
    pub(super) control: PathControl,
    /// CTOL, the tolerance of G641 to G645 \[mm\].
    contour_tolerance: Option<f64>,
    /// G20.
    pub(super) inches: bool,
    /// G91.
    pub(super) incremental: bool,
    /// G90.1.
    pub(super) absolute_centres: bool,
    /// G99.
    pub(super) to_retract_level: bool,
    /// G16: X and Y are distance and angle.
    pub(super) polar: bool,
    /// G98 or G99 was said.
    pub(super) level_said: bool,
    feed_mode: FeedMode,
    feed: Option<Feed>,
    /// F was said.
    feed_said: bool,
}

impl Modal {
    pub(super) fn new(setup: &Setup) -> Self {
        Self {
            motion: setup.rapid_at_start.then_some(Code::Rapid),
            motion_said: false,
            before_cycle: None,
            closed: false,
            tip: setup.tip_control,
            vectors: false,
            plane: setup.plane,
            control: setup.control,
            contour_tolerance: None,
            inches: setup.inches,
            incremental: false,
            absolute_centres: false,
            to_retract_level: true,
            polar: false,
            level_said: false,
            feed_mode: FeedMode::PerMinute,
            feed: None,
            feed_said: false,
        }
    }

    /// The G codes are those of `saved` again; what is none stays: F, CTOL, and which point is led.
    pub(super) fn restore_codes(&mut self, saved: Self) {
        let now = std::mem::replace(self, saved);
        self.feed = now.feed.filter(|_| now.feed_mode == self.feed_mode);
        self.feed_said = now.feed_said;
        (self.tip, self.vectors) = (now.tip, now.vectors);
        self.contour_tolerance = now.contour_tolerance;
    }

    /// mm of a unit of length.
    pub(super) fn unit(&self) -> f64 {
        if self.inches { INCH } else { 1.0 }
    }

    /// Takes up F and the modal codes of `block`, in the order of RS274/NGC: F is in the units from before the block.
    pub(super) fn block(&mut self, block: &Block, claims: &Claims, setup: &Setup) -> Result<(), NcError> {
        for code in &block.codes {
            match code.code {
                Code::InverseTime => self.set_feed_mode(FeedMode::InverseTime),
                Code::PerMinute => self.set_feed_mode(FeedMode::PerMinute),
                Code::PerRevolution => self.set_feed_mode(FeedMode::PerRevolution),
                // Before a motion of its block.
                Code::CancelMotion => self.end_cycle(),
                _ => {}
            }
        }
        let seconds = block.has(Code::Dwell) && claims.word(Code::Dwell, "P").is_none();
        if let Some(f) = block.word("F").filter(|_| !seconds) {
            if f.value < 0.0 || (f.value == 0.0 && self.feed_mode == FeedMode::InverseTime) {
                return Err(f.value_error("the feed must be above 0"));
            }
            self.feed_said = true;
            if self.feed_mode != FeedMode::InverseTime {
                let (written, mm) = (f.value, f.value * self.unit());
                self.feed = (written > 0.0).then_some(Feed { written, mm });
            }
        }
        for code in &block.codes {
            match code.code {
                Code::TipOn => (self.tip, self.vectors) = (true, false),
                Code::TipByVectors => (self.tip, self.vectors) = (true, true),
                Code::TipOff => (self.tip, self.vectors) = (setup.tip_control, false),
                Code::PlaneXy => self.plane = Plane::Xy,
                Code::PlaneZx => self.plane = Plane::Zx,
                Code::PlaneYz => self.plane = Plane::Yz,
                Code::Inches => self.inches = true,
                Code::Millimetres => self.inches = false,
                Code::Polar => self.polar = true,
                Code::PolarOff => self.polar = false,
                Code::Absolute => self.incremental = false,
                Code::Incremental => self.incremental = true,
                Code::AbsoluteCentres => self.absolute_centres = true,
                Code::IncrementalCentres => self.absolute_centres = false,
                Code::ToInitialLevel | Code::ToRetractLevel => {
                    self.to_retract_level = code.code == Code::ToRetractLevel;
                    self.level_said = true;
                }
                Code::ExactPath => self.control = PathControl::ExactPath,
                Code::ExactStop => self.control = PathControl::ExactStop,
                Code::Continuous => self.control = self.blend(claims)?,
                Code::WithinTolerance => self.control = self.within_tolerance(setup),
                Code::UniformNurbsEnd | Code::KnotNurbsEnd => {
                    // All of a G6.2 may have been said before its G6.3.
                    if !(std::mem::take(&mut self.closed) && code.code == Code::KnotNurbsEnd) {
                        return Err(Problem::NothingToClose(code.name).at(code.place));
                    }
                    self.motion = None;
                }
                motion if is_motion(motion) => {
                    if motion.is_cycle() && !self.motion.is_some_and(Code::is_cycle) {
                        self.before_cycle = self.motion;
                    }
                    (self.motion, self.motion_said) = (Some(motion), true);
                }
                // The others have their own places, or confirm the only state there is.
                _ => {}
            }
        }
        if let Some(tolerance) = block.word("CTOL") {
            self.set_contour_tolerance(tolerance.value, setup);
        }
        Ok(())
    }

    /// G80. Controllers whose cycles are in a group of their own go on as before the cycle.
    fn end_cycle(&mut self) {
        let straight = |code: &Code| matches!(code, Code::Rapid | Code::Feed);
        if !self.motion_said {
            return;
        }
        let cycle = self.motion.filter(|code| code.is_cycle());
        self.motion = cycle.and(self.before_cycle).filter(straight);
    }

    /// Whether the motion that holds is that of the start.
    pub(super) fn moves_as_at_start(&self) -> bool {
        self.motion.is_some() && !self.motion_said
    }

    /// Whether a program that has said no F so far begins with this one \[mm/min\].
    pub(super) fn begin_with(&mut self, mm_min: f64) -> bool {
        let begins = !self.feed_said && self.feed_mode == FeedMode::PerMinute && self.feed.is_none();
        if begins {
            let written = mm_min / self.unit();
            self.feed = Some(Feed { written, mm: mm_min });
        }
        begins
    }

    /// A feed of the other mode means nothing any more.
    fn set_feed_mode(&mut self, mode: FeedMode) {
        if self.feed_mode != mode {
            self.feed_mode = mode;
            self.feed = None;
        }
    }

    /// F for a motion of `mode` in `block`, which begins at `place` and turns rotary axes alone or moves the tip, with a spindle that
    /// turns at `rpm`, if it does.
    pub(super) fn feed_rate(
        &self,
        block: &Block,
        mode: Code,
        place: SourcePosition,
        turns_only: bool,
        rpm: Option<f64>,
    ) -> Result<FeedRate, NcError> {
        match self.feed_mode {
            FeedMode::PerMinute if turns_only => {
                let feed = self.feed.ok_or(Problem::NoFeed(mode.name()).at(place))?;
                Ok(FeedRate::PerMinute(feed.written))
            }
            FeedMode::PerRevolution if turns_only => {
                let (code, why) = ("G95", "rotary axes alone have no feed per revolution: write G94");
                Err(Problem::Impossible { code, why }.at(place))
            }
            FeedMode::PerMinute | FeedMode::PerRevolution => {
                self.mm_min(mode.name(), place, rpm).map(FeedRate::PerMinute)
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

    /// Whether every block has a feed of its own.
    pub(super) fn inverse_time(&self) -> bool {
        self.feed_mode == FeedMode::InverseTime
    }

    /// Whether F is the way of a revolution of the spindle.
    pub(super) fn per_revolution(&self) -> bool {
        self.feed_mode == FeedMode::PerRevolution
    }

    /// F of G94, or of G95 with a spindle that turns at `rpm`, if it does \[mm/min\].
    pub(super) fn mm_min(
        &self,
        code: &'static str,
        place: SourcePosition,
        rpm: Option<f64>,
    ) -> Result<f64, NcError> {
        let feed = self.feed.ok_or(Problem::NoFeed(code).at(place))?;
        if self.feed_mode != FeedMode::PerRevolution {
            return Ok(feed.mm);
        }
        let (code, why) = (
            "G95",
            "F is the way of a revolution of the spindle, which does not turn: write S and M3 before",
        );
        let rpm = rpm.filter(|rpm| *rpm > 0.0);
        rpm.map(|rpm| feed.mm * rpm)
            .ok_or(Problem::Impossible { code, why }.at(place))
    }

    /// F in mm, of a minute or a revolution.
    pub(super) fn feed_mm(&self) -> Option<f64> {
        self.feed.map(|feed| feed.mm)
    }

    /// F as it is written, 0 before.
    pub(super) fn written_feed(&self) -> f64 {
        self.feed.map_or(0.0, |feed| feed.written)
    }

    /// CTOL=: the tolerance where the path control has one; what is not above 0 takes it away.
    fn set_contour_tolerance(&mut self, tolerance: f64, setup: &Setup) {
        self.contour_tolerance = (tolerance > 0.0).then_some(tolerance * self.unit());
        if matches!(self.control, PathControl::Blend(_)) {
            self.control = self.within_tolerance(setup);
        }
    }

    /// G641 to G645: within CTOL, the tolerance that programs begin with, or the one of a G64 without P.
    fn within_tolerance(&self, setup: &Setup) -> PathControl {
        let tolerance = match setup.control {
            PathControl::Blend(blend) => blend.tolerance,
            _ => None,
        };
        let tolerance = self.contour_tolerance.or(tolerance);
        PathControl::Blend(Blend {
            tolerance: tolerance.or(Some(Blend::DEFAULT_TOLERANCE_MM)),
            smoothing: None,
        })
    }

    /// G64 with its P and Q.
    fn blend(&self, claims: &Claims) -> Result<PathControl, NcError> {
        let [p, q] = ["P", "Q"].map(|word| claims.word(Code::Continuous, word));
        if let Some(p) = p.filter(|p| p.value < 0.0) {
            return Err(p.value_error("the tolerance must not be negative; for none write G61"));
        }
        if let Some(q) = q.filter(|q| q.value < 0.0) {
            return Err(q.value_error(
                "short lines cannot be smoothed by less than 0 mm; write Q0 to leave them as they are",
            ));
        }
        Ok(PathControl::Blend(Blend {
            // P0 is no tolerance at all: best speed.
            tolerance: p.map(|p| p.value * self.unit()).filter(|p| *p > 0.0),
            smoothing: q.map(|q| q.value * self.unit()),
        }))
    }
}

fn is_motion(code: Code) -> bool {
    let spline = matches!(
        code,
        Code::CubicSpline | Code::QuadraticSpline | Code::UniformNurbs | Code::KnotNurbs
    );
    code.leads_to_an_end() || spline || code.is_cycle()
}
