//! Tilted planes, and the tool that is turned to them: G68.2, G53.1 and G53.6 (Fanuc), CYCLE800 (Siemens).
//!
//! A tilted plane is a frame inside the coordinate system. X Y Z of a program, arcs, cycles and directions of the tool are in it; A B C
//! are of the machine, as everywhere. The tool stands at right angles to the plane where it points along Z of it.

use super::block::{Block, Word};
use super::claims::Claims;
use super::codes::Code;
use super::error::{NcError, Problem, SourcePosition};
use super::frame::Frame;
use super::interpreter::Interpreter;
use super::offsets::Coordinates;
use super::program::{AXIS_WORDS, Way, Words};
use nalgebra::Vector3;
use shared::io::AXES;

/// Angles of Euler, about Z, X and Z again.
const ANGLES: [(&str, usize); 3] = [("I", 2), ("J", 0), ("K", 2)];
/// Directions of length 1 are the same to this.
const SAME_DIRECTION: f64 = 1e-12;
/// Three points are on a line where the sine of their angle is less.
const STRAIGHT: f64 = 1e-6;

/// The tilted plane that holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Tilt {
    /// Without TRANS and the like, which come after it.
    pub(super) frame: Frame,
    /// By what, and what ends it.
    by: Code,
}

/// Points of G68.2 P2 so far, in coordinates of the program.
pub(super) type Points = [Option<Vector3<f64>>; 3];

impl Tilt {
    /// By G68.2.
    fn is_of_fanuc(&self) -> bool {
        self.by == Code::Tilt
    }

    fn end(&self) -> &'static str {
        match self.is_of_fanuc() {
            true => "a tilted plane holds: end it first by G69",
            false => "a tilted plane holds: end it first by CYCLE800()",
        }
    }
}

impl Interpreter {
    /// What holds of tilted planes, and would have to end first.
    ///
    /// # Errors
    /// With what to do, if there is one.
    pub(super) fn check_no_tilt(&self, code: &'static str, place: SourcePosition) -> Result<(), NcError> {
        match &self.offsets.tilt {
            Some(tilt) => {
                let why = tilt.end();
                Err(Problem::Impossible { code, why }.at(place))
            }
            None => Ok(()),
        }
    }

    /// Refuses a change of the coordinate system below a plane of G68.2.
    pub(super) fn check_no_fanuc_tilt(
        &self,
        code: &'static str,
        place: SourcePosition,
    ) -> Result<(), NcError> {
        match self.offsets.tilt.is_some_and(|tilt| tilt.is_of_fanuc()) {
            true => self.check_no_tilt(code, place),
            false => Ok(()),
        }
    }

    /// G68.2: by the angles of Euler, or by three points in blocks that follow each other.
    pub(super) fn tilt(
        &mut self,
        block: &Block,
        claims: &Claims,
        place: SourcePosition,
    ) -> Result<(), NcError> {
        let impossible = |why, place| Err(Problem::Impossible { code: "G68.2", why }.at(place));
        self.check_no_tilt("G68.2", place)?;
        self.check_no_foreign("G68.2", place)?;
        if self.offsets.has_frame() {
            return impossible(
                "TRANS, ROT, MIRROR or SCALE hold: end them first by TRANS alone",
                place,
            );
        }
        if self.modal.incremental {
            return impossible("its words are coordinates: write it with G90", place);
        }
        let word = |name| claims.word(Code::Tilt, name);
        if let Some(word) = AXIS_WORDS[3..].iter().find_map(|axis| block.word(axis)) {
            return impossible("it is of X, Y and Z only", word.place);
        }
        if let Some(r) = word("R") {
            return impossible(
                "controllers do not agree on the axis that R turns about: leave it out, and turn by K",
                r.place,
            );
        }
        let (p, q) = (word("P"), word("Q"));
        match p.map_or(0.0, |p| p.value) {
            0.0 => {
                if let Some(q) = q.filter(|q| q.value != 313.0) {
                    return impossible(
                        "its angles are about Z, X and Z, which is Q313: leave Q out",
                        q.place,
                    );
                }
                let origin = self.place_said(block);
                let angles = ANGLES.map(|(name, axis)| (axis, word(name).map_or(0.0, |word| word.value)));
                let mut frame = Frame::default();
                frame.shift(&origin);
                angles
                    .into_iter()
                    .for_each(|(axis, degrees)| frame.turn(axis, degrees));
                self.hold_tilt(frame, Code::Tilt);
                Ok(())
            }
            2.0 => {
                if let Some(angle) = ANGLES.iter().find_map(|(name, _)| word(name)) {
                    return impossible("with P2 it is said by points, not by angles", angle.place);
                }
                self.point_of_plane(block, q, place)
            }
            _ => impossible(
                "planes are said by angles about Z, X and Z (P0) or by three points (P2): controllers do not agree on the others",
                p.map_or(place, |p| p.place),
            ),
        }
    }

    /// X Y Z of `block` in mm, 0 where there is none.
    fn place_said(&self, block: &Block) -> Coordinates {
        let mut at = [0.0; AXES];
        for (axis, value) in self.axis_values(block) {
            at[axis] = value;
        }
        at
    }

    /// G68.2 P2 Q1: the origin; Q2: a place on X; Q3: a place in the plane where Y is above 0.
    fn point_of_plane(
        &mut self,
        block: &Block,
        q: Option<&Word>,
        place: SourcePosition,
    ) -> Result<(), NcError> {
        let wrong = |why, place| {
            Err(Problem::Impossible {
                code: "G68.2 P2",
                why,
            }
            .at(place))
        };
        let missing = |word| {
            let code = "G68.2 P2";
            Problem::Missing { code, word }.at(place)
        };
        let q = q.ok_or_else(|| missing("Q1, Q2 or Q3"))?;
        let Some(number @ 1..=3) = q.number_below(4) else {
            return wrong(
                "its points are Q1, the origin, Q2 on X, and Q3 on the side of Y: another origin is not possible",
                q.place,
            );
        };
        if let Some(axis) = AXIS_WORDS[..3].iter().find(|axis| block.word(axis).is_none()) {
            return Err(missing(axis));
        }
        let [x, y, z, ..] = self.place_said(block);
        self.tilt_points[usize::from(number) - 1] = Some(Vector3::new(x, y, z));
        let [Some(origin), Some(on_x), Some(on_y)] = self.tilt_points else {
            return Ok(());
        };
        self.tilt_points = Points::default();
        let (x, aside) = (on_x - origin, on_y - origin);
        let up = x.cross(&aside);
        if up.norm() <= STRAIGHT * x.norm() * aside.norm() {
            return wrong("its three points are on a straight line", place);
        }
        let (x, z) = (x.normalize(), up.normalize());
        let mut frame = Frame::default();
        frame.shift(&[origin.x, origin.y, origin.z, 0.0, 0.0, 0.0]);
        frame.turn_to([x, z.cross(&x), z]);
        self.hold_tilt(frame, Code::Tilt);
        Ok(())
    }

    /// Refuses a motion before all points of a plane are said.
    pub(super) fn check_whole_plane(&self, place: SourcePosition) -> Result<(), NcError> {
        let missing = self.tilt_points.iter().position(Option::is_none);
        match missing.filter(|_| self.tilt_points != Points::default()) {
            Some(index) => {
                let code = "G68.2 P2";
                let word = ["Q1", "Q2", "Q3"][index];
                Err(Problem::Missing { code, word }.at(place))
            }
            None => Ok(()),
        }
    }

    pub(super) fn hold_tilt(&mut self, frame: Frame, by: Code) {
        self.offsets.tilt = Some(Tilt { frame, by });
        self.offsets.frame = frame;
        self.spline_end = None;
    }

    /// The tilted plane ends, with all that was in it; whether there was one.
    pub(super) fn end_tilt(&mut self) -> bool {
        self.tilt_points = Points::default();
        let held = self.offsets.tilt.take().is_some();
        if held {
            self.offsets.frame = Frame::default();
            self.spline_end = None;
        }
        held
    }

    /// G69 ends a plane of G68.2; whether there was one.
    pub(super) fn end_fanuc_tilt(&mut self) -> bool {
        let begun = self.tilt_points != Points::default();
        let held = self.offsets.tilt.is_none_or(|tilt| tilt.is_of_fanuc());
        held && (self.end_tilt() || begun)
    }

    /// G53.1, and G53.6 where the tip stays.
    pub(super) fn turn_tool(
        &mut self,
        claims: &Claims,
        code: Code,
        place: SourcePosition,
    ) -> Result<(), NcError> {
        let name = code.name();
        let impossible = |why, place| Err(Problem::Impossible { code: name, why }.at(place));
        self.check_whole_plane(place)?;
        if self.offsets.tilt.is_none() {
            return impossible("no tilted plane holds: write G68.2 before", place);
        }
        if let Some(p) = claims.word(code, "P").filter(|p| p.value != 0.0) {
            return impossible(
                "the tool goes the shorter way (P0): for the other one turn its rotary axes by G0",
                p.place,
            );
        }
        self.stand_on_plane(code == Code::ToolToPlaneAtTip, name, place)
    }

    /// The tool is turned to Z of the program, with the tip where it is, or with X Y Z of the machine where they are.
    pub(super) fn stand_on_plane(
        &mut self,
        keeps_tip: bool,
        name: &'static str,
        place: SourcePosition,
    ) -> Result<(), NcError> {
        self.check_come_back(name, place)?;
        let direction = Vector3::from(self.offsets.direction([0.0, 0.0, 1.0])).normalize();
        let fitted = self.setup.fitted;
        let all: Vec<usize> = (0..AXES).filter(|axis| *axis < 3 || fitted[*axis]).collect();
        let at = self.position(&all, place)?;
        let now = Vector3::from(self.along(&at));
        if (now - direction).norm() <= SAME_DIRECTION {
            return Ok(());
        }
        if !self.modal.tip {
            return Err(Problem::NotTip.at(place));
        }
        let mut words = Words::default();
        self.point(&mut words, direction.into(), place)?;
        if !keeps_tip {
            return self.go_in_axes(words.axes, place);
        }
        if let Some(axis) = self.free_axis(&at, &words) {
            // No attitude of the tool says where this axis stands, so that it is moved as an axis.
            let mut alone = [None; AXES];
            alone[axis] = words.axes[axis];
            self.go_in_axes(alone, place)?;
        }
        for (axis, value) in at.iter().enumerate().take(3) {
            words.axes[axis] = Some(*value);
        }
        if self.learn(&words) {
            self.rapid(Way::Line, words, place)?;
        }
        self.spline_end = None;
        Ok(())
    }

    /// A rotary axis that turns the tool about itself as it stands `at` a place, as C of a head whose tool points along it: on a way
    /// with all others it would have to jump, so it turns first.
    fn free_axis(&self, at: &Coordinates, words: &Words) -> Option<usize> {
        let now = Vector3::from(self.along(at));
        (3..AXES).rev().find(|axis| {
            let mut turned = *at;
            turned[*axis] = words.axes[*axis].unwrap_or(at[*axis]);
            let stays = (Vector3::from(self.along(&turned)) - now).norm() <= SAME_DIRECTION;
            turned[*axis] != at[*axis] && stays
        })
    }
}
