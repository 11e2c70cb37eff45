//! Places where the program has a beam on, and no beam was.

use cam::path::{PathError, PlannedPath};
use config::machine::MachineFile;
use host_link::record::Recorded;
use serde::Serialize;
use shared::config::BeamConfig;
use shared::io::SIDES;
use shared::protocol::{MotionSample, PathAction};
use shared::ticks::PATH_PERIOD_S;
use shared::trajectory::SpeedLimits;
use std::collections::BTreeMap;
use std::fmt;

/// Two places are one, to this much \[mm\].
const SAME: f64 = 1e-6;
/// Missing telemetry between two ticks with a gate open is bridged for so many ticks.
const MOST_MISSING: u32 = 10;

/// A piece of a path that was to be gone over with a beam on, and was not.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Unwelded {
    /// Line of the program where it begins.
    pub line: u32,
    /// Number of the beam, 1 or 2.
    pub beam: u8,
    /// Number of the path.
    pub path_id: u32,
    /// Where it begins and ends along that path \[mm\].
    pub from_mm: f64,
    /// Where it ends.
    pub to_mm: f64,
}

impl fmt::Display for Unwelded {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { line, beam, .. } = self;
        let (from, to) = (self.from_mm, self.to_mm);
        write!(
            f,
            "line {line}, s = {from:.2}…{to:.2} mm was not welded by beam {beam}"
        )
    }
}

/// What was left out of `paths`, by their numbers, as the motion board told in `record`. What stays on at rest, as a
/// spindle, is no beam. A gap as long as two gates may be off their places, a tick each, and as the machine needs to
/// stop from a beam's least speed and reach it again, is none.
///
/// # Errors
/// A long program, which is read again, has changed.
pub fn unwelded(
    record: &Recorded,
    machine: &MachineFile,
    paths: &BTreeMap<u32, PlannedPath>,
) -> Result<Vec<Unwelded>, PathError> {
    let burnt = burnt(record);
    let mut left_out = Vec::new();
    for (id, path) in paths.iter().filter(|(_, path)| path.weld().is_some()) {
        let nothing = <[Pieces; SIDES]>::default();
        let burnt = burnt.get(id).unwrap_or(&nothing);
        let sides = (0..SIDES).filter_map(|side| {
            let beam = machine.motion.beams[side].as_ref()?;
            let burnt = burnt[side].all.as_slice();
            (!beam.stays_on_at_rest).then(|| Side::new(side, *id, edge(beam, path), burnt))
        });
        let mut sides: Vec<Side> = sides.collect();
        let mut here = path.start_s;
        for leg in path.given_legs() {
            let leg = leg?;
            let end = here + leg.element.length;
            for event in leg.events {
                if let PathAction::Beam { side, on } = event.action {
                    let of = |s: &&mut Side| s.number == usize::from(side);
                    sides
                        .iter_mut()
                        .find(of)
                        .into_iter()
                        .for_each(|s| s.switch(event.s_mm, on));
                }
            }
            for side in &mut sides {
                side.go_over(end, leg.element.line, leg.element.feed);
            }
            here = end;
        }
        left_out.extend(sides.into_iter().flat_map(Side::end));
    }
    Ok(left_out)
}

/// Way from a beam's least speed to a stop and back to it \[mm\].
fn edge(beam: &BeamConfig, path: &PlannedPath) -> f64 {
    let limits = SpeedLimits {
        velocity: beam.min_speed_mm_s,
        ..path.limits
    };
    if beam.min_speed_mm_s > 0.0 {
        2.0 * limits.ramp()
    } else {
        0.0
    }
}

/// A piece of a path \[mm\].
type Piece = (f64, f64);

/// What was gone over with the beam of each side open, by path: in order, and not touching.
fn burnt(record: &Recorded) -> BTreeMap<u32, [Pieces; SIDES]> {
    let mut burnt: BTreeMap<u32, [Pieces; SIDES]> = BTreeMap::new();
    let samples = record.motion().iter();
    for (now, next) in samples.zip(record.motion().iter().skip(1)) {
        let on_path = now.state.on_path();
        let ticks = next.tick.wrapping_sub(now.tick);
        for side in (0..SIDES).filter(|side| on_path && now.beams[*side]) {
            let bridged = ticks == 1 || ticks <= MOST_MISSING && next.beams[side];
            // At its end, the board names no path any more.
            let same = next.path_id == now.path_id || next.path_id == 0;
            let to = if bridged && same { next.s_mm } else { reached(&now) };
            burnt.entry(now.path_id).or_default()[side].add(now.s_mm, to);
        }
    }
    burnt.values_mut().flatten().for_each(Pieces::merge);
    burnt
}

/// Pieces of a path, as few as they are once they are merged and not many more before.
#[derive(Default)]
struct Pieces {
    all: Vec<Piece>,
    /// How many there were when they were merged last.
    merged: usize,
}

impl Pieces {
    /// Goes over a piece; back is no way of welding.
    fn add(&mut self, from: f64, to: f64) {
        match self.all.last_mut() {
            Some(last) if (last.1 - from).abs() < SAME => last.1 = last.1.max(to),
            _ if to < from => {}
            _ => self.all.push((from, to)),
        }
        if self.all.len() > 2 * self.merged + 1000 {
            self.merge();
        }
    }

    /// Puts them in order, and those into one that touch.
    fn merge(&mut self) {
        self.all.sort_by(|a, b| a.0.total_cmp(&b.0));
        self.all.dedup_by(|next, last| {
            let touches = next.0 <= last.1 + SAME;
            if touches {
                last.1 = last.1.max(next.1);
            }
            touches
        });
        self.merged = self.all.len();
    }
}

/// Where the machine is a tick later.
fn reached(now: &MotionSample) -> f64 {
    now.s_mm + now.speed_mm_s * PATH_PERIOD_S
}

/// One beam on its way along a path.
struct Side<'a> {
    number: usize,
    path_id: u32,
    /// What a gap may be besides the ticks \[mm\].
    edge: f64,
    /// The beam is on from here on \[mm\].
    on: Option<f64>,
    burnt: &'a [Piece],
    gap: Option<Unwelded>,
    /// What it may be \[mm\].
    allowed: f64,
    found: Vec<Unwelded>,
    /// The switches on the element that comes next.
    switches: Vec<(f64, bool)>,
}

impl<'a> Side<'a> {
    fn new(number: usize, path_id: u32, edge: f64, burnt: &'a [Piece]) -> Self {
        Self {
            number,
            path_id,
            edge,
            on: None,
            burnt,
            gap: None,
            allowed: 0.0,
            found: Vec::new(),
            switches: Vec::new(),
        }
    }

    fn switch(&mut self, s: f64, on: bool) {
        self.switches.push((s, on));
    }

    /// The path goes on to `to` in `line`, at a feed \[mm/s\].
    fn go_over(&mut self, to: f64, line: u32, feed: f64) {
        self.allowed = 2.0 * feed * PATH_PERIOD_S + self.edge;
        for (s, on) in std::mem::take(&mut self.switches) {
            self.go_to(s, line);
            if on {
                self.on.get_or_insert(s);
            } else {
                self.on = None;
                self.close();
            }
        }
        self.go_to(to, line);
    }

    fn go_to(&mut self, to: f64, line: u32) {
        let Some(mut here) = self.on else { return };
        self.on = Some(here.max(to));
        while here < to - SAME {
            match self.burnt {
                [piece, rest @ ..] if piece.1 <= here + SAME => self.burnt = rest,
                [piece, ..] if piece.0 <= here + SAME => {
                    self.close();
                    here = piece.1;
                }
                pieces => {
                    let end = pieces.first().map_or(to, |piece| piece.0.min(to));
                    let gap = self.gap.get_or_insert(Unwelded {
                        line,
                        beam: self.number as u8 + 1,
                        path_id: self.path_id,
                        from_mm: here,
                        to_mm: end,
                    });
                    gap.to_mm = end;
                    here = end;
                }
            }
        }
    }

    fn close(&mut self) {
        let gap = self.gap.take();
        self.found
            .extend(gap.filter(|gap| gap.to_mm - gap.from_mm > self.allowed));
    }

    fn end(mut self) -> Vec<Unwelded> {
        self.close();
        self.found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_to_and_fro_and_with_gaps_are_few_in_memory() {
        let mut pieces = Pieces::default();
        // To and fro between 0 and 100 mm by 0.1 mm; every other time the beam is shut from 40 to 50 mm.
        for round in 0..400 {
            for k in 0..1000 {
                let s = 0.1 * f64::from(k);
                if round % 2 == 0 || !(40.0..50.0).contains(&s) {
                    pieces.add(s, s + 0.1);
                }
            }
            for k in (0..1000).rev() {
                pieces.add(0.1 * f64::from(k + 1), 0.1 * f64::from(k));
            }
            // A stretch of its own, never next to what was gone over before.
            pieces.add(200.0 + f64::from(round % 3), 200.5 + f64::from(round % 3));
            assert!(pieces.all.len() < 1010, "{}", pieces.all.len());
        }
        pieces.merge();
        let [all, own @ ..] = pieces.all.as_slice() else {
            panic!("nothing");
        };
        assert!(all.0 == 0.0 && (all.1 - 100.0).abs() < 1e-9, "{all:?}");
        assert_eq!(own, [(200.0, 200.5), (201.0, 201.5), (202.0, 202.5)]);
    }
}
