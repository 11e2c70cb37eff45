//! Starting a program at one of its lines: the whole program is planned for its state, and run from there.

use super::outputs::Switched;
use super::shape::{Shape, channels};
use super::{Leg, NOWHERE, PathError, PlannedPath, Planner, inner};
use nc::{Motion, Program, ProgramAction, Way};
use shared::io::{AXES, SIDES};
use shared::protocol::{PathAction, PathEvent};
use shared::trajectory::{CHANNELS, Element, PathSpace, ReferenceError, axes_at};
use std::sync::Arc;
use thiserror::Error;

/// The axes are followed in steps of this \[mm\], or degrees where the tip stands.
const STEP: f64 = 0.5;
/// Events this near to a line's start are those of the line \[mm\].
const SAME: f64 = 1e-6;

/// Why a program cannot be started at a line.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum FromLineError {
    /// The program does nothing any more.
    #[error("nothing moves in line {line} or after it; the last line that does is {last}")]
    Nothing {
        /// The line.
        line: u32,
        /// The last one with a motion.
        last: u32,
    },
    /// Lines are not run one after the other.
    #[error("a program with loops, conditions, subroutines or a probe is started at its beginning only")]
    Branches,
    /// A weld with weld data is welded as a whole.
    #[error("line {line} is in the weld of line {begins}: start there, or behind line {ends}, where it ends")]
    Welds {
        /// The line.
        line: u32,
        /// That of its WELDON.
        begins: u32,
        /// That of its WELDOFF.
        ends: u32,
    },
    /// A curve takes several lines.
    #[error(
        "line {line} is in the middle of the NURBS of line {begins}: start there, or after its G5.3 or last point"
    )]
    Inside {
        /// The line.
        line: u32,
        /// Where the curve is begun.
        begins: u32,
    },
    /// There is no run-in.
    #[error(
        "line {line} follows the seam, which has to be found before: start from line {begins}, where tracking \
         begins, or before it"
    )]
    Tracked {
        /// The line.
        line: u32,
        /// Where tracking goes on.
        begins: u32,
    },
    /// The axes cannot be followed to the line.
    #[error("line {line}: {source}")]
    Axes {
        /// Where they are lost.
        line: u32,
        /// Why.
        source: ReferenceError,
    },
    /// The machine cannot go there.
    #[error(transparent)]
    Path(#[from] PathError),
}

/// Where a program is started in its middle: the begin of a line, and what is switched on there.
struct RestartPoint {
    /// Index of its path.
    path: usize,
    /// Path length there \[mm\].
    s: f64,
    line: u32,
    /// mm, rad.
    axes: [f64; AXES],
    extension_mm: [f64; SIDES],
    /// Where the last rapid before it ended (mm, rad).
    clear: [f64; AXES],
    /// Of that path, before the line.
    switched: Switched,
    spindle: Spindle,
    /// Line with which tracking went on, if it is.
    tracking_since: Option<u32>,
}

/// The spindle before a place.
#[derive(Clone, Copy, Default)]
struct Spindle {
    on: bool,
    /// Index of the path with which it went on.
    on_with: usize,
    rpm: Option<f64>,
    /// Time to run up, as the program gave it \[s\].
    run_up_s: f64,
}

impl Planner {
    /// The paths of a program from the first motion in or after `line` on, and before them those that bring the machine
    /// there from the axes `from` (mm, degrees): away first, as for parking, then over the place, then down to it.
    ///
    /// `paths` are those of all of `program`. Beams go on where the line begins, if they are on there. A spindle is on
    /// before the machine goes down, which is no faster than a feed from where the program itself did not go by a rapid.
    ///
    /// # Errors
    /// [`FromLineError`].
    pub fn from_line(
        &self,
        program: &Program,
        mut paths: Vec<PlannedPath>,
        line: u32,
        from: &[f64; AXES],
    ) -> Result<Vec<PlannedPath>, FromLineError> {
        check_whole(program, line)?;
        let place = self.find(&paths, line, &inner(from))?;
        if let Some(begins) = place.tracking_since {
            return Err(FromLineError::Tracked {
                line: place.line,
                begins,
            });
        }
        // What was waited for in the lines before is not waited for.
        paths[place.path]
            .waits_before
            .retain(|wait| wait.place.line >= line);
        if place.path == 0 && place.s <= 0.0 {
            return Ok(paths);
        }
        let mut rest = paths.split_off(place.path);
        let feed = rest.iter().find(|path| path.motion == Motion::Feed);
        let slow = feed.map(|path| path.limits.velocity).filter(|_| place.spindle.on);
        let mut planned = self.approach(&inner(from), &place, slow)?;
        if place.s > 0.0
            && let Some(first) = rest.first_mut()
        {
            first.begin_at(place.s, place.switched.actions());
        }
        planned.append(&mut rest);
        Ok(planned)
    }

    /// Follows the axes and all that is switched to the first motion in or after `line`.
    fn find(
        &self,
        paths: &[PlannedPath],
        line: u32,
        from: &[f64; AXES],
    ) -> Result<RestartPoint, FromLineError> {
        let (mut axes, mut clear) = (*from, *from);
        let mut last = 0;
        let mut spindle = Spindle::default();
        let mut tracking_since = None;
        for (index, path) in paths.iter().enumerate() {
            if spindle.on && spindle.on_with + 1 == index {
                spindle.run_up_s = path.dwell_before_s;
            }
            // The boards begin every path with everything off.
            let mut switched = Switched::default();
            if tracking_at(path, 0.0) != Some(true) {
                tracking_since = None;
            }
            let mut s = 0.0;
            for leg in path.legs() {
                let Leg { events, element } = leg?;
                if element.line >= line {
                    let value = element.at(0.0).value;
                    return Ok(RestartPoint {
                        path: index,
                        s,
                        line: element.line,
                        axes,
                        extension_mm: std::array::from_fn(|side| value[CHANNELS - SIDES + side]),
                        clear,
                        switched,
                        spindle,
                        // The line itself may turn it off.
                        tracking_since: tracking_since.filter(|_| tracking_at(path, s) != Some(false)),
                    });
                }
                switched.take_up(&events);
                for event in &events {
                    self.spin(&mut spindle, event, index);
                    match event.action {
                        PathAction::Tracking { on: true } => {
                            tracking_since.get_or_insert(element.line);
                        }
                        PathAction::Tracking { on: false } => tracking_since = None,
                        _ => {}
                    }
                }
                axes = self.followed(path.space, &element, &axes)?;
                last = last.max(element.line);
                s += element.length;
            }
            if path.motion == Motion::Rapid {
                clear = axes;
            }
        }
        Err(FromLineError::Nothing { line, last })
    }

    fn spin(&self, spindle: &mut Spindle, event: &PathEvent, path: usize) {
        match event.action {
            PathAction::Beam { side, on } if Some(side) == self.spindle => {
                if on && !spindle.on {
                    spindle.on_with = path;
                }
                spindle.on = on;
            }
            PathAction::Power { side, watt } if Some(side) == self.spindle => spindle.rpm = Some(watt),
            _ => {}
        }
    }

    /// The axes at the end of `element`, which begins with them at `axes`.
    fn followed(
        &self,
        space: PathSpace,
        element: &Element,
        axes: &[f64; AXES],
    ) -> Result<[f64; AXES], FromLineError> {
        let count = (element.length / STEP).ceil().max(1.0) as u32;
        let mut axes = *axes;
        for i in 1..=count {
            let point = element.at(element.length * f64::from(i) / f64::from(count));
            axes = axes_at(&self.kinematics, &point, space, &axes).map_err(|source| FromLineError::Axes {
                line: element.line,
                source,
            })?;
        }
        Ok(axes)
    }

    /// To where a line begins, with beams off. With a spindle the rest of the way down, from where the last rapid of
    /// the program ended, is no faster than `slow` \[mm/s\].
    fn approach(
        &self,
        from: &[f64; AXES],
        place: &RestartPoint,
        slow: Option<f64>,
    ) -> Result<Vec<PlannedPath>, FromLineError> {
        let park = inner(&self.planning.park_axes());
        let (mut away, mut over, mut above) = (*from, place.axes, place.axes);
        for axis in &self.planning.park_first {
            let axis = *axis as usize;
            (away[axis], over[axis], above[axis]) = (park[axis], park[axis], park[axis]);
            let clear = place.clear[axis];
            let (low, high) = (park[axis].min(place.axes[axis]), park[axis].max(place.axes[axis]));
            if (low..=high).contains(&clear) {
                above[axis] = clear;
            }
        }
        let way = |from: &[f64; AXES], to: &[f64; AXES]| -> Result<Option<PlannedPath>, PathError> {
            let path = || self.axes_path(from, to, &place.extension_mm, NOWHERE);
            (from != to).then(path).transpose()
        };
        let mut paths = Vec::new();
        paths.extend(way(from, &away)?);
        paths.extend(way(&away, &over)?);
        if !place.spindle.on {
            paths.extend(way(&over, &place.axes)?);
            return Ok(paths);
        }
        let spun_up = paths.len() + 1;
        paths.push(self.spun_up(&over, place)?);
        paths.extend(way(&over, &above)?);
        if let Some(mut down) = way(&above, &place.axes)? {
            down.limits.velocity = slow.unwrap_or(f64::INFINITY).min(down.limits.velocity);
            paths.push(down);
        }
        if let Some(next) = paths.get_mut(spun_up) {
            next.dwell_before_s = place.spindle.run_up_s;
        }
        Ok(paths)
    }

    /// The spindle goes on while the axes stand at `axes`.
    fn spun_up(&self, axes: &[f64; AXES], place: &RestartPoint) -> Result<PlannedPath, PathError> {
        let pose = self.kinematics.forward(axes);
        let shape = Shape::standing(channels(&pose, &place.extension_mm), NOWHERE);
        let mut planned = PlannedPath::untimed(&shape, PathSpace::Tool, Motion::Stand);
        let demands = self.demands(&planned, &shape, axes)?;
        planned.limits = self.rapid_limits(&demands);
        let side = self.spindle.unwrap_or_default();
        let speed = place.spindle.rpm.map(|watt| PathAction::Power { side, watt });
        let on = PathAction::Beam { side, on: true };
        let actions = speed.into_iter().chain([on]);
        planned.events = actions.map(|action| PathEvent { s_mm: 0.0, action }).collect();
        Ok(planned)
    }
}

/// What `path` says of tracking at `s` \[mm\], at last.
fn tracking_at(path: &PlannedPath, s: f64) -> Option<bool> {
    let here = path.events.iter().filter(|event| (event.s_mm - s).abs() <= SAME);
    let mut tracking = here.filter_map(|event| match event.action {
        PathAction::Tracking { on } => Some(on),
        _ => None,
    });
    tracking.next_back()
}

/// A line in the middle of a NURBS, or of a weld, is not a block of its own.
fn check_whole(program: &Program, line: u32) -> Result<(), FromLineError> {
    if program.branches {
        return Err(FromLineError::Branches);
    }
    let mut welding = None;
    for path in &program.paths {
        for event in &path.events {
            let here = event.place.line;
            match event.action {
                ProgramAction::WeldOn(_) => welding = Some(here),
                ProgramAction::WeldOff => {
                    let began = welding.take().filter(|begins| *begins < line && line <= here);
                    if let Some(begins) = began {
                        let ends = here;
                        return Err(FromLineError::Welds { line, begins, ends });
                    }
                }
                _ => {}
            }
        }
        for next in Arc::new(path.clone()).moves() {
            let target = next.map_err(PathError::from)?.target;
            let begins = target.place.line;
            if let Way::Nurbs(curve) = &target.way
                && curve.points.last().is_some_and(|point| line <= point.place.line)
                && line > begins
            {
                return Err(FromLineError::Inside { line, begins });
            }
        }
    }
    Ok(())
}
