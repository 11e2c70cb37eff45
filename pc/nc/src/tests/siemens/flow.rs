//! Jumps, conditions and loops of Siemens programs.

use super::{wrong, xs};
use crate::tests::{Problem, problem, run};

#[test]
fn jumps_lead_to_labels_and_block_numbers() {
    assert_eq!(xs("GOTOF ONWARD\nG0 X1\nONWARD: G0 X2"), [2.0]);
    assert_eq!(
        xs("R1=0\nAGAIN: R1=R1+1\nG0 X=R1\nIF R1<3 GOTOB AGAIN\nX9"),
        [1.0, 2.0, 3.0, 9.0]
    );
    assert_eq!(
        xs("N10 R1=0\nN20 R1=R1+1\nN30 G0 X=R1\nN40 IF R1<>2 GOTOB N20\nN50 GOTOF N70\nN60 X7\nN70 X8"),
        [1.0, 2.0, 8.0]
    );
    // GOTO looks forward first, GOTOC goes on without a target.
    assert_eq!(
        xs("R1=1\nTWICE: G0 X=R1\nR1=R1+1\nIF R1>3 GOTOF DONE\nGOTO TWICE\nDONE: GOTOC NOWHERE\nX8"),
        [1.0, 2.0, 3.0, 8.0]
    );
    assert_eq!(
        xs(
            "R1=3\nCASE R1 OF 1 GOTOF ONE 3 GOTOF THREE DEFAULT GOTOF OTHER\nONE: G0 X1\nTHREE: G0 X3\nOTHER: G0 X4"
        ),
        [3.0, 4.0]
    );
    assert!(run("IF 1==1 GOTOF OUT\nG0 X1\nOUT: M2").unwrap().branches);
    // Nearest behind, nearest before.
    assert_eq!(
        xs("AA: G0 X1\nGOTOF AA\nG0 X2\nAA: G0 X3\nAA: G0 X4"),
        [1.0, 3.0, 4.0]
    );
    for body in [
        "GOTOF NOWHERE",
        "HERE: G0 X1\nGOTOF HERE",
        "GOTOB AFTER\nAFTER: G0 X1",
    ] {
        assert!(
            wrong(body).contains("not in this program, or not in the direction"),
            "{}",
            wrong(body)
        );
    }
    assert!(wrong("GOTOF").contains("a jump needs a label"));
    assert!(wrong("GOTOF \"NAME\"").contains("a jump needs a label"));
}

#[test]
fn jumps_leave_structures_but_enter_none() {
    assert_eq!(
        xs("R1=0\nLOOP\nR1=R1+1\nIF R1==2\nGOTOF OUT\nENDIF\nG0 X=R1\nENDLOOP\nOUT: X9"),
        [1.0, 9.0]
    );
    assert_eq!(
        xs("R1=0\nWHILE R1<9\nR1=R1+1\nIF R1<3 GOTOF NEXT\nG0 X=R1\nR1=9\nNEXT: R2=1\nENDWHILE"),
        [3.0]
    );
    assert!(wrong("GOTOF INSIDE\nLOOP\nINSIDE: G0 X1\nENDLOOP").contains("must not lead into a loop"));
}

#[test]
fn conditions_and_loops() {
    let choice = |r1: u32| {
        xs(&format!(
            "R1={r1}\nIF R1==1\nG0 X1\nELSE\nIF R1==2\nG0 X2\nELSE\nG0 X3\nENDIF\nENDIF\nX9"
        ))
    };
    assert_eq!(
        (choice(1), choice(2), choice(3)),
        (vec![1.0, 9.0], vec![2.0, 9.0], vec![3.0, 9.0])
    );
    assert_eq!(
        xs("DEF INT NO\nFOR NO=1 TO 3\nG0 X=NO\nENDFOR\nX=NO+10"),
        [1.0, 2.0, 3.0, 14.0]
    );
    assert_eq!(xs("FOR R5=3 TO 1\nwhat is this\nENDFOR\nG0 X=R5+1"), [4.0]);
    assert_eq!(xs("R1=0\nREPEAT\nR1=R1+1\nG0 X=R1\nUNTIL R1>=2"), [1.0, 2.0]);
    assert_eq!(
        xs("R1=5\nN10 WHILE (R1 > 3) AND (R1 < 9)\nR1=R1-1\nG0 X=R1\nN20 ENDWHILE ; done"),
        [4.0, 3.0]
    );
    assert_eq!(
        xs(
            "IF 0\nLOOP\nENDLOOP\nIF 1 GOTOF XX\nREPEAT XX P=2\nREPEAT\nUNTIL 1\nFOR R1=1 TO 2\nENDFOR\nELSE\nG0 X1\nENDIF"
        ),
        [1.0]
    );
}

#[test]
fn parts_are_run_again() {
    assert_eq!(
        xs("G91 G0\nSTEP: X1\nREPEATB STEP P=2\nX10"),
        [1.0, 2.0, 3.0, 13.0]
    );
    assert_eq!(
        xs("R1=0\nFROM: R1=R1+1\nG0 X=R1\nREPEAT FROM P2\nX9"),
        [1.0, 2.0, 3.0, 9.0]
    );
    assert_eq!(
        xs("GOTOF OVER\nFROM: G0 X1\nX2\nTO: X3\nX4\nOVER: REPEAT FROM TO\nX5"),
        [1.0, 2.0, 3.0, 5.0]
    );
    assert_eq!(
        xs("FROM: G0 X1\nENDLABEL: X2\nX3\nREPEAT FROM"),
        [1.0, 2.0, 3.0, 1.0, 2.0]
    );
    assert!(wrong("REPEAT NOWHERE P=2").contains("NOWHERE is not in this program"));
    assert!(wrong("FROM: G0 X1\nREPEAT FROM P=1.5").contains("is run 0 to 9999 times"));
}

#[test]
fn what_does_not_end_is_told() {
    assert!(matches!(
        problem("R1=0\nAGAIN: R1=R1+1\nGOTOB AGAIN\nM2").0,
        Problem::Endless(_)
    ));
    assert!(matches!(problem("GOTOS\nM2").0, Problem::Endless(_)));
    assert!(wrong("LOOP\nG0 X1\nENDLOOP").contains("the loop LOOP never ends"));
    assert!(wrong("R1=1\nREPEAT\nG0 X1\nUNTIL R1==2").contains("the loop REPEAT never ends"));
    for (body, text) in [
        ("IF 1==2\nG0 X1", "IF has no ENDIF"),
        ("ENDWHILE", "ENDWHILE has no WHILE"),
        ("LOOP\nENDIF", "ENDIF has no IF"),
        ("FOR X1=1 TO 2", "FOR needs a variable"),
        ("IF 1==1 G0 X1", "nothing else may stand"),
    ] {
        assert!(wrong(body).contains(text), "{}", wrong(body));
    }
    // Lines before the target of a jump are run once.
    let straight = "N1\n".repeat(1_000_001);
    assert!(
        run(&format!(
            "{straight}GOTOF ON\nON: R1=1\nBACK: R1=R1+1\nIF R1<5 GOTOB BACK\nM2"
        ))
        .is_ok()
    );
}
