//! Inputs that programs wait for, as the machine file calls them.

use super::{PathError, Planner};
use nc::{Until, Wait};

impl Planner {
    /// The machine must have every input that is waited for.
    pub(super) fn check_inputs(&self, waits: &[Wait]) -> Result<(), PathError> {
        for wait in waits {
            if let Until::Input { input, .. } | Until::Read { input } = wait.until
                && self.input_name(input).is_none()
            {
                return Err(PathError::NoOutput {
                    place: wait.place,
                    output: format!("input {}", input + 1),
                    machine: self.name.clone(),
                });
            }
        }
        Ok(())
    }

    /// What the machine file calls the input of this number, from 0.
    pub fn input_name(&self, input: u8) -> Option<&str> {
        let mut names = self.input_names.iter();
        names
            .find(|(_, number)| **number == input)
            .map(|(name, _)| name.as_str())
    }
}
