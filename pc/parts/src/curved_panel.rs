//! The true shape of a curved panel, for simulated worlds.
//!
//! z = z₀ − sag(u, Rx) − sag(v, Ry) + a (cos(2πu/λ) − 1) with u, v counted from the crown along x and y,
//! sag(u, R) = R − √(R² − u²), inside a rectangle around the crown.

use nalgebra::Vector3;
use serde::Deserialize;
use std::f64::consts::TAU;

/// Steps in which a beam looks for the panel \[mm\], and where it gives up \[mm\].
const STEP: f64 = 2.0;
const FURTHEST: f64 = 300.0;
/// Halvings of the last step, down to 1e-15 of it.
const HALVINGS: usize = 50;
/// Steps of the search for the nearest point, and when it has been found \[mm\].
const SEARCH: usize = 60;
const FOUND: f64 = 1e-12;
/// Part of a radius of curvature that a panel may reach out to, so that it keeps a slope.
const REACH: f64 = 0.95;

/// A curved panel.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(try_from = "Document")]
pub struct CurvedPanel {
    crown: Vector3<f64>,
    size: [f64; 2],
    radius: [f64; 2],
    wave: f64,
    wave_number: f64,
}

/// A panel as it is written.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Document {
    /// Its highest point, where it is level.
    crown_mm: [f64; 3],
    /// How far it reaches along x and y, half of it to either side of the crown.
    size_mm: [f64; 2],
    /// Radii of curvature along x and y at the crown.
    radius_mm: [f64; 2],
    /// Amplitude of the waves along x, a.
    #[serde(default)]
    wave_mm: f64,
    /// Length of a wave, λ.
    #[serde(default = "some_length")]
    wave_length_mm: f64,
}

/// Any length does where there is no wave.
fn some_length() -> f64 {
    1.0
}

impl TryFrom<Document> for CurvedPanel {
    type Error = &'static str;

    fn try_from(d: Document) -> Result<Self, &'static str> {
        let [sx, sy] = d.size_mm;
        let [rx, ry] = d.radius_mm;
        let all = [
            d.crown_mm.as_slice(),
            &[sx, sy, rx, ry, d.wave_mm, d.wave_length_mm],
        ]
        .concat();
        if !all.iter().all(|x| x.is_finite()) {
            return Err("all numbers of a panel must be finite");
        }
        if sx <= 0.0 || sy <= 0.0 || d.wave_length_mm <= 0.0 {
            return Err("size_mm and wave_length_mm must be above 0");
        }
        if sx / 2.0 > REACH * rx || sy / 2.0 > REACH * ry {
            return Err("half of size_mm must be less than 0.95 of radius_mm");
        }
        Ok(Self {
            crown: d.crown_mm.into(),
            size: d.size_mm,
            radius: d.radius_mm,
            wave: d.wave_mm,
            wave_number: TAU / d.wave_length_mm,
        })
    }
}

impl CurvedPanel {
    /// Whether the panel is there, over or under x, y \[mm\].
    fn covers(&self, x: f64, y: f64) -> bool {
        2.0 * (x - self.crown.x).abs() <= self.size[0] && 2.0 * (y - self.crown.y).abs() <= self.size[1]
    }

    /// Height at x, y \[mm\]; not finite beyond the radii.
    fn height(&self, x: f64, y: f64) -> f64 {
        let (u, v) = (x - self.crown.x, y - self.crown.y);
        let sag = |u: f64, radius: f64| radius - libm::sqrt(radius * radius - u * u);
        let wave = self.wave * (libm::cos(self.wave_number * u) - 1.0);
        self.crown.z - sag(u, self.radius[0]) - sag(v, self.radius[1]) + wave
    }

    /// Unit normal at x, y \[mm\], upwards.
    fn normal(&self, x: f64, y: f64) -> Vector3<f64> {
        let (u, v) = (x - self.crown.x, y - self.crown.y);
        let slope = |u: f64, radius: f64| u / libm::sqrt(radius * radius - u * u);
        let wave = self.wave * self.wave_number * libm::sin(self.wave_number * u);
        Vector3::new(slope(u, self.radius[0]) + wave, slope(v, self.radius[1]), 1.0).normalize()
    }

    /// Where a beam from `origin` along the unit vector `direction` meets the panel from above: the distance \[mm\]
    /// and the normal there.
    pub fn hit(&self, origin: &Vector3<f64>, direction: &Vector3<f64>) -> Option<(f64, Vector3<f64>)> {
        let above = |t: f64| {
            let p = origin + direction * t;
            self.covers(p.x, p.y).then(|| p.z - self.height(p.x, p.y))
        };
        let mut before = 0.0;
        let mut behind = None;
        while behind.is_none() && before < FURTHEST {
            let next = before + STEP;
            match (above(before), above(next)) {
                (Some(a), Some(b)) if a >= 0.0 && b < 0.0 => behind = Some(next),
                _ => before = next,
            }
        }
        let mut behind = behind?;
        for _ in 0..HALVINGS {
            let middle = (before + behind) / 2.0;
            match above(middle) {
                Some(height) if height < 0.0 => behind = middle,
                _ => before = middle,
            }
        }
        let p = origin + direction * before;
        Some((before, self.normal(p.x, p.y)))
    }

    /// The point of the panel that is nearest to `point`, and its normal; `None` if that is not on the panel.
    pub fn nearest(&self, point: &Vector3<f64>) -> Option<(Vector3<f64>, Vector3<f64>)> {
        let (mut x, mut y) = (point.x, point.y);
        for _ in 0..SEARCH {
            if !self.covers(x, y) {
                return None;
            }
            let (foot, normal) = (Vector3::new(x, y, self.height(x, y)), self.normal(x, y));
            let away = point - foot;
            let along = away - normal * normal.dot(&away);
            if along.norm() < FOUND {
                return Some((foot, normal));
            }
            x += along.x;
            y += along.y;
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn surface() -> CurvedPanel {
        toml::from_str(
            "crown_mm = [500.0, 400.0, 150.0]\nsize_mm = [360.0, 300.0]\nradius_mm = [250.0, 600.0]\n\
             wave_mm = 0.4\nwave_length_mm = 90.0\n",
        )
        .unwrap()
    }

    /// Along and across the surface: three heights agree with the normal.
    #[test]
    fn the_normal_is_the_gradient_of_the_height() {
        let (s, h) = (surface(), 1e-4);
        for (x, y) in [(500.0, 400.0), (350.0, 300.0), (655.0, 520.0)] {
            let n = s.normal(x, y);
            let dx = (s.height(x + h, y) - s.height(x - h, y)) / (2.0 * h);
            let dy = (s.height(x, y + h) - s.height(x, y - h)) / (2.0 * h);
            assert!((n - Vector3::new(-dx, -dy, 1.0).normalize()).norm() < 1e-7);
        }
    }

    #[test]
    fn a_beam_ends_on_the_surface_and_goes_past_the_panel() {
        let s = surface();
        for (x, y, lean) in [(500.0, 400.0, 0.0), (380.0, 300.0, 0.4), (640.0, 500.0, -0.7)] {
            let down = Vector3::new(lean, 0.3 * lean, -1.0).normalize();
            let on = Vector3::new(x, y, s.height(x, y));
            let (distance, normal) = s.hit(&(on - down * 83.7), &down).unwrap();
            assert!((distance - 83.7).abs() < 1e-9, "{distance}");
            assert!((normal - s.normal(x, y)).norm() < 1e-9);
        }
        let down = -Vector3::z();
        assert_eq!(s.hit(&Vector3::new(681.0, 400.0, 200.0), &down), None);
    }

    #[test]
    fn the_nearest_point_is_where_the_normal_leads_back() {
        let s = surface();
        for (x, y, off) in [(500.0, 400.0, 3.0), (360.0, 500.0, -2.0), (650.0, 300.0, 0.01)] {
            let on = Vector3::new(x, y, s.height(x, y));
            let (foot, normal) = s.nearest(&(on + s.normal(x, y) * off)).unwrap();
            assert!((foot - on).norm() < 1e-9 && (normal - s.normal(x, y)).norm() < 1e-9);
        }
        assert_eq!(s.nearest(&Vector3::new(700.0, 400.0, 100.0)), None);
    }

    #[test]
    fn a_panel_beyond_its_radius_is_refused() {
        let text = "crown_mm = [0.0, 0.0, 0.0]\nsize_mm = [100.0, 10.0]\nradius_mm = [50.0, 50.0]\n";
        let error = toml::from_str::<CurvedPanel>(text).unwrap_err().to_string();
        assert!(error.contains("0.95 of radius_mm"), "{error}");
    }
}
