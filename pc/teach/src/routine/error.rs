//! Why something cannot be taught.

use crate::{RingError, Unsmooth};
use config::probe::RangingError;
use shared::kinematics::KinematicsError;
use std::error::Error as StdError;
use thiserror::Error;

/// Why a point cannot be taught. Reads as one sentence.
#[derive(Debug, Error)]
pub enum PointError {
    /// Its distance cannot be measured.
    #[error("{0}")]
    Distance(RangingError),
    /// The distance of a neighbour cannot be measured.
    #[error("in the ring of {radius} mm: {source}; near an edge teach by hand, or with a smaller ring")]
    Neighbour {
        /// Radius \[mm\].
        radius: f64,
        /// Why.
        source: RangingError,
    },
    /// Values that are not finite numbers.
    #[error(transparent)]
    Ring(#[from] RingError),
    /// An edge, most likely.
    #[error(transparent)]
    Unsmooth(Unsmooth),
    /// The normal is not known well enough.
    #[error(
        "the normal is known within {error_deg:.2}° only, {limit_deg}° are required: clean the surface, take more \
         readings, or let the rings be larger"
    )]
    Uncertain {
        /// Expected error \[deg\].
        error_deg: f64,
        /// Largest one allowed \[deg\].
        limit_deg: f64,
    },
    /// Too steep.
    #[error("the surface is inclined by {found_deg:.1}°, {limit_deg}° are allowed (steepest_deg)")]
    Steep {
        /// Inclination \[deg\].
        found_deg: f64,
        /// Largest one allowed \[deg\].
        limit_deg: f64,
    },
    /// Turning does not help.
    #[error(
        "after {turns} corrections the probe is still {off_deg:.1}° off the normal: give a better attitude"
    )]
    Aim {
        /// Turns.
        turns: usize,
        /// Angle between probe and normal \[deg\].
        off_deg: f64,
    },
    /// The machine cannot take the attitude.
    #[error(transparent)]
    Kinematics(#[from] KinematicsError),
}

/// Why a line could not be taught. Reads as one sentence.
#[derive(Debug, Error)]
pub enum TeachError<E: StdError + 'static> {
    /// The machine does not do what it is asked.
    #[error("{source}")]
    Machine {
        /// Number of the point on which it was, from 1.
        number: usize,
        /// Why.
        source: E,
    },
    /// A point cannot be taught.
    #[error("point {number} (X{x} Y{y} Z{z}): {reason}")]
    Point {
        /// Its number, from 1.
        number: usize,
        /// Where the guide is \[mm\].
        x: f64,
        /// Where the guide is \[mm\].
        y: f64,
        /// Where the guide is \[mm\].
        z: f64,
        /// Why.
        reason: PointError,
    },
}

/// What ends one point.
#[derive(Debug, Error)]
pub(super) enum PointFailure<E: StdError + 'static> {
    #[error(transparent)]
    Machine(E),
    #[error(transparent)]
    Point(#[from] PointError),
}

/// Why the probe gave no distance.
pub(super) enum NoDistance<E> {
    Machine(E),
    Refused(RangingError),
}

impl<E: StdError + 'static> NoDistance<E> {
    pub(super) fn in_ring(self, radius: f64) -> PointFailure<E> {
        match self {
            Self::Machine(error) => PointFailure::Machine(error),
            Self::Refused(source) => PointFailure::Point(PointError::Neighbour { radius, source }),
        }
    }
}

impl<E: StdError + 'static> PointFailure<E> {
    pub(super) fn distance(seen: NoDistance<E>) -> Self {
        match seen {
            NoDistance::Machine(error) => Self::Machine(error),
            NoDistance::Refused(source) => Self::Point(PointError::Distance(source)),
        }
    }
}
