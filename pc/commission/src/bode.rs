//! What a Bode plot shows: gain and phase over the frequency.

use crate::Complex;
use crate::response::Line;
use shared::motion::Chirp;
use std::f64::consts::TAU;

/// Lines that are further from each other are not joined.
const JOINED_HZ: f64 = 4.5 * Chirp::LINE_HZ;

/// Gain and phase at frequencies \[Hz\], upwards. Where lines are missing, there is a NaN between those around them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bode {
    /// Gain \[dB\].
    pub gain_db: Vec<[f64; 2]>,
    /// Phase \[°\], without jumps; at the first frequency from -270 to 90.
    pub phase_deg: Vec<[f64; 2]>,
}

impl Bode {
    /// Frequencies that a plot marks \[Hz\].
    pub const MARKED_HZ: [f64; 7] = [5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 400.0];

    /// Of values at frequencies.
    pub fn of(values: impl IntoIterator<Item = (f64, Complex)>) -> Self {
        let mut bode = Self::default();
        let mut last = -90.0;
        for (hz, value) in values {
            if let Some([before, _]) = bode.gain_db.last().filter(|[before, _]| hz - before > JOINED_HZ) {
                let gap = [(before + hz) / 2.0, f64::NAN];
                bode.gain_db.push(gap);
                bode.phase_deg.push(gap);
            }
            bode.gain_db.push([hz, 20.0 * value.norm().log10()]);
            let phase = value.arg().to_degrees();
            last += (phase - last + 180.0).rem_euclid(360.0) - 180.0;
            bode.phase_deg.push([hz, last]);
        }
        bode
    }

    /// Of the speed of a motor for its command, which is 0 dB and 0° of a drive without lag or resonance.
    pub fn of_speed<'a>(lines: impl IntoIterator<Item = &'a Line>) -> Self {
        let speed = |line: &Line| (line.hz, Complex::i() * TAU * line.hz * line.gain);
        Self::of(lines.into_iter().map(speed))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_phase_of_dead_time_falls_without_a_jump() {
        let dead_s = 0.01;
        let values = (1..100).map(|k| {
            let hz = 2.0 * f64::from(k);
            let omega = TAU * hz;
            (
                hz,
                Complex::from_polar(100.0 / omega, -TAU / 4.0 - omega * dead_s),
            )
        });
        let bode = Bode::of(values);
        for ([hz, phase], [_, gain]) in bode.phase_deg.iter().zip(&bode.gain_db) {
            assert!((phase + 90.0 + 360.0 * hz * dead_s).abs() < 1e-6, "{hz} {phase}");
            assert!(
                (gain - 20.0 * (100.0 / (TAU * hz)).log10()).abs() < 1e-9,
                "{hz} {gain}"
            );
        }
        let line = |hz: f64| Line {
            hz,
            gain: 2.0 / (Complex::i() * TAU * hz),
            coherence: 1.0,
        };
        let speed = Bode::of_speed(&[line(4.0), line(6.0), line(40.0)]);
        let is_gap = |points: &[[f64; 2]]| points.len() == 4 && points[2][1].is_nan();
        assert!(is_gap(&speed.gain_db) && is_gap(&speed.phase_deg), "{speed:?}");
        for k in [0, 1, 3] {
            assert!((speed.gain_db[k][1] - 6.0206).abs() < 1e-4, "{speed:?}");
            assert!(speed.phase_deg[k][1].abs() < 1e-9, "{speed:?}");
        }
    }
}
