//! Motions: straight ones, arcs and helices, with inverse time, of the axes.

use super::expression::expression;
use super::writer::{Writer, XYZ};
use std::f64::consts::TAU;

/// Where parameters of the peer's say that the tip is.
const HERE: [[&str; 2]; 3] = [["#<_x>", "#5420"], ["#<_y>", "#5421"], ["#<_z>", "#5422"]];

/// G0 and G1, absolute or in increments.
pub fn straight(writer: &mut Writer) {
    let increments = writer.random.percent(25);
    if increments {
        writer.block("G91");
    }
    let rapid = writer.random.percent(35);
    for count in 0..writer.random.between(1, 4) {
        let mut words = axes(writer, increments);
        if !rapid && writer.random.percent(30) {
            let feed = writer.random.within(50.0, 3000.0);
            words.push(format!("F{}", writer.value(feed)));
        }
        if count == 0 || writer.random.percent(30) {
            let code = *writer
                .random
                .of(if rapid { &["G0", "G00"] } else { &["G1", "G01"] });
            let at = if writer.random.percent(80) { 0 } else { words.len() };
            words.insert(at, code.to_owned());
        }
        writer.block(&words.join(" "));
    }
    if increments {
        writer.block("G90");
    }
}

/// One or more axis words.
fn axes(writer: &mut Writer, increments: bool) -> Vec<String> {
    let mut words = Vec::new();
    let first = writer.random.below(3);
    for (axis, letter) in XYZ.into_iter().enumerate() {
        if axis != first && writer.random.percent(50) {
            continue;
        }
        let value = if writer.random.percent(20) {
            expression(writer, 2)
        } else if !increments && writer.random.percent(8) {
            let here = *writer.random.of(&HERE[axis]);
            format!("[{here} + {}]", writer.random.between(1, 9))
        } else {
            let length = writer.length(if increments { 10.0 } else { 60.0 });
            writer.value(length)
        };
        words.push(format!("{letter}{}", value.replace(' ', "")));
    }
    if writer.random.percent(12) {
        let letter = *writer.random.of(&['A', 'B', 'C']);
        let angle = writer.random.within(-170.0, 170.0);
        words.push(format!("{letter}{}", writer.value(angle)));
    }
    words
}

/// An arc or helix in one of the planes.
pub fn arc(writer: &mut Writer) {
    // First and second axis of the plane, and their words of the centre.
    let planes = [("G17", [0, 1, 2]), ("G18", [2, 0, 1]), ("G19", [1, 2, 0])];
    let (plane, [u, v, w]) = if writer.random.percent(60) {
        planes[0]
    } else {
        *writer.random.of(&planes)
    };
    writer.block(plane);
    let from: [f64; 3] = std::array::from_fn(|_| (writer.length(40.0) * 1e4).round() / 1e4);
    let words = XYZ
        .iter()
        .zip(from)
        .map(|(letter, value)| format!("{letter}{value:.4}"));
    let words: Vec<String> = words.collect();
    writer.block(&format!("G90 G1 {}", words.join(" ")));

    let radius = writer.length(15.0).abs() + 0.5;
    let start = writer.random.within(0.0, TAU);
    let angle = writer.random.within(0.1, 6.1);
    let counterclockwise = writer.random.percent(50);
    let end = start + if counterclockwise { angle } else { -angle };
    let code = if counterclockwise { "G3" } else { "G2" };
    let centre = [from[u] - radius * start.cos(), from[v] - radius * start.sin()];
    let to = [centre[0] + radius * end.cos(), centre[1] + radius * end.sin()];
    let increments = writer.random.percent(30);
    let mut words = vec![code.to_owned()];
    let full = writer.random.percent(15);
    let by_radius = !full && writer.random.percent(35);
    if !full {
        for (index, axis) in [u, v].into_iter().enumerate() {
            let value = to[index] - if increments { from[axis] } else { 0.0 };
            words.push(format!("{}{}", XYZ[axis], writer.value(value)));
        }
    }
    if writer.random.percent(40) {
        let height = writer.length(10.0);
        let value = if increments { height } else { from[w] + height };
        words.push(format!("{}{}", XYZ[w], writer.value(value)));
    }
    let absolute_centre = !by_radius && writer.random.percent(20);
    if by_radius {
        let signed = if angle > TAU / 2.0 { -radius } else { radius };
        words.push(format!("R{signed:.6}"));
    } else {
        for (index, axis) in [u, v].into_iter().enumerate() {
            let value = centre[index] - if absolute_centre { 0.0 } else { from[axis] };
            words.push(format!("{}{}", ['I', 'J', 'K'][axis], writer.value(value)));
        }
        if writer.random.percent(20) {
            words.push(format!("P{}", writer.random.between(1, 4)));
        }
    }
    let [distance, centre_mode] = [
        if increments { "G91" } else { "G90" },
        if absolute_centre { "G90.1" } else { "G91.1" },
    ];
    writer.block(&format!("{distance} {centre_mode}"));
    if !by_radius && writer.random.percent(10) && angle < 3.0 {
        words.push("F900".into());
    }
    writer.block(&words.join(" "));
    writer.block("G90 G91.1");
    if plane != "G17" {
        writer.block("G17");
    }
}

/// G93 with lines and an arc.
pub fn inverse_time(writer: &mut Writer) {
    writer.block("G93");
    for _ in 0..writer.random.between(1, 3) {
        let mut words = axes(writer, false);
        let rate = writer.random.within(0.5, 60.0);
        words.push(format!("F{}", writer.value(rate)));
        writer.block(&format!("G1 {}", words.join(" ")));
    }
    if writer.random.percent(40) {
        let radius = writer.length(10.0).abs() + 1.0;
        writer.block(&format!("G91 G3 X{:.4} I{radius:.4} F5", 2.0 * radius));
        writer.block("G90");
    }
    writer.block("G94 F600");
}

/// G53, G28 or G30.
pub fn of_the_axes(writer: &mut Writer) {
    let length = writer.length(50.0);
    let letter = *writer.random.of(&XYZ);
    let word = format!("{letter}{}", writer.value(length));
    match writer.random.below(5) {
        0 if letter == 'Z' => writer.block(&format!("G28 Z{length:.3}")),
        0 => {
            // One of them alone is read in two ways in a rotated coordinate system, and refused by ours there.
            let other = writer.length(50.0);
            writer.block(&format!("G28 X{length:.3} Y{other:.3}"));
        }
        1 => writer.block("G30"),
        2 => writer.block(&format!("G53 G1 {word}")),
        _ => writer.block(&format!("G53 G0 {word}")),
    }
}

/// A probe, and a motion from what it has found. The stand-in for a machine in `rs274` touches at the end, as ours, and then goes
/// back by 0.254 mm, so that the motion says all of where it leads.
pub fn probe(writer: &mut Writer) {
    let code = *writer.random.of(&["G38.2", "G38.3", "G38.4", "G38.5"]);
    let letter = *writer.random.of(&XYZ);
    let (to, feed) = (writer.length(60.0), writer.random.between(50, 600));
    let to = writer.value(to);
    writer.block(&format!("{code} {letter}{to} F{feed}"));
    if writer.random.percent(30) {
        let (number, name) = (writer.random.below(3) + 5061, writer.label());
        writer.block(&format!("#<found{name}> = #{number}"));
        writer.block(&format!("G0 X#5061 Y[#5062 + 1] Z[#<found{name}> / 2]"));
    } else {
        let by = writer.random.between(1, 9);
        writer.block(&format!("G1 X[#5061 - {by}] Y#5062 Z[#5063 + {by}] F600"));
    }
}
