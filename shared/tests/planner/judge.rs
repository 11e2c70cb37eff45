//! Judgement of a run by its outputs.

use super::bench::Bench;
use super::contour::Contour;
use super::run::Sample;
use shared::io::AXES;
use shared::trajectory::{Element, Tolerance, Way};
use std::fmt;

const TICK: f64 = 1e-3;

/// The worst of everything; shares of what is allowed.
#[derive(Clone, Copy, Debug, Default)]
pub struct Verdict {
    /// Of X Y Z A B C and the path, and when.
    pub velocity: Peak,
    pub acceleration: Peak,
    pub jerk: Peak,
    /// Of the tool over the feed.
    pub speed: Peak,
    pub position: Peak,
    pub attitude: Peak,
    /// Velocities and accelerations against the differences of the positions.
    pub consistent: Peak,
    /// Steps back where only forward was allowed \[mm\].
    pub back: Peak,
    /// Ticks from a hold to rest over those allowed.
    pub hold: Peak,
    /// Movement where it said that nothing moves \[mm or rad\].
    pub rest: Peak,
    /// Off the end \[mm or rad\].
    pub end: Peak,
    pub not_finite: bool,
}

/// Highest value, where, and at which tick.
#[derive(Clone, Copy, Debug)]
pub struct Peak {
    pub value: f64,
    pub what: &'static str,
    pub tick: usize,
}

impl Default for Peak {
    fn default() -> Self {
        Self {
            value: 0.0,
            what: "nothing",
            tick: 0,
        }
    }
}

impl Peak {
    fn see(&mut self, value: f64, what: &'static str, tick: usize) {
        if value > self.value {
            *self = Self { value, what, tick };
        }
    }
}

impl fmt::Display for Peak {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{:.4} ({}, tick {})", self.value, self.what, self.tick)
    }
}

impl Verdict {
    /// What is not as it must be; nothing if all is well.
    pub fn faults(&self) -> Vec<String> {
        let all = [
            ("velocity", &self.velocity, 1.01),
            ("acceleration", &self.acceleration, 1.01),
            ("jerk", &self.jerk, 1.05),
            ("tool speed", &self.speed, 1.01),
            ("path", &self.position, 1.0),
            ("attitude", &self.attitude, 1.0),
            ("consistency", &self.consistent, 1.0),
            ("step back [mm]", &self.back, 1e-9),
            ("hold", &self.hold, 1.0),
            ("movement at rest", &self.rest, 1e-9),
            ("end", &self.end, 1e-9),
        ];
        let mut faults: Vec<String> = all
            .iter()
            .filter(|(_, peak, most)| peak.value > *most)
            .map(|(name, peak, most)| format!("{name} {peak} above {most}"))
            .collect();
        if self.not_finite {
            faults.push("not finite".to_owned());
        }
        faults
    }
}

const NAMES: [&str; AXES + 1] = ["X", "Y", "Z", "A", "B", "C", "path"];

/// Judges the outputs of a run of `elements` that came to its end.
pub fn judge(bench: &Bench, elements: &[Element], tolerance: Tolerance, samples: &[Sample]) -> Verdict {
    let mut verdict = Verdict::default();
    let finite = |sample: &Sample| {
        let axes = &sample.output.axes;
        let along = sample.output.along;
        let all = axes
            .position
            .iter()
            .chain(&axes.velocity)
            .chain(&axes.acceleration);
        all.chain(&[along.s, along.v, along.a]).all(|x| x.is_finite())
    };
    if !samples.iter().all(finite) {
        verdict.not_finite = true;
        return verdict;
    }
    limits(&mut verdict, bench, samples);
    let contour = Contour::new(bench, elements, tolerance);
    if !elements.is_empty() {
        path(&mut verdict, bench, &contour, samples);
    }
    conduct(&mut verdict, bench, &contour, samples);
    verdict
}

/// Rows of one tick: X Y Z A B C, s.
fn row(bench: &Bench, samples: &[Sample], tick: isize) -> [f64; AXES + 1] {
    let mut row = [0.0; AXES + 1];
    if tick < 0 {
        row[..AXES].copy_from_slice(&bench.home);
        return row;
    }
    let output = &samples[(tick as usize).min(samples.len() - 1)].output;
    row[..AXES].copy_from_slice(&output.axes.position);
    row[AXES] = output.along.s;
    row
}

fn limits(verdict: &mut Verdict, bench: &Bench, samples: &[Sample]) {
    let mut most = [[f64::INFINITY; 3]; AXES + 1];
    for axis in 0..AXES {
        let limits = &bench.limits;
        most[axis] = [
            limits.velocity[axis],
            limits.acceleration[axis],
            limits.jerk[axis],
        ];
    }
    most[AXES] = [
        f64::INFINITY,
        bench.limits.path_acceleration,
        bench.limits.path_jerk,
    ];
    let linear = most[..3].iter().map(|limits| limits[1]).fold(0.0, f64::max);
    let along = most[AXES][1].min(2.0 * linear);
    for tick in 0..samples.len() + 3 {
        let rows = [0, 1, 2, 3].map(|back| row(bench, samples, tick as isize - back));
        let given = |tick: usize, i: usize| match samples.get(tick) {
            None => [0.0; 2],
            Some(Sample { output, .. }) if i == AXES => [output.along.v, output.along.a],
            Some(Sample { output, .. }) => [output.axes.velocity[i], output.axes.acceleration[i]],
        };
        for i in 0..=AXES {
            let [p0, p1, p2, p3] = rows.map(|row| row[i]);
            let v = (p0 - p1) / TICK;
            let a = (p0 - 2.0 * p1 + p2) / (TICK * TICK);
            let j = (p0 - 3.0 * p1 + 3.0 * p2 - p3) / (TICK * TICK * TICK);
            verdict.velocity.see(v.abs() / most[i][0], NAMES[i], tick);
            verdict.acceleration.see(a.abs() / most[i][1], NAMES[i], tick);
            verdict.jerk.see(j.abs() / most[i][2], NAMES[i], tick);
            if tick > 0 && most[i][2].is_finite() {
                // Of a mean over a tick and the mean of its ends: so far off where the acceleration is limited, as it is
                // before the output filter.
                let [now, before] = [given(tick, i), given(tick - 1, i)];
                let off = (v - 0.5 * (now[0] + before[0])).abs();
                let acceleration = if i == AXES { along } else { most[i][1] };
                let may = 0.25 * acceleration * TICK + 1e-6;
                verdict.consistent.see(off / may, NAMES[i], tick);
                let off = ((now[0] - before[0]) / TICK - 0.5 * (now[1] + before[1])).abs();
                // A jump of the acceleration between two ticks counts for as much as it has of the mean; of many the signs differ.
                let jumps = acceleration / (bench.limits.filter_s() / TICK).sqrt();
                let may = jumps.max(4.0 * most[i][2] * TICK) + 1e-3;
                verdict.consistent.see(off / may, NAMES[i], tick);
            }
        }
    }
}

/// Longest output filter, in ticks.
const FILTER: usize = 64;
/// Speed of the tool [mm/s] by what the filter makes of axes that turn about it.
const UNNOTICED: f64 = 0.1;
/// Ticks in which a lower override is obeyed at the latest, and a hold, but for the slowing down itself.
const LATENCY: usize = 400;

/// Ticks that the machine may take to slow down to rest from how it moves at a `tick`: with the acceleration of each axis,
/// of the path, and with what leaves the corners on its way inside the tolerance.
fn slowing(bench: &Bench, contour: &Contour, samples: &[Sample], tick: usize) -> usize {
    let now = &samples[tick].output;
    let velocities = now.axes.velocity.iter().zip(&bench.limits.acceleration);
    let slow = velocities.map(|(v, a)| v.abs() / a).fold(0.0, f64::max);
    let along = now.along.v.abs() / bench.limits.path_acceleration;
    let may = |slow: f64| LATENCY + (4.0 * slow / TICK) as usize;
    let soon = tick + may(slow.max(along));
    let then = &samples[soon.min(samples.len() - 1)].output;
    let accurate = contour.accurate_acceleration(now.along.s, then.along.s);
    may(slow.max(along).max(now.along.v.abs() / accurate))
}

/// What is wished, and for a while after each change what was wished before, whichever is more.
fn obeyed(bench: &Bench, contour: &Contour, samples: &[Sample], wish: impl Fn(&Sample) -> f64) -> Vec<f64> {
    let mut all: Vec<f64> = samples.iter().map(&wish).collect();
    for tick in 1..samples.len() {
        if wish(&samples[tick]) < wish(&samples[tick - 1]) {
            let before = all[tick - 1];
            let end = samples.len().min(tick + slowing(bench, contour, samples, tick));
            for later in &mut all[tick..end] {
                *later = later.max(before);
            }
        }
    }
    all
}

fn path(verdict: &mut Verdict, bench: &Bench, contour: &Contour, samples: &[Sample]) {
    let factors = obeyed(bench, contour, samples, |sample| sample.factor);
    let mut before = bench.tip(&bench.home);
    for (tick, sample) in samples.iter().enumerate() {
        let axes = &sample.output.axes.position;
        let tip = bench.tip(axes);
        let v = (tip - before).norm() / TICK;
        before = tip;
        let s = |tick: usize| samples[tick.min(samples.len() - 1)].output.along.s;
        let near = || (tick.saturating_sub(FILTER)..=tick + FILTER).map(s);
        let (low, high) = near().fold((s(tick), s(tick)), |(low, high), s| (low.min(s), high.max(s)));
        let most = contour.feed(low, high) * factors[tick] + UNNOTICED;
        verdict.speed.see(v / most, "tool", tick);
        let off = contour.off(axes, sample.output.along.s, 1.0 + (high - low));
        verdict.position.see(off.position, "tool", tick);
        verdict.attitude.see(off.attitude, "tool", tick);
    }
}

fn conduct(verdict: &mut Verdict, bench: &Bench, contour: &Contour, samples: &[Sample]) {
    let backwards = obeyed(bench, contour, samples, |sample| {
        f64::from(sample.way == Way::Back)
    });
    let mut holding = 0;
    for tick in 1..samples.len() {
        let [before, now] = [&samples[tick - 1], &samples[tick]];
        if backwards[tick] == 0.0 {
            let step = before.output.along.s - now.output.along.s;
            verdict.back.see(step, "s", tick);
        }
        let moved = (0..AXES).map(|i| (now.output.axes.position[i] - before.output.axes.position[i]).abs());
        let moved = moved.fold(0.0, f64::max);
        if before.output.at_rest && !now.touched {
            verdict.rest.see(moved, "tool", tick);
        }
        let stop = now.way == Way::Hold || now.factor == 0.0;
        holding = if stop { holding + 1 } else { 0 };
        if holding > 0 && !now.output.at_rest {
            let may = slowing(bench, contour, samples, tick + 1 - holding);
            verdict.hold.see(holding as f64 / may as f64, "hold", tick);
        }
    }
    let (ticks, end) = (samples.len(), &samples[samples.len() - 1].output);
    if let Some(last) = contour.last() {
        let off = (bench.tip(&end.axes.position) - last).norm();
        verdict.end.see(off, "tool", ticks);
    }
    let moving = end.axes.velocity.iter().fold(0.0f64, |most, v| most.max(v.abs()));
    verdict.end.see(moving, "velocity", ticks);
    let off = (end.along.s - contour.length()).abs();
    verdict.end.see(off, "s", ticks);
}
