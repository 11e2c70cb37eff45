//! The G and M codes of the dialect.

/// Codes of the dialect, in tenths, with the name people write and the modal group: two codes of one group
/// cannot stand in one block.
pub(super) const CODES: [(char, u32, Code, &str, Group); 36] = [
    ('G', 0, Code::Rapid, "G0", Group::Motion),
    ('G', 10, Code::Feed, "G1", Group::Motion),
    ('G', 20, Code::ArcClockwise, "G2", Group::Motion),
    ('G', 30, Code::ArcCounterClockwise, "G3", Group::Motion),
    ('G', 40, Code::Dwell, "G4", Group::NonModal),
    ('G', 52, Code::UniformNurbs, "G5.2", Group::Motion),
    ('G', 53, Code::UniformNurbsEnd, "G5.3", Group::Motion),
    ('G', 62, Code::KnotNurbs, "G6.2", Group::Motion),
    ('G', 63, Code::KnotNurbsEnd, "G6.3", Group::Motion),
    ('G', 170, Code::PlaneXy, "G17", Group::Plane),
    ('G', 180, Code::PlaneZx, "G18", Group::Plane),
    ('G', 190, Code::PlaneYz, "G19", Group::Plane),
    ('G', 210, Code::Millimetres, "G21", Group::Units),
    ('G', 400, Code::CompensationOff, "G40", Group::Compensation),
    ('G', 434, Code::TipOn, "G43.4", Group::ToolLength),
    ('G', 490, Code::TipOff, "G49", Group::ToolLength),
    ('G', 530, Code::MachineAxes, "G53", Group::NonModal),
    ('G', 540, Code::WorldOffset, "G54", Group::Offset),
    ('G', 610, Code::ExactPath, "G61", Group::PathControl),
    ('G', 611, Code::ExactStop, "G61.1", Group::PathControl),
    ('G', 640, Code::Continuous, "G64", Group::PathControl),
    ('G', 900, Code::Absolute, "G90", Group::Distance),
    ('G', 930, Code::InverseTime, "G93", Group::FeedMode),
    ('G', 940, Code::PerMinute, "G94", Group::FeedMode),
    ('M', 20, Code::End, "M2", Group::Stop),
    ('M', 30, Code::SpindleClockwise, "M3", Group::Spindle),
    ('M', 40, Code::SpindleCounterClockwise, "M4", Group::Spindle),
    ('M', 50, Code::SpindleOff, "M5", Group::Spindle),
    ('M', 300, Code::End, "M30", Group::Stop),
    ('M', 620, Code::OutputOn, "M62", Group::Outputs),
    ('M', 630, Code::OutputOff, "M63", Group::Outputs),
    ('M', 640, Code::OutputOnNow, "M64", Group::Outputs),
    ('M', 650, Code::OutputOffNow, "M65", Group::Outputs),
    ('M', 660, Code::WaitForInput, "M66", Group::Outputs),
    ('M', 670, Code::Analog, "M67", Group::Outputs),
    ('M', 680, Code::AnalogNow, "M68", Group::Outputs),
];

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
    /// G4.
    Dwell,
    /// G5.2: opens a NURBS whose knots are even.
    UniformNurbs,
    /// G5.3: closes it.
    UniformNurbsEnd,
    /// G6.2: opens a NURBS whose knots are given.
    KnotNurbs,
    /// G6.3: closes it.
    KnotNurbsEnd,
    /// G17.
    PlaneXy,
    /// G18.
    PlaneZx,
    /// G19.
    PlaneYz,
    /// G21.
    Millimetres,
    /// G40.
    CompensationOff,
    /// G43.4.
    TipOn,
    /// G49.
    TipOff,
    /// G53.
    MachineAxes,
    /// G54.
    WorldOffset,
    /// G61.
    ExactPath,
    /// G61.1.
    ExactStop,
    /// G64.
    Continuous,
    /// G90.
    Absolute,
    /// G93.
    InverseTime,
    /// G94.
    PerMinute,
    /// M2, M30.
    End,
    /// M3.
    SpindleClockwise,
    /// M4.
    SpindleCounterClockwise,
    /// M5.
    SpindleOff,
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
}

/// Modal groups.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Group {
    /// G0 G1 G2 G3 G5.2 G5.3 G6.2 G6.3.
    Motion,
    /// G4 G53: they hold in their block only.
    NonModal,
    /// G17 G18 G19.
    Plane,
    /// G21.
    Units,
    /// G40.
    Compensation,
    /// G43.4 G49.
    ToolLength,
    /// G54.
    Offset,
    /// G61 G61.1 G64.
    PathControl,
    /// G90.
    Distance,
    /// G93 G94.
    FeedMode,
    /// M2 M30.
    Stop,
    /// M3 M4 M5.
    Spindle,
    /// M62 to M68.
    Outputs,
}

impl Code {
    /// As people write it.
    pub fn name(self) -> &'static str {
        let own = CODES.iter().find(|(_, _, code, ..)| *code == self);
        own.map_or("", |(_, _, _, name, _)| name)
    }
}
