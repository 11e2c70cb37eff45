//! Whole programs, as people and CAM systems write them for Siemens controllers.

use crate::{Motion, Options, Program, explain, interpret};

/// X Y of every place that a feed goes down or along to, and the lowest Z.
fn fed(program: &Program) -> (Vec<[f64; 2]>, f64) {
    let (mut at, mut places, mut lowest) = ([0.0; 3], Vec::new(), f64::INFINITY);
    for path in &program.paths {
        for target in &path.targets {
            for (axis, at) in at.iter_mut().enumerate() {
                *at = target.words.axes[axis].unwrap_or(*at);
            }
            if path.motion == Motion::Feed {
                places.push([at[0], at[1]].map(|value| (value * 1e3).round() / 1e3 + 0.0));
                lowest = lowest.min(at[2]);
            }
        }
    }
    places.dedup();
    (places, lowest)
}

fn read(text: &str) -> Program {
    interpret(text, Options::default()).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn an_archive_with_a_contour_at_two_places() {
    let text = "%_N_FRAME_MPF
;$PATH=/_N_WKS_DIR/_N_FRAME_WPD
N10 G17 G90 G71 G94 G40 G64
N20 MSG(\"FRAME\")
N30 T=\"MILL_D12\" D1
N40 M6
N50 G54 S3000 M3
N60 G0 X0 Y0 Z30
N70 TRANS X100 Y50
N80 RIM(40,20,4)
N90 AROT RPL=90
N100 RIM(10,6,2)
N110 TRANS
N120 SUPA G0 Z300 D0
N130 M30
%_N_RIM_SPF
;$PATH=/_N_SPF_DIR
PROC RIM(REAL LONG_SIDE, REAL SHORT_SIDE, REAL DEPTH)
N10 DEF REAL CORNER
N20 CORNER=SHORT_SIDE/2
N30 G0 X=-LONG_SIDE/2 Y=-CORNER Z2
N40 G1 Z=-DEPTH F200
N50 X=LONG_SIDE/2 F800
N60 G3 Y=CORNER AR=180
N70 G1 X=-LONG_SIDE/2
N80 G0 Z30
N90 RET
";
    let (places, lowest) = fed(&read(text));
    let first = [[80.0, 40.0], [120.0, 40.0], [120.0, 60.0], [80.0, 60.0]];
    let second = [[103.0, 45.0], [103.0, 55.0], [97.0, 55.0], [97.0, 45.0]];
    assert_eq!(places, [first, second].concat());
    assert_eq!(lowest, -4.0);
}

#[test]
fn rows_of_holes_with_loops_and_a_pattern_about_a_pole() {
    let text = "; holes
DEF INT ROW, NO
DEF REAL PITCH=20
G17 G90 G54
T1 D1
M6
S1500 M3 F180
G0 X0 Y0 Z30
FOR ROW=0 TO 1
  FOR NO=0 TO 2
    IF (ROW==1) AND (NO==1) GOTOF SKIPPED
    G0 X=NO*PITCH Y=ROW*PITCH
    CYCLE82(10,0,2,-8,,0.3)
    SKIPPED: STOPRE
  ENDFOR
ENDFOR
G111 X100 Y0
MCALL CYCLE83(10,0,2,-20,,-5,,0,0,0,1,1)
G0 RP=10 AP=0
AP=90
MCALL
G0 Z100 M5
M30
";
    let (places, lowest) = fed(&read(text));
    let holes = [[0, 0], [20, 0], [40, 0], [0, 20], [40, 20], [110, 0], [100, 10]];
    assert_eq!(places, holes.map(|place| place.map(f64::from)));
    assert_eq!(lowest, -20.0);
    let mut told = Vec::new();
    explain(text, Options::default(), |line| told.push(line)).unwrap();
    let facts = |line: u32| {
        told.iter()
            .find(|told| told.line == line)
            .unwrap()
            .facts
            .join("; ")
    };
    assert_eq!(facts(18), "drills a hole after every motion (MCALL)");
    assert_eq!(facts(21), "drills no more holes after motions");
}
