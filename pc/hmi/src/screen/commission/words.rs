//! What was found of a motor, in words, and what is to be done about it.

use crate::commissioning::{Known, Measured, Motor, Standing, Verdict};
use crate::screen::View;
use crate::texts::Text;
use commission::{Found, NoDesign, NotFound};
use eframe::egui::Color32;
use shared::io::MOTOR_AXIS;
use shared::kinematics::AXIS_UNIT;

/// The verdict on a motor, and what is to be done, each in its colour.
pub(super) fn verdict(view: &View, motor: &Motor) -> Vec<(String, Color32)> {
    let (words, theme) = (view.words, view.theme);
    let measured = match &motor.known {
        Known::Nothing => return vec![(words.say(Text::MeasureFirst).to_owned(), theme.faint)],
        Known::Unreadable(error) => {
            let again = words.say(Text::DoRepeat).to_owned();
            return vec![(error.clone(), theme.bad), (again, theme.doubt)];
        }
        Known::Measured(measured) => measured,
    };
    let mut told = match &measured.found {
        Err(error) => vec![
            (format!("{}: {error}", words.say(Text::MotorRefused)), theme.bad),
            (words.say(remedy(error)).to_owned(), theme.doubt),
        ],
        Ok(found) => vec![of_found(view, measured, found)],
    };
    if measured.found.is_ok() {
        told.push(match measured.standing {
            Standing::Written => (words.say(Text::DoCheck).to_owned(), theme.good),
            Standing::Current | Standing::Changed => (words.say(Text::DoWrite).to_owned(), theme.doubt),
        });
    }
    if measured.standing == Standing::Changed {
        told.push((words.say(Text::DoMeasureAgain).to_owned(), theme.doubt));
    }
    told
}

fn of_found(view: &View, measured: &Measured, found: &Found) -> (String, Color32) {
    let (words, theme) = (view.words, view.theme);
    match Verdict::of(&found.of_loop.before) {
        Verdict::Swings => (words.say(Text::VerdictSwings).to_owned(), theme.bad),
        Verdict::TooLittle => (words.say(Text::VerdictTooLittle).to_owned(), theme.doubt),
        Verdict::Enough => {
            let times = found.of_loop.motor.kp / measured.before.kp;
            let text = words.with(Text::VerdictEnough, &[&format!("{times:.2}")]);
            (text, theme.good)
        }
    }
}

/// What is to be done where nothing was found.
fn remedy(error: &NotFound) -> Text {
    use commission::NoResponse::{Empty, Incoherent};
    match error {
        NotFound::Response(Incoherent { .. }) | NotFound::Design(NoDesign::NoLag) => Text::DoFreeMotor,
        NotFound::Response(Empty) | NotFound::NoMotor => Text::DoRepeat,
        NotFound::Refused(_) => Text::DoMendIt,
        NotFound::Design(NoDesign::NoGain) => Text::DoLookAtPlot,
        NotFound::Design(NoDesign::Parameter(_)) => Text::DoCorrect,
    }
}

/// Drive, notches and friction.
pub(super) fn parts(view: &View, motor: &Motor, found: &Found) -> Vec<String> {
    let words = view.words;
    let (gain, delay) = (found.of_loop.lag.gain, found.of_loop.lag.delay_s * 1e3);
    let drive = words.with(Text::DriveFound, &[&format!("{gain:.4}"), &format!("{delay:.2}")]);
    let mut told = vec![drive];
    let held = found.of_loop.held.as_ref();
    told.extend(held.map(|held| words.with(Text::GainHeld, &[&held.to_string()])));
    for notch in &found.of_loop.motor.notches {
        let [hz, damping, depth] = [
            format!("{:.1}", notch.frequency_hz),
            format!("{}", notch.damping),
            format!("{:.2}", notch.depth),
        ];
        told.push(words.with(Text::NotchFound, &[&hz, &damping, &depth]));
    }
    if found.of_loop.motor.notches.is_empty() {
        told.push(words.say(Text::NoNotch).to_owned());
    }
    told.push(match &found.friction {
        Ok(friction) => {
            let unit = format!("{}/s", unit(motor.index));
            let coulomb = format!("{:.3}", friction.coulomb);
            let reversal = format!("{:.2}", friction.reversal_speed);
            words.with(Text::FrictionFound, &[&coulomb, &unit, &reversal, &unit])
        }
        Err(error) => words.with(Text::FrictionLeft, &[&error.to_string()]),
    });
    told
}

/// The unit of the way of a motor.
pub(super) fn unit(index: usize) -> &'static str {
    match AXIS_UNIT[MOTOR_AXIS[index]] {
        1.0 => "mm",
        _ => "°",
    }
}
