//! What programs for a machine begin with, and what is checked of a whole program before it is planned.

use super::targets::Tip;
use super::tip_of_machine::TipOfMachine;
use super::{PathError, Planner};
use config::machine::{ArcPlane, LengthUnit, PathMode, ProbeConfig, ToolConfig};
use nc::{
    Blend, CoordinateSystem, Found, Laser, PathControl, Plane, ProbeInput, Program, ProgramAction, SYSTEMS,
    Setup, TipAndAxes,
};
use shared::io::AXES;
use std::collections::BTreeSet;
use std::sync::Arc;

/// A program may be read for a start this far off (mm, degrees).
const SAME_START: f64 = 1e-6;

/// A tool of the machine file.
pub(super) fn tool(tool: &ToolConfig) -> nc::Tool {
    nc::Tool {
        length_mm: tool.length_mm,
        diameter_mm: tool.diameter_mm,
    }
}

impl Planner {
    /// What a program for this machine begins with, when the axes stand at `from` (mm, degrees): the modes of the machine
    /// file's `[program]`. G28 and G30 lead to the park position.
    pub fn setup(&self, from: &[f64; AXES]) -> Setup {
        let kinematics = TipOfMachine::new(&self.kinematics, &self.drives);
        let park = self.planning.park_axes();
        let program = &self.program;
        Setup {
            start: kinematics.tip(from),
            tip_control: program.tip_control,
            inches: program.units == LengthUnit::Inch,
            plane: match program.plane {
                ArcPlane::G17 => Plane::Xy,
                ArcPlane::G18 => Plane::Zx,
                ArcPlane::G19 => Plane::Yz,
            },
            control: match program.path_mode {
                PathMode::G61 => PathControl::ExactPath,
                PathMode::G61_1 => PathControl::ExactStop,
                PathMode::G64 => PathControl::Blend(Blend {
                    tolerance: program.tolerance_mm,
                    smoothing: None,
                }),
            },
            rotary: program.rotary_deg.into_array(),
            fitted: self.fitted,
            homes: [park, park],
            systems: self.systems,
            tools: self.tools.clone(),
            passed_over: program.passed_over.numbers().clone(),
            grbl_commands: program.passed_over.grbl_commands(),
            spindle_rpm: program.spindle_rpm,
            laser: self.laser(),
            probe: self.probe(),
            found: self.found,
            rapid_at_start: program.motion.is_some(),
            r_at_initial_level: program.r_at_initial_level,
            feed_mm_min: program.feed_mm_min,
            kinematics: Some(Arc::new(kinematics)),
            ..Setup::default()
        }
    }

    /// Where G54 to G59.3 are when a program begins.
    pub fn systems(&self) -> &[CoordinateSystem; SYSTEMS] {
        &self.systems
    }

    /// Has programs begin with G54 to G59.3 there.
    pub fn set_systems(&mut self, systems: [CoordinateSystem; SYSTEMS]) {
        self.systems = systems;
    }

    /// Has programs begin with what a probe has found.
    pub fn set_found(&mut self, found: Found) {
        self.found = Some(found);
    }

    /// The beam that M3, M4, M5 and S switch, where the machine file says one.
    fn laser(&self) -> Option<Laser> {
        let words = self.program.laser?;
        let side = words.beam.checked_sub(1)?;
        Some(Laser {
            side,
            full_s: words.full_s,
            full_watt: (*self.largest_power.get(usize::from(side))?)?,
        })
    }

    /// The probe of G38, where the machine file names one.
    pub fn probe(&self) -> Option<ProbeInput> {
        let ProbeConfig { input, opens } = self.program.probe.as_ref()?;
        Some(ProbeInput {
            input: *self.input_names.get(input)?,
            touching: !opens,
        })
    }

    /// What of `program` this machine passes over, and what it takes for granted, a sentence each.
    pub fn notices(&self, program: &Program) -> Vec<String> {
        let events = program.paths.iter().flat_map(|path| &path.events);
        let mut told = BTreeSet::new();
        let mut tool_told = false;
        let mut notices = Vec::new();
        for event in events {
            let text = match event.action {
                // The next ones are the same, or the operator is asked for them.
                ProgramAction::ChangeTool(number) if !std::mem::replace(&mut tool_told, true) => {
                    format!("tool {number} must be in the machine")
                }
                ProgramAction::Coolant { .. } => format!("coolant switches nothing: {} has none", self.name),
                _ => continue,
            };
            if told.insert(text.clone()) {
                notices.push(format!("{}: {text}", event.place));
            }
        }
        notices
    }

    /// Whether `program` may begin with the tip at `tip`, and moves anything.
    pub(super) fn check_begin(&self, program: &Program, tip: &Tip) -> Result<(), PathError> {
        if program.paths.iter().all(|path| path.targets.is_empty()) {
            return Err(PathError::Empty);
        }
        if let Some((start, place)) = program.assumes {
            let here = tip.position_mm.into_iter().chain(tip.angles_deg);
            if here
                .zip(start)
                .any(|(here, start)| (here - start).abs() > SAME_START)
            {
                return Err(PathError::OtherStart { place });
            }
        }
        Ok(())
    }
}
