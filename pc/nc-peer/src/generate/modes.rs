//! What is between motions: coordinate systems, units, tools, outputs, path control.

use super::writer::Writer;

const SYSTEMS: [&str; 9] = [
    "G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3",
];

/// G10, G54 to G59.3, G52, G92.
pub fn offset(writer: &mut Writer) {
    let [x, y, z] = [writer.length(50.0), writer.length(50.0), writer.length(5.0)];
    match writer.random.below(12) {
        0..=2 => {
            let system = writer.random.between(1, 9);
            let rotation = match writer.random.below(3) {
                0 => format!(" R{:.4}", writer.random.within(-180.0, 180.0)),
                _ => String::new(),
            };
            let x = writer.value(x);
            writer.block(&format!("G10 L2 P{system} X{x} Y{y:.4} Z{z:.4}{rotation}"));
            if writer.random.percent(60) {
                writer.block(SYSTEMS[system - 1]);
            }
            if !rotation.is_empty() {
                say_place(writer);
            }
        }
        3 => {
            let system = writer.random.between(0, 9);
            writer.block(&format!("G10 L20 P{system} X{x:.4} Z{z:.4}"));
        }
        4 | 5 => {
            let system = *writer.random.of(&SYSTEMS);
            writer.block(system);
        }
        6 => writer.block(&format!("G92 X{x:.4} Y{y:.4}")),
        7 => writer.block(&format!("G92 Z{z:.4} A10")),
        8 => writer.block(&format!("G52 X{x:.4} Y{y:.4}")),
        9 => {
            let code = *writer.random.of(&["G92.1", "G92.2", "G92.3"]);
            writer.block(code);
        }
        10 => {
            writer.block("G10 L2 P0 R0");
            say_place(writer);
        }
        _ => writer.block("G54"),
    }
}

/// G20 or G21, with a feed. The length of a tool ends before: the machine of `rs274` does not change its unit with that of the
/// program, as that of LinuxCNC does.
pub fn units(writer: &mut Writer) {
    writer.block("G49");
    writer.inches = writer.random.percent(60);
    writer.block(if writer.inches { "G20" } else { "G21" });
    writer.block(if writer.inches { "F30" } else { "F700" });
}

/// T M6, G43, G43.1, G49.
pub fn tool(writer: &mut Writer) {
    let number = writer.random.between(1, 20);
    match writer.random.below(8) {
        0..=3 => {
            writer.block(&format!("T{number} M6"));
            say_place(writer);
            writer.block(&format!("G43 H{number}"));
        }
        4 => {
            writer.block(&format!("T{number}"));
            writer.block("M6");
            say_place(writer);
        }
        5 => {
            let length = writer.length(20.0).abs();
            writer.block(&format!("G43.1 Z{length:.4}"));
        }
        6 => {
            let length = writer.length(20.0).abs();
            let l = *writer.random.of(&[1, 1, 10, 11]);
            writer.block(&format!("G10 L{l} P{number} Z{length:.4}"));
            let code = *writer.random.of(&["G43", "G43", "G43.2"]);
            writer.block(&format!("{code} H{number}"));
        }
        _ => writer.block("G49"),
    }
    if writer.random.percent(50) {
        writer.block("G49");
    }
}

/// G10 L1 with a radius. Not of tool 1, of which `rs274` begins with the radius where the machine has no tool.
pub fn diameter(writer: &mut Writer) {
    let (number, radius) = (writer.random.between(2, 40), writer.length(4.0));
    writer.block(&format!("G10 L1 P{number} R{radius:.4}"));
}

/// X Y Z where the peer does not know where it is: after a change of tools it asks its machine, and that of the program
/// alone has left rotations of coordinate systems out; where one is rotated anew, it leaves G52 and G92 as they were turned.
fn say_place(writer: &mut Writer) {
    let [x, y, z] = [writer.length(50.0), writer.length(50.0), writer.length(20.0)];
    writer.block(&format!("G0 X{x:.4} Y{y:.4} Z{z:.4}"));
}

/// M62 to M68, spindle, coolant, dwell, pause.
pub fn output(writer: &mut Writer) {
    for _ in 0..writer.random.between(1, 4) {
        let channel = writer.random.below(3);
        let speed = writer.random.within(100.0, 5000.0);
        let power = writer.random.within(0.0, 500.0);
        match writer.random.below(16) {
            0..=2 => {
                let code = *writer.random.of(&["M62", "M63", "M64", "M65"]);
                writer.block(&format!("{code} P{channel}"));
            }
            3 | 4 => {
                let code = *writer.random.of(&["M67", "M68"]);
                let power = writer.value(power);
                writer.block(&format!("{code} E{} Q{power}", channel % 2));
            }
            5 | 6 => {
                let speed = writer.value(speed);
                writer.block(&format!("S{speed} M3"));
            }
            7 => writer.block("M4"),
            8 => writer.block("M5"),
            9 => writer.block(&format!("M5 S{speed:.1}")),
            10 => {
                let code = *writer.random.of(&["M7", "M8", "M9"]);
                writer.block(code);
            }
            11 | 12 => {
                let seconds = writer.random.within(0.0, 3.0);
                let seconds = writer.value(seconds);
                writer.block(&format!("G4 P{seconds}"));
            }
            13 => writer.block(&format!("S{speed:.1}")),
            14 => {
                let code = *writer.random.of(&["M0", "M1", "M60", "M48", "M49"]);
                writer.block(code);
            }
            _ => writer.line("(MSG, a sentence)"),
        }
    }
    // With M62, M63 and M67 a motion follows.
    let [x, y] = [writer.length(50.0), writer.length(50.0)];
    writer.block(&format!("G1 X{x:.4} Y{y:.4}"));
}

/// G61, G61.1, G64.
pub fn control(writer: &mut Writer) {
    let tolerance = writer.length(0.2).abs();
    match writer.random.below(5) {
        0 => writer.block("G61"),
        1 => writer.block("G61.1"),
        2 => writer.block("G64"),
        3 => writer.block(&format!("G64 P{tolerance:.4}")),
        _ => writer.block(&format!("G64 P{tolerance:.4} Q{:.4}", tolerance / 2.0)),
    }
}
