//! Seams in files: how a real seam deviates from the programmed one, and the curves that are planned from.

use crate::TrueSeams;
use cam::path::PlannedPath;
use config::machine::{MachineFile, TrackingUnit};
use config::table::{self, Row, TableError};
use shared::io::{SLIDE_NAMES, SLIDES};
use shared::protocol::{PathAction, PathEvent};
use std::path::Path;
use thiserror::Error;

/// How far beyond its ends a deviation continues in a straight line \[mm\], constant from there: enough for
/// the cameras and the map to see a straight seam, without leading a steep one out of the slides' reach.
const CONTINUATION: f64 = 20.0;
/// Rows may begin this much after the weld does and end this much before; the straight continuation is the seam
/// there \[mm\].
pub const OVERHANG_MM: f64 = 10.0;
/// Distance of the places where the reach is checked \[mm\].
const CHECK_STEP: f64 = 0.25;

/// Deviation of both real seams from the programmed ones over path length.
///
/// s = 0 is where the first beam goes on. U, V are those of each head on the planned pose (mathematics 0.7).
/// Linear between the rows.
#[derive(Clone, Debug, PartialEq)]
pub struct Deviation {
    s: Vec<f64>,
    /// u1, v1, u2, v2.
    value: Vec<[f64; SLIDES]>,
}

/// Why a seam cannot be followed.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SeamError {
    /// A seam is given to a machine that cannot follow it.
    #[error("this machine has no tracker and no slides to follow a seam: omit the seam")]
    NoTracking,
    /// The program tracks, and no seam is given.
    #[error(
        "the program follows the seam (M62 P2): give with --seam FILE how the real seams deviate from the programmed ones"
    )]
    NoSeam,
    /// Shorter than the weld.
    #[error(
        "the seam deviation covers s = {first:.3}…{last:.3} mm, but the weld is 0…{length:.3} mm: add rows to the seam file"
    )]
    TooShort {
        /// First row \[mm\].
        first: f64,
        /// Last row \[mm\].
        last: f64,
        /// Length of the weld \[mm\].
        length: f64,
    },
    /// The seam of the drawing lies elsewhere.
    #[error(
        "side {side}: at s = {s:.1} mm of the weld there is no seam: the seam file and the drawing it belongs to (--seam-of) describe another place"
    )]
    Elsewhere {
        /// 1 or 2.
        side: usize,
        /// Path length from where the first beam goes on \[mm\].
        s: f64,
    },
    /// Beyond the reach of a slide.
    #[error(
        "side {side}: at s = {s:.1} mm the seam needs slide {slide} at {position:.3} mm, {beyond:.3} mm beyond its travel ({min}…{max} mm)"
    )]
    Reach {
        /// 1 or 2.
        side: usize,
        /// Path length from where the first beam goes on \[mm\].
        s: f64,
        /// The slide.
        slide: &'static str,
        /// Where it would have to be \[mm\].
        position: f64,
        /// By how much too far \[mm\].
        beyond: f64,
        /// Travel \[mm\].
        min: f64,
        /// Travel \[mm\].
        max: f64,
    },
}

/// Farther than any machine goes \[mm\].
const BEYOND_MM: f64 = 100_000.0;

impl Deviation {
    /// No deviation, as far as any machine goes.
    pub fn straight() -> Self {
        Self::none(BEYOND_MM)
    }

    /// No deviation, over `length` \[mm\].
    pub(crate) fn none(length: f64) -> Self {
        Self {
            s: vec![0.0, length],
            value: vec![[0.0; SLIDES]; 2],
        }
    }

    /// Reads `s_mm,u1_mm,v1_mm,u2_mm,v2_mm` at `path`, or `s_mm,u1_mm,v1_mm` of one side; the other one is as programmed then.
    pub fn read(path: &Path) -> Result<Self, TableError> {
        Self::parse(&path.display().to_string(), &table::read(path)?)
    }

    /// Understands `text`; `path` is used in messages only.
    pub fn parse(path: &str, text: &str) -> Result<Self, TableError> {
        let rows = match table::parse(path, text, ["s_mm", "u1_mm", "v1_mm", "u2_mm", "v2_mm"]) {
            Err(other @ TableError::Header { .. }) => one_side(path, text, other)?,
            both => both?,
        };
        let path = path.to_owned();
        if rows.len() < 2 {
            return Err(TableError::Short { path, wanted: 2 });
        }
        if let Some(pair) = rows.windows(2).find(|r| r[1].values[0] <= r[0].values[0]) {
            return Err(TableError::Row {
                path,
                line: pair[1].line,
                reason: "s_mm must increase from row to row",
            });
        }
        Ok(Self {
            s: rows.iter().map(|r| r.values[0]).collect(),
            value: rows
                .iter()
                .map(|r| std::array::from_fn(|i| r.values[i + 1]))
                .collect(),
        })
    }

    /// First and last row \[mm\].
    pub fn range(&self) -> (f64, f64) {
        (self.s[0], self.s[self.s.len() - 1])
    }

    /// u1, v1, u2, v2 \[mm\] at `s` \[mm\]. Beyond the rows it continues in a straight line with the slope of
    /// the last span for 20 mm, then parallel to the plan.
    pub fn at(&self, s: f64) -> [f64; SLIDES] {
        let (first, last) = self.range();
        let s = s.clamp(first - CONTINUATION, last + CONTINUATION);
        let i = self.s.partition_point(|row| *row <= s).clamp(1, self.s.len() - 1);
        let part = (s - self.s[i - 1]) / (self.s[i] - self.s[i - 1]);
        std::array::from_fn(|c| {
            let (a, b) = (self.value[i - 1][c], self.value[i][c]);
            a + (b - a) * part
        })
    }

    /// Whether the rows cover the weld of `path` and the slides reach the seam all along it, the extension
    /// that keeps the defocus included.
    pub fn check(&self, path: &PlannedPath, machine: &MachineFile) -> Result<(), SeamError> {
        let unit = machine.tracking.as_ref().ok_or(SeamError::NoTracking)?;
        let length = path.length_mm();
        let (start, end) = path.weld().unwrap_or((0.0, length));
        let (first, last) = self.range();
        if first > OVERHANG_MM || last < end - start - OVERHANG_MM {
            let length = end - start;
            return Err(SeamError::TooShort { first, last, length });
        }
        let knots = path.path();
        let count = (length / CHECK_STEP).ceil() as usize;
        let mut worst: Option<(f64, SeamError)> = None;
        let even = (0..=count).map(|i| length * i as f64 / count as f64);
        let rows = self
            .s
            .iter()
            .map(|s| s + start)
            .filter(|s| (0.0..=length).contains(s));
        for s in even.chain(rows) {
            let follow = knots.at(s).map_or([0.0; 2], |point| point.v_follow());
            let deviation = self.at(s - start);
            for slide in 0..unit.board.slides.len() {
                let planned = if slide % 2 == 1 { follow[slide / 2] } else { 0.0 };
                reach(unit, slide, planned + deviation[slide], s - start, &mut worst);
            }
        }
        worst.map_or(Ok(()), |(_, error)| Err(error))
    }
}

/// The rows of a file of one side; it is of neither kind if there are `other` columns than those of two sides or of one.
fn one_side(path: &str, text: &str, other: TableError) -> Result<Vec<Row<5>>, TableError> {
    let rows = match table::parse(path, text, ["s_mm", "u1_mm", "v1_mm"]) {
        Err(TableError::Header { .. }) => return Err(other),
        rows => rows?,
    };
    let both = |Row {
                    line,
                    values: [s, u, v],
                }| Row {
        line,
        values: [s, u, v, 0.0, 0.0],
    };
    Ok(rows.into_iter().map(both).collect())
}

/// Notes in `worst` if `slide` cannot reach `position` \[mm\] by more than what was noted before.
fn reach(unit: &TrackingUnit, slide: usize, position: f64, s: f64, worst: &mut Option<(f64, SeamError)>) {
    let limits = &unit.board.slides[slide];
    let (min, max) = (limits.travel_min_mm, limits.travel_max_mm);
    let beyond = (position - max).max(min - position);
    if beyond > worst.as_ref().map_or(0.0, |(b, _)| *b) {
        let error = SeamError::Reach {
            side: slide / 2 + 1,
            s,
            slide: SLIDE_NAMES[slide],
            position,
            beyond,
            min,
            max,
        };
        *worst = Some((beyond, error));
    }
}

/// Whether `seams`, of another program's drawing, lie beside the weld of `path` and the slides reach them there.
pub fn check_facing(seams: &TrueSeams, path: &PlannedPath, machine: &MachineFile) -> Result<(), SeamError> {
    let unit = machine.tracking.as_ref().ok_or(SeamError::NoTracking)?;
    let (start, end) = path.weld().unwrap_or((0.0, path.length_mm()));
    let knots = path.knot_path();
    let count = ((end - start) / CHECK_STEP).ceil().max(1.0) as usize;
    let mut worst = None;
    for i in 0..=count {
        let along = (end - start) * i as f64 / count as f64;
        let pose = knots.at(start + along).and_then(|point| point.pose().ok());
        for side in unit.board.sides() {
            let facing = pose.and_then(|pose| seams.facing(side, &seams.heads().spot(&pose, side), 0.0));
            let Some((_, crossing)) = facing else {
                let (side, s) = (side + 1, along);
                return Err(SeamError::Elsewhere { side, s });
            };
            for (slide, position) in [(2 * side, crossing.u), (2 * side + 1, crossing.v)] {
                reach(unit, slide, position, along, &mut worst);
            }
        }
    }
    worst.map_or(Ok(()), |(_, error)| Err(error))
}

/// Whether the machine can follow the seams that the program asks it to: there is a tracker, a seam, and the
/// slides reach it.
pub fn check_seam(
    paths: &[PlannedPath],
    machine: &MachineFile,
    seam: Option<&Deviation>,
) -> Result<(), SeamError> {
    let tracks = |path: &PlannedPath| {
        let on = |event: &PathEvent| event.action == PathAction::Tracking { on: true };
        path.events.iter().any(on)
    };
    let tracked = paths.iter().any(tracks);
    match (&machine.tracking, seam) {
        (None, Some(_)) => Err(SeamError::NoTracking),
        (Some(_), None) if tracked => Err(SeamError::NoSeam),
        (_, None) => Ok(()),
        (Some(_), Some(seam)) => paths
            .iter()
            .filter(|path| path.weld().is_some())
            .try_for_each(|path| seam.check(path, machine)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cam::path::Planner;
    use nc::{Options, interpret};

    const HEADER: &str = "s_mm,u1_mm,v1_mm,u2_mm,v2_mm";

    fn parse(rows: &str) -> Result<Deviation, TableError> {
        Deviation::parse("d.csv", &format!("{HEADER}\n{rows}"))
    }

    #[test]
    fn deviation_is_linear_between_rows_and_goes_on_straight_but_bounded() {
        let deviation = parse("0,0,0,0,0\n10,1,0,-1,0\n20,1,0.5,-1,0\n").unwrap();
        assert_eq!(deviation.at(5.0), [0.5, 0.0, -0.5, 0.0]);
        assert_eq!(deviation.at(15.0), [1.0, 0.25, -1.0, 0.0]);
        assert_eq!(deviation.at(-10.0), [-1.0, 0.0, 1.0, 0.0]);
        assert_eq!(deviation.at(40.0), [1.0, 1.5, -1.0, 0.0]);
        assert_eq!(deviation.at(1e9), deviation.at(40.0));
    }

    #[test]
    fn malformed_rows_are_named_by_their_line() {
        let message = |rows: &str| parse(rows).unwrap_err().to_string();
        assert_eq!(
            message("0,0,0,0,0\n\n1,x,0,0,0"),
            "d.csv, line 4: \"x\" is not a finite number (u1_mm)"
        );
        assert_eq!(message("0,0,0,0"), "d.csv, line 2: 4 values instead of 5");
        assert_eq!(
            message("0,0,inf,0,0"),
            "d.csv, line 2: \"inf\" is not a finite number (v1_mm)"
        );
        assert_eq!(
            message("0,0,0,0,0\n5,0,0,0,0\n5,0,0,0,0"),
            "d.csv, line 4: s_mm must increase from row to row"
        );
        assert_eq!(message("0,0,0,0,0"), "d.csv: at least 2 rows are needed");
        let error = Deviation::parse("d.csv", "s,u1\n").unwrap_err().to_string();
        assert_eq!(error, format!("d.csv, line 1: the header must be {HEADER}"));
    }

    #[test]
    fn a_seam_beyond_the_slides_is_named_by_side_place_and_amount() {
        let text = include_str!("../../../machines/dual-beam-gantry.toml");
        let machine = MachineFile::parse("m.toml", text).unwrap();
        let planner = Planner::build(&machine).unwrap();
        let program =
            "G43.4\nG0 X900 Y900 Z100 A0 B0 C0 V2=3\nF5000\nG1 X950\nM62 P0\nX1050\nM63 P0\nX1100\nM2";
        let program = interpret(program, Options::default()).unwrap();
        let from = [100.0, 100.0, 900.0, 0.0, 0.0, 0.0];
        let weld = &planner.program(&program, &from, None).unwrap()[1];
        let check = |rows: &str| parse(rows).unwrap().check(weld, &machine);
        assert_eq!(check("0,0,0,0,0\n100,0,0,0,0"), Ok(()));
        let short = check("0,0,0,0,0\n89,0,0,0,0").unwrap_err();
        assert_eq!(
            short.to_string(),
            "the seam deviation covers s = 0.000…89.000 mm, but the weld is 0…100.000 mm: add rows to the seam file"
        );
        let rows = "0,0,0,0,0\n50,0,0,0,9.5\n100,0,0,0,0\n101,0,0,0,0";
        let Err(SeamError::Reach {
            side,
            s,
            slide,
            beyond,
            ..
        }) = check(rows)
        else {
            panic!("V2 would need 12.5 mm")
        };
        assert_eq!((side, slide), (2, "V2"));
        assert!((s - 50.0).abs() < 1e-6 && (beyond - 0.5).abs() < 1e-6);
    }
}
