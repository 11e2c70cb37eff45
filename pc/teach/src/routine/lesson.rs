//! One run of teaching: the moves of the machine, and the measurements of its probe.

use super::error::{NoDistance, PointError, PointFailure};
use super::{GuidePoint, ProbeMachine, Teacher, aim};
use crate::halving::HalvingError;
use crate::ring::{DIRECTIONS, NEIGHBOURS};
use crate::{Ring, Taught, TaughtPoint};
use nalgebra::Vector3;
use nc::text::NcText;
use shared::geometry::angle;
use shared::io::AXES;

const Z: usize = 2;
const C: usize = 5;
/// Nearer to the vertical than this C has no effect on the tool \[rad\].
const VERTICAL: f64 = 1e-3;

/// A turn about the focus begins so many times as slowly: the axes break away from friction one after the other, and
/// until all move the focus is off.
const TURNS_SLOWER: f64 = 3.0;

/// One run of teaching.
pub(super) struct Lesson<'t, 'a, A: ProbeMachine> {
    pub(super) teacher: &'t Teacher<'a>,
    pub(super) arm: &'t mut A,
    /// Where the axes were sent last (mm, rad).
    pub(super) axes: [f64; AXES],
    /// When the point before was done.
    pub(super) time_us: u64,
}

type Attempt<T, A> = Result<T, PointFailure<<A as ProbeMachine>::Error>>;

impl<A: ProbeMachine> Lesson<'_, '_, A> {
    /// To the safe height over the first point, in axis space, Z first if it has to rise.
    pub(super) fn approach(&mut self, guide: &GuidePoint) -> Attempt<(), A> {
        let teacher = self.teacher;
        let mut over = guide.position;
        over.z = teacher.safe_height.max(over.z + teacher.config.approach_mm);
        let axes = teacher.axes_of(&over, &guide.angles_deg);
        let mut up = self.axes;
        up[Z] = up[Z].max(axes[Z]);
        self.axes_to(up)?;
        self.axes_to(axes)
    }

    /// Teaches one point.
    pub(super) fn point(&mut self, guide: &GuidePoint) -> Attempt<TaughtPoint, A> {
        let teacher = self.teacher;
        let over = teacher.axes_of(&guide.position, &guide.angles_deg);
        let normal = teacher.kinematics.forward(&over).normal;
        let over = guide.position + normal * teacher.config.approach_mm;
        // In axis space: so attitude to attitude is a short way, whatever C means on it.
        self.axes_to(teacher.axes_of(&over, &guide.angles_deg))?;
        self.shift_to(&guide.position)?;
        let mut centre = self.surface_here().map_err(PointFailure::distance)?;
        let mut normal = self.first_normal(&centre)?;
        let mut off = 0.0;
        for _ in 0..=teacher.config.most_turns {
            self.shift_to(&centre)?;
            self.turn_to(&normal)?;
            // The point of the tangent plane that is nearest to the guide.
            let foot = guide.position - normal * normal.dot(&(guide.position - centre));
            self.shift_to(&foot)?;
            centre = self.surface_here().map_err(PointFailure::distance)?;
            let taught = self.rings(&centre)?;
            normal = self.to_work(&taught.ring.normal());
            off = self.off(&normal)?;
            if off <= teacher.config.aim_deg.to_radians() {
                return self.finish(centre, normal, &taught);
            }
        }
        Err(PointFailure::Point(PointError::Aim {
            turns: teacher.config.most_turns,
            off_deg: off.to_degrees(),
        }))
    }

    /// The normal by one ring of the first radius.
    fn first_normal(&mut self, centre: &Vector3<f64>) -> Attempt<Vector3<f64>, A> {
        let radius = self.teacher.config.rings.start_radius_mm;
        let heights = self.ring(centre, radius)?;
        let ring = Ring::new(radius, heights).map_err(PointError::Ring)?;
        Ok(self.to_work(&ring.normal()))
    }

    /// The ring that gives the best normal.
    fn rings(&mut self, centre: &Vector3<f64>) -> Attempt<Taught, A> {
        let teacher = self.teacher;
        let taught = teacher.halving.run(|radius| self.ring(centre, radius));
        let taught = taught.map_err(|error| match error {
            HalvingError::Measure { source, .. } => source,
            HalvingError::Ring(reason) => PointFailure::Point(reason.into()),
        })?;
        if let Some(unsmooth) = taught.unsmooth {
            return Err(PointError::Unsmooth(unsmooth).into());
        }
        if !taught.ok {
            return Err(PointFailure::Point(PointError::Uncertain {
                error_deg: taught.error.to_degrees(),
                limit_deg: teacher.config.rings.limit_deg,
            }));
        }
        Ok(taught)
    }

    /// Heights of the eight neighbours over `centre`, in the frame of the tool as it stands.
    fn ring(&mut self, centre: &Vector3<f64>, radius: f64) -> Attempt<[f64; NEIGHBOURS], A> {
        let tool = self.teacher.kinematics.forward(&self.axes);
        let mut heights = [0.0; NEIGHBOURS];
        for (height, [cos, sin]) in heights.iter_mut().zip(DIRECTIONS) {
            let beside = tool.tangent * cos + tool.normal.cross(&tool.tangent) * sin;
            self.shift_to(&(centre + beside * radius))?;
            let point = self.surface_here().map_err(|seen| seen.in_ring(radius))?;
            *height = tool.normal.dot(&(point - centre));
        }
        Ok(heights)
    }

    fn finish(&self, centre: Vector3<f64>, normal: Vector3<f64>, taught: &Taught) -> Attempt<TaughtPoint, A> {
        let (found_deg, limit_deg) = (
            angle(&normal, &Vector3::z()).to_degrees(),
            self.teacher.config.steepest_deg,
        );
        if found_deg > limit_deg {
            return Err(PointFailure::Point(PointError::Steep { found_deg, limit_deg }));
        }
        Ok(TaughtPoint {
            position: centre,
            normal,
            error: taught.error,
            rings: taught.rings,
            time_s: 0.0,
        })
    }

    /// The surface point in the beam.
    fn surface_here(&mut self) -> Result<Vector3<f64>, NoDistance<A::Error>> {
        let teacher = self.teacher;
        let look = self
            .arm
            .look(teacher.config.readings)
            .map_err(NoDistance::Machine)?;
        self.time_us = look.time_us;
        let ranging = teacher.probe.range(&look.readings).map_err(NoDistance::Refused)?;
        let tool = teacher.kinematics.forward(&look.axes);
        Ok(tool.position - tool.normal * (ranging.distance_mm - teacher.reference))
    }

    /// A direction in the frame of the tool as it stands, turned into the frame of the work.
    fn to_work(&self, direction: &Vector3<f64>) -> Vector3<f64> {
        let tool = self.teacher.kinematics.forward(&self.axes);
        let lateral = tool.normal.cross(&tool.tangent);
        tool.tangent * direction.x + lateral * direction.y + tool.normal * direction.z
    }

    /// The axes with the tool along `normal` and the tip where it is.
    fn aimed(&self, normal: &Vector3<f64>) -> Attempt<[f64; AXES], A> {
        let Teacher {
            kinematics, config, ..
        } = self.teacher;
        let tip = kinematics.forward(&self.axes).position;
        let upright = config.upright_deg.to_radians();
        aim(kinematics, &tip, normal, &self.axes, upright).map_err(|error| PointError::from(error).into())
    }

    /// By how much the tool would have to turn to stand along `normal` \[rad\].
    fn off(&self, normal: &Vector3<f64>) -> Attempt<f64, A> {
        let kinematics = self.teacher.kinematics;
        let aimed = kinematics.forward(&self.aimed(normal)?).normal;
        Ok(angle(&aimed, &kinematics.forward(&self.axes).normal))
    }

    /// Turns the tool along `normal`, the focus staying where it is.
    fn turn_to(&mut self, normal: &Vector3<f64>) -> Attempt<(), A> {
        let aimed = self.aimed(normal)?;
        let tool = self.teacher.kinematics.forward(&self.axes);
        if angle(&tool.normal, &Vector3::z()) < VERTICAL {
            // At its pole C has to turn before the tool leaves the vertical: with it would be too late.
            let mut turned = self.axes;
            turned[C] = aimed[C];
            self.axes_to(turned)?;
        }
        self.tip_at(aimed, TURNS_SLOWER)
    }

    /// Moves the axes straight to `axes` (mm, rad).
    fn axes_to(&mut self, axes: [f64; AXES]) -> Attempt<(), A> {
        let mut nc = NcText::default();
        nc.block(&format!("G53 G0 {}", self.teacher.axis_words(&axes)));
        self.run(nc, axes, 1.0)
    }

    /// Moves the tip to `position` without turning.
    fn shift_to(&mut self, position: &Vector3<f64>) -> Attempt<(), A> {
        let shift = position - self.teacher.kinematics.forward(&self.axes).position;
        let mut axes = self.axes;
        for i in 0..3 {
            axes[i] += shift[i];
        }
        self.tip_to(axes)
    }

    /// Moves the tip in a straight line to where it is for `axes`, and turns to their attitude on the way.
    fn tip_to(&mut self, axes: [f64; AXES]) -> Attempt<(), A> {
        self.tip_at(axes, 1.0)
    }

    /// The same, `slower` times as slowly as the machine can.
    fn tip_at(&mut self, axes: [f64; AXES], slower: f64) -> Attempt<(), A> {
        let tip = self.teacher.kinematics.forward(&axes).position;
        let mut values = axes;
        values[..3].copy_from_slice(tip.as_slice());
        let mut nc = NcText::default();
        nc.block("G43.4");
        nc.block(&format!("G0 {}", self.teacher.axis_words(&values)));
        self.run(nc, axes, slower)
    }

    fn run(&mut self, mut nc: NcText, axes: [f64; AXES], slower: f64) -> Attempt<(), A> {
        nc.block("M2");
        self.arm
            .run(&nc.finish(), slower)
            .map_err(PointFailure::Machine)?;
        self.axes = axes;
        Ok(())
    }
}
