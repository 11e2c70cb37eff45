//! The programmed feed, beams and tracking over the length of a path.

use super::PlannedPath;
use shared::io::SIDES;
use shared::protocol::PathAction;
use shared::trajectory::Shape;

/// Feeds, beams and tracking of a path, from where the machine begins on it. It grows with what changes, not with the
/// length of the program.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Programmed {
    /// Of each side, from where to where its gate is to be open \[mm\], in order.
    pub beams: [Vec<(f64, f64)>; SIDES],
    /// Whether the seam is followed anywhere.
    pub tracked: bool,
    /// From a path length on \[mm\], this feed \[mm/s\], 0 where the tip stands; in order.
    feeds: Vec<(f64, f64)>,
}

impl PlannedPath {
    /// What it is programmed to do. Of a program that cannot be read again only what could be read: a dry run of it
    /// says why.
    pub fn programmed(&self) -> Programmed {
        let mut programmed = Programmed::default();
        let mut since = [None; SIDES];
        let mut end_s = self.start_s;
        for leg in self.given_legs().map_while(Result::ok) {
            for event in &leg.events {
                programmed.take(event.s_mm, event.action, &mut since);
            }
            // Where nothing moves, the feed is none of the tip.
            let feed = match leg.element.shape {
                Shape::Point(_) => 0.0,
                _ => leg.element.feed,
            };
            programmed.go_on_at(end_s, feed);
            end_s += leg.element.length;
        }
        for (stretches, since) in programmed.beams.iter_mut().zip(since) {
            stretches.extend(since.filter(|since| *since < end_s).map(|since| (since, end_s)));
        }
        programmed
    }
}

impl Programmed {
    fn take(&mut self, s: f64, action: PathAction, since: &mut [Option<f64>; SIDES]) {
        match action {
            PathAction::Beam { side, on } => {
                let side = usize::from(side);
                let (Some(since), Some(stretches)) = (since.get_mut(side), self.beams.get_mut(side)) else {
                    return;
                };
                if on {
                    since.get_or_insert(s);
                } else if let Some(start) = since.take()
                    && start < s
                {
                    stretches.push((start, s));
                }
            }
            PathAction::Tracking { on } => self.tracked |= on,
            _ => {}
        }
    }

    fn go_on_at(&mut self, s: f64, feed: f64) {
        if self.feeds.last().is_none_or(|(_, last)| *last != feed) {
            self.feeds.push((s, feed));
        }
    }

    /// Feed at `s` \[mm/s\]; 0 of a path without any.
    pub fn feed_at(&self, s: f64) -> f64 {
        let after = self.feeds.partition_point(|(from, _)| *from <= s);
        let feed = self.feeds.get(after.saturating_sub(1));
        feed.map_or(0.0, |(_, feed)| *feed)
    }

    /// Lowest and highest feed from `reach` \[mm\] before `s` to as much behind it \[mm/s\].
    pub fn feeds_around(&self, s: f64, reach: f64) -> (f64, f64) {
        let first = self.feeds.partition_point(|(from, _)| *from <= s - reach);
        let end = self.feeds.partition_point(|(from, _)| *from <= s + reach);
        let feeds = &self.feeds[first.saturating_sub(1)..end];
        let here = self.feed_at(s);
        feeds.iter().fold((here, here), |(low, high), (_, feed)| {
            (low.min(*feed), high.max(*feed))
        })
    }
}

#[cfg(test)]
mod tests {
    use crate::path::{PlannedPath, Planner};
    use config::machine::MachineFile;
    use nc::{Options, interpret};
    use std::path::Path;

    fn paths(machine: &str, program: &str) -> Vec<PlannedPath> {
        let file = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../../machines")
            .join(machine);
        let machine = MachineFile::read(&file).unwrap();
        let program = interpret(program, Options::default()).unwrap();
        let planner = Planner::build(&machine).unwrap();
        planner.program(&program, &machine.homed_axes(), None).unwrap()
    }

    #[test]
    fn beams_and_feeds_are_where_the_program_has_them() {
        let gantry = "G43.4\nG0 X900 Y900 Z100 A0 B0 C0\nF5000\nM62 P2\nG1 X940\nM62 P0\nX960\nM62 P1\nX1000\n\
                      M63 P0\nX1010\nM63 P1\nM63 P2\nX1050\nM2";
        let path = &paths("dual-beam-gantry.toml", gantry)[1];
        let programmed = path.programmed();
        assert!(programmed.tracked);
        for (stretches, (from, to)) in programmed.beams.iter().zip([(40.0, 100.0), (60.0, 110.0)]) {
            assert_eq!(stretches.len(), 1, "{stretches:?}");
            assert!((stretches[0].0 - from).abs() < 1e-6 && (stretches[0].1 - to).abs() < 1e-6);
        }
        assert_eq!(programmed.feed_at(70.0), 5000.0 / 60.0);

        let head = "G43.4\nG0 X500 Y500 Z100 A0 C0\nM67 E0 Q1000\nF1200\nG1 X510\nM62 P0\nX530\nF600\nX540\nM63 P0\n\
                    X545\nM62 P0\nX550\nM2";
        let paths = paths("ac-head.toml", head);
        let path = paths.iter().find(|path| path.weld().is_some()).unwrap();
        let programmed = path.programmed();
        assert!(!programmed.tracked);
        let [first, second] = programmed.beams;
        assert!(second.is_empty());
        let near = |a: (f64, f64), b: (f64, f64)| (a.0 - b.0).abs() < 1e-6 && (a.1 - b.1).abs() < 1e-6;
        assert!(
            first.len() == 2 && near(first[0], (10.0, 40.0)) && near(first[1], (45.0, 50.0)),
            "{first:?}"
        );
        let programmed = path.programmed();
        assert_eq!(
            [5.0, 29.0, 31.0, 50.0].map(|s| programmed.feed_at(s)),
            [20.0, 20.0, 10.0, 10.0]
        );
        let around =
            [(29.0, 0.5), (29.0, 2.0), (31.0, 2.0)].map(|(s, reach)| programmed.feeds_around(s, reach));
        assert_eq!(around, [(20.0, 20.0), (10.0, 20.0), (10.0, 20.0)]);
    }
}
