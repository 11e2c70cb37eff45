//! Expressions whose value is a number of moderate size.

use super::writer::Writer;

/// Functions of an angle or a number of any size, whose values are small.
const SMALL: [&str; 3] = ["SIN", "COS", "ABS"];
/// Functions that jump: of numbers that are no results of functions.
const JUMPS: [&str; 3] = ["FIX", "FUP", "ROUND"];
const COMPARISONS: [&str; 6] = ["EQ", "NE", "GT", "GE", "LT", "LE"];

/// Sets some parameters.
pub fn assignments(writer: &mut Writer) {
    for _ in 0..writer.random.between(1, 3) {
        let number = writer.random.between(40, 60);
        let name = match writer.random.below(4) {
            0 => format!("#<local{number}>"),
            1 => format!("#<_global{number}>"),
            _ => format!("#{number}"),
        };
        let value = expression(writer, 2);
        writer.line(&format!("{name} = {value}"));
        if !writer.parameters.contains(&name) {
            writer.parameters.push(name);
        }
    }
}

/// An expression in brackets, with so many more in it.
pub fn expression(writer: &mut Writer, depth: usize) -> String {
    let first = operand(writer, depth);
    let mut text = first;
    for _ in 0..writer.random.below(3) {
        let next = operand(writer, depth);
        let tail = match writer.random.below(9) {
            0..=2 => format!(" + {next}"),
            3..=4 => format!(" - {next}"),
            5..=6 => {
                let factor = writer.random.within(-3.0, 3.0);
                format!(" * {factor:.3}")
            }
            7 => format!(" / {}", writer.random.between(2, 9)),
            _ => format!(" MOD {}", writer.random.between(2, 9)),
        };
        text += &tail;
    }
    let text = format!("[{text}]");
    if writer.random.percent(20) {
        text.replace(' ', "")
    } else {
        text
    }
}

/// A condition in brackets.
pub fn condition(writer: &mut Writer) -> String {
    let side = |writer: &mut Writer| match writer.random.below(3) {
        0 => format!("{}", writer.random.between(0, 5)),
        1 => format!("[{} + 1]", writer.random.between(0, 5)),
        _ => format!("{}*2", writer.random.between(0, 3)),
    };
    let (a, b) = (side(writer), side(writer));
    let first = *writer.random.of(&COMPARISONS);
    if writer.random.percent(70) {
        return format!("[{a} {first} {b}]");
    }
    let (c, d) = (side(writer), side(writer));
    let second = *writer.random.of(&COMPARISONS);
    let both = *writer.random.of(&["AND", "OR", "XOR"]);
    format!("[{a} {first} {b} {both} {c} {second} {d}]")
}

fn operand(writer: &mut Writer, depth: usize) -> String {
    let number = writer.random.within(-20.0, 20.0);
    let positive = writer.random.within(0.1, 20.0);
    if depth == 0 {
        return writer.digits(number);
    }
    match writer.random.below(16) {
        0 if !writer.parameters.is_empty() => writer.random.of(&writer.parameters).clone(),
        1 => expression(writer, depth - 1),
        2 => {
            let inner = expression(writer, depth - 1);
            format!("{}{inner}", writer.random.of(&SMALL))
        }
        3 => format!("{}[{number:.2}]", writer.random.of(&JUMPS)),
        4 => format!("SQRT[{positive:.3}]"),
        5 => format!("LN[{positive:.3}]"),
        6 => format!("EXP[{:.3}]", number / 10.0),
        7 => format!("ATAN[{number:.3}]/[{positive:.3}]"),
        8 => format!("{}[{:.3}]", writer.random.of(&["ASIN", "ACOS"]), number / 20.0),
        9 => format!("TAN[{:.3}]", number * 3.0),
        10 => format!("{:.2} ** {}", positive / 4.0, writer.random.between(0, 3)),
        11 => format!("2 * 3 ** 2 / {}", writer.random.between(1, 9)),
        12 => format!("EXISTS[#<local{}>]", writer.random.between(40, 60)),
        13 => format!("-{}", expression(writer, 0)),
        _ => writer.digits(number),
    }
}
