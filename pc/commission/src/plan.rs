//! Which excitations a motor gets: four bands, so that low frequencies move it against its friction and high ones stay
//! inside what its drive accelerates.

use shared::motion::Chirp;
use std::f64::consts::TAU;

/// Bands \[Hz\]; each goes beyond its ends, where a chirp has little power, by a tenth.
const BANDS: [(f64, f64); 4] = [(2.0, 15.0), (15.0, 60.0), (60.0, 200.0), (200.0, 450.0)];
const BEYOND: f64 = 1.1;
/// Amplitudes of the captures of a band, as parts of what is allowed: what depends on them is not the machine's response.
const PARTS: [f64; 3] = [1.0, 0.7, 1.0];
/// Farthest that a motor is moved (mm or °).
pub const TRAVEL: f64 = 2.0;
/// Part of it that the excitation itself takes.
const OF_TRAVEL: f64 = 0.6;

/// One excitation of the command of a motor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Planned {
    /// Where the chirp begins and ends \[Hz\].
    pub from_hz: f64,
    /// See above.
    pub to_hz: f64,
    /// Its amplitude (mm/s or °/s).
    pub amplitude: f64,
}

impl Planned {
    /// What the motor is told.
    pub fn chirp(&self) -> Chirp {
        Chirp::new(self.from_hz, self.to_hz)
    }
}

/// The excitations of a motor that may move with this speed and acceleration (mm or °, s).
pub fn plan(speed: f64, acceleration: f64) -> Vec<Planned> {
    let band = |(from, to): (f64, f64)| {
        let (from_hz, to_hz) = (from / BEYOND, to * BEYOND);
        let most = speed
            .min(acceleration / (TAU * to_hz))
            .min(OF_TRAVEL * TRAVEL * TAU * from_hz);
        PARTS.map(|part| Planned {
            from_hz,
            to_hz,
            amplitude: part * most,
        })
    };
    BANDS.into_iter().flat_map(band).collect()
}
