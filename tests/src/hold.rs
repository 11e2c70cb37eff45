//! A hold in the middle of the shipped weld.

use crate::prediction::run_heard;
use crate::{assert_welded, machine, shipped_seam, with_weld};
use host_link::boards::{Boards, command};
use report::Ended;
use shared::protocol::{MotionSample, Request, Role};
use shared::state::State;

/// How far into the weld the operator holds it \[mm\].
const HOLD_AFTER_MM: f64 = 200.0;
/// How long the machine stands before the operator continues \[path ticks\].
const STANDS: u32 = 300;
/// Ticks for which drives and gates still go on as they were told before the hold.
const TOLD: usize = 2;
/// Deviation from the seam \[mm\], and from the path.
const DEVIATION_MM: f64 = 0.03;
const CONTOUR_MM: f64 = 0.05;

/// An operator who holds a weld once, and continues when the machine has stood for a while.
#[derive(Default)]
struct Operator {
    /// Where the beams went on \[mm\].
    on_mm: Option<f64>,
    /// Told by the motion board from the hold on.
    since: Vec<MotionSample>,
    stood: u32,
}

impl Operator {
    fn on_sample(&mut self, boards: &mut dyn Boards, sample: &MotionSample) {
        if sample.beams == [true; 2] {
            self.on_mm.get_or_insert(sample.s_mm);
        }
        let middle = self.on_mm.is_some_and(|on| sample.s_mm >= on + HOLD_AFTER_MM);
        if self.since.is_empty() && middle {
            ask(boards, &Request::Hold);
        }
        if !self.since.is_empty() || middle {
            self.since.push(*sample);
        }
        if sample.state == State::Holding && sample.speed_mm_s == 0.0 {
            self.stood += 1;
            if self.stood == STANDS {
                ask(boards, &Request::Resume);
            }
        }
    }
}

fn ask(boards: &mut dyn Boards, request: &Request) {
    command(boards, Role::Motion, request).unwrap_or_else(|error| panic!("{error}"));
}

/// Welds the shipped job and holds it in the middle of the seam: the gates close at once, before the motion is slower
/// than the beams may be on; the machine stops on its path, goes over the place again at the speed of the weld, and no
/// spot is ever beside its seam.
///
/// # Panics
/// Where it is not so.
pub fn assert_held_weld_goes_on(boards: &mut dyn Boards, speed_m_per_min: f64) -> Ended {
    let mut operator = Operator::default();
    let ended = with_weld(shipped_seam(), speed_m_per_min, |job| {
        run_heard(boards, job, |boards, sample| operator.on_sample(boards, sample))
    });
    let since = &operator.since;
    let path = since.first().expect("a hold").path_id;

    let holds = |sample: &MotionSample| sample.state == State::Holding;
    let held = since.iter().position(holds).expect("a hold");
    let again = since.iter().rposition(holds).expect("a hold") + 1;
    for sample in &since[held + TOLD..again] {
        assert_eq!(sample.beams, [false; 2], "{sample:?}");
    }
    assert!(operator.stood >= STANDS, "stood for {} ms", operator.stood);
    let machine = machine();
    for sample in since {
        for (beam, open) in machine.motion.beams.iter().zip(sample.beams) {
            let slowest = beam.as_ref().map_or(0.0, |beam| beam.min_speed_mm_s);
            assert!(!open || sample.speed_mm_s >= slowest, "{sample:?}");
        }
    }
    let contour = ended.evaluation.ticks.iter().map(|tick| tick.contour_error_mm);
    for error in contour {
        assert!(error.expect("no gap") < CONTOUR_MM, "{error:?} mm");
    }

    let welds = |sample: &&MotionSample| sample.path_id == path && sample.beams == [true; 2];
    let off = since[..again].iter().rfind(welds).expect("beams on before");
    let on = since[again..].iter().find(welds).expect("beams on again");
    let overlap = off.s_mm - on.s_mm;
    println!(
        "held at {:.2} mm and {:.1} mm/s, went on from {:.2} mm, on again at {:.2} mm and {:.1} mm/s",
        off.s_mm,
        off.speed_mm_s,
        since[again - 1].s_mm,
        on.s_mm,
        on.speed_mm_s
    );
    let wanted = machine.motion.beams.iter().flatten().map(|beam| beam.overlap_mm);
    let wanted = wanted.fold(0.0, f64::max);
    let tick = 1e-3 * off.speed_mm_s;
    // Either end is known to a tick, and at the edges the gates have their tolerance.
    assert!((overlap - wanted).abs() < 0.1 + 4.0 * tick, "{overlap} mm");
    assert!(on.speed_mm_s > 0.94 * off.speed_mm_s, "{} mm/s", on.speed_mm_s);
    assert_welded(&ended, 400.0 + overlap, DEVIATION_MM);
    ended
}
