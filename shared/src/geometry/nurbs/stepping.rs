//! The next parameter a given way further along a curve (mathematics 3.5).

use super::super::Moving;
use super::curve::{Curve, speed};
use thiserror::Error;

/// Newton steps of [`newton_step`] with which all but cusps are met to 1e-10 of the chord.
pub const NEWTON_ITERATIONS: usize = 12;

/// Newton steps that suffice where curvature · chord < 0.1: chord errors of 1e-12 at 0.01 up to 1e-7 at 0.1.
pub const EMBEDDED_ITERATIONS: usize = 2;

/// |chord² − ds²| at which a step counts as exact, of ds².
const EXACT: f64 = 2e-10;

/// Chord up to which the end of the curve is one step away, of ds.
const END: f64 = 1.0 + 1e-9;

/// Why there is no next parameter.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum StepError {
    /// The step is not a positive number.
    #[error("the step along a curve must be a positive length, not {0} mm")]
    Length(f64),
    /// The rule needs a tangent, and there is none.
    #[error(
        "no tangent at parameter {u}: move control points that coincide apart, or step by the exact chord"
    )]
    NoTangent {
        /// Where.
        u: f64,
    },
    /// The rule did not get ahead: the step is below the resolution of the parameter, or the curve turns
    /// too much within it for the rule.
    #[error(
        "no way ahead at parameter {u}: the step is too small or the curve turns too sharply for this rule"
    )]
    NoProgress {
        /// Where.
        u: f64,
    },
}

/// How [`Walk`] finds the next parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepRule {
    /// [`taylor_1`].
    Taylor1,
    /// [`taylor_2`].
    Taylor2,
    /// Second-order Adams–Bashforth on du/ds = 1/|C′|, started by [`taylor_1`].
    AdamsBashforth2,
    /// [`newton_step`].
    Newton {
        /// Most Newton steps, for instance [`NEWTON_ITERATIONS`].
        iterations: usize,
    },
    /// [`chord_step`].
    ExactChord,
}

fn check_length(ds: f64) -> Result<(), StepError> {
    if ds.is_finite() && ds > 0.0 {
        Ok(())
    } else {
        Err(StepError::Length(ds))
    }
}

/// Where a step of `ds` begins: `u`, clamped to the domain, and what is there.
fn start<C: Curve>(curve: &C, u: f64, ds: f64) -> Result<(f64, Moving), StepError> {
    check_length(ds)?;
    let [first, last] = curve.domain();
    let u = libm::fmin(libm::fmax(u, first), last);
    Ok((u, curve.at(u)))
}

fn speed_at(at: &Moving, u: f64) -> Result<f64, StepError> {
    speed(at).ok_or(StepError::NoTangent { u })
}

/// u + ds/|C′|, which may lie beyond the end.
pub fn taylor_1<C: Curve>(curve: &C, u: f64, ds: f64) -> Result<f64, StepError> {
    let (u, at) = start(curve, u, ds)?;
    Ok(u + ds / speed_at(&at, u)?)
}

/// u + ds/|C′| − ds²·(C′·C″)/(2|C′|⁴), which may lie beyond the end, or before `u` where the curve changes its
/// speed within the step.
pub fn taylor_2<C: Curve>(curve: &C, u: f64, ds: f64) -> Result<f64, StepError> {
    let (u, at) = start(curve, u, ds)?;
    Ok(second_order(&at, u, ds, speed_at(&at, u)?))
}

fn second_order(at: &Moving, u: f64, ds: f64, speed: f64) -> f64 {
    let part = ds / speed;
    u + part - part * part * (at.first.dot(&at.second) / (2.0 * speed * speed))
}

/// |C(u) − start|² − ds², and its derivative over u.
fn excess<C: Curve>(curve: &C, start: &Moving, u: f64, ds: f64) -> (f64, f64) {
    let at = curve.at(u);
    let chord = at.value - start.value;
    (chord.norm_squared() - ds * ds, 2.0 * chord.dot(&at.first))
}

/// The end if it is one step away, otherwise Taylor-2 with Newton steps on |C(u) − C(u₀)|² = ds² after it,
/// halving where Newton leaves the bracket between u₀ and the end. Also whether it converged.
fn newton<C: Curve>(curve: &C, u: f64, ds: f64, iterations: usize) -> Result<(f64, bool), StepError> {
    let [_, end] = curve.domain();
    let (u, start) = start(curve, u, ds)?;
    let speed = speed_at(&start, u)?;
    let straight = u + ds / speed;
    // The chord alone would end a closed curve at its start.
    if straight >= end && (curve.point(end) - start.value).norm() <= ds * END {
        return Ok((end, true));
    }
    let (mut low, mut high) = (u, end);
    let predicted = second_order(&start, u, ds, speed);
    let mut x = if predicted > u { predicted } else { straight };
    if !(low < x && x < high) {
        x = (low + high) / 2.0;
    }
    for _ in 0..iterations {
        let (f, slope) = excess(curve, &start, x, ds);
        if libm::fabs(f) <= EXACT * ds * ds {
            return Ok((x, true));
        }
        if f > 0.0 {
            high = x;
        } else {
            low = x;
        }
        let next = x - f / slope;
        x = if low < next && next < high {
            next
        } else {
            (low + high) / 2.0
        };
    }
    Ok((x, false))
}

/// The next parameter whose chord from `u` is `ds`, by at most `iterations` Newton steps from [`taylor_2`], or
/// the end if it is nearer. Bounded work, for a control tick; at cusps the chord may be another, and a closed
/// curve that begins slowly may end at once.
pub fn newton_step<C: Curve>(curve: &C, u: f64, ds: f64, iterations: usize) -> Result<f64, StepError> {
    newton(curve, u, ds, iterations).map(|(x, _)| x)
}

/// The next parameter whose chord from `u` is `ds` to 1e-10 of it, or the end if there is none: as
/// [`newton_step`], and by following the curve where that does not converge, where it is seen to skip a part of
/// the curve, and where there is no tangent.
pub fn chord_step<C: Curve>(curve: &C, u: f64, ds: f64) -> Result<f64, StepError> {
    match newton(curve, u, ds, NEWTON_ITERATIONS) {
        Ok((x, true)) if stays_within(curve, [u, x], ds) => Ok(x),
        Ok(_) | Err(StepError::NoTangent { .. }) => follow(curve, u, ds),
        Err(error) => Err(error),
    }
}

/// Whether the curve stays within the circle of radius `ds` from one parameter to the other, seen at four
/// places. The last alone would not do: a closed curve is back where it began.
fn stays_within<C: Curve>(curve: &C, [from, to]: [f64; 2], ds: f64) -> bool {
    let start = curve.point(from);
    [0.25, 0.5, 0.75, 1.0].into_iter().all(|part| {
        let point = curve.point(from + (to - from) * part);
        (point - start).norm() <= ds * END
    })
}

/// Small steps until the curve leaves the circle of radius `ds`, then halving. Not fast, but sure.
fn follow<C: Curve>(curve: &C, u: f64, ds: f64) -> Result<f64, StepError> {
    /// Steps of a quarter of `ds` or less; more means a knot of curve inside the circle.
    const STEPS: usize = 1000;
    let [_, end] = curve.domain();
    let (u, start) = start(curve, u, ds)?;
    let mut low = u;
    for _ in 0..STEPS {
        if low >= end {
            return Ok(end);
        }
        let mut high = curve.next_break(low);
        while !stays_within(curve, [low, high], ds / 4.0) {
            let middle = (low + high) / 2.0;
            if middle <= low || middle >= high {
                return Err(StepError::NoProgress { u: low });
            }
            high = middle;
        }
        if excess(curve, &start, high, ds).0 > 0.0 {
            return halve(curve, &start, [low, high], ds);
        }
        low = high;
    }
    Err(StepError::NoProgress { u })
}

/// Where the chord is `ds`, between a parameter where it is not longer and one where it is.
fn halve<C: Curve>(
    curve: &C,
    start: &Moving,
    [mut low, mut high]: [f64; 2],
    ds: f64,
) -> Result<f64, StepError> {
    loop {
        let middle = (low + high) / 2.0;
        // Ends after at most as many rounds as a number has digits.
        if middle <= low || middle >= high {
            return Ok(high);
        }
        let (f, _) = excess(curve, start, middle, ds);
        if libm::fabs(f) <= EXACT * ds * ds {
            return Ok(middle);
        }
        if f > 0.0 {
            high = middle;
        } else {
            low = middle;
        }
    }
}

/// The parameters of a walk along a curve, from its start to its end, both included; the last step is what is
/// left. After an error there is nothing more.
#[derive(Clone, Debug)]
pub struct Walk<'a, C> {
    curve: &'a C,
    rule: StepRule,
    ds: f64,
    /// Where the walk stands; none before its start.
    at: Option<f64>,
    /// 1/|C′| at the step before, of [`StepRule::AdamsBashforth2`].
    before: Option<f64>,
    done: bool,
}

impl<'a, C: Curve> Walk<'a, C> {
    /// A walk in steps of `ds` \[mm\].
    pub fn new(curve: &'a C, rule: StepRule, ds: f64) -> Result<Self, StepError> {
        check_length(ds)?;
        Ok(Self {
            curve,
            rule,
            ds,
            at: None,
            before: None,
            done: false,
        })
    }

    fn step(&mut self, u: f64) -> Result<f64, StepError> {
        let (curve, ds) = (self.curve, self.ds);
        let next = match self.rule {
            StepRule::Taylor1 => taylor_1(curve, u, ds)?,
            StepRule::Taylor2 => taylor_2(curve, u, ds)?,
            StepRule::AdamsBashforth2 => {
                let now = 1.0 / speed_at(&curve.at(u), u)?;
                let before = self.before.replace(now).unwrap_or(now);
                u + ds * (1.5 * now - 0.5 * before)
            }
            StepRule::Newton { iterations } => newton_step(curve, u, ds, iterations)?,
            StepRule::ExactChord => chord_step(curve, u, ds)?,
        };
        if next > u {
            Ok(libm::fmin(next, curve.domain()[1]))
        } else {
            Err(StepError::NoProgress { u })
        }
    }
}

impl<C: Curve> Iterator for Walk<'_, C> {
    type Item = Result<f64, StepError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.done {
            return None;
        }
        let [first, end] = self.curve.domain();
        let next = match self.at {
            None => Ok(first),
            Some(u) => self.step(u),
        };
        self.at = next.ok();
        self.done = next.is_err() || self.at >= Some(end);
        Some(next)
    }
}
