//! Contours as Siemens has them besides: RND=, RNDM=, CHF= and CHR= put something into the corner between a motion and the
//! next one, CT goes on in the direction of the motion before, and ANG= gives the direction of a line.

use super::inserts::{Cut, Insert, cut};
use crate::block::{Block, Word};
use crate::error::{NcError, Problem, SourcePosition};
use crate::interpreter::Interpreter;
use crate::offsets::Coordinates;
use crate::pieces::Piece;
use crate::program::{ArcForm, ArcWay, FeedRate, Plane, Way, Words};
use crate::reader::Reader;
use nalgebra::Vector2;
use shared::geometry::Turn;
use shared::io::AXES;

/// Most lines between a motion and the next one that a corner is made with.
const MOST_LINES_BETWEEN: usize = 100;
/// An arc by its tangent is a line where the sine of the angle to its end is less, and so is a line along an axis.
const STRAIGHT: f64 = 1e-9;

/// What is known of the contour.
#[derive(Clone, Debug, Default)]
pub(crate) struct Corners {
    /// RNDM= \[mm\].
    rounding: f64,
    /// FRCM= \[mm/min\].
    feed: f64,
    /// The motion before, as it is programmed, if it is known.
    last: Option<Piece>,
    /// The one after that of the block that is carried out, where a corner is wanted.
    next: Option<Piece>,
    /// Where the next motion begins, behind what was put into the corner \[mm\].
    begins: Option<Vector2<f64>>,
    /// Motions are looked at ahead, and their corners are not wanted.
    looks_ahead: bool,
}

impl Corners {
    /// The next motion goes on from somewhere else.
    pub(crate) fn forget(&mut self) {
        (self.last, self.begins) = (None, None);
    }

    /// RNDM= rounds every corner.
    pub(crate) fn rounds(&self) -> bool {
        self.rounding > 0.0
    }
}

impl Reader {
    /// Looks at the motion after that of `block`, which is the next to be carried out, if there is to be a corner.
    pub(crate) fn look_behind_corner(&mut self, block: &Block) {
        let wanted = self.interpreter.wants_corner(block);
        self.interpreter.corners.next = wanted.then(|| self.motion_after(block)).flatten();
    }

    /// A copy, prepared and without its paths, that has carried out `block`; none if that is wrong.
    pub(crate) fn copy_behind(
        &mut self,
        block: &Block,
        prepare: impl FnOnce(&mut Interpreter),
    ) -> Option<Self> {
        let mut state = self.interpreter.without_blocks();
        state.corners.looks_ahead = true;
        prepare(&mut state);
        let mut ahead = Self::at(self.position.clone(), state, self.options.clone());
        ahead.interpreter.block(block).ok()?;
        ahead.call_of(block).ok()?;
        Some(ahead)
    }

    /// What is wrong ahead is told where it is carried out.
    fn motion_after(&mut self, block: &Block) -> Option<Piece> {
        let mut ahead = self.copy_behind(block, |_| ())?;
        ahead.interpreter = ahead.interpreter.without_blocks();
        for _ in 0..MOST_LINES_BETWEEN {
            if !ahead.block().ok()? || !ahead.interpreter.open {
                return None;
            }
            let path = ahead.interpreter.paths.last();
            if path.is_some_and(|path| !path.targets.is_empty()) {
                return ahead.interpreter.corners.last;
            }
        }
        None
    }
}

impl Interpreter {
    /// RNDM= and FRCM= of a block.
    pub(crate) fn modal_corner(&mut self, block: &Block) -> Result<(), NcError> {
        if let Some(rounding) = block.word("RNDM") {
            self.corners.rounding = self.length(rounding)?;
        }
        if let Some(feed) = block.word("FRCM") {
            self.corners.feed = self.length(feed)?;
        }
        Ok(())
    }

    fn wants_corner(&self, block: &Block) -> bool {
        let words = ["RND", "RNDM", "CHF", "CHR"];
        let wanted = self.corners.rounds() || words.iter().any(|name| block.word(name).is_some());
        wanted && !self.corners.looks_ahead
    }

    /// Where the tip is, if its place in the plane is known.
    pub(crate) fn known_place(&self) -> Option<Coordinates> {
        let known = !self.lost && self.modal.plane.axes().iter().all(|axis| self.known[*axis]);
        known.then_some(self.at)
    }

    /// Where the tip is: behind what was put into the last corner.
    pub(crate) fn place(&self) -> Coordinates {
        let mut at = self.at;
        if let Some((plane, aside)) = self.compensation.aside() {
            for (axis, value) in plane.axes().into_iter().zip(aside) {
                at[axis] = value;
            }
        }
        if let Some(begins) = self.corners.begins {
            for (axis, value) in self.modal.plane.axes().into_iter().zip(begins.iter()) {
                at[axis] = *value;
            }
        }
        at
    }

    /// The tip has come by this motion.
    pub(crate) fn has_come_by(&mut self, piece: Piece) {
        self.corners.last = Some(piece);
    }

    /// Whether `block` puts something into the corner behind it.
    pub(crate) fn puts_into_corner(&self, block: &Block) -> Result<bool, NcError> {
        Ok(self.insert(block)?.is_some())
    }

    /// The tip has come straight from there.
    pub(crate) fn has_come(&mut self, from: Option<Coordinates>) {
        self.corners.last = from.and_then(|from| Piece::of(&Way::Line, self.modal.plane, &from, &self.at));
    }

    /// Feeds from a place of the tip to where it is now, and through what `block` puts into the corner there.
    pub(crate) fn feed_to_corner(
        &mut self,
        block: &Block,
        (mut way, mut words): (Way, Words),
        from: Option<Coordinates>,
        feed: FeedRate,
        place: SourcePosition,
    ) -> Result<(), NcError> {
        let plane = self.modal.plane;
        let piece = from.and_then(|from| Piece::of(&way, plane, &from, &self.at));
        let begins = self.corners.begins.take();
        let next = self.corners.next.take();
        let own = piece.map(|piece| begins.map_or(piece, |start| piece.starting(start)));
        let corner = match (self.insert(block)?, next) {
            (Some((insert, word)), Some(next)) => {
                let fitting = own.and_then(|own| cut(&own, &next, insert).ok());
                fitting.ok_or_else(|| {
                    let why = "it does not fit between this motion and the next: both are lines or arcs in the plane, and \
                               long enough; with a chamfer lines";
                    word.map_or(Problem::Impossible { code: "RNDM=", why }.at(place), |word| word.value_error(why))
                })?
            }
            (Some((_, Some(word))), None) => {
                let text = format!(
                    "{}: the path ends here, and nothing is put into the corner",
                    word.label()
                );
                self.notice(text, word.place);
                None
            }
            _ => None,
        };
        if let (Way::Arc(arc), Some(offset)) = (&mut way, own.and_then(Piece::to_centre))
            && (begins.is_some() || corner.is_some())
        {
            // With another end it may be the shorter of the two by its radius.
            arc.form = ArcForm::Centre(in_plane(plane, offset));
        }
        let Some(Cut { from, to, arc }) = corner else {
            self.feed_motion(way, words, feed, place)?;
            self.corners.last = piece;
            return Ok(());
        };
        set(&mut words, plane, from);
        self.feed_motion(way, words, feed, place)?;
        let through = match arc {
            None => Way::Line,
            Some((centre, turn)) => Way::Arc(ArcWay {
                about: plane.normal(),
                turn,
                form: ArcForm::Centre(in_plane(plane, centre - from)),
                more_turns: 0,
            }),
        };
        let mut words = Words::default();
        set(&mut words, plane, to);
        let feed = self.corner_feed(block)?.unwrap_or(feed);
        self.feed_motion(through, words, feed, place)?;
        (self.corners.last, self.corners.begins) = (piece, Some(to));
        Ok(())
    }

    /// What `block` puts into the corner behind it, and the word that says so, but for RNDM=.
    fn insert<'b>(&self, block: &'b Block) -> Result<Option<(Insert, Option<&'b Word>)>, NcError> {
        if self.corners.looks_ahead {
            return Ok(None);
        }
        let word = |name, form: fn(f64) -> Insert| block.word(name).map(|word| (word, form));
        let words = [
            word("RND", Insert::Rounding),
            word("CHF", Insert::Chamfer),
            word("CHR", Insert::ChamferLeg),
        ];
        let mut said = words.into_iter().flatten();
        let Some((word, form)) = said.next() else {
            let rounding = self.corners.rounding;
            return Ok((rounding > 0.0).then_some((Insert::Rounding(rounding), None)));
        };
        if let Some((second, _)) = said.next() {
            return Err(second.value_error("a corner has one of RND=, CHF= and CHR="));
        }
        let length = self.length(word)?;
        Ok((length > 0.0).then(|| (form(length), Some(word))))
    }

    /// FRC= or FRCM=, if either holds.
    fn corner_feed(&self, block: &Block) -> Result<Option<FeedRate>, NcError> {
        let own = block.word("FRC").map(|word| self.length(word)).transpose()?;
        let feed = own.unwrap_or(self.corners.feed);
        Ok((feed > 0.0).then_some(FeedRate::PerMinute(feed)))
    }

    /// A length in mm, or a feed in mm/min.
    fn length(&self, word: &Word) -> Result<f64, NcError> {
        match word.value >= 0.0 {
            true => Ok(word.value * self.modal.unit()),
            false => Err(word.value_error("what is put into corners is not below 0")),
        }
    }

    /// CT: the arc from a place of the tip to where `words` lead that begins in the direction of the motion before.
    pub(crate) fn tangent_arc(
        &mut self,
        words: &Words,
        from: Option<Coordinates>,
        place: SourcePosition,
    ) -> Result<Way, NcError> {
        let plane = self.modal.plane;
        let wrong = |why| Problem::Impossible { code: "CT", why }.at(place);
        let before = self.corners.last.filter(|last| last.plane == plane);
        let (from, heading) = from.zip(before.and_then(|last| last.heading())).ok_or_else(|| {
            wrong("it needs a line or an arc in the plane before it, whose direction it goes on in")
        })?;
        let chord = Vector2::from(
            plane
                .axes()
                .map(|axis| words.axes[axis].unwrap_or(from[axis]) - from[axis]),
        );
        // How far its end is to the left, and ahead.
        let (aside, ahead) = (heading.perp(&chord), heading.dot(&chord));
        if aside.abs() <= STRAIGHT * chord.norm() {
            return match ahead > 0.0 {
                true => Ok(Way::Line),
                false => Err(wrong("its end lies behind its start, or is its start")),
            };
        }
        let left = Vector2::new(-heading.y, heading.x);
        Ok(Way::Arc(ArcWay {
            about: plane.normal(),
            turn: if aside > 0.0 {
                Turn::CounterClockwise
            } else {
                Turn::Clockwise
            },
            form: ArcForm::Centre(in_plane(plane, left * (chord.norm_squared() / (2.0 * aside)))),
            more_turns: 0,
        }))
    }

    /// ANG=: the other coordinate of the end of a line in the plane is put into `said`.
    pub(crate) fn line_by_angle(
        &mut self,
        block: &Block,
        said: &mut [Option<f64>; AXES],
    ) -> Result<(), NcError> {
        let Some(angle) = block.word("ANG") else {
            return Ok(());
        };
        let [a, b] = self.modal.plane.axes();
        let now = self.programmed(&[a.min(b), a.max(b)], angle.place)?;
        let (sin, cos) = angle.value.to_radians().sin_cos();
        let (known, slope) = match (said[a], said[b]) {
            (Some(end), None) => (end - now[a], sin / cos),
            (None, Some(end)) => (end - now[b], cos / sin),
            _ => {
                return Err(angle.value_error(
                    "a line by its angle has one coordinate of its end in the plane besides; contours of several lines \
                     with angles are not supported",
                ));
            }
        };
        let other = known * slope;
        let ahead = match said[a] {
            Some(_) => known * cos,
            None => known * sin,
        };
        if slope.abs() > 1.0 / STRAIGHT || ahead < 0.0 {
            return Err(angle.value_error("no line in this direction leads to that coordinate"));
        }
        match said[a] {
            Some(_) => said[b] = Some(now[b] + other),
            None => said[a] = Some(now[a] + other),
        }
        Ok(())
    }
}

/// Coordinates of the plane among those of X, Y and Z.
fn in_plane(plane: Plane, place: Vector2<f64>) -> [f64; 3] {
    let mut all = [0.0; 3];
    for (axis, value) in plane.axes().into_iter().zip(place.iter()) {
        all[axis] = *value;
    }
    all
}

fn set(words: &mut Words, plane: Plane, place: Vector2<f64>) {
    for (axis, value) in plane.axes().into_iter().zip(place.iter()) {
        words.axes[axis] = Some(*value);
    }
}
