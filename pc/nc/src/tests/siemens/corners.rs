//! Corners with something in them, arcs by their tangent, lines by their angle, patterns of holes.

use super::{wrong, xs};
use crate::reading::read;
use crate::source::Source;
use crate::tests::{Options, run};
use crate::{ArcForm, FeedRate, Motion, Program, ProgramPath, Way};
use shared::geometry::Turn;

/// A motion in the plane: where it begins and ends, and centre and sense of an arc.
#[derive(Clone, Copy, Debug)]
struct Step {
    start: [f64; 2],
    end: [f64; 2],
    arc: Option<([f64; 2], f64)>,
    feed: f64,
}

impl Step {
    /// Direction at one of its ends.
    fn heading(&self, at: [f64; 2]) -> [f64; 2] {
        let along = match self.arc {
            None => [self.end[0] - self.start[0], self.end[1] - self.start[1]],
            Some((centre, sense)) => [-(at[1] - centre[1]) * sense, (at[0] - centre[0]) * sense],
        };
        along.map(|value| value / along[0].hypot(along[1]))
    }

    fn radius(&self) -> f64 {
        self.arc
            .map_or(f64::INFINITY, |(centre, _)| far(self.start, centre))
    }
}

fn far(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

fn program(body: &str) -> Program {
    run(&format!("F600\n{body}\nM2")).unwrap_or_else(|error| panic!("{body}: {error}"))
}

fn steps(body: &str) -> Vec<Step> {
    let path = program(body).paths.pop().unwrap();
    assert_eq!(path.motion, Motion::Feed);
    steps_of(&path)
}

/// Those of a path that begins at the origin.
fn steps_of(path: &ProgramPath) -> Vec<Step> {
    let mut start = [0.0, 0.0];
    let step = |target: &crate::Target| {
        let end = [0, 1].map(|axis| target.words.axes[axis].unwrap_or(start[axis]));
        let arc = match &target.way {
            Way::Line => None,
            Way::Arc(arc) => {
                let ArcForm::Centre(offset) = arc.form else {
                    panic!("{arc:?}")
                };
                let sense = if arc.turn == Turn::Clockwise { -1.0 } else { 1.0 };
                Some(([start[0] + offset[0], start[1] + offset[1]], sense))
            }
            way => panic!("{way:?}"),
        };
        let Some(FeedRate::PerMinute(feed)) = target.feed else {
            panic!("{target:?}")
        };
        let step = Step {
            start,
            end,
            arc,
            feed,
        };
        start = end;
        step
    };
    path.targets.iter().map(step).collect()
}

#[track_caller]
fn assert_ends(body: &str, ends: &[[f64; 2]]) {
    let found = steps(body);
    let places: Vec<_> = found.iter().map(|step| step.end).collect();
    let near = places.iter().zip(ends).all(|(a, b)| far(*a, *b) < 1e-9);
    assert!(near && places.len() == ends.len(), "{body}: {places:?}");
}

#[test]
fn corners_are_rounded_and_chamfered() {
    assert_ends("G1 X50 RND=5\nY50", &[[45.0, 0.0], [50.0, 5.0], [50.0, 50.0]]);
    let rounded = steps("G1 X50 RND=5\nY50")[1];
    assert_eq!(rounded.arc, Some(([45.0, 5.0], 1.0)));
    assert_eq!(steps("G1 X50 RND=5\nY-50")[1].arc, Some(([45.0, -5.0], -1.0)));
    let leg = 10.0 / 2_f64.sqrt();
    assert_ends(
        "G1 X50 CHF=10\nY50",
        &[[50.0 - leg, 0.0], [50.0, leg], [50.0, 50.0]],
    );
    assert_ends("G1 X50 CHR=5\nY50", &[[45.0, 0.0], [50.0, 5.0], [50.0, 50.0]]);
    // Steps go from the corner as it is programmed.
    assert_ends("G91 G1 X50 RND=5\nY50", &[[45.0, 0.0], [50.0, 5.0], [50.0, 50.0]]);
    assert_ends(
        "G20\nG1 X1 RND=0.1\nY1",
        &[[22.86, 0.0], [25.4, 2.54], [25.4, 25.4]],
    );
    // What is between the motions does not matter, nor does a loop.
    assert_ends(
        "G1 X50 RND=5\n; a comment\nR1=50\nM62 P1\nY=R1",
        &[[45.0, 0.0], [50.0, 5.0], [50.0, 50.0]],
    );
    // Where there is no corner, or no next motion, nothing is put in.
    assert_ends("G1 X50 RND=5\nX90", &[[50.0, 0.0], [90.0, 0.0]]);
    assert_ends("G1 X50 RND=5", &[[50.0, 0.0]]);
    assert_eq!(program("G1 X50 RND=5\nG0 Y50").paths[2].targets.len(), 1);
    let stops = program("G1 X50 RND=5\nG4 F1\nG1 Y50");
    assert_eq!(stops.paths[2].targets.len(), 1);
    assert!(stops.notices[0].text.contains("nothing is put into the corner"));
}

#[test]
fn roundings_hold_until_they_end_and_have_a_feed() {
    let square = "RNDM=2 FRCM=300\nG1 X20\nY20\nX0\nRNDM=0\nY0";
    assert_ends(
        square,
        &[
            [18.0, 0.0],
            [20.0, 2.0],
            [20.0, 18.0],
            [18.0, 20.0],
            [2.0, 20.0],
            [0.0, 18.0],
            [0.0, 0.0],
        ],
    );
    let feeds: Vec<_> = steps(square).iter().map(|step| step.feed / 60.0).collect();
    assert_eq!(feeds, [10.0, 5.0, 10.0, 5.0, 10.0, 5.0, 10.0]);
    assert_eq!(steps("G1 X50 RND=5 FRC=60\nY50")[1].feed, 60.0);
    // One of its own goes before, and 0 is none.
    assert_ends("RNDM=2\nG1 X20 RND=0\nY20", &[[20.0, 0.0], [20.0, 20.0]]);
    assert_ends(
        "RNDM=2\nG1 X20 CHR=1\nY20",
        &[[19.0, 0.0], [20.0, 1.0], [20.0, 20.0]],
    );
}

/// Between lines and arcs in any order, to either side: the rounding touches both, and goes on where they lead.
#[test]
fn roundings_touch_what_they_lie_between() {
    let firsts = [
        "G1 X40 Y0",
        "G1 X40 Y13",
        "G2 X40 Y0 CR=35",
        "G3 X40 Y5 CR=30",
        "G3 X40 Y0 CR=-22",
    ];
    let seconds = [
        "G1 X70 Y50",
        "G1 X45 Y-40",
        "G1 X10 Y30",
        "G2 X80 Y20 CR=40",
        "G3 X80 Y-20 CR=41",
        "G2 X55 Y30 CR=-25",
    ];
    let mut rounded = 0;
    for first in firsts {
        for second in seconds {
            for radius in [0.5, 3.0] {
                let body = format!("{first} RND={radius}\n{second}");
                let whole = run(&format!("F600\n{body}\nM2"));
                let Ok(whole) = whole else { continue };
                let [one, between, two] = steps_of(whole.paths.last().unwrap())[..] else {
                    panic!("{body}")
                };
                rounded += 1;
                assert!((between.radius() - radius).abs() < 1e-9, "{body}");
                for (a, b, at) in [(one, between, one.end), (between, two, between.end)] {
                    assert!(far(a.heading(at), b.heading(at)) < 1e-7, "{body}: {a:?} {b:?}");
                }
                // Those of the two motions are as they were.
                let plain = body.replace(&format!(" RND={radius}"), "");
                let plain = run(&format!("F600\n{plain}\nM2")).unwrap();
                let ends = |path: &ProgramPath| path.targets.last().unwrap().words;
                assert_eq!(
                    ends(plain.paths.last().unwrap()),
                    ends(whole.paths.last().unwrap())
                );
                if let Some((centre, _)) = two.arc {
                    assert!(
                        (far(two.start, centre) - far(two.end, centre)).abs() < 1e-9,
                        "{body}"
                    );
                }
            }
        }
    }
    assert!(rounded >= 40, "{rounded}");
}

#[test]
fn what_does_not_fit_into_a_corner_is_told() {
    for body in [
        "G1 X4 RND=5\nY50",
        "G1 X50 RND=5\nY4",
        "G1 X50 RND=5\nX0",
        "G1 X50 RND=5\nY50 Z3",
        "G1 X50 Z1 RND=5\nY50",
        "G1 X50 CHR=5\nG2 X60 Y10 CR=10",
        "G1 X50 RND=5\nG18\nZ50",
        "RNDM=30\nG1 X50\nY50\nX25\nY0",
    ] {
        assert!(wrong(&format!("F9\n{body}")).contains("does not fit"), "{body}");
    }
    assert!(wrong("F9\nG1 X50 RND=-1\nY5").contains("not below 0"));
    assert!(wrong("F9\nG1 X50 RND=1 CHF=1\nY5").contains("one of RND=, CHF= and CHR="));
    // What is wrong ahead is told there.
    let error = run("F600\nG1 X50 RND=5\nY50 Q\nM2").unwrap_err();
    assert!(
        error.to_string().contains("Q needs a number") && error.place.line > 2,
        "{error}"
    );
}

/// Blocks that are read again are what they were.
#[test]
fn corners_are_the_same_where_blocks_are_not_kept() {
    let body = "G21 G90 G17 G43.4\nG0 X0 Y0 Z0 A0 B0 C0 V1=0 V2=0\nF600\nRNDM=0.5\nG1 X5\n\
                FOR R1=1 TO 9\nY=R1*4 RND=1\nX=R1*7 CHR=0.2\nENDFOR\nM2\n";
    let source = Source::Text(body.as_bytes().into());
    let targets = |kept| {
        let program = read(&source, Options::default(), kept).unwrap();
        let path = program.paths.last().unwrap().whole().unwrap();
        path.targets
            .iter()
            .map(|target| (target.way.clone(), target.words))
            .collect::<Vec<_>>()
    };
    let all = targets(1000);
    assert_eq!(all.len(), 2 * 19 - 1);
    for kept in 1..8 {
        assert_eq!(targets(kept), all, "{kept}");
    }
}

#[test]
fn an_arc_may_go_on_in_the_direction_of_the_motion_before() {
    let arc = |body: &str| steps(body).last().unwrap().arc;
    assert_eq!(arc("G1 X10\nCT X20 Y10"), Some(([10.0, 10.0], 1.0)));
    assert_eq!(arc("G1 X10\nCT X20 Y-10"), Some(([10.0, -10.0], -1.0)));
    // It holds on, and goes on from an arc.
    let half = arc("G1 X10\nCT X20 Y10\nX10 Y20").unwrap();
    assert!(far(half.0, [10.0, 10.0]) < 1e-9 && half.1 == 1.0, "{half:?}");
    assert_eq!(arc("G1 X10\nCT X20"), None);
    assert!(wrong("F9\nG1 X10\nCT X5").contains("behind its start"));
    assert!(wrong("F9\nG1 X10\nG18\nCT X5 Z5").contains("CT"));
    assert!(wrong("F9\nG1 X10\nG92 X0\nG53 G0 Z0\nCT X5").contains("before it"));
}

#[test]
fn a_line_may_have_its_angle() {
    assert_ends("G1 X10 ANG=45", &[[10.0, 10.0]]);
    assert_ends("G1 Y-10 ANG=-30", &[[300_f64.sqrt(), -10.0]]);
    assert!(wrong("F9\nG1 X10 ANG=135").contains("no line in this direction"));
    assert!(wrong("F9\nG1 X10 ANG=90").contains("no line in this direction"));
    assert!(wrong("F9\nG1 ANG=30").contains("one coordinate of its end"));
}

#[test]
fn holes_lie_in_rows_and_on_circles() {
    let drill = "F100\nG0 Z20\nMCALL CYCLE81(15,0,2,-10)\n";
    let near = |found: Vec<f64>, wanted: &[f64]| {
        let near = found.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-9);
        assert!(near && found.len() == wanted.len(), "{found:?}");
    };
    near(xs(&format!("{drill}HOLES1(5,0,0,10,20,3)")), &[15.0, 35.0, 55.0]);
    near(xs(&format!("{drill}HOLES1(5,0,60,10,20,2)")), &[10.0, 20.0]);
    near(
        xs(&format!("{drill}HOLES2(10,0,8,0,0,4)")),
        &[18.0, 10.0, 2.0, 10.0],
    );
    near(xs(&format!("{drill}HOLES2(10,0,8,90,90,2)")), &[10.0, 2.0]);
    assert!(wrong("F9\nHOLES1(5,0,0,10,20,3)").contains("MCALL"));
    assert!(wrong(&format!("{drill}HOLES2(10,0,8,0,0,0)")).contains("number of holes"));
}
