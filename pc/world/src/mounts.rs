//! Where simulated cameras truly are, and when they expose.

use plant_file::CameraMount;
use shared::protocol::Capture;
use vision::render::SplitMix64;

/// A camera as it is mounted, from strobe to strobe.
#[derive(Clone, Copy, Debug, Default)]
pub struct Mounted {
    mount: CameraMount,
    /// Time of the last strobe by the tracker's clock \[µs\], and its slides \[mm\].
    last: Option<(u64, [f64; 2])>,
}

impl Mounted {
    /// One that is mounted so.
    pub fn new(mount: CameraMount) -> Self {
        Self { mount, last: None }
    }

    /// How far ahead of the spot it is, on a machine whose controller believes `believed_mm` \[mm\].
    pub fn lead_mm(&self, believed_mm: f64) -> f64 {
        self.mount.lead_mm.unwrap_or(believed_mm) + self.mount.lead_error_mm
    }

    /// By how much it is turned about T more than the controller believes \[rad\].
    pub fn turned(&self) -> f64 {
        self.mount.turned_deg.to_radians()
    }

    /// From the strobe of `capture` to the exposure \[µs\].
    pub fn delay_us(&self, capture: u32) -> u64 {
        (self.delay_s(capture) * 1e6).round() as u64
    }

    fn delay_s(&self, capture: u32) -> f64 {
        let jitter = match self.mount.jitter_s {
            0.0 => 0.0,
            jitter => jitter * SplitMix64::new(capture.into()).uniform(),
        };
        self.mount.delay_s + jitter
    }

    /// Slides of `side` at the exposure at which a camera that is mounted right would see what this one sees \[mm\]. Captures
    /// come in the order of their strobes; from the strobe on the slides go on as they went since the one before.
    pub fn slides_mm(&mut self, side: usize, capture: &Capture) -> [f64; 2] {
        let slides = capture.truth_mm.unwrap_or(capture.slides_mm);
        let here = [slides[2 * side], slides[2 * side + 1]];
        let delay_s = self.delay_s(capture.number);
        let share = |(before, _): (u64, [f64; 2])| {
            let period = capture.time_us.saturating_sub(before);
            // After a pause nothing is known of how they go.
            (1..=LONGEST_PERIOD_US)
                .contains(&period)
                .then(|| delay_s * 1e6 / period as f64)
        };
        let going = self.last.and_then(|last| Some((last.1, share(last)?)));
        self.last = Some((capture.time_us, here));
        std::array::from_fn(|i| {
            let went = going.map_or(0.0, |(before, share)| (here[i] - before[i]) * share);
            let drift = self.mount.drift_mm[i].at(capture.time_us as f64 * 1e-6);
            here[i] + went + self.mount.beside_spot_mm[i] + drift
        })
    }
}

/// Strobes further apart are not of one row \[µs\].
const LONGEST_PERIOD_US: u64 = 50_000;

#[cfg(test)]
mod tests {
    use super::*;
    use plant::Growth;

    #[test]
    fn slides_go_on_from_the_strobe_to_the_exposure() {
        let capture = |number: u32, u: f64| Capture {
            number,
            time_us: u64::from(number) * 5_000,
            motion_time_us: 0,
            s_mm: 0.0,
            path_id: 0,
            slides_mm: [9.0; 4],
            truth_mm: Some([0.0, 0.0, u, 0.5]),
        };
        let mut mounted = Mounted::new(CameraMount {
            beside_spot_mm: [0.1, -0.2],
            lead_mm: Some(11.0),
            lead_error_mm: -0.25,
            delay_s: 0.001,
            ..CameraMount::default()
        });
        let near = |is: [f64; 2], wanted: [f64; 2]| {
            assert!(
                is.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-12),
                "{is:?}"
            );
        };
        near(mounted.slides_mm(1, &capture(1, 1.0)), [1.1, 0.3]);
        near(mounted.slides_mm(1, &capture(2, 1.05)), [1.16, 0.3]);
        near(mounted.slides_mm(1, &capture(40, 3.0)), [3.1, 0.3]);
        assert_eq!((mounted.delay_us(1), mounted.lead_mm(10.0)), (1_000, 10.75));
    }

    #[test]
    fn a_camera_drifts_as_it_warms_and_exposes_at_another_time_at_each_strobe() {
        let growth = |amount| Growth {
            amount,
            time_constant_s: 2.0,
        };
        let mount = CameraMount {
            drift_mm: [growth(0.02), growth(-0.01)],
            delay_s: 0.001,
            jitter_s: 0.0005,
            ..CameraMount::default()
        };
        let mut mounted = Mounted::new(mount);
        let at_rest = |number: u32| Capture {
            number,
            time_us: 4_000_000,
            motion_time_us: 0,
            s_mm: 0.0,
            path_id: 0,
            slides_mm: [0.0; 4],
            truth_mm: None,
        };
        let warm = 1.0 - (-2.0_f64).exp();
        let [u, v] = mounted.slides_mm(0, &at_rest(1));
        assert!((u - 0.02 * warm).abs() < 1e-12 && (v + 0.01 * warm).abs() < 1e-12);
        let delays: Vec<u64> = (0..1000).map(|capture| mounted.delay_us(capture)).collect();
        assert!(delays.iter().all(|delay| (1_000..=1_500).contains(delay)));
        let mean = delays.iter().sum::<u64>() as f64 / 1000.0;
        assert!((mean - 1_250.0).abs() < 20.0, "{mean}");
        assert_eq!(delays[7], mounted.delay_us(7));
    }
}
