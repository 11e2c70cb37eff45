//! The G and M codes of the dialect.

/// Codes of the dialect, in tenths, with the name people write and the modal group: two codes of one group
/// cannot stand in one block.
pub(super) const CODES: [(char, u32, Code, &str, Group); 146] = [
    ('G', 0, Code::Rapid, "G0", Group::Motion),
    ('G', 10, Code::Feed, "G1", Group::Motion),
    ('G', 20, Code::ArcClockwise, "G2", Group::Motion),
    ('G', 30, Code::ArcCounterClockwise, "G3", Group::Motion),
    ('G', 40, Code::Dwell, "G4", Group::NonModal),
    ('G', 50, Code::CubicSpline, "G5", Group::Motion),
    ('G', 51, Code::QuadraticSpline, "G5.1", Group::Motion),
    ('G', 52, Code::UniformNurbs, "G5.2", Group::Motion),
    ('G', 53, Code::UniformNurbsEnd, "G5.3", Group::Motion),
    ('G', 62, Code::KnotNurbs, "G6.2", Group::Motion),
    ('G', 63, Code::KnotNurbsEnd, "G6.3", Group::Motion),
    ('G', 80, Code::Radii, "G8", Group::Lathe),
    ('G', 90, Code::StopHere, "G9", Group::StopHere),
    ('G', 100, Code::SetOffsets, "G10", Group::NonModal),
    ('G', 110, Code::Hint, "G11", Group::Hint),
    ('G', 150, Code::PolarOff, "G15", Group::Polar),
    ('G', 160, Code::Polar, "G16", Group::Polar),
    ('G', 170, Code::PlaneXy, "G17", Group::Plane),
    ('G', 180, Code::PlaneZx, "G18", Group::Plane),
    ('G', 190, Code::PlaneYz, "G19", Group::Plane),
    ('G', 200, Code::Inches, "G20", Group::Units),
    ('G', 210, Code::Millimetres, "G21", Group::Units),
    ('G', 220, Code::Hint, "G22", Group::Hint),
    ('G', 230, Code::Hint, "G23", Group::Hint),
    ('G', 280, Code::Home, "G28", Group::NonModal),
    ('G', 281, Code::SetHome, "G28.1", Group::NonModal),
    ('G', 300, Code::SecondHome, "G30", Group::NonModal),
    ('G', 301, Code::SetSecondHome, "G30.1", Group::NonModal),
    ('G', 310, Code::Skip, "G31", Group::Motion),
    ('G', 382, probe(false, true), "G38.2", Group::Motion),
    ('G', 383, probe(false, false), "G38.3", Group::Motion),
    ('G', 384, probe(true, true), "G38.4", Group::Motion),
    ('G', 385, probe(true, false), "G38.5", Group::Motion),
    ('G', 400, Code::CompensationOff, "G40", Group::Compensation),
    ('G', 410, Code::Left, "G41", Group::Compensation),
    ('G', 411, Code::LeftBy, "G41.1", Group::Compensation),
    ('G', 420, Code::Right, "G42", Group::Compensation),
    ('G', 421, Code::RightBy, "G42.1", Group::Compensation),
    ('G', 430, Code::ToolLength, "G43", Group::ToolLength),
    ('G', 431, Code::OwnLength, "G43.1", Group::ToolLength),
    ('G', 432, Code::MoreLength, "G43.2", Group::ToolLength),
    ('G', 434, Code::TipOn, "G43.4", Group::ToolLength),
    ('G', 435, Code::TipByVectors, "G43.5", Group::ToolLength),
    ('G', 490, Code::TipOff, "G49", Group::ToolLength),
    ('G', 500, Code::Hint, "G50", Group::Hint),
    ('G', 501, Code::MirrorNoMore, "G50.1", Group::NonModal),
    ('G', 511, Code::MirrorAxes, "G51.1", Group::NonModal),
    ('G', 520, Code::LocalOffset, "G52", Group::NonModal),
    ('G', 530, Code::MachineAxes, "G53", Group::NonModal),
    ('G', 531, Code::ToolToPlane, "G53.1", Group::NonModal),
    ('G', 536, Code::ToolToPlaneAtTip, "G53.6", Group::NonModal),
    ('G', 540, Code::System(1), "G54", Group::Offset),
    ('G', 550, Code::System(2), "G55", Group::Offset),
    ('G', 560, Code::System(3), "G56", Group::Offset),
    ('G', 570, Code::System(4), "G57", Group::Offset),
    ('G', 580, Code::System(5), "G58", Group::Offset),
    ('G', 590, Code::System(6), "G59", Group::Offset),
    ('G', 591, Code::System(7), "G59.1", Group::Offset),
    ('G', 592, Code::System(8), "G59.2", Group::Offset),
    ('G', 593, Code::System(9), "G59.3", Group::Offset),
    ('G', 600, Code::ExactStop, "G60", Group::PathControl),
    ('G', 610, Code::ExactPath, "G61", Group::PathControl),
    ('G', 611, Code::ExactStop, "G61.1", Group::PathControl),
    ('G', 620, Code::Hint, "G62", Group::Hint),
    ('G', 640, Code::Continuous, "G64", Group::PathControl),
    ('G', 6410, Code::WithinTolerance, "G641", Group::PathControl),
    ('G', 6420, Code::WithinTolerance, "G642", Group::PathControl),
    ('G', 6430, Code::WithinTolerance, "G643", Group::PathControl),
    ('G', 6440, Code::WithinTolerance, "G644", Group::PathControl),
    ('G', 6450, Code::WithinTolerance, "G645", Group::PathControl),
    ('G', 680, Code::TurnAbout, "G68", Group::NonModal),
    ('G', 682, Code::Tilt, "G68.2", Group::NonModal),
    ('G', 690, Code::Hint, "G69", Group::Hint),
    ('G', 700, Code::Inches, "G70", Group::Units),
    ('G', 710, Code::Millimetres, "G71", Group::Units),
    ('G', 730, Code::ChipBreaking, "G73", Group::Motion),
    ('G', 740, Code::LeftTapping, "G74", Group::Motion),
    ('G', 800, Code::CancelMotion, "G80", Group::CycleEnd),
    ('G', 810, Code::Drilling, "G81", Group::Motion),
    ('G', 820, Code::DrillingWithDwell, "G82", Group::Motion),
    ('G', 830, Code::PeckDrilling, "G83", Group::Motion),
    ('G', 840, Code::Tapping, "G84", Group::Motion),
    ('G', 850, Code::Boring, "G85", Group::Motion),
    ('G', 860, Code::BoringWithStop, "G86", Group::Motion),
    ('G', 890, Code::BoringWithDwell, "G89", Group::Motion),
    ('G', 900, Code::Absolute, "G90", Group::Distance),
    ('G', 901, Code::AbsoluteCentres, "G90.1", Group::CentreDistance),
    ('G', 910, Code::Incremental, "G91", Group::Distance),
    ('G', 911, Code::IncrementalCentres, "G91.1", Group::CentreDistance),
    ('G', 920, Code::OffsetHere, "G92", Group::NonModal),
    ('G', 921, Code::ForgetOffset, "G92.1", Group::NonModal),
    ('G', 922, Code::SuspendOffset, "G92.2", Group::NonModal),
    ('G', 923, Code::RestoreOffset, "G92.3", Group::NonModal),
    ('G', 930, Code::InverseTime, "G93", Group::FeedMode),
    ('G', 940, Code::PerMinute, "G94", Group::FeedMode),
    ('G', 950, Code::PerRevolution, "G95", Group::FeedMode),
    ('G', 970, Code::SpindleSpeed, "G97", Group::SpindleMode),
    ('G', 980, Code::ToInitialLevel, "G98", Group::ReturnLevel),
    ('G', 990, Code::ToRetractLevel, "G99", Group::ReturnLevel),
    ('G', 7000, Code::Inches, "G700", Group::Units),
    ('G', 7100, Code::Millimetres, "G710", Group::Units),
    ('G', 1000, Code::MirrorNoMore, "G100", Group::NonModal),
    ('G', 1010, Code::MirrorAxes, "G101", Group::NonModal),
    ('G', 1030, Code::Hint, "G103", Group::Hint),
    ('G', 1100, Code::PoleFromTip, "G110", Group::NonModal),
    ('G', 1110, Code::Pole, "G111", Group::NonModal),
    ('G', 1120, Code::PoleFromPole, "G112", Group::NonModal),
    ('G', 1530, Code::MachineAxes, "G153", Group::NonModal),
    ('G', 1870, Code::Hint, "G187", Group::Hint),
    ('G', 2550, Code::Hint, "G255", Group::Hint),
    ('G', 4500, Code::RoundCorners, "G450", Group::Corners),
    ('G', 4510, Code::SharpCorners, "G451", Group::Corners),
    ('G', 5000, Code::NoSystem, "G500", Group::Offset),
    ('G', 5050, Code::System(5), "G505", Group::Offset),
    ('G', 5060, Code::System(6), "G506", Group::Offset),
    ('G', 5070, Code::System(7), "G507", Group::Offset),
    ('G', 5080, Code::System(8), "G508", Group::Offset),
    ('G', 5090, Code::System(9), "G509", Group::Offset),
    ('M', 0, Code::Pause, "M0", Group::Stop),
    ('M', 10, Code::OptionalPause, "M1", Group::Stop),
    ('M', 20, Code::End, "M2", Group::Stop),
    ('M', 30, Code::SpindleClockwise, "M3", Group::Spindle),
    ('M', 40, Code::SpindleCounterClockwise, "M4", Group::Spindle),
    ('M', 50, Code::SpindleOff, "M5", Group::Spindle),
    ('M', 60, Code::ChangeTool, "M6", Group::Tool),
    ('M', 70, Code::MistOn, "M7", Group::Coolant),
    ('M', 80, Code::FloodOn, "M8", Group::Coolant),
    ('M', 90, Code::CoolantOff, "M9", Group::Coolant),
    ('M', 170, Code::SubprogramEnd, "M17", Group::Call),
    ('M', 300, Code::End, "M30", Group::Stop),
    ('M', 480, Code::OverridesOn, "M48", Group::Overrides),
    ('M', 600, Code::PalletPause, "M60", Group::Stop),
    ('M', 610, Code::SetTool, "M61", Group::Tool),
    ('M', 620, Code::OutputOn, "M62", Group::Outputs),
    ('M', 630, Code::OutputOff, "M63", Group::Outputs),
    ('M', 640, Code::OutputOnNow, "M64", Group::Outputs),
    ('M', 650, Code::OutputOffNow, "M65", Group::Outputs),
    ('M', 660, Code::WaitForInput, "M66", Group::Outputs),
    ('M', 670, Code::Analog, "M67", Group::Outputs),
    ('M', 680, Code::AnalogNow, "M68", Group::Outputs),
    ('M', 700, Code::SaveModes, "M70", Group::SavedModes),
    ('M', 710, Code::ForgetModes, "M71", Group::SavedModes),
    ('M', 720, Code::RestoreModes, "M72", Group::SavedModes),
    ('M', 730, Code::SaveModesOfSubroutine, "M73", Group::SavedModes),
    ('M', 980, Code::Call, "M98", Group::Call),
    ('M', 990, Code::Return, "M99", Group::Call),
];

/// G38.2 to G38.5.
const fn probe(away: bool, must: bool) -> Code {
    Code::Probe { away, must }
}

/// Codes that other controllers have and this one refuses, in tenths, and why.
const REFUSED: [(char, u32, &str); 27] = [
    ('G', 70, LATHE),
    ('G', 120, POCKET),
    ('G', 130, POCKET),
    ('G', 330, THREADING),
    ('G', 331, THREADING),
    ('G', 380, PROBING),
    (
        'G',
        440,
        "lengths of tools are added: write G43 H, and the length with the other sign",
    ),
    ('G', 630, "the operator can always override the feed: write G64"),
    ('G', 510, "coordinates are not scaled: let the CAM system do so"),
    (
        'G',
        541,
        "coordinate systems are G54 to G59.3: G54.1 P has no others",
    ),
    ('G', 650, MACRO),
    ('G', 660, MACRO),
    (
        'G',
        683,
        "planes are not taken from the tool: write G68.2 with angles or points",
    ),
    ('G', 720, LATHE),
    ('G', 760, THREADING),
    ('G', 870, "back boring is not supported: write its motions out"),
    (
        'G',
        880,
        "boring with a retract by hand is not supported: write G86",
    ),
    (
        'G',
        960,
        "constant surface speed is for lathes: write G97 and S in r/min",
    ),
    (
        'G',
        2540,
        "coordinates do not turn with rotary axes: the tip is controlled anyway",
    ),
    ('M', 970, LOCAL_CALL),
    ('M', 1980, LOCAL_CALL),
    ('M', 190, "the spindle is not positioned by programs"),
    ('M', 490, OVERRIDES),
    ('M', 500, OVERRIDES),
    ('M', 510, OVERRIDES),
    ('M', 520, OVERRIDES),
    ('M', 530, OVERRIDES),
];

const POCKET: &str = "circular pockets are not supported: let the CAM system put out their motions";
const LOCAL_CALL: &str = "write M98 P and the number of an O word: there are no subroutines by block number, and none in other folders";
pub(super) const LATHE: &str = "lathe codes are not supported";
const MACRO: &str =
    "macros are not called after motions, and G65 stands first in its block: write G65 P where it is to run";
const THREADING: &str = "threads that the axes cut behind a spindle need one that they follow, and this machine has none: a tap goes with G84";
const PROBING: &str = "write G38.2 for a probe that has to touch, or G38.3 for one that may";
const OVERRIDES: &str = "programs do not lock the operator's feed override: leave it out, or list it under passed_over in [program] of the machine file";

/// G501 to G599: coordinate systems of Siemens, of which there are fewer here.
const FAR_SYSTEMS: std::ops::RangeInclusive<f64> = 5010.0..=5990.0;

/// Why the code `letter` with this number of tenths is refused, if it is known at all.
pub(super) fn refused(letter: char, tenths: f64) -> Option<&'static str> {
    if letter == 'G' && FAR_SYSTEMS.contains(&tenths) {
        return Some("coordinate systems are G54 to G57 and G505 to G509 here: G500 to G599 have no others");
    }
    let found = REFUSED
        .iter()
        .find(|(own, number, _)| *own == letter && (tenths - f64::from(*number)).abs() < NEAR)?;
    Some(found.2)
}

/// The number of an M code that is none of the dialect, and that only the builder of another machine knows; those of
/// [`OVERRIDES`] change nothing here, and so may be one.
pub(super) fn of_other_machines(address: &str, value: f64) -> Option<u16> {
    let whole = value.fract() == 0.0 && (0.0..=MOST_FUNCTION).contains(&value);
    let tenths = value * 10.0;
    let known = CODES
        .iter()
        .any(|(letter, own, ..)| *letter == 'M' && f64::from(*own) == tenths);
    let refused = refused('M', tenths).is_some_and(|why| why != OVERRIDES);
    (address == "M" && whole && !known && !refused).then_some(value as u16)
}

/// Largest number of an M code.
const MOST_FUNCTION: f64 = 9999.0;

/// Codes are this near to their tenths.
pub(super) const NEAR: f64 = 1e-3;

/// Meaning of a G or M code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Code {
    /// G0.
    Rapid,
    /// G1.
    Feed,
    /// G2.
    ArcClockwise,
    /// G3.
    ArcCounterClockwise,
    /// CIP: an arc through a point.
    ArcThrough,
    /// CT: an arc in the direction of the motion before.
    TangentArc,
    /// G4.
    Dwell,
    /// G5: a cubic spline in the plane.
    CubicSpline,
    /// G5.1: a quadratic spline in the plane.
    QuadraticSpline,
    /// G5.2: opens a NURBS whose knots are even.
    UniformNurbs,
    /// G5.3: closes it.
    UniformNurbsEnd,
    /// G6.2: opens a NURBS whose knots are given.
    KnotNurbs,
    /// G6.3: closes it.
    KnotNurbsEnd,
    /// G8: X is a radius, as it always is.
    Radii,
    /// G9: the motion of this block ends at rest.
    StopHere,
    /// G10.
    SetOffsets,
    /// G15.
    PolarOff,
    /// G16: X and Y are distance and angle.
    Polar,
    /// G17.
    PlaneXy,
    /// G18.
    PlaneZx,
    /// G19.
    PlaneYz,
    /// G20, G70, G700.
    Inches,
    /// G21, G71, G710.
    Millimetres,
    /// G28.
    Home,
    /// G28.1.
    SetHome,
    /// G30.
    SecondHome,
    /// G30.1.
    SetSecondHome,
    /// G38.2 to G38.5: to where the probe touches, or comes free.
    Probe {
        /// It comes free.
        away: bool,
        /// Not to is an error.
        must: bool,
    },
    /// G31: as G38.3, in its block only.
    Skip,
    /// G40.
    CompensationOff,
    /// G41: the tool is to the left of the contour.
    Left,
    /// G41.1: the same, with a diameter that the block says.
    LeftBy,
    /// G42.
    Right,
    /// G42.1.
    RightBy,
    /// G450: outside corners of a contour are gone around by arcs.
    RoundCorners,
    /// G451: they are gone to where the lines meet.
    SharpCorners,
    /// NORM: the tool goes straight to a contour.
    StraightEntry,
    /// KONT: around it, if need be.
    EntryAround,
    /// G43.
    ToolLength,
    /// G43.1: a length that the block says.
    OwnLength,
    /// G43.2: the length of another tool besides.
    MoreLength,
    /// G43.4.
    TipOn,
    /// G43.5: the same, and I J K of straight motions are the direction of the tool.
    TipByVectors,
    /// G49.
    TipOff,
    /// G52.
    LocalOffset,
    /// G53, G153, SUPA.
    MachineAxes,
    /// TRANS.
    Shift,
    /// ATRANS.
    MoreShift,
    /// ROT.
    Turn,
    /// AROT.
    MoreTurn,
    /// G51.1, G101: X Y Z are mirrored.
    MirrorAxes,
    /// G50.1, G100: they are not any more.
    MirrorNoMore,
    /// G68: a rotation about a point.
    TurnAbout,
    /// G68.2: a tilted plane.
    Tilt,
    /// CYCLE800, which is a statement.
    Swivel,
    /// G53.1: the tool turns to the tilted plane.
    ToolToPlane,
    /// G53.6: the same with the tip where it is.
    ToolToPlaneAtTip,
    /// MIRROR.
    Mirror,
    /// AMIRROR.
    MoreMirror,
    /// SCALE.
    Scale,
    /// ASCALE.
    MoreScale,
    /// G110.
    PoleFromTip,
    /// G111.
    Pole,
    /// G112.
    PoleFromPole,
    /// G500: no coordinate system holds.
    NoSystem,
    /// G54 to G59.3, G505 to G509: the coordinate system of this number, from 1.
    System(u8),
    /// G61.
    ExactPath,
    /// G61.1, G60.
    ExactStop,
    /// G64.
    Continuous,
    /// G641 to G645: G64 with the default tolerance.
    WithinTolerance,
    /// A code of another controller that changes nothing here, which is told.
    Hint,
    /// G73.
    ChipBreaking,
    /// G80.
    CancelMotion,
    /// G81.
    Drilling,
    /// G82.
    DrillingWithDwell,
    /// G83.
    PeckDrilling,
    /// G85.
    Boring,
    /// G86.
    BoringWithStop,
    /// G84: a tap for right-hand threads.
    Tapping,
    /// G74: one for left-hand threads.
    LeftTapping,
    /// G89.
    BoringWithDwell,
    /// G90.
    Absolute,
    /// G90.1.
    AbsoluteCentres,
    /// G91.
    Incremental,
    /// G91.1.
    IncrementalCentres,
    /// G92.
    OffsetHere,
    /// G92.1.
    ForgetOffset,
    /// G92.2.
    SuspendOffset,
    /// G92.3.
    RestoreOffset,
    /// G93.
    InverseTime,
    /// G94.
    PerMinute,
    /// G95.
    PerRevolution,
    /// G97.
    SpindleSpeed,
    /// G98.
    ToInitialLevel,
    /// G99.
    ToRetractLevel,
    /// M0.
    Pause,
    /// M1.
    OptionalPause,
    /// M2, M30.
    End,
    /// M3.
    SpindleClockwise,
    /// M4.
    SpindleCounterClockwise,
    /// M5.
    SpindleOff,
    /// M6.
    ChangeTool,
    /// M7.
    MistOn,
    /// M8.
    FloodOn,
    /// M9.
    CoolantOff,
    /// M48: overrides are on, as they always are.
    OverridesOn,
    /// M60.
    PalletPause,
    /// M62.
    OutputOn,
    /// M63.
    OutputOff,
    /// M64.
    OutputOnNow,
    /// M65.
    OutputOffNow,
    /// M66.
    WaitForInput,
    /// M67.
    Analog,
    /// M68.
    AnalogNow,
    /// M61: the tool that is in the machine already.
    SetTool,
    /// M70.
    SaveModes,
    /// M71.
    ForgetModes,
    /// M72.
    RestoreModes,
    /// M73: like M70, and restored where the subroutine ends.
    SaveModesOfSubroutine,
    /// M98.
    Call,
    /// M99.
    Return,
    /// M17: the end of a subprogram of Siemens.
    SubprogramEnd,
}

/// Modal groups.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Group {
    /// G0 G1 G2 G3 G5 G5.1 G5.2 G5.3 G6.2 G6.3 G31 G38.2 to G38.5, CIP and canned cycles.
    Motion,
    /// G80, which may stand beside a motion.
    CycleEnd,
    /// G4 G10 G28 G30 G52 G53 G92, G53.1 G53.6, TRANS, ROT, MIRROR, SCALE, G110 and theirs, G50.1 G51.1 G68 G68.2 G100 G101: they are for their block only.
    NonModal,
    /// G15 G16.
    Polar,
    /// G17 G18 G19.
    Plane,
    /// G20 G21 G70 G71 G700 G710.
    Units,
    /// G40 G41 G42 G41.1 G42.1.
    Compensation,
    /// G450 G451, KONT NORM: several may stand together.
    Corners,
    /// G43 G43.1 G43.2 G43.4 G43.5 G49.
    ToolLength,
    /// G54 to G59.3, G500, G505 to G509.
    Offset,
    /// G60 G61 G61.1 G64 G641 to G645.
    PathControl,
    /// G90 G91.
    Distance,
    /// G90.1 G91.1.
    CentreDistance,
    /// G93 G94 G95.
    FeedMode,
    /// G97.
    SpindleMode,
    /// G98 G99.
    ReturnLevel,
    /// G8.
    Lathe,
    /// G9.
    StopHere,
    /// M0 M1 M2 M30 M60.
    Stop,
    /// M3 M4 M5.
    Spindle,
    /// M6 M61.
    Tool,
    /// M70 to M73.
    SavedModes,
    /// M7 M8 M9: M7 and M8 may stand together.
    Coolant,
    /// M48.
    Overrides,
    /// M62 to M68.
    Outputs,
    /// M98 M99 M17.
    Call,
    /// ORIAXES, G11, G22, G23, G50, G62, G69, G103, G187, G255, and G5, G5.1 and G8 as high-speed machining; several may
    /// stand together.
    Hint,
}

impl Code {
    /// As people write it.
    pub fn name(self) -> &'static str {
        match self {
            Self::ArcThrough => "CIP",
            Self::TangentArc => "CT",
            Self::Turn => "ROT",
            Self::MoreTurn => "AROT",
            code => {
                let own = CODES.iter().find(|(_, _, own, ..)| *own == code);
                own.map_or("", |(_, _, _, name, _)| name)
            }
        }
    }

    /// G38.2 to G38.5, and G31.
    pub fn probes(self) -> bool {
        matches!(self, Self::Probe { .. } | Self::Skip)
    }

    /// G0 to G3, CIP, CT, and motions with the probe: one motion to the coordinates of its block.
    pub fn leads_to_an_end(self) -> bool {
        matches!(
            self,
            Self::Rapid
                | Self::Feed
                | Self::ArcClockwise
                | Self::ArcCounterClockwise
                | Self::ArcThrough
                | Self::TangentArc
        ) || self.probes()
    }

    /// G73, G74 and G81 to G89.
    pub fn is_cycle(self) -> bool {
        matches!(
            self,
            Self::ChipBreaking
                | Self::Drilling
                | Self::DrillingWithDwell
                | Self::PeckDrilling
                | Self::Boring
                | Self::BoringWithStop
                | Self::BoringWithDwell
                | Self::Tapping
                | Self::LeftTapping
        )
    }

    /// Codes that take the axis words of their block for themselves: no motion is made of them.
    pub fn takes_axes(self) -> bool {
        matches!(
            self,
            Self::SetOffsets
                | Self::Home
                | Self::SecondHome
                | Self::LocalOffset
                | Self::OffsetHere
                | Self::OwnLength
                | Self::Shift
                | Self::MoreShift
                | Self::Turn
                | Self::MoreTurn
                | Self::MirrorAxes
                | Self::MirrorNoMore
                | Self::TurnAbout
                | Self::Tilt
                | Self::Mirror
                | Self::MoreMirror
                | Self::Scale
                | Self::MoreScale
                | Self::PoleFromTip
                | Self::Pole
                | Self::PoleFromPole
        )
    }
}
