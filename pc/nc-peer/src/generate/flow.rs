//! Subroutines, loops and conditions.

use super::expression::{condition, expression};
use super::writer::{Loop, Writer};
use super::{motion, piece};

/// A loop, a condition or a call.
pub fn flow(writer: &mut Writer, depth: usize) {
    match writer.random.below(7) {
        0 | 1 => branches(writer, depth),
        2..=4 => repeated(writer, depth),
        5 if !writer.numbered.is_empty() => {
            let number = *writer.random.of(&writer.numbered);
            let times = writer.random.between(1, 3);
            writer.block(&format!("M98 P{number} L{times}"));
        }
        _ => call(writer),
    }
}

/// A loop.
fn repeated(writer: &mut Writer, depth: usize) {
    let any = *writer
        .random
        .of(&[Loop::While, Loop::While, Loop::Do, Loop::Repeat]);
    match writer.jumps_in.unwrap_or(any) {
        Loop::While => counted(writer, depth, false),
        Loop::Do => counted(writer, depth, true),
        Loop::Repeat => {
            let (label, times) = (writer.label(), writer.random.below(4));
            writer.line(&format!("o{label} repeat [{times}]"));
            body(writer, depth);
            writer.line(&format!("o{label} endrepeat"));
        }
    }
}

/// A subroutine with arguments, which may give back a value. It ends with absolute coordinates in mm.
pub fn subroutine(writer: &mut Writer) {
    let number = writer.label();
    let label = if writer.random.percent(50) {
        format!("<Sub{number}>")
    } else {
        number.to_string()
    };
    let arguments = writer.random.below(4);
    writer.line(&format!("o{label} sub"));
    // What is set before is not known in it, and what is set in it not after.
    let known = std::mem::take(&mut writer.parameters);
    writer.parameters = (1..=arguments).map(|index| format!("#{index}")).collect();
    for _ in 0..writer.random.between(1, 3) {
        simple(writer);
    }
    if writer.random.percent(30) {
        let (number, condition) = (writer.label(), condition(writer));
        writer.line(&format!("o{number} if {condition}"));
        writer.line(&format!("  o{label} return [3]"));
        writer.line(&format!("o{number} endif"));
        writer.block("G1 X5 Y5");
    }
    let value = match writer.random.below(3) {
        0 => format!(" {}", expression(writer, 1)),
        _ => String::new(),
    };
    writer.line(&format!("o{label} endsub{value}"));
    writer.parameters = known;
    writer.subroutines.push((label, arguments));
}

/// A subroutine for M98; it stands behind the end of the program.
pub fn numbered_subroutine(writer: &mut Writer, number: usize) {
    writer.line(&format!("o{number}"));
    writer.parameters.clear();
    simple(writer);
    writer.line("M99");
}

fn simple(writer: &mut Writer) {
    if writer.random.percent(60) {
        motion::straight(writer);
    } else {
        motion::arc(writer);
    }
}

fn call(writer: &mut Writer) {
    if writer.subroutines.is_empty() {
        motion::straight(writer);
        return;
    }
    let (label, arguments) = writer.random.of(&writer.subroutines).clone();
    let arguments: Vec<String> = (0..arguments).map(|_| expression(writer, 1)).collect();
    writer.line(&format!("o{label} call {}", arguments.join(" ")));
    if writer.random.percent(30) {
        writer.block("G1 X[#<_value>+3]");
    }
}

fn branches(writer: &mut Writer, depth: usize) {
    let (label, first) = (writer.label(), condition(writer));
    writer.line(&format!("o{label} if {first}"));
    body(writer, depth);
    if writer.random.percent(30) {
        let second = condition(writer);
        writer.line(&format!("o{label} elseif {second}"));
        body(writer, depth);
    }
    if writer.random.percent(50) {
        writer.line(&format!("o{label} else"));
        body(writer, depth);
    }
    writer.line(&format!("o{label} endif"));
}

/// While or do, with a counter.
fn counted(writer: &mut Writer, depth: usize, until: bool) {
    let (label, times) = (writer.label(), writer.random.between(1, 3));
    let counter = format!("#<counter{label}>");
    writer.line(&format!("{counter} = 0"));
    if until {
        writer.line(&format!("o{label} do"));
    } else {
        writer.line(&format!("O{label} while [{counter} LT {times}]"));
    }
    body(writer, depth);
    writer.block(&format!("G1 X[{counter}*5] Y{times}"));
    writer.line(&format!("{counter} = [{counter} + 1]"));
    if writer.jumps_in.is_some() && writer.random.percent(30) {
        let (inner, word) = (writer.label(), *writer.random.of(&["break", "continue"]));
        writer.line(&format!("o{inner} if [{counter} EQ 2]"));
        writer.line(&format!("o{label} {word}"));
        writer.line(&format!("o{inner} endif"));
    }
    if until {
        writer.line(&format!("o{label} while [{counter} LT {times}]"));
    } else {
        writer.line(&format!("o{label} endwhile"));
    }
}

/// Blocks that may be run any number of times, or never: what they set is not known after them.
fn body(writer: &mut Writer, depth: usize) {
    let (known, inches) = (writer.parameters.clone(), writer.inches);
    for _ in 0..writer.random.between(1, 2) {
        piece(writer, depth + 1);
    }
    writer.parameters = known;
    if writer.inches != inches {
        writer.inches = inches;
        writer.block(if inches { "G20" } else { "G21" });
    }
}
