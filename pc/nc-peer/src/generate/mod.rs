//! Random programs of nearly everything that both interpreters know, lathe and threading aside. Most are right.

mod compensation;
mod cycles;
mod expression;
mod flow;
mod modes;
mod motion;
mod writer;
mod wrong;

use crate::random::Random;
use writer::Writer;

/// The program of a case of a seed.
pub fn program(seed: u64, case: u64) -> String {
    let mut writer = Writer::new(Random::new(seed, case));
    if writer.random.percent(20) {
        writer.line("%");
    }
    writer.block("G21 G17 G90 G94 G40 G49 G80 G54");
    for _ in 0..writer.random.below(3) {
        flow::subroutine(&mut writer);
    }
    if writer.random.percent(25) {
        let number = 1000 + writer.label();
        writer.numbered.push(number);
    }
    writer.block("G0 X0 Y0 Z20 A0 B0 C0");
    writer.block("F600 S1000");
    if writer.random.percent(20) {
        // Many a contour is not possible for its tool, and ends the program.
        compensated(&mut writer);
    } else {
        for _ in 0..writer.random.between(3, 12) {
            piece(&mut writer, 0);
        }
    }
    let percent = writer.lines.first().is_some_and(|line| line == "%");
    let end = *writer.random.of(&["M2", "M2", "M30"]);
    writer.line(end);
    for number in writer.numbered.clone() {
        flow::numbered_subroutine(&mut writer, number);
    }
    if percent {
        writer.line("%");
    }
    writer.lines.join("\n") + "\n"
}

/// Contours with cutter compensation, after what changes where they are.
fn compensated(writer: &mut Writer) {
    for _ in 0..writer.random.below(3) {
        match writer.random.below(4) {
            0 => modes::units(writer),
            1 => modes::tool(writer),
            2 => modes::diameter(writer),
            _ => modes::offset(writer),
        }
    }
    for _ in 0..writer.random.between(1, 2) {
        compensation::contour(writer);
    }
}

/// Some blocks; so many loops and conditions are around them.
fn piece(writer: &mut Writer, depth: usize) {
    if writer.random.percent(1) {
        wrong::block(writer);
    }
    match writer.random.below(25) {
        0..=5 => motion::straight(writer),
        6..=9 => motion::arc(writer),
        10 => motion::inverse_time(writer),
        11 => motion::of_the_axes(writer),
        12 | 13 => modes::offset(writer),
        14 => modes::units(writer),
        15 => modes::tool(writer),
        16 | 17 => modes::output(writer),
        18 => modes::control(writer),
        19 => cycles::cycle(writer),
        20 => expression::assignments(writer),
        21 => motion::probe(writer),
        _ if depth < 2 => flow::flow(writer, depth),
        _ => motion::straight(writer),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn programs_are_those_of_their_case() {
        assert_eq!(program(1, 2), program(1, 2));
        assert_ne!(program(1, 2), program(1, 3));
        assert_ne!(program(1, 2), program(2, 2));
    }
}
