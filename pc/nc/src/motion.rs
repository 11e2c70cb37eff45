//! Motions: from the words of a block to where the tip or the axes go.

use super::arc;
use super::block::{Block, Distance, Word};
use super::claims::Claims;
use super::codes::Code;
use super::direction::DIRECTION_WORDS;
use super::error::{NcError, Problem, SourcePosition};
use super::interpreter::{Interpreter, no_slides_or_direction};
use super::nurbs::OpenNurbs;
use super::offsets::Coordinates;
use super::program::{
    AXIS_WORDS, ArcForm, ArcWay, ControlPoint, EXTENSION_WORDS, FeedRate, Motion, NurbsWay, Plane,
    ProgramPath, Target, Way, Words,
};
use shared::io::AXES;

/// What turning coordinates there and back leaves of a motion to where the tip is, and less than any program says \[mm\].
const ROUNDING: f64 = 1e-9;

impl Interpreter {
    /// The position in the frame of the tip; the start of the program may be assumed.
    ///
    /// # Errors
    /// It is not known.
    pub(super) fn position(&mut self, axes: &[usize], place: SourcePosition) -> Result<Coordinates, NcError> {
        if axes.iter().any(|axis| !self.known[*axis]) {
            if self.lost {
                return Err(Problem::UnknownPosition.at(place));
            }
            self.assumed.get_or_insert(place);
        }
        Ok(self.at)
    }

    /// The position in coordinates of the program (mm, degrees).
    pub(super) fn programmed(
        &mut self,
        axes: &[usize],
        place: SourcePosition,
    ) -> Result<Coordinates, NcError> {
        let at = self.position(&self.offsets.with_coupled(axes), place)?;
        Ok(self.offsets.to_programmed(&at))
    }

    /// Coordinates of the program that axis words say, in mm and degrees; with G91 from where the tip is.
    pub(super) fn said(&mut self, block: &Block) -> Result<[Option<f64>; AXES], NcError> {
        let mut said = [None; AXES];
        for (axis, name) in AXIS_WORDS.iter().enumerate() {
            let Some(word) = block.word(name) else { continue };
            let value = word.value * if axis < 3 { self.modal.unit() } else { 1.0 };
            let distance = word.distance.unwrap_or(match self.modal.incremental {
                true => Distance::Step,
                false => Distance::Absolute,
            });
            let now = match distance {
                Distance::Absolute => 0.0,
                _ => self.programmed(&[axis], word.place)?[axis],
            };
            said[axis] = Some(distance.coordinate(value, now));
        }
        Ok(said)
    }

    /// Words of the tip for coordinates of the program.
    pub(super) fn tip_words(
        &mut self,
        mut said: [Option<f64>; AXES],
        place: SourcePosition,
    ) -> Result<Words, NcError> {
        if self.offsets.says_in_part(&said) {
            let coupled = self.offsets.coupled();
            let now = self.programmed(coupled, place)?;
            for axis in coupled {
                said[*axis] = said[*axis].or(Some(now[*axis]));
            }
        }
        self.tell_system(place);
        let mut tip = self.offsets.to_tip(&said.map(|value| value.unwrap_or(0.0)));
        for axis in self.offsets.coupled() {
            if (tip[*axis] - self.at[*axis]).abs() <= ROUNDING {
                tip[*axis] = self.at[*axis];
            }
        }
        let mut words = Words {
            axes: std::array::from_fn(|axis| said[axis].map(|_| tip[axis])),
            ..Words::default()
        };
        for axis in 3..AXES {
            // A table that another machine would have stays where it is.
            if words.axes[axis] == Some(0.0) && !self.setup.fitted[axis] {
                words.axes[axis] = None;
                let name = AXIS_WORDS[axis];
                let text = format!("{name}0 changes nothing: the machine has no axis {name}");
                self.tell_once(text, place);
            }
        }
        Ok(words)
    }

    /// G53: the axes named go to their coordinates, with G0 in axis space, with G1 so that the tip goes straight; whether
    /// that feeds.
    pub(super) fn axes_motion(&mut self, block: &Block, place: SourcePosition) -> Result<bool, NcError> {
        no_slides_or_direction(block)?;
        self.check_come_back("G53", place)?;
        let mut axes = Words::of(block).axes;
        if axes.iter().all(Option::is_none) {
            let text = "G53, G153 and SUPA without axis words change nothing: they hold in their block only";
            self.tell_once(text.to_owned(), place);
            return Ok(false);
        }
        let kinematics = self.setup.kinematics.clone();
        let feeds = match (self.modal.motion, &kinematics) {
            (Some(Code::Rapid), _) => false,
            (Some(Code::Feed), Some(_)) => true,
            _ => return Err(Problem::AxesNeedRapid.at(place)),
        };
        if self.modal.incremental {
            let (code, why) = ("G53", "coordinates of axes are absolute: write G90");
            return Err(Problem::Impossible { code, why }.at(place));
        }
        let unit = self.modal.unit();
        axes[..3].iter_mut().flatten().for_each(|value| *value *= unit);
        match kinematics.filter(|_| feeds) {
            None => self.go_in_axes(axes, place).map(|()| false),
            Some(kinematics) => {
                let at = self.position(&[0, 1, 2, 3, 4, 5], place)?;
                let tip = self.tip_of_machine(&at);
                let mut all = kinematics.axes(&tip).ok_or(Problem::UnknownPosition.at(place))?;
                for (own, said) in all.iter_mut().zip(axes) {
                    *own = said.unwrap_or(*own);
                }
                let tip = self.end_of_tool(&kinematics.tip(&all));
                let fitted = self.setup.fitted;
                let words = Words {
                    axes: std::array::from_fn(|axis| (axis < 3 || fitted[axis]).then_some(tip[axis])),
                    ..Words::default()
                };
                let turns_only = (0..3).all(|axis| !self.moves(&words, axis));
                let feed = self.feed_rate(block, Code::Feed, place, turns_only)?;
                if self.learn(&words) {
                    self.feed_motion(Way::Line, words, feed, place)?;
                }
                self.spline_end = None;
                Ok(true)
            }
        }
    }

    /// The axes named go to these positions (mm, degrees), in axis space.
    pub(super) fn go_in_axes(
        &mut self,
        axes: [Option<f64>; AXES],
        place: SourcePosition,
    ) -> Result<(), NcError> {
        if let Some(pending) = self.pending.iter().find(|pending| pending.opens()) {
            return Err(Problem::OnInAxes(pending.code).at(pending.place));
        }
        // In axis space the boards switch nothing on.
        self.stand();
        let words = Words {
            axes,
            ..Words::default()
        };
        self.rapid(Way::Axes, words, place)?;
        // Where the tip is now, the program does not say; kinematics may know.
        let kinematics = self.setup.kinematics.clone();
        let after = kinematics.and_then(|kinematics| {
            let mut all = kinematics.axes(&self.tip_of_machine(&self.at))?;
            for (own, said) in all.iter_mut().zip(axes) {
                *own = said.unwrap_or(*own);
            }
            Some((
                self.end_of_tool(&kinematics.tip(&all)),
                axes.iter().all(Option::is_some),
            ))
        });
        match after {
            Some((tip, all_said)) if !self.lost || all_said => {
                let known = all_said || self.known.iter().all(|known| *known);
                (self.at, self.known) = (tip, [known; AXES]);
                self.lost &= !all_said;
            }
            _ => {
                self.known = [false; AXES];
                self.lost = true;
            }
        }
        self.spline_end = None;
        Ok(())
    }

    /// The motion of `block` in tip coordinates, if it has one; whether that feeds.
    pub(super) fn tip_motion(&mut self, block: &Block, claims: &Claims) -> Result<bool, NcError> {
        let own = block
            .codes
            .iter()
            .find(|code| opens_nurbs(code.code) || is_curve(code.code) || code.code.probes());
        let is_motion = |word: &&super::block::Word| {
            let address = word.address.as_str();
            let own = |code: Code| claims.word(code, address).is_some();
            AXIS_WORDS.contains(&address)
                || EXTENSION_WORDS.contains(&address)
                || DIRECTION_WORDS.contains(&address)
                || address == "ANG"
                || self.modal.motion.is_some_and(own)
        };
        let first_word = block.words.iter().find(is_motion).map(|word| word.place);
        let Some(place) = own.map(|code| code.place).or(first_word) else {
            return Ok(false);
        };
        let Some(mode) = self.modal.motion else {
            return Err(Problem::NoMotion.at(place));
        };
        if self.modal.moves_as_at_start() {
            let text = "axis words before any motion code are those of a G0, as the machine file says";
            self.tell_once(text.to_owned(), place);
        }
        if !self.modal.tip {
            return Err(Problem::NotTip.at(place));
        }
        self.modal.closed = false;
        self.check_reshaped(block, mode.is_cycle(), place)?;
        self.check_in_plane(block, mode, place)?;
        self.check_both_said(block)?;
        self.check_whole_plane(place)?;
        let direction = self.direction(block, claims, mode)?;
        if let Some((_, place)) = direction
            && self.offsets.frame.reshapes()
        {
            let (code, why) = ("MIRROR or SCALE", "directions of the tool do not follow it");
            return Err(Problem::Impossible { code, why }.at(place));
        }
        if mode.is_cycle() {
            return self.canned_cycle(block, claims, mode, place);
        }
        let mut said = self.said(block)?;
        let form = self.opening_angle(claims, mode, &mut said)?;
        self.line_by_angle(block, &mut said)?;
        self.fill_in_rotary(&mut said);
        let mut words = self.tip_words(said, place)?;
        if let Some((direction, place)) = direction {
            self.point(&mut words, direction, place)?;
        }
        let unit = self.modal.unit();
        words.extension = Words::of(block)
            .extension
            .map(|word| word.map(|value| value * unit));
        let from = match self.compensation.is_on() {
            true => Some(self.position(&self.modal.plane.axes(), place)?),
            false => self.known_place(),
        };
        if mode == Code::Rapid {
            if self.learn(&words) || self.has_to_come_back() {
                self.go(block, (Way::Line, words), from, None, place)?;
            }
            self.spline_end = None;
            return Ok(false);
        }
        let turns_only = mode == Code::Feed && (0..3).all(|axis| !self.moves(&words, axis));
        let feed = self.feed_rate(block, mode, place, turns_only)?;
        if opens_nurbs(mode) {
            self.open_nurbs(block, claims, mode, place, feed)?;
            return Ok(true);
        }
        if mode.probes() {
            self.spline_end = None;
            self.probe(mode, words, feed, place)?;
            // Of Fanuc, for its block only.
            self.modal.motion = self.modal.motion.filter(|code| *code != Code::Skip);
            return Ok(true);
        }
        let way = match mode {
            Code::Feed => Way::Line,
            Code::CubicSpline | Code::QuadraticSpline => self.spline(block, claims, mode, place, &said)?,
            Code::ArcThrough => Way::Arc(self.arc_through(block, &said, place)?),
            Code::TangentArc => self.tangent_arc(&words, from, place)?,
            _ => Way::Arc(self.arc(claims, mode, place, form)?),
        };
        if mode != Code::CubicSpline {
            self.spline_end = None;
        }
        // An arc without a way is a full circle.
        if self.learn(&words) || way != Way::Line || self.has_to_come_back() {
            self.go(block, (way, words), from, Some(feed), place)?;
        }
        Ok(true)
    }

    /// What lies in a plane of X, Y and Z only: contours with an offset, corners, and arcs that go on in the direction before them.
    fn check_in_plane(&self, block: &Block, mode: Code, place: SourcePosition) -> Result<(), NcError> {
        let beside = self.compensation.is_on() || self.has_to_come_back();
        if !beside && mode != Code::TangentArc && self.corner_place(block, place).is_none() {
            return Ok(());
        }
        let plane = self.modal.plane;
        match self
            .offsets
            .arcs(plane)
            .is_none_or(|arcs| arcs.about == plane.normal())
        {
            true => Ok(()),
            false => {
                let (code, why) = (
                    "a tilted or rotated plane",
                    "G41, G42, roundings, chamfers and CT do not lie in it: write their motions out, or turn about the axis of G17, G18 or G19 only",
                );
                Err(Problem::Impossible { code, why }.at(place))
            }
        }
    }

    /// Rotary axes of the first motion that it does not say.
    fn fill_in_rotary(&mut self, said: &mut [Option<f64>; AXES]) {
        if self.placed {
            return;
        }
        let default = self.setup.rotary;
        for axis in 0..3 {
            if !self.known[3 + axis] && self.setup.fitted[3 + axis] {
                said[3 + axis] = said[3 + axis].or(default[axis]);
            }
        }
    }

    /// The arc of G2 or G3.
    fn arc(
        &mut self,
        claims: &Claims,
        mode: Code,
        place: SourcePosition,
        known: Option<ArcForm>,
    ) -> Result<ArcWay, NcError> {
        let plane = self.modal.plane;
        let mut way = arc::way(claims, mode, plane, place, known)?;
        let arcs = self.offsets.arcs(plane).ok_or(Problem::StretchedArc.at(place))?;
        (way.about, way.turn) = (arcs.about, arcs.turn(way.turn));
        way.form = match way.form {
            // That of an opening angle is in mm.
            ArcForm::Radius(radius) if known.is_none() => {
                ArcForm::Radius(radius * self.modal.unit() * arcs.factor)
            }
            ArcForm::Radius(radius) => ArcForm::Radius(radius * arcs.factor),
            ArcForm::Centre(_) => {
                let words = arc::CENTRE_WORDS.map(|name| claims.word(mode, name));
                let [a, b] = plane.axes();
                let own =
                    |word: Option<&Word>| word.is_some_and(|word| word.distance == Some(Distance::Absolute));
                let now = match self.modal.absolute_centres || words.into_iter().any(own) {
                    true => self.programmed(&[a.min(b), a.max(b)], place)?,
                    false => Coordinates::default(),
                };
                let mut offset = [0.0; 3];
                for axis in [a, b] {
                    offset[axis] = self.to_centre(words[axis], now[axis]);
                }
                ArcForm::Centre(self.offsets.direction(offset))
            }
        };
        Ok(way)
    }

    /// G5 and G5.1: one Bézier curve in the plane X Y, to the coordinates `said`.
    fn spline(
        &mut self,
        block: &Block,
        claims: &Claims,
        mode: Code,
        place: SourcePosition,
        said: &[Option<f64>; AXES],
    ) -> Result<Way, NcError> {
        let code = mode.name();
        let impossible = |why| Err(Problem::Impossible { code, why }.at(place));
        if self.modal.plane != Plane::Xy {
            return impossible("it lies in the XY plane: select it with G17");
        }
        if let Some(word) = ["Z", "A", "B", "C"].iter().find_map(|name| block.word(name)) {
            return Err(Problem::Orphan(word.label()).at(word.place));
        }
        let unit = self.modal.unit();
        let pair = |names: [&str; 2]| {
            let words = names.map(|name| claims.word(mode, name));
            let any = words.iter().any(Option::is_some);
            any.then(|| words.map(|word| word.map_or(0.0, |word| word.value * unit)))
        };
        let now = self.programmed(&[0, 1], place)?;
        let start = [now[0], now[1]];
        let tilted = self.offsets.tilted();
        let end = [said[0].unwrap_or(now[0]), said[1].unwrap_or(now[1])];
        let first = pair(["I", "J"]);
        let plus = |a: [f64; 2], b: [f64; 2]| [a[0] + b[0], a[1] + b[1]];
        let inner = if mode == Code::QuadraticSpline {
            let Some(first) = first else {
                return impossible("I and J lead from the start to the control point");
            };
            vec![plus(start, first)]
        } else {
            let Some(last) = pair(["P", "Q"]) else {
                return impossible("P and Q lead from the end to the second control point");
            };
            let smooth = self.spline_end.map(|[p, q]| [-p, -q]);
            let Some(first) = first.or(smooth) else {
                return impossible(
                    "I and J lead from the start to the first control point; only after another G5 it goes on by itself",
                );
            };
            self.spline_end = Some(last);
            vec![plus(start, first), plus(end, last)]
        };
        let order = inner.len() + 2;
        let mut points = vec![ControlPoint {
            position: [None; 3],
            weight: 1.0,
            place,
        }];
        for [x, y] in inner.into_iter().chain([end]) {
            let tip = self.offsets.to_tip(&[x, y, now[2], 0.0, 0.0, 0.0]);
            points.push(ControlPoint {
                position: [Some(tip[0]), Some(tip[1]), Some(tip[2]).filter(|_| tilted)],
                weight: 1.0,
                place,
            });
        }
        let knots = [0.0, 1.0].iter().flat_map(|knot| vec![*knot; order]).collect();
        Ok(Way::Nurbs(Box::new(NurbsWay { order, points, knots })))
    }

    fn open_nurbs(
        &mut self,
        block: &Block,
        claims: &Claims,
        mode: Code,
        place: SourcePosition,
        feed: FeedRate,
    ) -> Result<(), NcError> {
        if mode == Code::UniformNurbs && self.modal.plane != Plane::Xy {
            return Err(Problem::NurbsPlane.at(place));
        }
        if self.modal.incremental {
            let (code, why) = (mode.name(), "control points are absolute: write G90");
            return Err(Problem::Impossible { code, why }.at(place));
        }
        self.nurbs = Some(OpenNurbs::begin(block, claims, mode, place, feed)?);
        Ok(())
    }

    /// A complete NURBS, with coordinates as they are written. No motion continues after it.
    pub(super) fn end_nurbs(&mut self, mut way: NurbsWay, mut words: Words) -> Result<(), NcError> {
        let Some(open) = self.nurbs.take() else {
            return Ok(());
        };
        let unit = self.modal.unit();
        let mut last = [None; 3];
        for point in &mut way.points {
            let mut said = [None; AXES];
            for axis in 0..3 {
                said[axis] = point.position[axis].map(|value| value * unit);
            }
            // What was said before holds on, where all of them are needed.
            if self.offsets.says_in_part(&said) {
                for axis in self.offsets.coupled() {
                    said[*axis] = said[*axis].or(last[*axis]);
                }
            }
            for axis in 0..3 {
                last[axis] = said[axis].or(last[axis]);
            }
            let tip = self.tip_words(said, point.place)?;
            point.position = [tip.axes[0], tip.axes[1], tip.axes[2]];
        }
        words.axes[..3].copy_from_slice(&last);
        words.axes = self.tip_words(words.axes, open.place)?.axes;
        words.extension = words.extension.map(|word| word.map(|value| value * unit));
        self.learn(&words);
        self.feed_motion(Way::Nurbs(Box::new(way)), words, open.feed, open.place)?;
        self.modal.closed = self.modal.motion == Some(Code::KnotNurbs);
        self.modal.motion = None;
        Ok(())
    }

    pub(super) fn rapid(&mut self, way: Way, words: Words, place: SourcePosition) -> Result<(), NcError> {
        self.alone(Motion::Rapid, (way, words), None, place)
    }

    /// A path of one motion, or of none that still counts as one; no beam of `laser` burns on it.
    pub(super) fn alone(
        &mut self,
        motion: Motion,
        (mut way, mut words): (Way, Words),
        feed: Option<FeedRate>,
        place: SourcePosition,
    ) -> Result<(), NcError> {
        if way != Way::Axes {
            self.retract(&mut way, &mut words, place, feed.is_some())?;
        }
        self.corners.forget();
        self.said = None;
        self.motions += 1;
        let target = Target {
            way,
            words,
            feed,
            control: self.modal.control,
            place,
        };
        self.start_path(motion, target);
        self.burning.gate = false;
        self.open = false;
        Ok(())
    }

    /// Goes on along an open path, or starts one.
    pub(super) fn feed_motion(
        &mut self,
        mut way: Way,
        mut words: Words,
        feed: FeedRate,
        place: SourcePosition,
    ) -> Result<(), NcError> {
        self.spindle.check_speed(self.setup.laser.is_some())?;
        self.burn(feed, place)?;
        self.retract(&mut way, &mut words, place, true)?;
        self.corners.forget();
        self.said = None;
        self.motions += 1;
        let target = Target {
            way,
            words,
            feed: Some(feed),
            control: self.modal.control,
            place,
        };
        match self.paths.last_mut() {
            Some(path) if self.open => {
                let with_target = path.targets.len();
                path.targets.push(target);
                let waiting = self.pending.drain(..);
                path.events
                    .extend(waiting.map(|pending| pending.event(with_target)));
            }
            _ => self.start_path(Motion::Feed, target),
        }
        self.open = true;
        Ok(())
    }

    fn start_path(&mut self, motion: Motion, target: Target) {
        let dwell_before_s = self.dwell_before();
        self.paths.push(ProgramPath {
            waits_before: std::mem::take(&mut self.waits),
            dwell_before_s,
            motion,
            targets: match motion {
                Motion::Stand => Vec::new(),
                Motion::Rapid | Motion::Feed => vec![target],
            },
            events: self.pending.drain(..).map(|pending| pending.event(0)).collect(),
            probe: None,
            fixed_feed: self.fixed_feed,
            rest: None,
        });
    }

    /// Whether `words` lead an axis elsewhere.
    pub(super) fn moves(&self, words: &Words, axis: usize) -> bool {
        words.axes[axis].is_some_and(|value| !self.known[axis] || value != self.at[axis])
    }

    /// Takes up what `words` say; whether that is anything new.
    pub(super) fn learn(&mut self, words: &Words) -> bool {
        let mut new = false;
        for axis in 0..AXES {
            if let Some(value) = words.axes[axis] {
                new |= self.moves(words, axis);
                (self.at[axis], self.known[axis]) = (value, true);
            }
        }
        for (own, said) in self.extension.iter_mut().zip(words.extension) {
            if said.is_some() && *own != said {
                *own = said;
                new = true;
            }
        }
        self.placed |= new;
        new
    }
}

fn is_curve(code: Code) -> bool {
    matches!(code, Code::CubicSpline | Code::QuadraticSpline)
}

/// Whether a motion with this code is a NURBS of several blocks.
fn opens_nurbs(code: Code) -> bool {
    matches!(code, Code::UniformNurbs | Code::KnotNurbs)
}
