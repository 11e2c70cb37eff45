//! Which boards a program uses, and how it connects to them.

use crate::emulated::{self, BoardsError};
use crate::simulated::SimulatedBoards;
use emulator::{SESSION_VARIABLE, Session};
use host_link::boards::{Boards, Endpoint, NetworkBoards, Timeouts};
use plant_file::PlantChoice;
use std::path::Path;
use std::str::FromStr;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Largest number of wrong letters in a misspelt word.
const NEAR: usize = 2;

/// Which boards.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum BoardChoice {
    /// Of `cargo xtask emulate` or `cargo xtask weld`.
    Emulated,
    /// In this program.
    Simulated,
    /// In the network.
    At {
        /// Address of the motion board.
        motion: String,
        /// Address of the tracker board, if there is one.
        tracker: Option<String>,
    },
}

impl FromStr for BoardChoice {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let (motion, tracker) = match text.split_once(',') {
            Some((motion, tracker)) => (motion, Some(tracker)),
            None => (text, None),
        };
        match text {
            "emulated" => Ok(Self::Emulated),
            "simulated" => Ok(Self::Simulated),
            _ if motion.is_empty() || tracker == Some("") || is_meant(text) => {
                Err("must be emulated, simulated, or the addresses MOTION,TRACKER (MOTION without a tracker)")
            }
            _ => Ok(Self::At {
                motion: motion.to_owned(),
                tracker: tracker.map(str::to_owned),
            }),
        }
    }
}

/// Whether it is nearly one of the words, and no board's name.
fn is_meant(text: &str) -> bool {
    let text = text.to_lowercase();
    let near = |word| strsim::damerau_levenshtein(&text, word) <= NEAR;
    ["emulated", "simulated"].into_iter().any(near)
}

impl BoardChoice {
    /// What the report calls it.
    pub fn name(&self) -> String {
        match self {
            Self::Emulated => "emulated".to_owned(),
            Self::Simulated => "simulated".to_owned(),
            Self::At {
                motion,
                tracker: None,
            } => motion.clone(),
            Self::At {
                motion,
                tracker: Some(tracker),
            } => format!("{motion},{tracker}"),
        }
    }

    /// Connects; simulated boards become the machine whose kinematics are `wanted`, emulated ones must have been
    /// booted as it, and with the same `plant`. The tracker board is left alone unless the machine is `tracked`.
    /// The time of simulated ones does not run ahead of the clock's times `pace`, if that is told. `interrupted` stops the machine.
    ///
    /// # Errors
    /// [`BoardsError`]: there are none, they are another machine's, or they do not answer.
    pub fn connect(
        &self,
        wanted: &'static str,
        plant: &PlantChoice,
        tracked: bool,
        pace: Option<f64>,
        interrupted: Arc<AtomicBool>,
    ) -> Result<Box<dyn Boards + Send>, BoardsError> {
        let patience = Timeouts::default();
        match self {
            Self::Simulated => {
                let boards = SimulatedBoards::wired_to(&plant.of(wanted)?);
                Ok(Box::new(match pace {
                    Some(pace) => boards.at_pace(pace),
                    None => boards,
                }))
            }
            Self::At { motion, tracker } => {
                let motion = Endpoint::board(motion);
                let tracker = tracker.as_deref().map(Endpoint::board);
                let boards = NetworkBoards::connect(&motion, tracker.as_ref(), None, patience)?;
                Ok(Box::new(boards.stopped_by(interrupted)))
            }
            Self::Emulated if cfg!(not(target_os = "linux")) => Err(BoardsError::NeedsLinux),
            Self::Emulated => {
                let path = std::env::var_os(SESSION_VARIABLE).ok_or(BoardsError::NoEmulator)?;
                let session = Session::read(Path::new(&path))?;
                if session.machine != wanted {
                    let wired = session.machine;
                    return Err(BoardsError::WrongMachine { wired, wanted });
                }
                if session.plant != plant.to_string() {
                    return Err(BoardsError::WrongPlant {
                        wired: session.plant,
                        wanted: plant.to_string(),
                    });
                }
                let boards = emulated::connect(&session, tracked, patience)?;
                Ok(Box::new(boards.stopped_by(interrupted)))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boards_are_chosen_by_word_or_by_address() {
        assert_eq!("emulated".parse(), Ok(BoardChoice::Emulated));
        assert_eq!("simulated".parse(), Ok(BoardChoice::Simulated));
        let two = "192.168.7.10,192.168.7.11".parse::<BoardChoice>().unwrap();
        assert_eq!(two.name(), "192.168.7.10,192.168.7.11");
        let one = "192.168.7.10".parse::<BoardChoice>().unwrap();
        assert_eq!(one.name(), "192.168.7.10");
        for wrong in ["", "192.168.7.10,", ",x", "simulatd", "Simulated", "emulator"] {
            let said = wrong.parse::<BoardChoice>().unwrap_err();
            assert!(said.starts_with("must be emulated, simulated, or"), "{wrong}");
        }
        assert!("gantry-motion".parse::<BoardChoice>().is_ok());
    }
}
