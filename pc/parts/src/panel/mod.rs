//! A line on a curved panel, for the A/C head: taught by the ranging probe, then cut (mathematics 2).

mod attitude;
mod judge;
mod line;
mod program;
mod speed;
#[cfg(test)]
mod tests;

use crate::CurvedPanel;
use crate::limits::SPEED_DIP;
use crate::{Judgement, Kind, Limit, PartContext, Percent, Plan, Run};
use config::table::FARTHEST_MM;
use config::{RangeError, in_range};
use nalgebra::Vector3;
use serde::Deserialize;
use shared::kinematics::{Kinematics, KinematicsError};
use std::borrow::Cow;
use std::path::PathBuf;
use teach::{GuidePoint, TaughtPoint, TeachingConfig, read_points};
use thiserror::Error;

/// Points of a program that are nearer to each other say nothing more \[mm\].
const CLOSEST_MM: f64 = 0.1;

/// A cut on a curved panel.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Panel {
    /// Speed of the focus \[m/min\].
    speed_m_min: f64,
    /// Power of the beam \[W\].
    power_w: f64,
    /// The cut ends where it begins.
    #[serde(default)]
    closed: bool,
    /// The head runs along the line with the beam off for this long before and after the cut \[mm\].
    lead_mm: f64,
    /// Distance of the points of the program \[mm\].
    spacing_mm: f64,
    /// Points taught before: CSV, as `seamwright teach` writes it.
    taught: Option<PathBuf>,
    /// Where to teach: X Y Z \[mm\] of the tip and A C \[deg\].
    #[serde(default)]
    guide: Vec<[f64; 5]>,
    /// How to teach.
    teaching: TeachingConfig,
    /// What the cut is judged by.
    #[serde(default)]
    limits: PanelLimits,
    /// The panel as it really is. Only simulated worlds look at it, and the judgement of a run in one.
    simulated_surface: Option<CurvedPanel>,
    /// Points taught in this session.
    #[serde(skip)]
    points: Option<Vec<TaughtPoint>>,
}

/// What a run is judged by.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct PanelLimits {
    /// Largest distance of the focus from where it should be, cutting and while A and C turn \[mm\].
    focus_mm: Limit,
    /// Largest error of a taught normal, in a simulated world \[deg\].
    normal_deg: Limit,
    /// Largest angle of the tool with the true normal, in a simulated world \[deg\]; published is that the process bears 7.
    tool_off_normal_deg: Limit,
    /// Most that the speed may fall below the feed with the beam on \[%\].
    speed_dip_percent: Percent,
}

impl Default for PanelLimits {
    fn default() -> Self {
        Self {
            focus_mm: Limit::new(0.01),
            normal_deg: Limit::new(0.5),
            tool_off_normal_deg: Limit::new(7.0),
            speed_dip_percent: SPEED_DIP,
        }
    }
}

/// Why there is no program. Reads as one sentence.
#[derive(Debug, Error)]
pub enum PanelError {
    /// The surface is unknown.
    #[error(
        "the panel is not taught: `seamwright teach` writes its points, and taught = \"FILE\" in the part file names \
         them; `seamwright weld` teaches and cuts in one go"
    )]
    Untaught,
    /// Not enough points for a curve.
    #[error("{found} taught points are too few for a curve, at least {least} are needed")]
    TooFew {
        /// How many there are.
        found: usize,
        /// How many are needed.
        least: usize,
    },
    /// A number makes no sense.
    #[error(transparent)]
    Value(#[from] RangeError),
    /// Another machine.
    #[error("a panel is cut with an A/C head, and the machine has none")]
    NoHead,
    /// No smooth curve.
    #[error("no smooth curve through the taught points: {0}; are two of them the same?")]
    Curve(curves::SplineError),
    /// The head cannot take the attitude.
    #[error("near taught point {point}: {source}")]
    Attitude {
        /// Its number, from 1.
        point: usize,
        /// Why.
        source: KinematicsError,
    },
    /// An axis does not reach.
    #[error("near taught point {point} the path leaves the travel of {axis}: move or turn the work")]
    Travel {
        /// Its number, from 1.
        point: usize,
        /// The axis.
        axis: &'static str,
    },
    /// A drive is too slow somewhere.
    #[error(
        "speed_m_min is {speed}, and may be {:.2} at most: no more allows the {quantity} of {axis} near {whose} point \
         {point}{}",
        floor(*.largest),
        if *.upright { "; a larger upright_deg may let it be more" } else { "" }
    )]
    Speed {
        /// "taught", or "guide" before anything is taught.
        whose: &'static str,
        /// The number of the point, from 1.
        point: usize,
        /// The drive.
        axis: &'static str,
        /// Its "speed" or its "acceleration".
        quantity: &'static str,
        /// Largest speed on the whole line \[m/min\].
        largest: f64,
        /// Asked for \[m/min\].
        speed: f64,
        /// It is C, which turns fast where the normal is near the vertical.
        upright: bool,
    },
    /// The safe height is too low.
    #[error("the safe height of {safe} mm is below the panel, which reaches {top:.1} mm")]
    SafeHeight {
        /// It \[mm\].
        safe: f64,
        /// Highest point of the path \[mm\].
        top: f64,
    },
}

/// Rounded down to two decimals, so that the value in the message can be used.
fn floor(m_min: f64) -> f64 {
    libm::floor(100.0 * m_min) / 100.0
}

impl Panel {
    /// Whether it has to be taught before it can be planned.
    pub fn is_untaught(&self) -> bool {
        self.taught.is_none() && self.points.is_none()
    }

    /// Where to teach.
    pub fn guides(&self) -> Vec<GuidePoint> {
        let guide = |[x, y, z, a, c]: &[f64; 5]| GuidePoint {
            position: Vector3::new(*x, *y, *z),
            angles_deg: [*a, 0.0, *c],
        };
        self.guide.iter().map(guide).collect()
    }

    /// How to teach.
    pub fn teaching(&self) -> &TeachingConfig {
        &self.teaching
    }

    /// The panel as it really is, in a simulated world.
    pub fn simulated_surface(&self) -> Option<&CurvedPanel> {
        self.simulated_surface.as_ref()
    }

    /// Sets the points that were taught.
    pub fn set_points(&mut self, points: Vec<TaughtPoint>) {
        self.points = Some(points);
    }

    /// The taught points: of this session, or of the file.
    fn points(&self, context: &PartContext) -> anyhow::Result<Cow<'_, [TaughtPoint]>> {
        match (&self.points, &self.taught) {
            (Some(points), _) => Ok(Cow::Borrowed(points)),
            (None, Some(file)) => Ok(Cow::Owned(read_points(&context.directory.join(file))?)),
            (None, None) => Err(PanelError::Untaught.into()),
        }
    }

    /// Checks the numbers of the cut.
    fn check(&self) -> Result<(), PanelError> {
        let above_0 = [("speed_m_min", self.speed_m_min), ("power_w", self.power_w)];
        for (key, value) in above_0 {
            in_range(key, value, value > 0.0, "above 0")?;
        }
        // Otherwise there is no end of points.
        let more = [
            ("spacing_mm", self.spacing_mm, CLOSEST_MM, "at least 0.1"),
            ("lead_mm", self.lead_mm, 0.0, "0 or more, and no more than 100000"),
        ];
        for (key, value, least, requirement) in more {
            in_range(key, value, (least..=FARTHEST_MM).contains(&value), requirement)?;
        }
        Ok(())
    }
}

impl Kind for Panel {
    fn plan(&self, context: &PartContext) -> anyhow::Result<Plan> {
        self.check()?;
        let points = self.points(context)?;
        self.check_speed(context, &points)?;
        Ok(self.program(context, &points)?)
    }

    fn check_judging(&self, context: &PartContext, _: &Kinematics) -> anyhow::Result<()> {
        self.points(context).map(drop)
    }

    fn judge(&self, context: &PartContext, run: &Run) -> anyhow::Result<Judgement> {
        Ok(self.figures(run, &self.points(context)?))
    }

    fn speed_dip(&self) -> Option<Percent> {
        Some(self.limits.speed_dip_percent)
    }
}
