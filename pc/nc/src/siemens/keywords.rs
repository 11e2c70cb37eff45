//! Words of Siemens programs without a number: codes, what is always so here, and what is refused.

use crate::block::{Block, CodeWord};
use crate::codes::{Code, Group};
use crate::error::{NcError, Problem};
use crate::scanner::Scanner;

/// The point that an arc of CIP goes through.
pub(crate) const POINT_WORDS: [&str; 3] = ["I1", "J1", "K1"];

/// Words and the codes that they are here.
const CODES: [(&str, Code, Group); 18] = [
    ("TRAORI", Code::TipOn, Group::ToolLength),
    ("TRAFOOF", Code::TipOff, Group::ToolLength),
    ("ORIAXES", Code::Hint, Group::Hint),
    ("NORM", Code::StraightEntry, Group::Corners),
    ("KONT", Code::EntryAround, Group::Corners),
    ("KONTC", Code::EntryAround, Group::Corners),
    ("KONTT", Code::EntryAround, Group::Corners),
    ("SUPA", Code::MachineAxes, Group::NonModal),
    ("CIP", Code::ArcThrough, Group::Motion),
    ("CT", Code::TangentArc, Group::Motion),
    ("TRANS", Code::Shift, Group::NonModal),
    ("ATRANS", Code::MoreShift, Group::NonModal),
    ("ROT", Code::Turn, Group::NonModal),
    ("AROT", Code::MoreTurn, Group::NonModal),
    ("MIRROR", Code::Mirror, Group::NonModal),
    ("AMIRROR", Code::MoreMirror, Group::NonModal),
    ("SCALE", Code::Scale, Group::NonModal),
    ("ASCALE", Code::MoreScale, Group::NonModal),
];

/// Words without an effect here: what they ask for is always so, or what they change is not there.
const WITHOUT_EFFECT: [&str; 43] = [
    "COMPCAD",
    "COMPCURV",
    "COMPSURF",
    "COMPON",
    "COMPOF",
    "ORIWKS",
    "ORIVECT",
    "ORIVIRT1",
    "ORIVIRT2",
    "ORIEULER",
    "ORIRPY",
    "ORIC",
    "ORID",
    "ORISON",
    "ORISOF",
    "UPATH",
    "SPATH",
    "FFWON",
    "FFWOF",
    "FNORM",
    "CFTCP",
    "CFC",
    "CFIN",
    "SOFT",
    "BRISK",
    "DRIVE",
    "SOFTA",
    "BRISKA",
    "DYNNORM",
    "DYNPOS",
    "DYNROUGH",
    "DYNSEMIFIN",
    "DYNFINISH",
    "CUT2D",
    "CUT2DF",
    "STOPRE",
    "WALIMON",
    "WALIMOF",
    "DIAMOF",
    "SETMS",
    "RTLION",
    "RTLIOF",
    "STARTFIFO",
];

/// Words with a value without an effect here.
const VALUES_WITHOUT_EFFECT: [&str; 5] = ["ADIS", "ADISPOS", "OTOL", "ATOL", "LIMS"];

/// G codes without an effect here: where exact stops are fine enough, and the dialect.
const G_WITHOUT_EFFECT: [u32; 4] = [290, 601, 602, 603];
/// The same of M: gears of the spindle.
const M_WITHOUT_EFFECT: [u32; 6] = [40, 41, 42, 43, 44, 45];

const SPLINE: &str = "splines through points are not supported: write G1 with G64 P, G5 or G6.2";
const KNOTS: &str =
    "its curve depends on knots that the controller chooses: write G1 with G64 P, or G6.2 with its knots";
const CYCLE: &str = "this cycle is not supported: write its motions out, or let the CAM system do so";
const TAPPING: &str = "threading and tapping need a spindle that the axes follow, and this machine has none";
const FRAME: &str =
    "only TRANS, MIRROR, SCALE, ROT and ATRANS, AMIRROR, ASCALE, AROT change the coordinates of a program";
const SPINDLE: &str = "the spindle is not positioned by programs";
const FILES: &str =
    "subprograms are called by their name alone in a line, and are in this program or beside it";
const ACTIONS: &str = "synchronised actions are not supported: outputs are switched by M62 to M68";
const LATHE: &str = "lathe codes are not supported";

/// Words that are refused, and why.
const REFUSED: [(&str, &str); 43] = [
    ("ASPLINE", SPLINE),
    ("CSPLINE", SPLINE),
    ("BSPLINE", KNOTS),
    ("POLY", SPLINE),
    ("INVCW", SPLINE),
    ("ROTS", FRAME),
    ("AROTS", FRAME),
    ("TOFRAME", FRAME),
    ("TOROT", FRAME),
    ("CRPL", FRAME),
    ("CYCLE60", CYCLE),
    ("CYCLE61", CYCLE),
    ("CYCLE62", CYCLE),
    ("CYCLE63", CYCLE),
    ("CYCLE64", CYCLE),
    ("CYCLE70", CYCLE),
    ("CYCLE71", CYCLE),
    ("CYCLE72", CYCLE),
    ("CYCLE76", CYCLE),
    ("CYCLE77", CYCLE),
    ("CYCLE79", CYCLE),
    ("CYCLE86", CYCLE),
    ("CYCLE801", CYCLE),
    ("CYCLE802", CYCLE),
    ("CYCLE899", CYCLE),
    ("POCKET1", CYCLE),
    ("POCKET2", CYCLE),
    ("POCKET3", CYCLE),
    ("POCKET4", CYCLE),
    ("SLOT1", CYCLE),
    ("SLOT2", CYCLE),
    ("LONGHOLE", CYCLE),
    ("CYCLE84", TAPPING),
    ("CYCLE840", TAPPING),
    ("CYCLE97", LATHE),
    ("DIAMON", LATHE),
    ("SPOS", SPINDLE),
    ("SPOSA", SPINDLE),
    ("FGROUP", "F is the speed of the tip, as with FGROUP(X,Y,Z)"),
    ("CALL", FILES),
    ("EXTCALL", FILES),
    ("PCALL", FILES),
    ("WHEN", ACTIONS),
];

/// A word without a number, if one stands at the scanner.
pub(super) fn read(scanner: &mut Scanner, block: &mut Block) -> Result<bool, NcError> {
    let (place, start) = (scanner.place(), scanner.mark());
    let word = scanner.identifier().to_ascii_uppercase();
    if scanner.peek() == Some('=') {
        scanner.go_back(start);
        return Ok(false);
    }
    if let Some((name, code, group)) = CODES.iter().find(|(name, ..)| *name == word) {
        block.add(CodeWord::new(name, *code, *group, place))?;
        return Ok(true);
    }
    let known = WITHOUT_EFFECT.contains(&word.as_str());
    if !known {
        scanner.go_back(start);
    }
    Ok(known)
}

/// Whether a word with this letter or name and this value changes nothing here.
pub(crate) fn is_without_effect(address: &str, value: f64) -> bool {
    let codes: &[u32] = match address {
        "G" => &G_WITHOUT_EFFECT,
        "M" => &M_WITHOUT_EFFECT,
        _ => return VALUES_WITHOUT_EFFECT.contains(&address),
    };
    codes.iter().any(|code| f64::from(*code) == value)
}

/// Why a word is refused, if it is known at all.
pub(crate) fn refused_word(word: &str) -> Option<Problem> {
    let found = REFUSED.iter().find(|(name, _)| name.eq_ignore_ascii_case(word));
    found.map(|(name, why)| Problem::Impossible { code: name, why })
}

/// Whether the cycle `name` changes nothing here; the scanner is behind it then.
pub(super) fn cycle_without_effect(name: &str, scanner: &mut Scanner) -> Result<bool, NcError> {
    let start = scanner.mark();
    scanner.skip_blanks();
    if scanner.peek() == Some('(') {
        scanner.step();
        let within = scanner.take(|c| c != ')').to_owned();
        scanner.step();
        let nothing = match name {
            // High speed is planned ahead anyway, within the tolerance of G64; the others are for displays.
            "CYCLE832" | "WORKPIECE" | "GROUP_BEGIN" | "GROUP_END" => true,
            // F is that of the tip.
            "FGROUP" => within.split(',').all(|axis| "XYZ".contains(axis.trim())),
            _ => false,
        };
        if nothing {
            return Ok(true);
        }
    }
    scanner.go_back(start);
    Ok(false)
}
