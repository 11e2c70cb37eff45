//! Which excitations a motor gets: six bands, so that low frequencies move it well above its noise and high ones stay inside what
//! its axis accelerates, and all of them on its way, so that friction and play stay on one side; and one at rest, so small that
//! friction holds the motor: the mechanics behind a motor that is held swing at another frequency, and less damped.

use shared::motion::{Chirp, Way};
use shared::protocol::CAPTURE_TICKS;
use std::f64::consts::TAU;

/// Bands \[Hz\], and the part of the acceleration that each uses; each goes beyond its ends, where a chirp has little power, by a tenth.
/// The lowest line is left out: the way, whose speed is not quite even, is seen in it. Low bands leave a part of the acceleration,
/// for what the drive does with all of it is measured against them. High ones move the machine by some counts only: they use all of it, and are
/// narrow, for the lower ones then need not keep to the amplitude that it leaves at the highest line, and fewer lines share it.
const BANDS: [(f64, f64, f64); 6] = [
    (4.0, 15.0, 0.5),
    (15.0, 60.0, 0.5),
    (60.0, 90.0, 1.0),
    (90.0, 135.0, 1.0),
    (135.0, 200.0, 1.0),
    (200.0, 450.0, 1.0),
];
const BEYOND: f64 = 1.1;
/// Amplitudes of the captures of a band, as parts of what is allowed: what depends on them is not the machine's response.
const PARTS: [f64; 3] = [1.0, 0.7, 1.0];
/// Periods before what is captured.
pub const SETTLE_PERIODS: u8 = 2;
/// Way that a motor makes there and back, where there is room (mm or °).
pub const WAY: f64 = 20.0;
/// Farthest that it is moved beside it (mm or °).
pub const TRAVEL: f64 = 2.0;
/// Part of that which the excitation itself takes.
const OF_TRAVEL: f64 = 0.5;
/// Part of the speed of the way that it takes: the motor never turns round.
const OF_SPEED: f64 = 0.7;

/// Band of the excitation at rest \[Hz\]: where mechanics swing.
const BAND_AT_REST: (f64, f64) = (20.0, 200.0);
/// How far it moves a rigid machine in the middle of that band \[counts\]: as little as a grating still shows.
pub const COUNTS_AT_REST: f64 = 5.0;

/// How often a motor goes there and back in the capture in which it turns round: as slowly as a capture has it \[Hz\].
pub const TURNS_HZ: f64 = Chirp::LINE_HZ;

/// How far it goes to either side then (mm or °), if it may move with this speed \[1/s\] and acceleration \[1/s²\].
pub fn turns(speed: f64, acceleration: f64) -> f64 {
    let omega = TAU * TURNS_HZ;
    (OF_TRAVEL * TRAVEL)
        .min(speed / omega)
        .min(acceleration / (omega * omega))
}

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
    /// What the motor is told beside its way.
    pub fn chirp(&self) -> Chirp {
        Chirp::new(self.from_hz, self.to_hz)
    }
}

/// A way of so many mm or °, as the motor makes it meanwhile.
pub fn way(length: f64) -> Way {
    Way::new(length, (4 * u32::from(SETTLE_PERIODS) + 2) * CAPTURE_TICKS as u32)
}

/// The excitations of a motor that makes a way of this `length` (mm or °) and may move with this acceleration \[1/s²\].
pub fn plan(length: f64, acceleration: f64) -> Vec<Planned> {
    let band = |(from, to, part): (f64, f64, f64)| {
        let (from_hz, to_hz) = (from / BEYOND, to * BEYOND);
        let most = (OF_SPEED * way(length).speed())
            .min(part * acceleration / (TAU * to_hz))
            .min(OF_TRAVEL * TRAVEL * TAU * from_hz);
        PARTS.map(|part| Planned {
            from_hz,
            to_hz,
            amplitude: part * most,
        })
    };
    BANDS.into_iter().flat_map(band).collect()
}

/// The excitations of a motor that stands, with so many counts a mm or °, and may move with this acceleration \[1/s²\].
pub fn plan_at_rest(counts_per_unit: f64, acceleration: f64) -> Vec<Planned> {
    let (from, to) = BAND_AT_REST;
    let (from_hz, to_hz) = (from / BEYOND, to * BEYOND);
    let least = COUNTS_AT_REST / counts_per_unit.abs() * TAU * (from * to).sqrt();
    let planned = Planned {
        from_hz,
        to_hz,
        amplitude: least.min(acceleration / (TAU * to_hz)),
    };
    vec![planned; PARTS.len()]
}

/// The sine on the command of a motor on its way of this `length` (mm or °) that asks for this `acceleration` \[1/s²\]: at the
/// lowest line at which it does not turn the motor round, nor make it faster than `max_speed` \[1/s\].
pub fn swing(length: f64, acceleration: f64, max_speed: f64) -> Planned {
    let speed = way(length).speed();
    let omega = acceleration / (OF_SPEED * speed.min(max_speed - speed));
    let hz = (omega / TAU / Chirp::LINE_HZ).ceil().max(1.0) * Chirp::LINE_HZ;
    Planned {
        from_hz: hz,
        to_hz: hz,
        amplitude: acceleration / (TAU * hz),
    }
}
