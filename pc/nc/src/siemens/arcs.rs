//! Arcs as Siemens has them besides: by their opening angle (AR=), through a point (CIP), and TURN=.

use super::keywords::POINT_WORDS;
use crate::arc::CENTRE_WORDS;
use crate::block::{Block, Distance, Word};
use crate::claims::Claims;
use crate::codes::Code;
use crate::error::{NcError, Problem, SourcePosition};
use crate::interpreter::Interpreter;
use crate::offsets::{about, linear};
use crate::program::{ArcForm, ArcWay, Plane};
use nalgebra::Vector3;
use shared::geometry::Turn;
use shared::io::AXES;

/// Three points are on a line where the sine of their angle is less.
const STRAIGHT: f64 = 1e-9;

impl Interpreter {
    /// The form of an arc with AR=: a radius between its ends, or nothing where it has a centre; its end is put into `said` then.
    pub(crate) fn opening_angle(
        &mut self,
        claims: &Claims,
        mode: Code,
        said: &mut [Option<f64>; AXES],
    ) -> Result<Option<ArcForm>, NcError> {
        let Some(angle) = claims.word(mode, "AR") else {
            return Ok(None);
        };
        let place = angle.place;
        if !(angle.value > 0.0 && angle.value < 360.0) {
            return Err(angle.value_error("the opening angle of an arc is above 0 and below 360 degrees"));
        }
        let [a, b] = self.modal.plane.axes();
        let now = self.programmed(&[a.min(b), a.max(b)], place)?;
        let has_end = said[a].is_some() || said[b].is_some();
        let centre = CENTRE_WORDS.iter().any(|name| claims.word(mode, name).is_some());
        let radius = ["R", "CR"].iter().any(|name| claims.word(mode, name).is_some());
        if radius || centre == has_end {
            let (code, why) = (
                "AR=",
                "an arc with an opening angle has its end or its centre besides, and nothing else",
            );
            return Err(Problem::Impossible { code, why }.at(place));
        }
        let half = (angle.value / 2.0).to_radians();
        if has_end {
            let way = [a, b].map(|axis| said[axis].unwrap_or(now[axis]) - now[axis]);
            let radius = way[0].hypot(way[1]) / (2.0 * half.sin());
            return Ok(Some(ArcForm::Radius(if angle.value > 180.0 {
                -radius
            } else {
                radius
            })));
        }
        let offset = [a, b].map(|axis| self.to_centre(claims.word(mode, CENTRE_WORDS[axis]), now[axis]));
        let sense = if mode == Code::ArcClockwise { -1.0 } else { 1.0 };
        let (sin, cos) = (sense * 2.0 * half).sin_cos();
        said[a] = Some(now[a] + offset[0] - (offset[0] * cos - offset[1] * sin));
        said[b] = Some(now[b] + offset[1] - (offset[0] * sin + offset[1] * cos));
        Ok(None)
    }

    /// From the start, which is at `now`, to the centre along an axis \[mm\], of I J or K in the units of the program.
    pub(crate) fn to_centre(&self, word: Option<&Word>, now: f64) -> f64 {
        let value = word.map_or(0.0, |word| word.value) * self.modal.unit();
        let step = word
            .and_then(|word| word.distance)
            .map_or(!self.modal.absolute_centres, Distance::is_step);
        if step { value } else { value - now }
    }

    /// The arc of CIP from the tip through the point of I1= J1= K1= to the end that is `said`.
    pub(crate) fn arc_through(
        &mut self,
        block: &Block,
        said: &[Option<f64>; AXES],
        place: SourcePosition,
    ) -> Result<ArcWay, NcError> {
        let wrong = |why| Problem::Impossible { code: "CIP", why }.at(place);
        let now = self.programmed(&[0, 1, 2], place)?;
        let mut point = [now[0], now[1], now[2]];
        let words = POINT_WORDS.map(|name| block.word(name));
        if words.iter().all(Option::is_none) {
            return Err(wrong("it needs the point that it goes through: I1= J1= K1="));
        }
        for (axis, word) in words.into_iter().enumerate() {
            let Some(word) = word else { continue };
            let steps = word.distance.map_or(self.modal.incremental, Distance::is_step);
            point[axis] = word.value * self.modal.unit() + if steps { now[axis] } else { 0.0 };
        }
        let end: [f64; 3] = std::array::from_fn(|axis| said[axis].unwrap_or(now[axis]));
        let at = |place: [f64; 3]| {
            let mut all = now;
            all[..3].copy_from_slice(&place);
            Vector3::from(linear(&self.offsets.to_tip(&all)))
        };
        // Seen from the start, in coordinates of the tip.
        let [p, e] = [point, end].map(|place| at(place) - at(linear(&now)));
        let normal = p.cross(&e);
        if normal.norm() <= STRAIGHT * p.norm() * e.norm() {
            return Err(wrong("its three points are on a straight line: write G1"));
        }
        if self.offsets.frame.reshapes() {
            let [p, e] = [point, end].map(|place| Vector3::from(place) - Vector3::from(linear(&now)));
            let (programmed, _) = about(p.cross(&e));
            let planes = [Plane::Xy, Plane::Zx, Plane::Yz];
            let own = planes.iter().position(|plane| plane.normal() == programmed);
            // In space it stays an arc only where all planes have them.
            let concerned = own.map_or(&planes[..], |index| &planes[index..=index]);
            if concerned.iter().any(|plane| self.offsets.arcs(*plane).is_none()) {
                return Err(Problem::StretchedArc.at(place));
            }
        }
        let across = e * p.norm_squared() - p * e.norm_squared();
        let to_centre = across.cross(&normal) / (2.0 * normal.norm_squared());
        let (about, mirrored) = about(normal);
        Ok(ArcWay {
            about,
            turn: match mirrored {
                true => Turn::Clockwise,
                false => Turn::CounterClockwise,
            },
            form: ArcForm::Centre(to_centre.into()),
            more_turns: 0,
        })
    }
}
