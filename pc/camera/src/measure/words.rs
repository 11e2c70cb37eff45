//! Explanations of measurements in words.

use vision::{Criterion, Doubt, Measured, Report, State, Status};

/// Quality from which a measurement is used.
pub const NEEDED: f64 = 0.5;

/// A status in a word or two.
pub fn status(status: Status) -> &'static str {
    match status {
        Status::Seam => "seam",
        Status::Dark => "dark",
        Status::Overexposed => "overexposed",
        Status::TooHigh => "too high",
        Status::TooLow => "too low",
        Status::NoBand => "no band",
        Status::NoSeam => "no seam",
        Status::Ambiguous => "ambiguous",
    }
}

/// Why a picture is of no use; nothing of one that is.
pub fn why(report: &Report) -> Option<String> {
    let plain = match report.status {
        Status::Seam => return None,
        Status::Dark => "most pixels are nearly black: the light is off, or no work lies before the camera",
        Status::Overexposed => "much of the picture is saturated: less light or a shorter exposure",
        Status::TooHigh => {
            "no sharp band; the work is probably higher than the picture reaches: move the camera away from it"
        }
        Status::TooLow => {
            "no sharp band; the work is probably lower than the picture reaches: move the camera towards it"
        }
        Status::NoBand => "nothing in the picture is sharp",
        Status::Ambiguous => "there are two candidates for the seam",
        Status::NoSeam => return Some(report.measured.as_ref().map_or_else(String::new, weakness)),
    };
    Some(plain.to_owned())
}

/// What speaks against a measured seam, with its quality.
fn weakness(measured: &Measured) -> String {
    match measured.weakest {
        Some(weakest) => format!(
            "{} (quality {:.2}, {NEEDED} needed)",
            criterion(weakest),
            measured.quality
        ),
        None => NO_LINE.to_owned(),
    }
}

/// Of a band without anything that may be a seam.
const NO_LINE: &str = "there is a sharp band, but no dark line across it";

/// Why a picture is of no use, without figures.
pub fn reason(report: &Report) -> &'static str {
    match (report.status, report.measured) {
        (Status::Seam, _) => "",
        (Status::Dark, _) => "nearly black: no light, or no work before the camera",
        (Status::TooHigh, _) => "nothing is sharp: work probably too high",
        (Status::TooLow, _) => "nothing is sharp: work probably too low",
        (Status::NoBand, _) => "nothing is sharp",
        (
            Status::NoSeam,
            Some(Measured {
                weakest: Some(weakest),
                ..
            }),
        ) => criterion(weakest),
        (Status::NoSeam, _) => NO_LINE,
        (other, _) => status(other),
    }
}

/// What speaks against a seam whose quality a criterion holds down.
pub fn criterion(weakest: Criterion) -> &'static str {
    match weakest {
        Criterion::Depth => "the line is not dark enough against the plate",
        Criterion::Straightness => "too little of the edges lies on straight lines",
        Criterion::Scatter => "the edges are too rough",
        Criterion::Continuity => {
            "the line does not continue outside the sharp band: is it a spot or a scratch?"
        }
        Criterion::Height => "the height is too uncertain: too little texture?",
        Criterion::Width => "the line is too narrow",
        Criterion::Border => "it is too close to the left or right border",
        Criterion::Band => "the band is too close to the upper or lower border",
        Criterion::Ambiguity => "another candidate is as good",
        Criterion::Lateral => "the position across the seam is too uncertain: too little texture?",
        Criterion::Gain => "the band explains too little of the picture",
        Criterion::Walls => "too little of one wall is in the picture",
        Criterion::Sides => "a plate is lit on one side of the gap only",
        Criterion::Emptiness => "it has a plate's texture: a scratch, a groove or a shadow",
        Criterion::Interior => "the gap is not equally dark: a shadow or spatter beside it?",
    }
}

/// What an observer is doing.
pub fn state(state: State) -> &'static str {
    match state {
        State::Acquiring => "acquiring",
        State::Tracking => "tracking",
        State::Lost => "lost",
    }
}

/// Why an observer does not accept a seam.
pub fn doubt(doubt: Doubt) -> &'static str {
    match doubt {
        Doubt::New => "not accepted yet: three pictures in a row have to agree",
        Doubt::Position => "not accepted: its position differs from that of the seam before",
        Doubt::Height => "not accepted: its height differs from that of the seam before",
        Doubt::Interrupted => "not accepted: the seam was not there, or doubtful, in the pictures before",
        Doubt::Width => "not accepted: its width differs from that of the seam before",
    }
}
