//! Turns of planning that path ticks come into, as on a board: deadlines are missed, and nothing else is lost.

use super::bench;
use super::judge::judge;
use super::program::elements;
use super::random::{any_acts, cases, moves};
use super::run::{Act, run_with};
use proptest::prelude::*;
use shared::kinematics::Kinematics;
use shared::trajectory::{
    BoardPlanning, BoardPlayer, ELEMENTS, NODES, Output, Player, PlayerAccess, Tolerance, Unreachable, Way,
};

/// The two halves of a planner. Path ticks come into turns of planning each time that those have reached the player as
/// often as `late` says, one entry after the other and then from the first again; never if it is empty.
pub struct Halves<'a> {
    pub player: Box<BoardPlayer>,
    planning: Box<BoardPlanning>,
    kinematics: &'a Kinematics,
    late: std::iter::Cycle<std::slice::Iter<'a, u32>>,
    /// Until the next.
    left: Option<u32>,
}

impl<'a> Halves<'a> {
    pub fn new(kinematics: &'a Kinematics, late: &'a [u32]) -> Self {
        let mut late = late.iter().cycle();
        Self {
            player: Box::new(BoardPlayer::new()),
            planning: Box::new(BoardPlanning::new()),
            kinematics,
            left: late.next().copied(),
            late,
        }
    }

    /// A tick, a turn, and the ticks that came into it.
    pub fn tick(&mut self) -> Vec<Result<Output, Unreachable>> {
        let mut interrupted = Interrupted {
            outputs: vec![self.player.tick(self.kinematics)],
            player: &mut self.player,
            kinematics: self.kinematics,
            late: &mut self.late,
            left: &mut self.left,
        };
        self.planning.turn(&mut interrupted, self.kinematics);
        interrupted.outputs
    }
}

struct Interrupted<'a, 'b> {
    player: &'a mut BoardPlayer,
    kinematics: &'a Kinematics,
    late: &'a mut std::iter::Cycle<std::slice::Iter<'b, u32>>,
    left: &'a mut Option<u32>,
    outputs: Vec<Result<Output, Unreachable>>,
}

impl PlayerAccess<ELEMENTS, NODES> for Interrupted<'_, '_> {
    fn with<R>(&mut self, use_it: impl FnOnce(&mut Player<ELEMENTS, NODES>) -> R) -> R {
        if let Some(left) = self.left {
            if *left == 0 {
                self.outputs.push(self.player.tick(self.kinematics));
                *self.left = self.late.next().copied();
            } else {
                *left -= 1;
            }
        }
        use_it(self.player)
    }
}

/// What a late plan may cost: a hold, a lower override, or the end of going back is obeyed later.
const LATER: [&str; 3] = ["hold", "tool speed", "step back"];

proptest! {
    #![proptest_config(cases(300))]

    /// Wherever path ticks come into turns, on every machine alike no limit is passed, and the path is kept to its end.
    #[test]
    fn missed_deadlines_cost_time_only(
        moves in moves(), acts in any_acts(), late in prop::collection::vec(10u32..600, 1..20),
        turning in any::<bool>(),
    ) {
        let bench = if turning { bench::dual_beam() } else { bench::wire_arc() };
        let tolerance = Tolerance { position: bench.limits.tolerance, attitude: 1e-3 };
        let elements = elements(&bench, &moves, tolerance);
        let samples = run_with(&bench, &elements, &acts, 8, &late);
        let samples = samples.map_err(|stuck| TestCaseError::fail(stuck.to_string()))?;
        let mut faults = judge(&bench, &elements, tolerance, &samples).faults();
        let back = acts.iter().any(|(_, act)| matches!(act, Act::Go(Way::Back)));
        let later = &LATER[..if back { 3 } else { 2 }];
        faults.retain(|fault| !later.iter().any(|later| fault.starts_with(later)));
        prop_assert!(faults.is_empty(), "{}", faults.join("; "));
    }
}

/// Deadlines are missed in the test above, and counted; in step none is.
#[test]
fn missed_deadlines_are_counted() {
    let bench = bench::dual_beam();
    for (late, some) in [(&[][..], false), (&[40][..], true)] {
        let mut halves = Halves::new(&bench.kinematics, late);
        halves.player.start(&bench.limits, bench.space, 0.0, &bench.home);
        let ticks: usize = (0..100).map(|_| halves.tick().len()).sum();
        assert_eq!(halves.player.missed() as usize, ticks - 100, "{late:?}");
        assert_eq!(halves.player.missed() > 0, some, "{late:?}");
    }
}
