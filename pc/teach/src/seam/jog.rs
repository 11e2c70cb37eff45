//! Teaching by hand: the operator types jog commands, one per line.

use super::follow::{Centred, SAME_PLACE, take};
use super::{CameraMachine, Ended, Follower, MachinePose, SeamPoint, SeamTeachError, View};
use crate::spoken::Spoken;
use nalgebra::Vector3;
use shared::geometry::{Pose, rotate};
use shared::io::SIDES;

/// The jog commands.
pub const JOG_WORDS: &str = "\
x y z DISTANCE     moves along an axis of the work [mm]
a b c ANGLE        turns the head about the tip [deg]
across up along D  moves by the head: to the left of travel, away from the work, ahead [mm]
u1 v1 u2 v2 D      moves a slide of one side, v toward the work [mm]
step [D]           goes on along the seam, by D [mm] or by the spacing rule
centre             brings both seams to the middle of their bands
search             looks for them around here
take               takes this point down
undo               takes the last point out again
look               tells what the cameras see
done               ends";

/// An operator who teaches by hand.
pub trait JogOperator: CameraMachine {
    /// The next line of the operator; `None` when there are no more.
    fn line(&mut self) -> Result<Option<String>, Self::Error>;

    /// Prints a message to the operator.
    fn say(&mut self, text: &str);

    /// The last point does not count; `points` are those that stay.
    fn untaught(&mut self, points: &[SeamPoint]) -> Result<(), Self::Error>;

    /// Whether `error` means that the machine has not moved, and can be asked for something else.
    fn is_refusal(&self, error: &Self::Error) -> bool;
}

/// A jog command.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Jog {
    /// To move along X, Y or Z \[mm\].
    Axis(usize, f64),
    /// To turn about A, B or C \[rad\].
    Turn(usize, f64),
    /// To move by the head: across, up or along \[mm\].
    Head(usize, f64),
    /// To move a slide \[mm\].
    Slide(usize, f64),
    /// To continue along the seam \[mm\].
    Step(Option<f64>),
    /// To centre both seams.
    Centre,
    /// To search them.
    Search,
    /// To take the point down.
    Take,
    /// To take the last one out.
    Undo,
    /// To print what is seen.
    Look,
    /// To end.
    Done,
}

impl Jog {
    /// What `line` means; what is wrong with it otherwise.
    pub fn parse(line: &str) -> Result<Self, String> {
        let Some(spoken) = Spoken::of(line)? else {
            return Ok(Self::Look);
        };
        if let Some(axis) = spoken.place(&["x", "y", "z"]) {
            return Ok(Self::Axis(axis, spoken.mm()?));
        }
        if let Some(axis) = spoken.place(&["a", "b", "c"]) {
            return Ok(Self::Turn(axis, spoken.deg()?.to_radians()));
        }
        if let Some(way) = spoken.place(&["across", "up", "along"]) {
            return Ok(Self::Head(way, spoken.mm()?));
        }
        if let Some(slide) = spoken.place(&["u1", "v1", "u2", "v2"]) {
            return Ok(Self::Slide(slide, spoken.mm()?));
        }
        if spoken.word == "step" {
            let by = spoken.value.map(|_| spoken.mm()).transpose()?;
            return Ok(Self::Step(by));
        }
        match spoken.alone()? {
            "centre" | "center" => Ok(Self::Centre),
            "search" => Ok(Self::Search),
            "take" => Ok(Self::Take),
            "undo" => Ok(Self::Undo),
            "look" => Ok(Self::Look),
            "done" => Ok(Self::Done),
            word => Err(format!("{word} is not a command here\n{JOG_WORDS}")),
        }
    }

    /// Where a move leads from `machine_pose`; `None` if it is no move of machine or slides.
    fn moved(self, machine_pose: &MachinePose) -> Option<MachinePose> {
        let Pose {
            position,
            tangent,
            normal,
        } = machine_pose.pose;
        let pose = match self {
            Self::Axis(axis, by) => Pose {
                position: position + Vector3::ith(axis, by),
                ..machine_pose.pose
            },
            Self::Head(way, by) => Pose {
                position: position + [normal.cross(&tangent), normal, tangent][way] * by,
                ..machine_pose.pose
            },
            Self::Turn(axis, by) => {
                let heading = libm::atan2(tangent.y, tangent.x);
                let about = [
                    tangent,
                    Vector3::new(-libm::sin(heading), libm::cos(heading), 0.0),
                    Vector3::z(),
                ][axis];
                Pose {
                    position,
                    tangent: rotate(&about, by, &tangent),
                    normal: rotate(&about, by, &normal),
                }
            }
            Self::Slide(slide, by) => {
                let mut there = *machine_pose;
                there.slides_mm[slide] += by;
                return Some(there);
            }
            Self::Step(_)
            | Self::Centre
            | Self::Search
            | Self::Take
            | Self::Undo
            | Self::Look
            | Self::Done => {
                return None;
            }
        };
        Some(MachinePose {
            pose,
            ..*machine_pose
        })
    }
}

impl Follower<'_> {
    /// Lets the operator teach by hand from `start` on, or from the last of the `points` that are taught already.
    pub fn jog<R: JogOperator>(
        &self,
        rig: &mut R,
        start: &MachinePose,
        points: &[SeamPoint],
    ) -> Result<Ended, SeamTeachError<R::Error>> {
        let mut points = points.to_vec();
        let mut machine_pose = self.start(start, &points);
        rig.approach(&machine_pose)?;
        self.tell(rig)?;
        while let Some(line) = rig.line()? {
            let jog = match Jog::parse(&line) {
                Ok(Jog::Done) => break,
                Ok(jog) => jog,
                Err(wrong) => {
                    rig.say(&wrong);
                    continue;
                }
            };
            match self.obey(rig, jog, &machine_pose, &mut points) {
                Ok(there) => machine_pose = there,
                Err(SeamTeachError::Machine(error)) if rig.is_refusal(&error) => rig.say(&error.to_string()),
                Err(SeamTeachError::Machine(error)) => return Err(error.into()),
                Err(not_found @ SeamTeachError::NotFound(_)) => {
                    rig.go(&machine_pose)?;
                    rig.say(&not_found.to_string());
                }
            }
        }
        Ok(Ended::Operator)
    }

    /// Does what the operator says; where the machine stands then.
    fn obey<R: JogOperator>(
        &self,
        rig: &mut R,
        jog: Jog,
        machine_pose: &MachinePose,
        points: &mut Vec<SeamPoint>,
    ) -> Result<MachinePose, SeamTeachError<R::Error>> {
        if let Some(there) = jog.moved(machine_pose) {
            rig.go(&there)?;
            self.tell(rig)?;
            return Ok(there);
        }
        let there = match jog {
            Jog::Step(by) => {
                let Some(there) = self.stepped(machine_pose, points, by) else {
                    rig.say("step continues after the last point taken, and no point is taken yet");
                    return Ok(*machine_pose);
                };
                rig.go(&there)?;
                there
            }
            Jog::Search => self.find(rig, machine_pose)?.machine_pose,
            Jog::Centre => match self.centre(rig, machine_pose)?.both() {
                Some(centred) => centred.machine_pose,
                None => {
                    rig.say("both seams must be visible to be centred: move nearer, or type search");
                    *machine_pose
                }
            },
            Jog::Take => {
                let view = self.look(rig)?;
                let [Some(first), Some(second)] = self.feet(&view) else {
                    rig.say("both seams must be visible to take a point");
                    return Ok(*machine_pose);
                };
                let here = Centred {
                    machine_pose: *machine_pose,
                    feet: [first, second],
                    ends: self.ends(&view),
                };
                let middle = (first.position + second.position) / 2.0;
                let behind = |last: &SeamPoint| (middle - last.middle()).dot(&view.pose.tangent) < SAME_PLACE;
                if points.last().is_some_and(behind) {
                    rig.say("this is not beyond the last point: type step to continue, or undo to remove the last point");
                    return Ok(*machine_pose);
                }
                take(rig, points, &here)?;
                let s_mm = points.last().map_or(0.0, |point| point.s_mm);
                rig.say(&format!("point {} at s {s_mm:.2} mm", points.len()));
                return Ok(*machine_pose);
            }
            Jog::Undo => {
                match points.pop() {
                    Some(_) => rig.untaught(points)?,
                    None => rig.say("no point is taken"),
                }
                rig.say(&format!("{} points", points.len()));
                return Ok(*machine_pose);
            }
            _ => *machine_pose,
        };
        self.tell(rig)?;
        Ok(there)
    }

    /// Tells the operator what the cameras see.
    fn tell<R: JogOperator>(&self, rig: &mut R) -> Result<(), R::Error> {
        let view = self.look(rig)?;
        let text = described(&view);
        rig.say(&text);
        Ok(())
    }
}

/// A line for the operator.
fn described(view: &View) -> String {
    let sides = (0..SIDES).map(|k| match view.sides[k] {
        None => format!("side {}: no seam", k + 1),
        Some(seen) => {
            let [u, v] = seen.offset_mm;
            let width = seen
                .width_mm
                .map_or_else(String::new, |w| format!(", gap {w:.3} mm"));
            format!(
                "side {}: U {u:+.3} V {v:+.3} mm{width}, quality {:.2}",
                k + 1,
                seen.quality
            )
        }
    });
    let p = view.pose.position;
    let sides: Vec<String> = sides.collect();
    format!("X{:.2} Y{:.2} Z{:.2}  {}", p.x, p.y, p.z, sides.join("; "))
}
