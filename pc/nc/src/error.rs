//! What can be wrong with an NC program, and where.

use std::fmt;
use thiserror::Error;

/// A position in the text of a program; line and column count from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SourcePosition {
    /// Line of the file.
    pub line: u32,
    /// Character in the line.
    pub column: u32,
}

impl fmt::Display for SourcePosition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}, column {}", self.line, self.column)
    }
}

/// A problem and its position.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{place}: {problem}")]
pub struct NcError {
    /// Where.
    pub place: SourcePosition,
    /// What.
    pub problem: Problem,
}

/// What is wrong.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Problem {
    /// The file cannot be read.
    #[error("cannot be read: {0}")]
    Unreadable(String),
    /// No line of a program.
    #[error("the line has more than {0} bytes: this is no NC program, or its ends of lines are missing")]
    LongLine(usize),
    /// No character of the dialect.
    #[error("'{0}' is not understood here: write text that is no program in ( ) or behind ;")]
    Character(char),
    /// A tool does not go along a contour.
    #[error("{code} with a radius of {radius} mm: {why}")]
    Gouge {
        /// G41 or G42.
        code: &'static str,
        /// Radius of the tool \[mm\].
        radius: f64,
        /// Why, and what to do.
        why: &'static str,
    },
    /// What cutter compensation does not go together with.
    #[error("{code} is not possible while cutter compensation is on, since line {line}: write G40 before")]
    WhileCompensated {
        /// The code.
        code: &'static str,
        /// That of G41 or G42.
        line: u32,
    },
    /// S of a beam.
    #[error(
        "S{s} is more than S{full}, the full power of the beam by laser in [program] of the machine file"
    )]
    LaserPower {
        /// S.
        s: f64,
        /// S of the full power.
        full: f64,
    },
    /// A tape mark that is not the first, and more than that.
    #[error(
        "'%' ends a program, and text stands behind it here: write a comment in ( ), and the number of a further program in a file of its own"
    )]
    TextBehindTapeMark,
    /// A command to Grbl, or a variable of Siemens.
    #[error(
        "'$' begins a command to Grbl or a variable of a Siemens controller, which are no part of programs here: leave it out, or list \"$\" under passed_over in [program] of the machine file"
    )]
    Dollar,
    /// A command to Grbl that does something.
    #[error("{0} is no command to Grbl that may be left out: take it out of the program")]
    GrblCommand(String),
    /// The search of the reference marks after a motion.
    #[error("$H after a motion leads the axes to their reference marks, which programs do not: write G28")]
    HomeAmidst,
    /// A program of Heidenhain controllers.
    #[error(
        "this is a program of a Heidenhain controller, which is not read here: let the CAM system put out RS274/NGC or Siemens 840D"
    )]
    Heidenhain,
    /// Zeros before a number without a point.
    #[error(
        "{0} has zeros before it and no point: on controllers with an implied point it is another length, so write the point"
    )]
    ImpliedPoint(String),
    /// `(` without `)`.
    #[error("the comment is not closed")]
    OpenComment,
    /// A letter without a number.
    #[error("{0} needs a number")]
    NoNumber(String),
    /// DEF without what follows it.
    #[error(
        "variables are defined as DEF REAL NAME, OTHER=1, COUNTS[3], with INT and BOOL too; their names begin with two letters or _"
    )]
    NoDefinition,
    /// T= without the name of a tool.
    #[error("T=\"NAME\" needs the name of a tool between quotation marks")]
    ToolName,
    /// A number without a letter.
    #[error("a number without a letter before it")]
    LooseNumber,
    /// `<` without `>`.
    #[error("the name is not closed with >")]
    OpenName,
    /// A name is wanted.
    #[error("a name in < > is missing")]
    NoName,
    /// A value is wanted.
    #[error("a value is missing")]
    NoValue,
    /// Brackets inside brackets.
    #[error("more than {deepest} expressions inside each other")]
    TooDeep {
        /// What is possible.
        deepest: u32,
    },
    /// No number of a parameter.
    #[error("#{0} is no parameter: their numbers are whole, from 0 to 5602")]
    ParameterNumber(f64),
    /// A name without a value.
    #[error("{0} has no value here")]
    Undefined(String),
    /// EXISTS beside what it asks for.
    #[error(
        "{0} is set in this block: controllers differ in whether it exists here, so ask in the block before"
    )]
    ExistsHere(String),
    /// A tool that is not in the table.
    #[error(
        "there is no tool {0}: give it a table [tools.{0}] in the machine file, or its length with G10 L1 P{0} Z"
    )]
    NoTool(u32),
    /// A value of Fanuc controllers.
    #[error(
        "#{0} is a value of the controller on Fanuc's, which is not known here: write its value, or set it before"
    )]
    OfControl(u32),
    /// A parameter of a macro that has not been given to it.
    #[error(
        "#{0} has no value here: give it to the macro, as controllers leave out the words and terms of such parameters"
    )]
    Vacant(u32),
    /// `#1 EQ #0` of one that was set to 0.
    #[error(
        "#{0} was set to 0: with EQ #0 and NE #0 Fanuc controllers ask whether it has a value, and others whether it is 0, so write EQ 0 or NE 0"
    )]
    EqualsVacant(u32),
    /// `#3000=`.
    #[error("the program stops with the alarm {0} here, by #3000: what it asks for before does not hold")]
    Alarm(f64),
    /// `#3006=`.
    #[error("#3006 stops Fanuc controllers with a message: write M0, and the message in ( ) before it")]
    StopByParameter,
    /// A letter of G65 that is no argument.
    #[error(
        "{0} is no argument of a macro that G65 calls: write G65 P, L if it is to run several times, and letters with values"
    )]
    MacroArgument(char),
    /// The system sets it.
    #[error("{0} cannot be set by a program")]
    ReadOnly(String),
    /// `[` without `]`.
    #[error("the bracket is not closed")]
    OpenBracket,
    /// The line ends in an expression.
    #[error("] is missing")]
    NoBracket,
    /// A function that there is not.
    #[error("{0} is no function")]
    UnknownFunction(String),
    /// A function of a value that has none.
    #[error("{name}[{value}] has no value: {reason}")]
    Argument {
        /// Function.
        name: String,
        /// Its argument.
        value: f64,
        /// What is possible.
        reason: &'static str,
    },
    /// ATAN with one argument.
    #[error("ATAN has two arguments: ATAN[y]/[x]")]
    NoSlash,
    /// No operator.
    #[error("{0} is no operator")]
    UnknownOperator(String),
    /// A root of a negative number.
    #[error("a negative number has no power that is not whole")]
    Power,
    /// x / 0.
    #[error("division by 0")]
    DivisionByZero,
    /// Beyond all numbers.
    #[error("the value is too large")]
    NotFinite,
    /// `#1` that is neither a value nor set.
    #[error("{0} stands without a letter before it and without = behind it")]
    LooseParameter(String),
    /// A code that is not supported.
    #[error("{letter}{number}: {why}")]
    RefusedCode {
        /// G or M.
        letter: char,
        /// Its number.
        number: f64,
        /// Why, and what to do.
        why: &'static str,
    },
    /// U, V, W.
    #[error("{0} is a parallel axis, which machines here do not have")]
    NoParallelAxes(String),
    /// An O word with something unknown behind it.
    #[error("{0} is not understood after an O word")]
    UnknownKeyword(String),
    /// WELDON without a name.
    #[error("WELDON needs the name of a set of the weld data: WELDON=root")]
    NoWeldName,
    /// More in the line of an O word.
    #[error(
        "this does not belong to the O word, or the number of the program, before it: write it in a line of its own"
    )]
    FlowRest,
    /// A condition or count is missing.
    #[error("{0} needs one value in brackets")]
    FlowValue(&'static str),
    /// The other end of a loop, condition or subroutine is not there.
    #[error("o{label} {keyword} has no {wanted}")]
    FlowEnd {
        /// Its number or name.
        label: String,
        /// What is there.
        keyword: &'static str,
        /// What is missing.
        wanted: &'static str,
    },
    /// A subroutine that is nowhere.
    #[error("there is no subroutine {label}: neither in this program nor as {label}.ngc beside it")]
    NoSubroutine {
        /// Number or name.
        label: String,
    },
    /// Subroutines that call each other without end.
    #[error("more than {0} subroutines inside each other")]
    CallDepth(usize),
    /// A loop without an end.
    #[error("loops and subroutines have run more than {0} lines again: the program does not seem to end")]
    Endless(u64),
    /// A loop in which nothing changes.
    #[error("the loop {0} never ends: nothing is set in it that its conditions depend on")]
    SameAgain(String),
    /// In a file with a subroutine.
    #[error("in {file}: {problem}")]
    InFile {
        /// Name of the file.
        file: String,
        /// What is wrong there.
        problem: Box<Problem>,
    },
    /// The main program has gone on into a subroutine, to its M99.
    #[error(
        "the main program goes on into this subroutine, whose M99 would repeat it for ever: write M2 before the O word"
    )]
    EndlessProgram,
    /// The position is needed where the program does not say it.
    #[error("where the tip is here is not known: write a G0 with X Y Z and all rotary axes before")]
    UnknownPosition,
    /// An axis-code that takes the axis words, and a motion.
    #[error("{0} takes the axis words of its block: write the motion in a block of its own")]
    AxesTaken(&'static str),
    /// An arc in a plane whose axes have unlike factors.
    #[error("an arc needs the same factor of SCALE for both axes of its plane: with these it is an ellipse")]
    StretchedArc,
    /// What is not possible in this mode.
    #[error("{code}: {why}")]
    Impossible {
        /// The code.
        code: &'static str,
        /// Why, and what to do.
        why: &'static str,
    },
    /// A number that is out of all proportion.
    #[error("the number of {0} has more than nine digits before the point: correct it")]
    TooLarge(String),
    /// `/` not at the start of a line.
    #[error("block delete must be at the start of the line")]
    DeleteInside,
    /// N not at the start of a block, or not a whole number.
    #[error("a block number is a whole number at the start of the line")]
    BlockNumber,
    /// A word of another dialect.
    #[error("{0} is not understood")]
    UnknownWord(String),
    /// An R parameter that there is not.
    #[error("R{0} is no parameter: they are R0 to R299")]
    SiemensNumber(String),
    /// R1= beside words.
    #[error("R parameters are set in blocks of their own: write the words of this one in the next")]
    SiemensAlone,
    /// A value of the controller.
    #[error("variables of the controller that begin with $ are not known here: write their value")]
    SystemVariable,
    /// A text where a number is wanted.
    #[error("this is a text, where a number is wanted")]
    TextValue,
    /// An operator of truths beside a comparison.
    #[error(
        "AND, OR, XOR and NOT bind before comparisons on these controllers: write brackets around each comparison"
    )]
    ComparisonBrackets,
    /// MOD of a negative number.
    #[error("MOD of negative numbers is read differently by controllers: use positive ones")]
    NegativeRemainder,
    /// An index that no array has.
    #[error("{0} is no index or size of an array: they are whole, from 0, and up to 10000")]
    ArrayIndex(f64),
    /// DO of a macro without its number.
    #[error("WHILE [ ] DO has the number of its loop behind it: DO1, DO2 or DO3")]
    MacroLoop,
    /// THEN of a macro with something else than a parameter.
    #[error("THEN has a parameter that is set behind it, in the same line: IF [#1 EQ 5] THEN #2=1")]
    MacroThen,
    /// FOR without its counter.
    #[error("FOR needs a variable with its first and its last value: FOR NAME=1 TO 5")]
    NoCounter,
    /// More in the line of a statement.
    #[error("nothing else may stand in the line of this statement")]
    StatementRest,
    /// The other end of a structure of Siemens is not there.
    #[error("{keyword} has no {wanted}")]
    StructureEnd {
        /// What is there.
        keyword: &'static str,
        /// What is missing.
        wanted: &'static str,
    },
    /// A jump without a target.
    #[error("a jump needs a label of two characters or more, or a block number: GOTOF NAME, GOTOB N100")]
    NoTarget,
    /// The target of a jump is not there.
    #[error("{0} is not in this program, or not in the direction of the jump")]
    NoLabel(String),
    /// A jump into a structure.
    #[error("a jump must not lead into a loop or condition, nor out of those of O words")]
    JumpInside,
    /// A count of passes.
    #[error("P{0} is not possible: a subprogram or part is run 0 to 9999 times")]
    Passes(f64),
    /// A subprogram that is nowhere.
    #[error(
        "{0} is not understood: there is no such word, and no subprogram {0}, neither in this program nor as {0}.SPF beside it"
    )]
    NoSubprogram(String),
    /// MCALL of something else than a drilling cycle.
    #[error(
        "MCALL {0}: only CYCLE81, CYCLE82, CYCLE83, CYCLE85, CYCLE87, CYCLE88 and CYCLE89 are called after motions"
    )]
    ModalCall(String),
    /// More arguments than a subprogram has.
    #[error("the subprogram takes {most} arguments by its PROC, and {given} are given")]
    Arguments {
        /// In the call.
        given: usize,
        /// By PROC.
        most: usize,
    },
    /// MSG without its text.
    #[error("MSG has a text in quotes and brackets: MSG(\"text\")")]
    NoMessage,
    /// A direction of the tool of length 0.
    #[error(
        "the direction of the tool is zero: it leads from the tip to the machine, with at least one component"
    )]
    NoDirection,
    /// A direction of the tool that the machine does not realise.
    #[error("the tool cannot point along X{} Y{} Z{}: {why}", direction[0], direction[1], direction[2])]
    Unreachable {
        /// Unit vector in the frame of the work, rounded.
        direction: [f64; 3],
        /// What is in the way, and what to do.
        why: String,
    },
    /// A G or M code of another dialect.
    #[error("{letter}{number} is not understood{}", if *letter == 'M' && number.fract() == 0.0 && *number <= 9999.0 { ": it is a function of another machine, so list it under passed_over in [program] of the machine file if it may be left out, or switch an output with M62 to M65" } else { "" })]
    UnknownCode {
        /// G or M.
        letter: char,
        /// Its number.
        number: f64,
    },
    /// The same word twice in a block.
    #[error("{0} occurs twice in this block")]
    Twice(String),
    /// Two codes of one modal group in a block.
    #[error("{first} and {second} exclude each other in one block")]
    ModalGroup {
        /// First code.
        first: &'static str,
        /// Second code.
        second: &'static str,
    },
    /// A word that belongs to a code that is not in the block.
    #[error("{0} belongs to no code of this block: leave it out, or write it beside the code that it is for")]
    Orphan(String),
    /// A word that could belong to two codes.
    #[error("{word} could belong to {first} or to {second}: write them in two blocks")]
    Ambiguous {
        /// The word.
        word: String,
        /// First code.
        first: &'static str,
        /// Second code.
        second: &'static str,
    },
    /// A code without a word it needs.
    #[error("{code} needs {word}")]
    Missing {
        /// The code.
        code: &'static str,
        /// The word.
        word: &'static str,
    },
    /// A word with a value it cannot have.
    #[error("{word}{value} is not possible: {reason}")]
    Value {
        /// The word.
        word: String,
        /// Its value.
        value: f64,
        /// What is possible.
        reason: &'static str,
    },
    /// Axis words without G0, G1, G2 or G3.
    #[error("axis words without a motion: G0, G1, G2, G3, G5.2 or G6.2 must come first, also after a NURBS")]
    NoMotion,
    /// Motion without tool centre point control.
    #[error("G43.4 must come before the first motion of the tip: X Y Z are its coordinates")]
    NotTip,
    /// G53 with a feed.
    #[error("G53 moves axes with G0 only: write G53 G0")]
    AxesNeedRapid,
    /// M62 or M64 for a motion in axis space.
    #[error("{0} cannot take effect with G53: in axis space beams and tracking stay off")]
    OnInAxes(&'static str),
    /// An arc with centre and radius.
    #[error("an arc has a centre (I J K) or a radius (R), not both")]
    CentreAndRadius,
    /// I, J or K of the axis that the arc goes about.
    #[error("{word} is not in the plane of {plane}, where the centre has {words}")]
    OffPlane {
        /// The word.
        word: String,
        /// G17, G18 or G19.
        plane: &'static str,
        /// The words of that plane.
        words: &'static str,
    },
    /// A feed motion without F.
    #[error(
        "{0} needs a feed: no F was given, or none since G94; write F, or feed_mm_min in [program] of the machine file"
    )]
    NoFeed(&'static str),
    /// A feed motion with G93 and without F.
    #[error("with G93 every block that feeds has its own F: 1 / (minutes that {0} takes)")]
    NoInverseTime(&'static str),
    /// F with G93 in a block that does not feed.
    #[error("with G93 F means the time of its own block, and this one does not feed: leave F out")]
    InverseTimeAlone,
    /// G4, M62, M63 or M67 without a motion after it.
    #[error("{0} has no motion after it with which it could take effect")]
    NoMotionAfter(&'static str),
    /// G5.3 or G6.3 without a curve to close.
    #[error("{0} has no NURBS to close")]
    NothingToClose(&'static str),
    /// Another code among control points.
    #[error("the {open} of line {line} is not complete: it takes control points up to {close}")]
    NurbsOpen {
        /// G5.2 or G6.2.
        open: &'static str,
        /// Its line.
        line: u32,
        /// What closes it.
        close: &'static str,
    },
    /// A word among control points that does not belong to them.
    #[error("{word} does not belong to {code}: write it in the block that opens the NURBS, or after it")]
    NotInNurbs {
        /// The word.
        word: String,
        /// Where it stands.
        code: &'static str,
    },
    /// Z in G5.2.
    #[error("G5.2 lies in the XY plane: write a NURBS in space with G6.2")]
    FlatNurbs,
    /// G5.2 in another plane.
    #[error("G5.2 lies in the XY plane: select it with G17")]
    NurbsPlane,
    /// A rotary axis or slide before the last control point.
    #[error(
        "{word} belongs to the last control point: rotary axes and slides go evenly from end to end of a NURBS"
    )]
    TurnInside {
        /// The word.
        word: String,
    },
    /// Not enough control points.
    #[error("a NURBS of order {order} needs at least {order} control points, this one has {points}")]
    FewPoints {
        /// Control points.
        points: usize,
        /// Order.
        order: usize,
    },
    /// Not enough knots.
    #[error(
        "a NURBS of order {order} with {points} control points has {} knots, not {knots}: {order} blocks with K \
         alone follow the last point",
        points + order
    )]
    FewKnots {
        /// Knots.
        knots: usize,
        /// Control points.
        points: usize,
        /// Order.
        order: usize,
    },
    /// A control point after a knot on its own.
    #[error("after a knot on its own no control point can follow")]
    PointAfterKnots,
}

impl Problem {
    /// This problem at `place`.
    pub(super) fn at(self, place: SourcePosition) -> NcError {
        NcError { place, problem: self }
    }
}
