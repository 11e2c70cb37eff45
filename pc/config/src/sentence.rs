//! Errors, as they are told to a person.

use std::error::Error;

/// An error and its causes in one line; a cause that its effect has already quoted is not said again.
pub fn sentence(error: &(dyn Error + 'static)) -> String {
    let mut text = String::new();
    let mut cause = Some(error);
    while let Some(error) = cause {
        let said = error.to_string();
        if !text.contains(&said) {
            if !text.is_empty() {
                text.push_str(": ");
            }
            text.push_str(&said);
        }
        cause = error.source();
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine::MachineFile;
    use std::path::Path;

    #[test]
    fn a_cause_is_said_once() {
        let error = MachineFile::read(Path::new("none.toml")).unwrap_err();
        let text = sentence(&error);
        assert!(text.starts_with("cannot read machine file none.toml: "), "{text}");
        assert_eq!(text.matches("os error").count(), 1, "{text}");
    }
}
