//! Contours with cutter compensation: a way to them, lines, arcs and helices with corners of all kinds, and a way off.

use super::writer::{Writer, XYZ};
use std::f64::consts::TAU;

/// The plane with the indices of its axes and of the one that arcs go about.
const PLANES: [(&str, [usize; 3]); 4] = [
    ("G17", [0, 1, 2]),
    ("G17", [0, 1, 2]),
    ("G17", [0, 1, 2]),
    ("G18", [2, 0, 1]),
];

/// Where a contour is, in the plane, in the unit of the program.
struct Contour {
    axes: [usize; 3],
    at: [f64; 2],
    /// Its direction \[rad\].
    heading: f64,
    increments: bool,
}

/// One contour. Most are possible for their tool.
pub fn contour(writer: &mut Writer) {
    writer.block("G90 G49 G94 F500");
    let (plane, axes) = *writer.random.of(&PLANES);
    writer.block(plane);
    let start: [f64; 3] = std::array::from_fn(|_| (writer.length(40.0) * 1e3).round() / 1e3);
    let words = XYZ
        .iter()
        .zip(start)
        .map(|(letter, value)| format!("{letter}{value:.3}"));
    let words: Vec<String> = words.collect();
    writer.block(&format!("G0 {}", words.join(" ")));
    let mut contour = Contour {
        axes,
        at: [start[axes[0]], start[axes[1]]],
        heading: writer.random.within(0.0, TAU),
        increments: false,
    };
    let side = *writer.random.of(&["G41", "G42"]);
    let unit = if writer.inches { 25.4 } else { 1.0 };
    let switch = match writer.random.below(4) {
        0 => format!("{side} D{}", writer.random.between(1, 40)),
        1 => side.to_owned(),
        _ => {
            let diameter = writer.random.within(-3.0, 9.0) / unit;
            format!("{side}.1 D{}", writer.value(diameter))
        }
    };
    if writer.random.percent(50) {
        writer.block(&switch);
        enter(writer, &mut contour, "");
    } else {
        enter(writer, &mut contour, &switch);
    }
    for _ in 0..writer.random.between(1, 8) {
        between(writer, &mut contour);
        if writer.random.percent(60) {
            line(writer, &mut contour);
        } else {
            arc(writer, &mut contour);
        }
    }
    if contour.increments {
        writer.block("G90");
    }
    leave(writer, &mut contour);
    if plane != "G17" {
        writer.block("G17");
    }
}

/// The first motion, by a line or an arc.
fn enter(writer: &mut Writer, contour: &mut Contour, switch: &str) {
    let length = writer.length(14.0).abs() + writer.length(6.0).abs();
    if writer.random.percent(20) {
        let radius = length + writer.length(5.0).abs();
        let words = turn(writer, contour, radius, 1.2);
        writer.block(format!("{switch} {words}").trim_start());
        return;
    }
    let words = ahead(writer, contour, length);
    let code = *writer.random.of(&["G0", "G1", "G1"]);
    writer.block(format!("{switch} {code} {words}").trim_start());
}

/// What may stand between two motions.
fn between(writer: &mut Writer, contour: &mut Contour) {
    // A corner: most to either side, some back, some hardly any.
    contour.heading += match writer.random.below(8) {
        0 | 1 => 0.0,
        2 => writer.random.within(-0.08, 0.08),
        3 => writer.random.within(-3.2, 3.2),
        4 => *writer.random.of(&[TAU / 4.0, -TAU / 4.0]),
        _ => writer.random.within(-1.7, 1.7),
    };
    let height = writer.length(5.0);
    match writer.random.below(16) {
        0 => {
            let letter = XYZ[contour.axes[2]];
            let code = *writer.random.of(&["G0", "G1"]);
            writer.block(&format!("{code} {letter}{height:.3}"));
        }
        1 => {
            let feed = writer.random.within(100.0, 900.0);
            writer.block(&format!("F{feed:.2}"));
        }
        2 => writer.block("G4 P0.5"),
        3 => {
            let code = *writer.random.of(&["M7", "M9", "S700 M3", "M5"]);
            writer.block(code);
        }
        4 => {
            contour.increments = !contour.increments;
            writer.block(if contour.increments { "G91" } else { "G90" });
        }
        5 => writer.line("(a remark)"),
        _ => {}
    }
}

fn line(writer: &mut Writer, contour: &mut Contour) {
    let length = writer.length(20.0).abs();
    let words = ahead(writer, contour, length);
    let code = *writer.random.of(&["G0", "G1", "G1", "G1", "G1"]);
    writer.block(&format!("{code} {words}"));
}

/// Words of a line in the direction of the contour, at times with the third axis or one that turns.
fn ahead(writer: &mut Writer, contour: &mut Contour, length: f64) -> String {
    let (sin, cos) = contour.heading.sin_cos();
    let to = [contour.at[0] + length * cos, contour.at[1] + length * sin];
    let mut words = ends(contour, to);
    if writer.random.percent(10) {
        words += &format!(" {}{:.3}", XYZ[contour.axes[2]], writer.length(4.0));
    }
    if writer.random.percent(5) {
        words += &format!(" C{:.2}", writer.random.within(-90.0, 90.0));
    }
    words
}

/// Words of both axes of the plane to a place, where the contour is then but for their decimals.
fn ends(contour: &mut Contour, to: [f64; 2]) -> String {
    let mut words = Vec::new();
    for (index, value) in to.into_iter().enumerate() {
        let from = if contour.increments {
            contour.at[index]
        } else {
            0.0
        };
        let written = ((value - from) * 1e6).round() / 1e6;
        words.push(format!("{}{written:.6}", XYZ[contour.axes[index]]));
        contour.at[index] = from + written;
    }
    words.join(" ")
}

fn arc(writer: &mut Writer, contour: &mut Contour) {
    let radius = writer.length(9.0).abs() + writer.length(3.0).abs();
    let most = if writer.random.percent(20) { 6.2 } else { 3.0 };
    let mut words = turn(writer, contour, radius, most);
    if writer.random.percent(15) {
        words += &format!(" {}{:.3}", XYZ[contour.axes[2]], writer.length(4.0));
    }
    writer.block(&words);
}

/// Words of an arc that begins in the direction of the contour.
fn turn(writer: &mut Writer, contour: &mut Contour, radius: f64, most: f64) -> String {
    let sense = *writer.random.of(&[1.0, -1.0]);
    let angle = writer.random.within(0.05, most);
    let from = contour.at;
    let out = contour.heading - sense * TAU / 4.0;
    let centre = [from[0] - radius * out.cos(), from[1] - radius * out.sin()];
    let end = out + sense * angle;
    let to = [centre[0] + radius * end.cos(), centre[1] + radius * end.sin()];
    let code = if sense > 0.0 { "G3" } else { "G2" };
    contour.heading += sense * angle;
    if writer.random.percent(25) {
        let signed = if angle > TAU / 2.0 { -radius } else { radius };
        return format!("{code} {} R{signed:.6}", ends(contour, to));
    }
    if writer.random.percent(6) {
        contour.heading -= sense * angle;
        let [u, v] = [centre[0] - from[0], centre[1] - from[1]];
        return format!(
            "{code} {}{u:.6} {}{v:.6}",
            centre_letter(contour, 0),
            centre_letter(contour, 1)
        );
    }
    let [u, v] = [centre[0] - from[0], centre[1] - from[1]];
    let ends = ends(contour, to);
    format!(
        "{code} {ends} {}{u:.6} {}{v:.6}",
        centre_letter(contour, 0),
        centre_letter(contour, 1)
    )
}

fn centre_letter(contour: &Contour, index: usize) -> char {
    ['I', 'J', 'K'][contour.axes[index]]
}

/// G40 and a line, in one block or two.
fn leave(writer: &mut Writer, contour: &mut Contour) {
    let length = writer.length(15.0).abs();
    contour.heading += writer.random.within(-2.0, 2.0);
    let words = ahead(writer, contour, length);
    let code = *writer.random.of(&["G0", "G1"]);
    match writer.random.below(4) {
        0 | 1 => writer.block(&format!("G40 {code} {words}")),
        2 => {
            writer.block("G40");
            writer.block(&format!("{code} {words}"));
        }
        _ => {
            writer.block("G40");
            let height = writer.length(9.0);
            writer.block(&format!("G0 {}{height:.3}", XYZ[contour.axes[2]]));
            writer.block(&format!("{code} {words}"));
        }
    }
}
