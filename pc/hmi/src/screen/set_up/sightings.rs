//! What the cameras show of their seams while a dialog is open: the mean of the pictures.

use crate::station::Station;
use shared::io::{AXES, SIDES};

/// Pictures that are passed over at first: they may have been taken before the machine was at rest.
const PASSED_OVER: u32 = 2;

/// The seams of both cameras.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sightings([Sum; SIDES]);

/// Of the pictures of one camera.
#[derive(Clone, Copy, Debug, Default)]
struct Sum {
    newest: Option<u32>,
    pictures: u32,
    sum: [f64; 3],
}

impl Sightings {
    /// Takes what is new.
    pub fn take(&mut self, station: &Station) {
        for (side, of) in self.0.iter_mut().enumerate() {
            let sighted = station.sighted(side).filter(|one| of.newest != Some(one.capture));
            let Some(sighted) = sighted else { continue };
            of.newest = Some(sighted.capture);
            of.pictures = of.pictures.saturating_add(1);
            if of.pictures > PASSED_OVER {
                of.sum = std::array::from_fn(|axis| of.sum[axis] + sighted.position[axis]);
            }
        }
    }

    /// The seam of `side` as X Y Z of a tip that has the angles of `tip`.
    pub fn of(&self, side: usize, tip: &[f64; AXES]) -> Option<[f64; AXES]> {
        let of = self.0.get(side).filter(|of| of.pictures > PASSED_OVER)?;
        let count = f64::from(of.pictures - PASSED_OVER);
        Some(std::array::from_fn(|axis| match of.sum.get(axis) {
            Some(sum) => sum / count,
            None => tip[axis],
        }))
    }
}
