//! The NC program of a taught seam: each pass from above its beginning to above its end.

use super::error::TaughtSeamError;
use super::{Pass, TaughtSeam, drawn_back};
use crate::{PartContext, Plan};
use cam::path::{Planner, Tip};
use config::machine::MachineFile;
use nalgebra::Vector3;
use nc::text::{NcText, decimal, words};
use shared::geometry::Pose;
use shared::io::{AXES, AXIS_NAMES};
use shared::kinematics::AXIS_UNIT;
use teach::TipPoint;

/// Writes places of the tip for one machine.
struct Writer<'a> {
    planner: Planner,
    machine: &'a MachineFile,
    fitted: [bool; AXES],
}

pub(super) fn plan(
    part: &TaughtSeam,
    points: &[TipPoint],
    context: &PartContext,
) -> Result<Plan, TaughtSeamError> {
    let machine = context.machine;
    let writer = Writer {
        planner: Planner::build(machine)?,
        machine,
        fitted: machine.motion.kinematics.fitted(),
    };
    let notes = notes(part, points);
    let mut nc = NcText::default();
    nc.line("%");
    nc.comment(context.title);
    nc.comment(&format!("machine {}", machine.name));
    for note in &notes {
        nc.comment(note);
    }
    nc.comment("X Y Z: tip in the frame of the work [mm], A B C: axes [deg]; after G53 all are axes");
    nc.block("G21 G17 G90 G94 G40 G500");
    nc.block("G43.4");
    let corners = part.corner_mm;
    nc.block(&corners.map_or("G64".to_owned(), |mm| format!("G64 P{}", decimal(mm, 5))));
    let mut stands = None;
    for (index, pass) in part.passes.iter().enumerate() {
        nc.comment(&format!("pass {}: {}", index + 1, pass.weld));
        let mut seam: Vec<(Pose, [f64; 3])> = points.iter().map(|point| writer.pose(point)).collect();
        if pass.back {
            seam.reverse();
        }
        writer.pass(&mut nc, pass, &seam, part.approach_mm, &mut stands)?;
    }
    writer.up(&mut nc);
    nc.block("M2");
    nc.line("%");
    Ok(Plan {
        program: nc.finish(),
        notes,
    })
}

impl Writer<'_> {
    fn pose(&self, point: &TipPoint) -> (Pose, [f64; 3]) {
        let tip = Tip {
            position_mm: point.position_mm,
            angles_deg: point.angles_deg,
            ..Tip::default()
        };
        (self.planner.pose(&tip), point.angles_deg)
    }

    /// A pass along `seam`, from where the tip `stands`, in words, or from afar.
    fn pass(
        &self,
        nc: &mut NcText,
        pass: &Pass,
        seam: &[(Pose, [f64; 3])],
        approach_mm: f64,
        stands: &mut Option<String>,
    ) -> Result<(), TaughtSeamError> {
        let clearance = pass.clearance(self.machine);
        let place = |(pose, angles): &(Pose, [f64; 3]), back: f64| {
            let position_mm = drawn_back(pose, clearance + back).position.into();
            Tip {
                position_mm,
                angles_deg: *angles,
                ..Tip::default()
            }
        };
        let [first, .., last] = seam else {
            return Ok(());
        };
        let above = place(first, approach_mm);
        let there = self.words(&above);
        match stands {
            None => self.approach(nc, &above)?,
            Some(stands) if *stands != there => nc.block(&format!("G0 {there}")),
            Some(_) => {}
        }
        nc.block(&format!("G0 {}", self.words(&place(first, 0.0))));
        nc.block(&format!("WELDON={}", pass.weld));
        let mut feed = format!(" F{}", decimal(pass.mm_min, 3));
        for point in &seam[1..] {
            let words = self.words(&place(point, 0.0));
            nc.block(&format!("G1 {words}{}", std::mem::take(&mut feed)));
        }
        nc.block("WELDOFF");
        let there = self.words(&place(last, approach_mm));
        nc.block(&format!("G0 {there}"));
        *stands = Some(there);
        Ok(())
    }

    /// From anywhere: the axes that park first are out of the way while the others go above the seam.
    fn approach(&self, nc: &mut NcText, above: &Tip) -> Result<(), TaughtSeamError> {
        let [a, b, c] = above.angles_deg.map(f64::to_radians);
        let near = [0.0, 0.0, 0.0, a, b, c];
        let axes = self
            .planner
            .kinematics()
            .inverse(&self.planner.pose(above), &near);
        let axes = axes.map_err(|_| TaughtSeamError::Approach { tip: *above })?;
        self.up(nc);
        let goes = |nc: &mut NcText, first: bool| {
            let moved = (0..AXES).filter(|i| self.fitted[*i] && self.parks_first(*i) == first);
            let words = words(moved.map(|i| (AXIS_NAMES[i], axes[i] / AXIS_UNIT[i])));
            if !words.is_empty() {
                nc.block(&format!("G53 G0 {words}"));
            }
        };
        goes(nc, false);
        goes(nc, true);
        Ok(())
    }

    /// The axes that park first, where they park.
    fn up(&self, nc: &mut NcText) {
        let park = self.machine.planning.park_axes();
        let axes = (0..AXES).filter(|i| self.parks_first(*i));
        let words = words(axes.map(|i| (AXIS_NAMES[i], park[i])));
        if !words.is_empty() {
            nc.block(&format!("G53 G0 {words}"));
        }
    }

    fn parks_first(&self, axis: usize) -> bool {
        let mut first = self.machine.planning.park_first.iter();
        first.any(|first| *first as usize == axis)
    }

    /// A tip as words.
    fn words(&self, tip: &Tip) -> String {
        let values = tip.position_mm.into_iter().chain(tip.angles_deg).enumerate();
        let values = values.filter(|(i, _)| *i < 3 || self.fitted[*i]);
        words(values.map(|(i, value)| (AXIS_NAMES[i], value)))
    }
}

/// What a person should know.
fn notes(part: &TaughtSeam, points: &[TipPoint]) -> Vec<String> {
    let places = |point: &TipPoint| Vector3::from(point.position_mm);
    let chords = points
        .windows(2)
        .map(|pair| (places(&pair[1]) - places(&pair[0])).norm());
    let chords: f64 = chords.sum();
    let passes: Vec<&str> = part.passes.iter().map(|pass| pass.weld.as_str()).collect();
    vec![format!(
        "seam through {} taught places, {chords:.2} mm from one to the next; {}: {}",
        points.len(),
        if passes.len() == 1 { "1 pass" } else { "passes" },
        passes.join(", ")
    )]
}
