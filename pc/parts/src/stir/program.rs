//! The NC program: approach, plunge, preheat, contour and retract of every pass.

use super::contour::{Form, Segment};
use super::passes::Pass;
use super::{C, Job, Stir};
use crate::PartContext;
use config::machine::MachineFile;
use nc::text::{NcText, decimal, words};
use shared::units::DEG_PER_RAD;

/// Tilts that are usual in the process \[°\] (mathematics 4).
const USUAL_TILT: [f64; 2] = [2.0, 5.0];
/// Places of the contour nearer than this are one \[mm\]: a program is not written finer.
const SAME_PLACE: f64 = 1e-6;
/// The planner lets C change its rate with this part of its acceleration, where a segment begins to turn.
const TURN_SHARE: f64 = 0.5;

/// Writes the program.
pub(super) fn write(part: &Stir, job: &Job, context: &PartContext) -> String {
    let mut nc = NcText::default();
    nc.line("%");
    nc.comment(context.title);
    nc.comment(&format!(
        "machine {}, {} mm/min, {} r/min, tilt {} deg",
        context.machine.name, part.travel_mm_min, part.spindle_r_min, part.tilt_deg
    ));
    nc.comment("X Y Z: tip of the pin [mm], B C: tilt and turn of the head [deg], E0: spindle [r/min]");
    nc.block("G21 G17 G90 G94 G40 G500 G64");
    nc.block("G43.4");
    for (index, pass) in job.passes.iter().enumerate() {
        if index > 0 {
            nc.comment("C ends here: the head turns back above the plate");
        }
        stir(&mut nc, part, job, pass, context.machine.planning.safe_height_mm);
    }
    nc.block("M2");
    nc.line("%");
    nc.finish()
}

/// One pass, from above the plate to above the plate.
fn stir(nc: &mut NcText, part: &Stir, job: &Job, pass: &Pass, safe: f64) {
    let (start, heading) = job.contour.at(pass.from);
    let b = job.b * DEG_PER_RAD;
    let c = (heading + pass.offset) * DEG_PER_RAD;
    let height = |z: f64| words([("Z", z)]);
    let feed = |mm_min: f64| format!("F{}", decimal(mm_min, 1));
    nc.comment("approach: first up, then the head turns");
    nc.block(&format!("G53 G0 {}", height(safe)));
    nc.block(&format!("G53 G0 {}", words([("B", b), ("C", c)])));
    let above = words([("X", start.x), ("Y", start.y), ("Z", safe), ("B", b), ("C", c)]);
    nc.block(&format!("G0 {above}"));
    nc.block(&format!("G0 {}", height(job.clear_z)));
    nc.comment("plunge");
    nc.block(&format!("M67 E0 Q{}", decimal(part.spindle_r_min, 1)));
    nc.block("M62 P0");
    nc.block(&feed(part.plunge_mm_min));
    nc.block(&format!("G1 {}", height(job.depth_z)));
    nc.comment("preheat: the pin turns in place");
    nc.block(&format!("G4 P{}", decimal(part.preheat_s, 3)));
    nc.comment("contour");
    nc.block(&feed(part.travel_mm_min));
    for segment in job.contour.segments() {
        if segment.end_s() > pass.from + SAME_PLACE && segment.start_s < pass.to - SAME_PLACE {
            nc.block(&motion(job, segment, pass));
        }
    }
    // A dwell of nothing ends the path: the pin rises from rest.
    nc.block("G4 P0.0");
    nc.comment("retract");
    nc.block(&feed(part.retract_mm_min));
    nc.block(&format!("G1 {}", height(job.clear_z)));
    nc.block("M63 P0");
    nc.block(&format!("G0 {}", height(safe)));
}

/// The block of `segment`, as far as it is in `pass`.
fn motion(job: &Job, segment: &Segment, pass: &Pass) -> String {
    let (from, to) = (segment.start_s.max(pass.from), segment.end_s().min(pass.to));
    let (start, end) = (job.contour.at(from).0, job.contour.at(to).0);
    let turned = segment.curvature() * (to - segment.start_s);
    let c = (segment.heading + turned + pass.offset) * DEG_PER_RAD;
    let end = words([("X", end.x), ("Y", end.y)]);
    let c = words([("C", c)]);
    match &segment.form {
        Form::Line(_) => format!("G1 {end} {c}"),
        Form::Arc(arc) => {
            let code = if segment.turn > 0.0 { "G3" } else { "G2" };
            let centre = arc.centre() - start;
            let centre = words([("I", centre.x), ("J", centre.y)]);
            format!("{code} {end} {centre} {c}")
        }
    }
}

/// What a person should know.
pub(super) fn notes(part: &Stir, job: &Job, machine: &MachineFile) -> Vec<String> {
    let contour = &job.contour;
    let [least, most] = range_of_c(job).map(|c| decimal(c * DEG_PER_RAD, 2));
    let minutes = contour.length() / part.travel_mm_min;
    let mut notes = vec![format!(
        "contour of {:.2} mm in {} segments, {minutes:.1} min; C moves between {least}° and {most}°",
        contour.length(),
        contour.segments().len(),
    )];
    if job.passes.len() > 1 {
        let places: Vec<String> = job.passes[1..]
            .iter()
            .map(|pass| format!("{:.2}", pass.from))
            .collect();
        notes.push(format!(
            "C reaches the end of its travel: the pin is lifted after {} mm, C turned back, and the pin plunges \
             again there",
            places.join(", ")
        ));
    }
    if part.tilt_deg < USUAL_TILT[0] || part.tilt_deg > USUAL_TILT[1] {
        notes.push(format!(
            "tilt_deg is {}, usual are {} to {}",
            part.tilt_deg, USUAL_TILT[0], USUAL_TILT[1]
        ));
    }
    if let Some(off) = late_at_joins(part, job, machine).filter(|off| *off > 0.0) {
        notes.push(format!(
            "where an arc begins or ends, C is up to {off:.4}° off the heading while it changes its rate, {}° are allowed",
            part.limits.heading_deg.get()
        ));
    }
    let widest = contour
        .segments()
        .iter()
        .enumerate()
        .map(|(i, s)| (s.turn.abs(), i));
    if let Some((sweep, index)) = widest.max_by(|a, b| a.0.total_cmp(&b.0)).filter(|a| a.0 > 0.0) {
        // Half of the time of the arc left, C turns through half of it, the tool travels a quarter.
        notes.push(format!(
            "C follows the heading at any speed; matched to the programmed trapezoid, as published, it would be \
             {:.1}° off on segment {} if the feed were halved in its middle",
            sweep * DEG_PER_RAD / 4.0,
            index + 1
        ));
    }
    notes
}

/// Least and largest C \[rad\]: C turns one way on every segment.
fn range_of_c(job: &Job) -> [f64; 2] {
    let of_pass = |pass: &Pass| {
        let (from, to, offset) = (pass.from, pass.to, pass.offset);
        let ends = job.contour.segments().iter().map(Segment::end_s);
        let places = ends.filter(move |s| *s > from && *s < to).chain([from, to]);
        places.map(move |s| job.contour.at(s).1 + offset)
    };
    let all = job.passes.iter().flat_map(of_pass);
    all.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], c| {
        [least.min(c), most.max(c)]
    })
}

/// By how much C is off where the curvature changes \[°\]: Δω²/(8α) with the acceleration α that C has for it
/// (mathematics 4.2, spread to both sides of the join).
pub(super) fn late_at_joins(part: &Stir, job: &Job, machine: &MachineFile) -> Option<f64> {
    let acceleration = TURN_SHARE * machine.motion.axes[C].as_ref()?.max_acceleration;
    let speed = part.travel_mm_min / 60.0;
    let steps = job.contour.segments().windows(2).map(|pair| {
        let step = (pair[1].curvature() - pair[0].curvature()) * DEG_PER_RAD * speed;
        step * step / (8.0 * acceleration)
    });
    steps.reduce(f64::max)
}
