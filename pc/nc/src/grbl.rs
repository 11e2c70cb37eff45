//! Lines for a Grbl controller itself that stand in programs, as `$I` and `$32=1`.

use super::error::{NcError, Problem};
use super::scanner::Scanner;

/// Commands that show something or end an alarm: none of them moves an axis or changes what a program means.
const WITHOUT_EFFECT: [&str; 8] = ["?", "$", "$$", "$#", "$G", "$I", "$N", "$X"];

/// Reads a command that may be passed over, before the first motion also the search of the reference marks, which the machine
/// has done when a program begins.
pub(super) fn command(scanner: &mut Scanner, moved: bool) -> Result<String, NcError> {
    let place = scanner.place();
    let text = scanner.take(|c| !matches!(c, ';' | '('));
    let name: String = text.chars().filter(|c| !c.is_whitespace()).collect();
    let name = name.to_ascii_uppercase();
    if WITHOUT_EFFECT.contains(&name.as_str()) || is_setting(&name) || (name == "$H" && !moved) {
        return Ok(name);
    }
    let problem = if name == "$H" {
        Problem::HomeAmidst
    } else {
        Problem::GrblCommand(name)
    };
    Err(problem.at(place))
}

/// `$32=1`.
fn is_setting(name: &str) -> bool {
    let setting = name.strip_prefix('$').and_then(|rest| rest.split_once('='));
    setting.is_some_and(|(number, value)| {
        !number.is_empty() && number.bytes().all(|byte| byte.is_ascii_digit()) && value.parse::<f64>().is_ok()
    })
}
