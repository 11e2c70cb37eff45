//! The NC program of a cut: approach, lead-in, cut, lead-out, retract.

use super::attitude::{Attitudes, tool_axis};
use super::line::{Line, Station};
use super::{Panel, PanelError};
use crate::{PartContext, Plan};
use config::in_range;
use config::table::FARTHEST_MM;
use nalgebra::Vector3;
use nc::text::{NcText, decimal};
use shared::geometry::Pose;
use shared::io::{AXES, AXIS_NAMES};
use shared::kinematics::{AXIS_UNIT, AxisLimits, Kinematics};
use shared::units::MM_S_PER_M_MIN;
use teach::TaughtPoint;

const Z: usize = 2;
const A: usize = 3;
pub(super) const C: usize = 5;
/// Decimals of lengths \[mm\] and of angles \[deg\].
const LENGTH_DECIMALS: i32 = 5;
const ANGLE_DECIMALS: i32 = 6;

/// A point of the program.
#[derive(Clone, Copy, Debug)]
struct Stop {
    station: Station,
    /// A and C \[rad\].
    angles: [f64; 2],
    /// Where the axes stand (mm, rad).
    axes: [f64; AXES],
}

impl Panel {
    /// The program through `points`.
    pub(super) fn program(&self, context: &PartContext, points: &[TaughtPoint]) -> Result<Plan, PanelError> {
        let machine = context.machine;
        let limits = AxisLimits::build_all(&machine.motion.axes).map_err(|_| PanelError::NoHead)?;
        let kinematics = match machine.motion.kinematics.build(&limits) {
            Ok(kinematics @ Kinematics::AcHead(_)) => kinematics,
            _ => return Err(PanelError::NoHead),
        };
        let line = Line::through(points, self.closed)?;
        let (stations, cut) = self.stations(&line, context)?;
        let near = self.guide.first().map_or(0.0, |guide| guide[4].to_radians());
        let upright = self.teaching.upright_deg.to_radians();
        let attitudes = Attitudes::along(&stations, upright, near, &limits[C])?;
        let point = |s: f64| line.point_near(s, points.len());
        let Some(attitudes) = attitudes else {
            let point = point(0.0);
            return Err(PanelError::Travel { point, axis: "C" });
        };
        let mut stops: Vec<Stop> = Vec::with_capacity(stations.len());
        for (station, angles) in stations.iter().zip(&attitudes.angles) {
            let axes = self.axes(station, *angles, &kinematics, stops.last(), point(station.s))?;
            if let Some(axis) = (0..AXES).find(|i| !limits[*i].contains(axes[*i])) {
                let (point, axis) = (point(station.s), AXIS_NAMES[axis]);
                return Err(PanelError::Travel { point, axis });
            }
            stops.push(Stop {
                station: *station,
                angles: *angles,
                axes,
            });
        }
        let lean = (attitudes.lean.0.to_degrees(), point(stations[attitudes.lean.1].s));
        let mut notes = vec![format!(
            "{} taught points, {:.1} mm to cut, {} points of the program",
            points.len(),
            line.length(),
            stops.len()
        )];
        if lean.0 >= 0.01 {
            notes.push(format!(
                "near the vertical C is kept from turning fast: the tool leans off the normal by up to {:.2}°, near \
                 taught point {}",
                lean.0, lean.1
            ));
        }
        Ok(Plan {
            program: self.text(context, &stops, cut, &kinematics, &line, points.len())?,
            notes,
        })
    }

    /// Places on the line from the lead-in to the lead-out, and which of them are the ends of the cut.
    fn stations(&self, line: &Line, context: &PartContext) -> Result<(Vec<Station>, [usize; 2]), PanelError> {
        let planning = &context.machine.planning;
        let velocity = self.speed_m_min * MM_S_PER_M_MIN;
        let lead = self.lead_mm.max(planning.speed_up_length(velocity));
        let requirement =
            "shorter: correct speed_m_min, or path_acceleration_mm_s2 and path_jerk_mm_s3 of the machine";
        in_range("lead_mm", lead, lead <= FARTHEST_MM, requirement)?;
        let length = line.length();
        let pieces = [(-lead, 0.0), (0.0, length), (length, length + lead)];
        let mut stations = vec![line.at(-lead)];
        let ends = pieces.map(|(from, to)| {
            let count = ((to - from) / self.spacing_mm).ceil().max(1.0) as usize;
            stations.extend((1..=count).map(|i| line.at(from + (to - from) * i as f64 / count as f64)));
            stations.len() - 1
        });
        Ok((stations, [ends[0], ends[1]]))
    }

    /// Where the axes stand at `station` with A and C as given.
    fn axes(
        &self,
        station: &Station,
        angles: [f64; 2],
        kinematics: &Kinematics,
        before: Option<&Stop>,
        point: usize,
    ) -> Result<[f64; AXES], PanelError> {
        let [a, c] = angles;
        let near = before.map_or([0.0, 0.0, 0.0, a, 0.0, c], |before| {
            let mut near = before.axes;
            near[A] = a;
            near[C] = c;
            near
        });
        let (sin, cos) = libm::sincos(c);
        let pose = Pose {
            position: station.position,
            tangent: Vector3::new(cos, sin, 0.0),
            normal: tool_axis(angles),
        };
        kinematics
            .inverse(&pose, &near)
            .map_err(|source| PanelError::Attitude { point, source })
    }

    fn text(
        &self,
        context: &PartContext,
        stops: &[Stop],
        cut: [usize; 2],
        kinematics: &Kinematics,
        line: &Line,
        count: usize,
    ) -> Result<String, PanelError> {
        let machine = context.machine;
        let (first, last) = (&stops[0], &stops[stops.len() - 1]);
        let off = |stop: &Stop| stop.station.position + tool_axis(stop.angles) * self.teaching.approach_mm;
        let safe = machine.planning.safe_height_mm;
        let top = stops.iter().map(|stop| stop.station.position.z);
        let top = top.fold(f64::NEG_INFINITY, f64::max) + self.teaching.approach_mm;
        if safe < top {
            return Err(PanelError::SafeHeight { safe, top });
        }
        // Over the beginning, with its attitude.
        let mut over = first.axes;
        over[Z] += safe - kinematics.forward(&first.axes).position.z;
        let high = over[Z].max(machine.planning.park_axes()[Z]);

        let mut nc = NcText::default();
        nc.line("%");
        nc.comment(context.title);
        nc.comment(&format!(
            "machine {}, {} m/min, {count} taught points",
            machine.name, self.speed_m_min
        ));
        nc.comment("X Y Z: focus [mm], A C: head [deg]; with G53 the axes");
        nc.block("G21 G17 G90 G94 G40 G500 G64");
        nc.comment("approach");
        nc.block(&format!("G53 G0 Z{}", decimal(high, LENGTH_DECIMALS)));
        nc.block(&format!(
            "G53 G0 {}",
            words(&[over[0], over[1], over[2]], &first.angles)
        ));
        nc.block("G43.4");
        nc.block(&format!("G0 {}", words(&off(first).into(), &first.angles)));
        nc.block(&format!(
            "G0 {}",
            words(&first.station.position.into(), &first.angles)
        ));
        nc.block(&format!("M67 E0 Q{}", decimal(self.power_w, 1)));
        nc.comment("lead-in");
        nc.block(&format!("F{}", decimal(self.speed_m_min * 1000.0, 1)));
        let mut named = 0;
        for (left, stop) in stops[1..].iter().enumerate() {
            // Outputs change at the start of the motion that leaves the point before.
            if left == cut[0] {
                nc.comment("cut");
                nc.block("M62 P0");
            }
            if left == cut[1] {
                nc.comment("lead-out");
                nc.block("M63 P0");
            }
            let near = line.point_near(stop.station.s, count);
            if (0.0..=line.length()).contains(&stop.station.s) && near > named {
                nc.comment(&format!("near taught point {near}"));
                named = near;
            }
            nc.block(&format!(
                "G1 {}",
                words(&stop.station.position.into(), &stop.angles)
            ));
        }
        nc.comment("retract");
        nc.block(&format!("G0 {}", words(&off(last).into(), &last.angles)));
        nc.block(&format!("G53 G0 Z{}", decimal(high, LENGTH_DECIMALS)));
        nc.block("M2");
        nc.line("%");
        Ok(nc.finish())
    }
}

/// X Y Z \[mm\] and A C \[rad\] as words.
fn words(position: &[f64; 3], angles: &[f64; 2]) -> String {
    let [x, y, z] = position.map(|x| decimal(x, LENGTH_DECIMALS));
    let [a, c] = [(A, angles[0]), (C, angles[1])].map(|(i, x)| decimal(x / AXIS_UNIT[i], ANGLE_DECIMALS));
    format!("X{x} Y{y} Z{z} A{a} C{c}")
}
