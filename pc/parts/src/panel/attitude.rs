//! A and C along a line of normals.
//!
//! N = (sinC sinA, −cosC sinA, cosA). Where the normal is well inclined it gives C; near the vertical its
//! direction means little and C would have to turn fast. There C continues smoothly from one side to the
//! other, A changes its sign where that is the shorter way, and the tool leans off the normal by less than
//! the inclination.

use super::PanelError;
use super::line::Station;
use cam::curve::Curve;
use nalgebra::Vector3;
use shared::geometry::angle;
use shared::kinematics::AxisLimits;
use std::f64::consts::PI;

/// Below this inclination no normal gives C \[rad\].
const LEVEL: f64 = 0.01;

/// A and C for every station.
#[derive(Clone, Debug, PartialEq)]
pub struct Attitudes {
    /// A and C \[rad\].
    pub angles: Vec<[f64; 2]>,
    /// Largest angle of the tool with the normal \[rad\], and the station where it is.
    pub lean: (f64, usize),
}

/// Axis of the tool.
pub fn tool_axis([a, c]: [f64; 2]) -> Vector3<f64> {
    let (sin_a, cos_a) = libm::sincos(a);
    let (sin_c, cos_c) = libm::sincos(c);
    Vector3::new(sin_c * sin_a, -cos_c * sin_a, cos_a)
}

impl Attitudes {
    /// For `stations`, at least two, C beginning near `near` \[rad\]. Stations less inclined than `upright` \[rad\] do
    /// not give C. `None` if C does not stay within its `limits`.
    pub fn along(
        stations: &[Station],
        upright: f64,
        near: f64,
        limits: &AxisLimits,
    ) -> Result<Option<Self>, PanelError> {
        let inclination = |station: &Station| angle(&station.normal, &Vector3::z());
        let steepest = stations.iter().map(inclination).fold(0.0, f64::max);
        // On a level panel the normals that there are have to do.
        let upright = upright.min(steepest / 2.0).max(LEVEL);
        let mut nodes: Vec<(f64, f64)> = Vec::new();
        for station in stations.iter().filter(|s| inclination(s) >= upright) {
            let direction = libm::atan2(station.normal.x, -station.normal.y);
            let before = nodes.last().map_or(near, |(_, c)| *c);
            nodes.push((station.s, before + wrap_half(direction - before)));
        }
        // C stands still before the first and after the last of them.
        let (first, last) = (stations[0].s, stations[stations.len() - 1].s);
        let (c_first, c_last) = match (nodes.first(), nodes.last()) {
            (Some((_, first)), Some((_, last))) => (*first, *last),
            _ => (near, near),
        };
        if nodes.first().is_none_or(|(s, _)| *s > first) {
            nodes.insert(0, (first, c_first));
        }
        if nodes.last().is_none_or(|(s, _)| *s < last) {
            nodes.push((last, c_last));
        }
        let (s, c): (Vec<f64>, Vec<[f64; 1]>) = nodes.into_iter().map(|(s, c)| (s, [c])).unzip();
        let turn = Curve::through(s, &c).map_err(PanelError::Curve)?;
        // Half a turn further A has the other sign, and the tool stands the same.
        let turns = [0.0, PI, -PI, 2.0 * PI, -2.0 * PI];
        let mut found = turns
            .into_iter()
            .map(|turned| Self::turned(stations, &turn, turned));
        Ok(found.find(|found| found.angles.iter().all(|[_, c]| limits.contains(*c))))
    }

    fn turned(stations: &[Station], turn: &Curve<1>, turned: f64) -> Self {
        let mut lean = (0.0, 0);
        let mut angles = Vec::with_capacity(stations.len());
        for (index, station) in stations.iter().enumerate() {
            let c = turn.at(station.s)[0][0] + turned;
            let toward = Vector3::new(libm::sin(c), -libm::cos(c), 0.0);
            let a = libm::atan2(station.normal.dot(&toward), station.normal.z);
            let off = angle(&tool_axis([a, c]), &station.normal);
            if off > lean.0 {
                lean = (off, index);
            }
            angles.push([a, c]);
        }
        Self { angles, lean }
    }
}

/// `x` plus as many half turns as bring it to (−90°, 90°] \[rad\].
fn wrap_half(x: f64) -> f64 {
    x - PI * libm::ceil(x / PI - 0.5)
}
