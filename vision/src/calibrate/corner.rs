//! What the corner of a coupon reads beside where it is.

use thiserror::Error;

/// Fewest places of a coupon.
const FEWEST: usize = 4;

/// Largest scatter of the offsets of single places \[mm\].
const SCATTER_MM: f64 = 0.010;

/// Largest offset that rounding and optics make \[mm\].
const LARGEST_MM: f64 = 0.10;

/// One place of a coupon, seen twice from the same slides: u and n, in the camera's frame \[mm\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CornerPair {
    /// Where it is: measured as a gap, or known from the coupon's drawing.
    pub is_mm: [f64; 2],
    /// Where it reads as a corner.
    pub reads_mm: [f64; 2],
}

/// A corner's offset and how well it holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CornerFit {
    /// What has to be added to what a corner reads: u and n \[mm\].
    pub offset_mm: [f64; 2],
    /// Scatter of the places about it, root of the mean square of each coordinate \[mm\].
    pub scatter_mm: [f64; 2],
    /// Places.
    pub places: usize,
}

/// Why a coupon gives no offset.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum CornerError {
    /// Too few places.
    #[error("{found} places of the corner coupon were measured in both ways; at least 4 are needed")]
    Few {
        /// How many.
        found: usize,
    },
    /// The offset is not the same everywhere.
    #[error(
        "the corner's offset scatters by {scatter_um:.1} µm from place to place (may be 10 µm); is the coupon clean, and did it lie still?"
    )]
    Scatter {
        /// The larger of both coordinates' \[µm\].
        scatter_um: f64,
    },
    /// The offset is too large.
    #[error(
        "the measured corner is {offset_um:.0} µm off (at most 100 µm are possible): do both measurements show the same seam?"
    )]
    Large {
        /// The larger of both coordinates' \[µm\].
        offset_um: f64,
    },
}

/// What has to be added to what a corner reads, from places of a coupon.
pub fn corner_offset(pairs: &[CornerPair]) -> Result<CornerFit, CornerError> {
    let places = pairs.len();
    if places < FEWEST {
        return Err(CornerError::Few { found: places });
    }
    let off = |k: usize| pairs.iter().map(move |pair| pair.is_mm[k] - pair.reads_mm[k]);
    let offset_mm = [0, 1].map(|k| off(k).sum::<f64>() / places as f64);
    let scatter_mm = [0, 1].map(|k| {
        let squares: f64 = off(k).map(|off| (off - offset_mm[k]).powi(2)).sum();
        (squares / (places - 1) as f64).sqrt()
    });
    let [u, n] = offset_mm.map(f64::abs);
    if u.max(n) > LARGEST_MM {
        let offset_um = 1e3 * u.max(n);
        return Err(CornerError::Large { offset_um });
    }
    let worst = scatter_mm[0].max(scatter_mm[1]);
    if worst > SCATTER_MM {
        let scatter_um = 1e3 * worst;
        return Err(CornerError::Scatter { scatter_um });
    }
    Ok(CornerFit {
        offset_mm,
        scatter_mm,
        places,
    })
}
