//! What the axes of a machine touch, and the input that a touch closes.

use crate::config::TouchConfig;
use shared::io::{AXES, Bits};

impl TouchConfig {
    /// The inputs `process` with this one on while the axes stand inside a body, and off else.
    pub(crate) fn read(&self, mut process: Bits, axes: &[f64; AXES]) -> Bits {
        let touches = self.bodies.iter().any(|body| {
            let limits = body.from.into_iter().zip(body.to);
            axes.iter()
                .zip(limits)
                .all(|(at, (from, to))| (from..=to).contains(at))
        });
        process.set(usize::from(self.input).wrapping_sub(1), touches);
        process
    }
}
