//! Macros of Fanuc programs, numbers of programs, and lines with several statements.

use super::dialects::{ends, wrong};
use super::*;

/// X of each motion.
fn xs(body: &str) -> Vec<f64> {
    ends(body).into_iter().map(|end| end[0]).collect()
}

#[test]
fn loops_and_jumps_of_macros_are_understood() {
    assert_eq!(
        xs("#1=0\nWHILE[#1LT3]DO1\n#1=#1+1\nG0X#1\nEND1\nX9\nM2"),
        [1.0, 2.0, 3.0, 9.0]
    );
    assert_eq!(
        xs(
            "#1=1\nWHILE [#1 LE 2] DO 1\n#2=1\nWHILE [#2 LE 2] DO2\nG0 X[#1*10+#2]\n#2=#2+1\nEND2\n#1=#1+1\nEND1 (done)\nM2"
        ),
        [11.0, 12.0, 21.0, 22.0]
    );
    assert_eq!(
        xs("#1=1\nN10 G0 X#1\n#1=#1+1\nIF[#1EQ3]GOTO20(out)\nGOTO10\nN20 X9\nM2"),
        [1.0, 2.0, 9.0]
    );
    assert_eq!(
        xs("#1=5\nIF [#1 GT 3] THEN #1=3\nIF [#1 GT 3] THEN #1=1/0 (not run)\nG0 X#1\nM2"),
        [3.0]
    );
    assert_eq!(xs("#1=2+3*4-[1+1]*2/4\nG0 X#1\n#2=-#1\nX#2\nM2"), [13.0, -13.0]);
    assert!(wrong("WHILE [1 EQ 1] DO4\nM2").contains("DO1, DO2 or DO3"));
    assert!(wrong("WHILE [1 EQ 1] DO\nM2").contains("DO1, DO2 or DO3"));
    assert!(wrong("#1=0\nWHILE [#1 LT 1] DO1\n#1=1\nEND2\nM2").contains("END2 has no DO2"));
    assert!(wrong("END1\nM2").contains("END1 has no DO1"));
    assert!(wrong("IF [1 EQ 1] THEN G0 X1\nM2").contains("THEN has a parameter"));
    assert!(wrong("#1=2*\nM2").contains("a value is missing"));
    assert!(wrong("GOTO 77\nM2").contains("N77 is not in this program"));
}

#[test]
fn statements_of_one_line_are_carried_out_one_after_the_other() {
    for (body, expected) in [
        // In the line of DO: in every pass, and not where the loop does not run.
        (
            "#1=0\nWHILE[#1LT3]DO1 #1=#1+1\nG0X#1\nEND1\nX9\nM2",
            vec![1.0, 2.0, 3.0, 9.0],
        ),
        ("#1=5\nWHILE[#1LT3]DO1 G0 X1\nX2\nEND1\nG0 X9\nM2", vec![9.0]),
        (
            "#1=5\nWHILE [ #1 GT 0 ] DO1 #1= #1 - 2 IF [ #1 LT 0 ] THEN #1= 0\nG0 X#1\nEND1\nM2",
            vec![3.0, 1.0, 0.0],
        ),
        // Before END, which also ends what is gone over.
        (
            "#1=0\nWHILE[#1LT2]DO1\n#1=#1+1\nG0X#1END1\nX9\nM2",
            vec![1.0, 2.0, 9.0],
        ),
        ("#1=5\nWHILE[#1LT2]DO1\n#1=#1+1\nG0X#1 END1\nG0X9\nM2", vec![9.0]),
        (
            "#1=5\nWHILE[#1LT2]DO1\nWH[#1LT9]DO2 G0X1\nX2 END2\nX3 END1\nG0X9\nM2",
            vec![9.0],
        ),
        ("#1=0\nWH[#1LT2]DO1\n#1=#1+1\nG0X#1\nEND1\nM2", vec![1.0, 2.0]),
        ("#1=4 IF [#1 EQ 4] GOTO 20\nG0X1\nN20 G0X2\nM2", vec![2.0]),
        ("#1=4 GOTO 20\nG0X1\nN20 G0X2\nM2", vec![2.0]),
    ] {
        assert_eq!(xs(body), expected, "{body}");
    }
    // Block delete leaves out the whole line.
    let text = "G0 X0\n/#1=4 GOTO 20\nX1\nN20 X2\nM2";
    let options = Options {
        block_delete: true,
        ..Options::default()
    };
    assert_eq!(interpret(text, options).unwrap().paths.len(), 3);
    // A second WHILE would begin where the line does.
    assert!(run("#1=0 WHILE[#1LT3]DO1\nEND1\nM2").is_err());
    assert!(wrong("WHILE[1EQ1]DO1 #1=#9\nG0 X1 Q5 END1\nM2").contains("Q belongs to no code of this block"));
    let error = run("G0 X1\nX2 Q5 END1\nM2").unwrap_err();
    assert_eq!(error.place.column, 4);
}

#[test]
fn words_stand_behind_the_number_of_a_program() {
    assert_eq!(
        ends(":1234 (NAME)\nM98 P20\nM30\n:20\nG0 X5\nM99"),
        ends("O1\nG0 X5\nM2")
    );
    for number in ["O8000", "N10 O8000", ":8000", ":O8000", "o8000"] {
        let own = if number.starts_with('N') { "" } else { " X3" };
        let body = format!("{number} (PART)\nG0 X5\nM2");
        assert_eq!(xs(&body), [5.0], "{number}");
        let body = format!("G0 X1\nM98 P8000 L2\nX9\nM2\n{number}{own}\nX4\nM99");
        let expected: &[f64] = if own.is_empty() {
            &[1.0, 4.0, 9.0]
        } else {
            &[1.0, 3.0, 4.0, 3.0, 4.0, 9.0]
        };
        assert_eq!(xs(&body), expected, "{number}");
    }
    assert_eq!(xs("O8000 #1=5\nG0 X#1\nM2"), [5.0]);
    let program = run("O8000 T4 M6\nG0 X1\nM2").unwrap();
    assert!(format!("{:?}", program.paths).contains("ChangeTool(4)"));
    for body in ["O100 -5", "O100 [5]", ":10 sub", "O100 Q5", "O100 TEXT"] {
        assert!(run(&format!("{body}\nM2")).is_err(), "{body}");
    }
}

#[test]
fn g65_gives_its_letters_to_a_macro() {
    let macro_of = |call: &str, body: &str| {
        xs(&format!(
            "#1=77\n#33=7\n{call}\nG0 X#1\nX#33\nM30\nO9010\n{body}\nM99"
        ))
    };
    assert_eq!(macro_of("G65 P9010 A1.5", "G0 X#1"), [1.5, 77.0, 7.0]);
    for (letter, number) in [
        ("A", 1),
        ("B", 2),
        ("C", 3),
        ("D", 7),
        ("E", 8),
        ("F", 9),
        ("H", 11),
        ("I", 4),
        ("J", 5),
        ("K", 6),
        ("M", 13),
        ("Q", 17),
        ("R", 18),
        ("S", 19),
        ("T", 20),
        ("U", 21),
        ("V", 22),
        ("W", 23),
        ("X", 24),
        ("Y", 25),
        ("Z", 26),
    ] {
        assert_eq!(
            macro_of(&format!("G65P9010{letter}3."), &format!("G0 X#{number}"))[0],
            3.0,
            "{letter}"
        );
    }
    // The macro has 33 of its own, and those of each pass are new.
    assert_eq!(
        macro_of("N5 G65 P9010 L2 A1.(two)B[1+1]", "#33=#1+#2\n#1=5\nG0 X#33\nX0"),
        [3.0, 0.0, 3.0, 0.0, 77.0, 7.0]
    );
    assert_eq!(macro_of("G65 P9010 L0 A1", "G0 X1"), [77.0, 7.0]);
    // Where a word is left out on controllers, nothing is made up.
    assert!(wrong("G65 P10 X1\nM30\nO10\nG0 X#24 Y#25\nM99").contains("#25 has no value here"));
    assert!(wrong("G65 P10\nM30\nO10\n#3=#4+1\nM99").contains("#4 has no value here"));
    for (call, why) in [
        ("G65 A1", "G65 needs P"),
        ("G65 P9 A1 A2", "A occurs twice"),
        ("G65 P9 G1", "G is no argument"),
        ("G65 P9 L1.5", "0 to 9999 times"),
        ("G90 G65 P9 A1", "G65 stands first in its block"),
        ("G65 P9 A", "A needs a number"),
        ("G65 P9", "there is no subroutine 9"),
        ("G66 P9 A1", "not called after motions"),
    ] {
        assert!(
            wrong(&format!("{call}\nM2")).contains(why),
            "{call}: {}",
            wrong(&format!("{call}\nM2"))
        );
    }
}

#[test]
fn what_has_no_value_equals_number_0() {
    let sets = |call: &str, test: &str| {
        xs(&format!(
            "G65 P10 {call}\nM30\nO10\nIF [{test}] GOTO 1\nG0 X5\nN1 M99"
        ))
        .is_empty()
    };
    assert!(sets("A1", "#2 EQ #0") && !sets("A1", "#1 EQ #0"));
    assert!(sets("A1", "#1NE#0") && !sets("A1", "#2 NE #0"));
    assert!(sets("A1", "[#1 EQ 1] AND [#3EQ#0]"));
    assert!(wrong("G65 P10 A0\nM30\nO10\nIF [#1 EQ #0] GOTO 1\nN1 M99").contains("#1 was set to 0"));
    // Elsewhere what is not set is 0 as well.
    assert_eq!(xs("IF [#5 EQ #0] GOTO 1\nG0 X5\nN1 G0 X6\nM2"), [6.0]);
    assert!(wrong("#100=0\nIF [#100 NE #0] GOTO 1\nN1 M2").contains("#100 was set to 0"));
    assert_eq!(xs("#1=2\nG0 X[#1 EQ #0+2]\nX[3*[#0 EQ 0]]\nM2"), [1.0, 3.0]);
}

#[test]
fn values_of_fanuc_controllers_are_not_made_up() {
    for number in [2005, 3001, 3000, 4111, 5001, 5044] {
        assert!(
            wrong(&format!("#1=#{number}\nM2")).contains("a value of the controller"),
            "{number}"
        );
    }
    assert_eq!(xs("#4001=3\nG0 X#4001\nX#5420\nX#100\nM2"), [3.0, 0.0]);
    assert!(wrong("IF [1 EQ 1] THEN #3000=12 (NO ARGUMENT)\nM2").contains("stops with the alarm 12"));
    assert!(run("IF [1 EQ 2] THEN #3000=12 (NO ARGUMENT)\nM2").is_ok());
    assert!(wrong("#3006=1\nM2").contains("write M0"));
}
