//! Models of the work's height over u, along which the sharp band lies: a plate, a corner.

/// A height field n(u) of N parameters, the last of which is l, the logarithm of the profile's width over the expected.
pub(crate) trait HeightField<const N: usize> {
    /// Longest step of each parameter in one iteration.
    const STEP: [f64; N];

    /// Whether cells count the more the sharper they are. Streaks along the seam are not equally bright from end to end:
    /// far off the band that adds more bias than information.
    const SHARPEST: bool;

    /// What cells of half the resolution count beside those of the full one.
    const COARSER: f64;

    /// What the likelihood counts against priors: neighbouring cells see the same texture.
    const TEMPER: f64;

    /// Height at u and its derivatives.
    fn height(&self, at: &[f64; N], lateral: f64) -> (f64, [f64; N]);

    /// How much a column of cells at u counts: 0 to 1.
    fn weight(&self, at: &[f64; N], lateral: f64, width: f64) -> f64;
}

/// Longest steps \[mm\], slopes, l.
const STEP_MM: f64 = 0.04;
const STEP_SLOPE: f64 = 0.15;
const STEP_FOCUS: f64 = 0.3;

/// n = h + q·u ± t/2 with (h, q, t, l): a plate, on the right of the gap t higher than on the left.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plate {
    /// Middle of the gap and half the width of what it spoils, if known \[mm\].
    pub gap: Option<[f64; 2]>,
}

impl HeightField<4> for Plate {
    const STEP: [f64; 4] = [STEP_MM, STEP_SLOPE, STEP_MM, STEP_FOCUS];

    /// A plate's roll and focus need the whole picture.
    const SHARPEST: bool = false;

    const COARSER: f64 = 1.0;

    const TEMPER: f64 = 0.35;

    fn height(&self, at: &[f64; 4], lateral: f64) -> (f64, [f64; 4]) {
        let side = match self.gap {
            Some([middle, _]) if lateral < middle => -0.5,
            Some(_) => 0.5,
            None => 0.0,
        };
        let [h, q, t, _] = *at;
        (h + q * lateral + side * t, [1.0, lateral, side, 0.0])
    }

    fn weight(&self, _at: &[f64; 4], lateral: f64, width: f64) -> f64 {
        self.gap
            .map_or(1.0, |[middle, half]| outside(lateral - middle, half, width))
    }
}

/// n = h + b·(u − u0) with (h, u0, b left, b right, l): two walls.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Corner {
    /// Half the width of the corner that is rounded, dark or mirrored \[mm\].
    pub spoilt: f64,
}

impl HeightField<5> for Corner {
    const STEP: [f64; 5] = [STEP_MM, STEP_MM, STEP_SLOPE, STEP_SLOPE, STEP_FOCUS];

    const SHARPEST: bool = true;

    /// The less: of streaks they see next to nothing.
    const COARSER: f64 = 0.5;

    /// The more: cells do not count in full.
    const TEMPER: f64 = 0.6;

    fn height(&self, at: &[f64; 5], lateral: f64) -> (f64, [f64; 5]) {
        let [h, u0, left, right, _] = *at;
        let from = lateral - u0;
        if from < 0.0 {
            (h + left * from, [1.0, -left, from, 0.0, 0.0])
        } else {
            (h + right * from, [1.0, -right, 0.0, from, 0.0])
        }
    }

    fn weight(&self, at: &[f64; 5], lateral: f64, width: f64) -> f64 {
        outside(lateral - at[1], self.spoilt, width)
    }
}

/// Share of a column of `width` that lies further than `half` from the middle.
fn outside(from_middle: f64, half: f64, width: f64) -> f64 {
    ((from_middle.abs() - half) / width + 0.5).clamp(0.0, 1.0)
}
