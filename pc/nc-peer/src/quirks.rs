//! Differences that are none of ours, by the name of the program and with the reason.

/// Ends of paths of programs whose comparison means nothing, and why.
const QUIRKS: [(&str, &str); 2] = [("x-trim.ngc", GOES_BACK), ("smartprobe.ngc", GOES_BACK)];

const GOES_BACK: &str = "the stand-in for a machine goes back by 0.254 mm after a probe, and the program does not say all of where it goes then";

/// Why a program is not compared, if it is not.
pub fn reason(program: &str) -> Option<&'static str> {
    let found = QUIRKS.iter().find(|(name, _)| program.ends_with(name));
    found.map(|(_, reason)| *reason)
}
