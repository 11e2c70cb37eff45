//! The motions beside a contour: one for each programmed one, and one around each outside corner.

use super::Side;
use super::offset::{Corner, Gouge, OffsetPiece};
use crate::block::Block;
use crate::error::{NcError, Problem, SourcePosition};
use crate::interpreter::Interpreter;
use crate::offsets::Coordinates;
use crate::pieces::Piece;
use crate::program::{ArcForm, ArcWay, FeedRate, Plane, Way, Words};
use nalgebra::Vector2;
use shared::geometry::Arc;
use shared::io::AXES;

/// Places of the plane that differ by less are one \[mm\].
const SAME: f64 = 1e-9;
/// The tip stands so near to an inside corner that was seen ahead \[mm\].
const AT_CORNER: f64 = 1e-6;

impl Interpreter {
    /// A motion beside the contour.
    pub(super) fn go_beside(
        &mut self,
        block: &Block,
        side: Side,
        (way, mut words): (Way, Words),
        from: Option<Coordinates>,
        feed: Option<FeedRate>,
        place: SourcePosition,
    ) -> Result<(), NcError> {
        let Side { plane, offset, .. } = side;
        let from = from.ok_or(Problem::UnknownPosition.at(place))?;
        let gouges = |gouge: Gouge| {
            let (code, radius) = (side.code, (offset.abs() * 1e6).round() / 1e6);
            let why = gouge.reason();
            Problem::Gouge { code, radius, why }.at(place)
        };
        if self.puts_into_corner(block)? {
            let (code, why) = (
                side.code,
                "RND=, RNDM=, CHF= and CHR= are not put into a compensated contour: write the arc or line",
            );
            return Err(Problem::Impossible { code, why }.at(place));
        }
        let axes = plane.axes();
        let stays = axes
            .iter()
            .all(|axis| (self.at[*axis] - from[*axis]).abs() <= SAME);
        if stays && way == Way::Line {
            axes.iter().for_each(|axis| words.axes[*axis] = None);
            return match words == Words::default() {
                true => Ok(()),
                false => self.emit(way, words, feed, place),
            };
        }
        let piece = Piece::of(&way, plane, &from, &self.at).filter(|piece| fits_radius(&way, piece));
        let piece = piece.ok_or_else(|| gouges(Gouge::Radii))?;
        if let Some(scout) = &mut self.compensation.scout {
            scout.see(piece);
            return Ok(());
        }
        let before = self.compensation.before;
        let motion = match before {
            Some(_) => OffsetPiece::along(&piece, offset),
            None => OffsetPiece::entering(&piece, offset),
        };
        let motion = motion.map_err(gouges)?;
        let mut start = match self.compensation.aside {
            Some((_, place)) => place,
            None => piece.start,
        };
        match before
            .map(|before| before.corner(&motion))
            .transpose()
            .map_err(gouges)?
        {
            Some(Corner::Around { centre, to, turn }) => {
                let round = Way::Arc(ArcWay {
                    about: plane.normal(),
                    turn,
                    form: ArcForm::Centre(in_plane(plane, centre - start)),
                    more_turns: 0,
                });
                // The rotary axes turn here, as on LinuxCNC.
                let mut corner = Words::default();
                corner.axes[3..].copy_from_slice(&words.axes[3..]);
                let round = if feed.is_some() { round } else { Way::Line };
                self.emit_to(round, corner, (plane, to), feed, place)?;
                start = to;
            }
            Some(Corner::Inside(at)) if (at - start).norm() > AT_CORNER => {
                let (code, why) = (
                    side.code,
                    "too many lines without a motion lie before this one: its inside corner was not seen ahead",
                );
                return Err(Problem::Impossible { code, why }.at(place));
            }
            _ => {}
        }
        let next = self.compensation.next.take();
        // What is wrong with the next motion is told there.
        let next = next.and_then(|next| OffsetPiece::along(&next, offset).ok());
        let corner = next
            .map(|next| motion.corner(&next))
            .transpose()
            .map_err(gouges)?;
        let end = match corner {
            Some(Corner::Inside(at)) => at,
            _ => motion.end(),
        };
        motion.check(start, end).map_err(gouges)?;
        if before.is_none() && corner.is_some_and(|corner| corner != Corner::Smooth) {
            let text = "the motion to the contour ends beside its own end, as on LinuxCNC: other controllers end it beside where the next one begins";
            self.tell_once(text.to_owned(), place);
        }
        let way = match (way, motion.arc()) {
            (Way::Arc(arc), Some((centre, _))) => Way::Arc(ArcWay {
                form: ArcForm::Centre(in_plane(plane, centre - start)),
                ..arc
            }),
            (way, _) => way,
        };
        self.emit_to(way, words, (plane, end), feed, place)?;
        self.compensation.before = Some(motion);
        self.has_come_by(piece);
        Ok(())
    }

    /// A motion to a place in the plane that is not the programmed one.
    fn emit_to(
        &mut self,
        way: Way,
        mut words: Words,
        (plane, to): (Plane, Vector2<f64>),
        feed: Option<FeedRate>,
        place: SourcePosition,
    ) -> Result<(), NcError> {
        let programmed = self.at;
        for (axis, value) in plane.axes().into_iter().zip(to.iter()) {
            words.axes[axis] = Some(*value);
            self.at[axis] = *value;
        }
        let emitted = self.emit(way, words, feed, place);
        self.at = programmed;
        self.compensation.aside = Some((plane, to));
        emitted
    }

    pub(super) fn emit(
        &mut self,
        way: Way,
        words: Words,
        feed: Option<FeedRate>,
        place: SourcePosition,
    ) -> Result<(), NcError> {
        match feed {
            Some(feed) => self.feed_motion(way, words, feed, place),
            None => self.rapid(way, words, place),
        }
    }
}

/// Whether R of an arc is that of the circle which was found for it.
fn fits_radius(way: &Way, piece: &Piece) -> bool {
    let (Way::Arc(arc), Some((centre, _))) = (way, piece.arc) else {
        return true;
    };
    match arc.form {
        ArcForm::Radius(radius) => {
            let found = (piece.start - centre).norm();
            (found - radius.abs()).abs() <= Arc::radius_tolerance(found)
        }
        ArcForm::Centre(_) => true,
    }
}

/// Coordinates of the plane among those of X, Y and Z.
fn in_plane(plane: Plane, place: Vector2<f64>) -> [f64; 3] {
    let mut all = [0.0; AXES];
    for (axis, value) in plane.axes().into_iter().zip(place.iter()) {
        all[axis] = *value;
    }
    [all[0], all[1], all[2]]
}
