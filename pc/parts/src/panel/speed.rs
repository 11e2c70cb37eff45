//! How fast a line can be cut: checked before anything moves.

use super::program::C;
use super::{Panel, PanelError};
use crate::PartContext;
use cam::path::{Bound, Planner};
use nc::{Options, interpret};
use shared::io::AXIS_NAMES;
use shared::units::MM_S_PER_M_MIN;
use teach::TaughtPoint;

/// A feed that every machine can follow, to see what a line asks of it \[m/min\].
const CREEP: f64 = 1e-3;
/// Guide points lie some millimetres and degrees off the panel, so the line through them asks more of the drives than the
/// taught one will, by a third on the shipped panel. By more than this it is no matter of how they lie.
const GUIDES: f64 = 2.0;

impl Panel {
    /// Whether every drive is fast enough on the line through `points`.
    pub(super) fn check_speed(
        &self,
        context: &PartContext,
        points: &[TaughtPoint],
    ) -> Result<(), PanelError> {
        match self.bound(context, points)? {
            Some(bound) if self.speed_m_min > bound.largest_mm_s / MM_S_PER_M_MIN => {
                Err(self.too_fast(&bound, points, "taught"))
            }
            _ => Ok(()),
        }
    }

    /// Whether the feed can be cut, as far as the guide points show that before anything is taught; what a
    /// person should know of it, if it is not sure.
    ///
    /// # Errors
    /// [`PanelError::Value`], [`PanelError::Speed`].
    pub fn check_before_teaching(&self, context: &PartContext) -> Result<Option<String>, PanelError> {
        self.check()?;
        let points: Vec<TaughtPoint> = self.guides().iter().map(as_taught).collect();
        // A line that cannot be planned through rough points may well be through taught ones.
        let Ok(Some(bound)) = self.bound(context, &points) else {
            return Ok(None);
        };
        let largest = bound.largest_mm_s / MM_S_PER_M_MIN;
        let too_fast = || self.too_fast(&bound, &points, "guide");
        if self.speed_m_min > GUIDES * largest {
            return Err(too_fast());
        }
        let unsure = || {
            format!(
                "{}; whether this holds for the panel is only known when it is taught",
                too_fast()
            )
        };
        Ok((self.speed_m_min > largest).then(unsure))
    }

    /// The drive that allows the least speed on the line through `points`.
    fn bound(&self, context: &PartContext, points: &[TaughtPoint]) -> Result<Option<Bound>, PanelError> {
        let creeping = Self {
            speed_m_min: CREEP,
            ..self.clone()
        };
        let plan = creeping.program(context, points)?;
        // Other errors of the program are reported when it is planned.
        let program = interpret(&plan.program, Options::default()).ok();
        let paths = program.and_then(|program| {
            let planner = Planner::build(context.machine).ok()?;
            let from = context.machine.planning.park_axes();
            planner.program(&program, &from, None).ok()
        });
        let bounds = paths.into_iter().flatten().filter_map(|path| path.bound);
        Ok(bounds.min_by(|a, b| a.largest_mm_s.total_cmp(&b.largest_mm_s)))
    }

    fn too_fast(&self, bound: &Bound, points: &[TaughtPoint], whose: &'static str) -> PanelError {
        let mut before = 0.0;
        let mut ways = vec![0.0];
        for pair in points.windows(2) {
            before += (pair[1].position - pair[0].position).norm();
            ways.push(before);
        }
        // The line begins a lead before the first point.
        let off = |way: &f64| (way + self.lead_mm - bound.s_mm).abs();
        let nearest = ways
            .iter()
            .enumerate()
            .min_by(|a, b| off(a.1).total_cmp(&off(b.1)));
        PanelError::Speed {
            whose,
            point: nearest.map_or(1, |(index, _)| index + 1),
            axis: bound.axis,
            quantity: bound.quantity,
            largest: bound.largest_mm_s / MM_S_PER_M_MIN,
            speed: self.speed_m_min,
            upright: bound.axis == AXIS_NAMES[C],
        }
    }
}

/// A guide as if the panel were there.
fn as_taught(guide: &teach::GuidePoint) -> TaughtPoint {
    let [a, _, c] = guide.angles_deg.map(f64::to_radians);
    TaughtPoint {
        position: guide.position,
        normal: crate::panel::attitude::tool_axis([a, c]),
        error: 0.0,
        rings: 0,
        time_s: 0.0,
    }
}
