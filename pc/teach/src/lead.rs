//! Teaching places of the tip: the operator leads the machine by commands, one per line, and takes places down.

use crate::TipPoint;
use crate::spoken::Spoken;
use nalgebra::Vector3;

/// The commands.
pub const LEAD_WORDS: &str = "\
x y z DISTANCE     moves the tip along an axis of the work [mm]
up DISTANCE        moves the tip along the tool, away from the work [mm]
a b c ANGLE        turns a rotary axis, the tip stays [deg]
take               takes this place down
undo               takes the last place out again
look               tells where the tip is
done               ends";

/// A machine that an operator leads.
pub trait LedMachine {
    /// Why it cannot go on.
    type Error: std::fmt::Display;

    /// Where the tip is.
    fn tip(&self) -> TipPoint;

    /// Direction of the tool there, from the work to the machine.
    fn tool(&self) -> Vector3<f64>;

    /// Goes straight to `there`, slowly.
    fn go(&mut self, there: &TipPoint) -> Result<(), Self::Error>;

    /// The next line of the operator; `None` when there are no more.
    fn line(&mut self) -> Result<Option<String>, Self::Error>;

    /// Prints a message to the operator.
    fn say(&mut self, text: &str);

    /// These are the places now; they are on the disk afterwards.
    fn keep(&mut self, points: &[TipPoint]) -> Result<(), Self::Error>;

    /// Whether `error` means that the machine has not moved, and can be asked for something else.
    fn is_refusal(&self, error: &Self::Error) -> bool;
}

/// A command.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Lead {
    Axis(usize, f64),
    Up(f64),
    Turn(usize, f64),
    Take,
    Undo,
    Look,
    Done,
}

impl Lead {
    /// What `line` means; what is wrong with it otherwise.
    fn parse(line: &str) -> Result<Self, String> {
        let Some(spoken) = Spoken::of(line)? else {
            return Ok(Self::Look);
        };
        if let Some(axis) = spoken.place(&["x", "y", "z"]) {
            return Ok(Self::Axis(axis, spoken.mm()?));
        }
        if let Some(axis) = spoken.place(&["a", "b", "c"]) {
            return Ok(Self::Turn(axis, spoken.deg()?));
        }
        if spoken.word == "up" {
            return Ok(Self::Up(spoken.mm()?));
        }
        match spoken.alone()? {
            "take" => Ok(Self::Take),
            "undo" => Ok(Self::Undo),
            "look" => Ok(Self::Look),
            "done" => Ok(Self::Done),
            word => Err(format!("{word} is not a command here\n{LEAD_WORDS}")),
        }
    }
}

/// Lets the operator take down places behind `points`, until they are done or there are no more lines; all places.
///
/// # Errors
/// Those of the machine that are no refusals.
pub fn lead<M: LedMachine>(machine: &mut M, points: &[TipPoint]) -> Result<Vec<TipPoint>, M::Error> {
    let mut points = points.to_vec();
    let tell = |machine: &mut M| {
        let place = described(&machine.tip());
        machine.say(&place);
    };
    tell(machine);
    while let Some(line) = machine.line()? {
        let mut there = machine.tip();
        match Lead::parse(&line) {
            Err(wrong) => {
                machine.say(&wrong);
                continue;
            }
            Ok(Lead::Done) => break,
            Ok(Lead::Look) => {
                tell(machine);
                continue;
            }
            Ok(Lead::Take) => {
                if points.last().is_some_and(|last| last.is_near(&there)) {
                    machine.say("this place is taken already");
                    continue;
                }
                points.push(there);
                machine.keep(&points)?;
                machine.say(&format!("place {}: {}", points.len(), described(&there)));
                continue;
            }
            Ok(Lead::Undo) => {
                if points.pop().is_some() {
                    machine.keep(&points)?;
                }
                machine.say(&format!("{} places", points.len()));
                continue;
            }
            Ok(Lead::Axis(axis, by)) => there.position_mm[axis] += by,
            Ok(Lead::Turn(axis, by)) => there.angles_deg[axis] += by,
            Ok(Lead::Up(by)) => {
                let tool = machine.tool();
                for (place, way) in there.position_mm.iter_mut().zip(tool.iter()) {
                    *place += way * by;
                }
            }
        }
        match machine.go(&there) {
            Ok(()) => tell(machine),
            Err(error) if machine.is_refusal(&error) => machine.say(&error.to_string()),
            Err(error) => return Err(error),
        }
    }
    Ok(points)
}

/// A place for the operator.
fn described(tip: &TipPoint) -> String {
    let [x, y, z] = tip.position_mm;
    let [a, b, c] = tip.angles_deg;
    format!("X{x:.2} Y{y:.2} Z{z:.2} mm  A{a:.3} B{b:.3} C{c:.3} deg")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A machine that goes anywhere up to X 50.
    struct Led {
        lines: std::slice::Iter<'static, &'static str>,
        tip: TipPoint,
        kept: Vec<TipPoint>,
        told: Vec<String>,
    }

    impl LedMachine for Led {
        type Error = &'static str;

        fn tip(&self) -> TipPoint {
            self.tip
        }

        fn tool(&self) -> Vector3<f64> {
            Vector3::new(0.6, 0.0, 0.8)
        }

        fn go(&mut self, there: &TipPoint) -> Result<(), &'static str> {
            if there.position_mm[0] > 50.0 {
                return Err("out of reach");
            }
            self.tip = *there;
            Ok(())
        }

        fn line(&mut self) -> Result<Option<String>, &'static str> {
            Ok(self.lines.next().map(|line| (*line).to_owned()))
        }

        fn say(&mut self, text: &str) {
            self.told.push(text.to_owned());
        }

        fn keep(&mut self, points: &[TipPoint]) -> Result<(), &'static str> {
            self.kept = points.to_vec();
            Ok(())
        }

        fn is_refusal(&self, error: &&'static str) -> bool {
            *error == "out of reach"
        }
    }

    #[test]
    fn places_are_led_to_taken_and_taken_out_and_what_is_refused_does_not_end_it() {
        const LINES: [&str; 14] = [
            "x 10", "up 5", "take", "take", "c -15", "x 60", "y 7 8", "jump", "take", "y 2", "take", "undo",
            "done", "take",
        ];
        let mut led = Led {
            lines: LINES.iter(),
            tip: TipPoint {
                position_mm: [0.0; 3],
                angles_deg: [0.0; 3],
            },
            kept: Vec::new(),
            told: Vec::new(),
        };
        let points = lead(&mut led, &[]).unwrap();
        let first = TipPoint {
            position_mm: [13.0, 0.0, 4.0],
            angles_deg: [0.0; 3],
        };
        assert_eq!(points, [first]);
        assert_eq!(led.kept, points);
        assert_eq!(led.tip.position_mm, [13.0, 2.0, 4.0]);
        assert_eq!(led.tip.angles_deg, [0.0, 0.0, -15.0]);
        // The same place with another attitude is no second one.
        let told = |text: &str| led.told.iter().filter(|told| told.starts_with(text)).count();
        assert_eq!(
            (told("this place is taken already"), told("out of reach")),
            (2, 1)
        );
        assert_eq!(
            (told("8 is too much"), told("jump is not a command here")),
            (1, 1)
        );
        assert_eq!(led.lines.next(), Some(&"take"));
    }
}
