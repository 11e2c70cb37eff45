//! Canned cycles.

use super::writer::Writer;

/// G73, G74 and G81 to G89, in G17 (in other planes `rs274` exchanges the axes of a tap), at some places, with what may stand beside them.
pub fn cycle(writer: &mut Writer) {
    let unit = if writer.inches { 1.0 / 25.4 } else { 1.0 };
    let (retract, depth) = (writer.random.within(1.0, 6.0), writer.random.within(-12.0, -1.0));
    writer.block(&format!("G90 G17 G0 Z{:.4}", 15.0 * unit));
    let code = *writer
        .random
        .of(&[73, 74, 81, 81, 81, 82, 83, 83, 84, 84, 85, 86, 88, 89]);
    match code {
        84 | 86 | 88 => writer.block("M3 S800"),
        74 => writer.block("M4 S800"),
        _ => {}
    }
    let level = *writer.random.of(&["G98", "G99", ""]);
    let mut words = format!("{level} G{code}");
    let increments = writer.random.percent(20);
    if increments {
        words = format!("G91 {words}");
    }
    let (z, r) = if increments {
        (depth - retract, retract - 15.0)
    } else {
        (depth, retract)
    };
    let [x, y] = [writer.length(30.0), writer.length(30.0)];
    let x = writer.value(x);
    words += &format!(" X{x} Y{y:.4} Z{:.4} R{:.4}", z * unit, r * unit);
    if matches!(code, 73 | 83) {
        words += &format!(" Q{:.4}", writer.random.within(0.7, 4.0) * unit);
    }
    let may_dwell = matches!(code, 74 | 84) && writer.random.percent(70);
    if may_dwell || matches!(code, 82 | 86 | 88 | 89) {
        words += &format!(" P{:.2}", writer.random.within(0.1, 1.0));
    }
    if writer.random.percent(25) {
        words += &format!(" L{}", writer.random.between(1, 3));
    }
    writer.block(words.trim_start());
    for _ in 0..writer.random.below(3) {
        let [x, y] = [writer.length(30.0), writer.length(30.0)];
        if writer.random.percent(70) {
            writer.block(&format!("X{x:.4} Y{y:.4}"));
        } else {
            writer.block(&format!("Y{y:.4}"));
        }
    }
    writer.block("G80 G90");
}
