//! Blocks in which the tip does not move, in runs.

use super::*;

const MODES: [&str; 5] = ["G64", "G64 P0.02", "G64 P0.02 Q0", "G61", "G61.1"];

fn fed(machine: &MachineFile, program: &str) -> (f64, f64) {
    let ran = ran(machine, program, 1.0);
    assert_eq!(ran.highest.above().count(), 0, "{program}\n{ran}");
    let feeds = ran.paths.iter().filter(|path| path.motion == Motion::Feed);
    feeds.fold((0.0, 0.0), |(length, time), path| {
        (length + path.length_mm, time + path.duration_s)
    })
}

/// They take no longer than the program without them but for what a rest takes.
#[test]
fn short_blocks_run_to_their_end() {
    for name in ["stir-gantry.toml", "dual-beam-gantry.toml"] {
        let machine = machine(name);
        let a = if name.starts_with("dual") { "A0 " } else { "" };
        for mode in MODES {
            let fed = |body: &str| {
                let begin = format!("{BEGIN}G0 X600 Y500 Z50 {a}B0 C0\nF600\n{mode}\nM67 E0 Q1");
                fed(&machine, &format!("{begin}\n{body}\nM2"))
            };
            for (body, without) in [
                (
                    "G1 X640\nX640.0004\nM67 E0 Q2\nX640.0007 Y500.0003\nX680",
                    "G1 X640\nX680",
                ),
                ("G1 X640\nM67 E0 Q3\nX640.0003\nM67 E0 Q2\nX640.0005", "G1 X640"),
                (
                    "G1 X640\nX640.0003\nG3 X740.0003 I50\nG1 Y500.0004\nG2 I-50\nG1 X740.0005",
                    "G1 X640\nG3 X740 I50\nG2 I-50",
                ),
                (
                    "G3 I50\nM67 E0 Q3\nG1 X600.0005\nM67 E0 Q2\nG2 I50",
                    "G3 I50\nG2 I50",
                ),
            ] {
                let (seen, wanted) = (fed(body), fed(without));
                assert!((seen.0 - wanted.0).abs() < 4e-3, "{mode} {body}: {} mm", seen.0);
                let more = seen.1 - wanted.1;
                assert!(more.abs() < 0.2, "{name} {mode} {body}: {more} s more");
            }
            assert!(fed("G1 X600.0002").1 < 0.2, "{name} {mode}");
        }
    }
}

/// A turn alone takes its length over F; blocks on both sides of it are as they would be by themselves.
#[test]
fn turns_alone_take_their_degrees_over_the_feed() {
    let machine = machine("ac-head.toml");
    for mode in MODES {
        for (body, seconds, rests) in [
            ("G1 A50", 4.0, 1.0),
            ("G1 A40 C40", 5.0, 1.0),
            ("G1 X320\nA30 C30\nX340", 2.0 + 36.0555 / 10.0 + 2.0, 3.0),
            ("G1 C100\nC200\nC250", 25.0, 3.0),
            ("G93 G1 A40 C40 F6", 10.0, 1.0),
            ("G1 X310\nC-300\nC0\nX320 A20", 62.0, 4.0),
        ] {
            let program = format!("{BEGIN}G0 X300 Y700 Z300 A10 C0\nF600\n{mode}\n{body}\nM2");
            let (_, time) = fed(&machine, &program);
            let more = time - seconds;
            assert!(
                (0.0..0.25 * rests).contains(&more),
                "{mode} {body}: {more} s more"
            );
        }
        // Faster than C can be: as fast as the attitude allows, of which the output filter must not be off.
        let program = format!("{BEGIN}G0 X300 Y700 Z300 A10 C0\nF60000\n{mode}\nG1 C300\nM2");
        let (_, time) = fed(&machine, &program);
        assert!(
            (300.0 / 180.0..300.0 / 90.0 + 0.3).contains(&time),
            "{mode}: {time} s"
        );
    }
}
