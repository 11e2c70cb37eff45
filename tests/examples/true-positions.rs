//! Digests of the true positions that the shipped job of every machine leaves on simulated boards, to show
//! whether a change of the PC's programs changes what machines do: `true-positions` before it and after it
//! has to print the same.

use config::machine::JointForm;
use host_link::boards::{Boards, LinkError};
use host_link::pass_on;
use report::Ended;
use shared::protocol::{Datagram, Role};
use std::time::Duration;
use system_tests::{JOBS, shipped_seam, weld, weld_job, weld_through_pictures};
use world::SceneFile;
use world::simulated::SimulatedBoards;

/// Speed of the seam welds \[m/min\].
const SPEED: f64 = 5.0;

fn main() {
    for (machine, job) in JOBS {
        digest(job, SimulatedBoards::new(machine).expect("a plant"), |boards| {
            weld_job(boards, machine, job)
        });
    }
    digest("t-seam-400 by geometry", SimulatedBoards::default(), |boards| {
        weld(boards, shipped_seam(), SPEED)
    });
    digest(
        "t-seam-400 through pictures",
        SimulatedBoards::default(),
        |boards| weld_through_pictures(boards, JointForm::Gap, SceneFile::default(), SPEED),
    );
}

fn digest(job: &str, boards: SimulatedBoards, weld: impl FnOnce(&mut dyn Boards) -> Ended) {
    let mut listened = Listened {
        boards,
        samples: 0,
        digest: Fnv::default(),
    };
    let ended = weld(&mut listened);
    assert!(ended.error.is_none(), "{job}: {:?}", ended.error);
    println!("{:016x} {:7} samples  {job}", listened.digest.0, listened.samples);
}

/// Simulated boards, and what the true positions in their telemetry come to.
struct Listened {
    boards: SimulatedBoards,
    samples: u32,
    digest: Fnv,
}

impl Boards for Listened {
    pass_on!(boards: request, send, now, identity, path_states_target);

    fn receive(&mut self, timeout: Duration) -> Result<Option<(Role, Datagram)>, LinkError> {
        let received = self.boards.receive(timeout)?;
        match &received {
            Some((_, Datagram::MotionTelemetry(telemetry))) => {
                for sample in &telemetry.samples {
                    self.take(sample.time_us, &sample.truth.expect("a simulated machine"));
                }
            }
            Some((_, Datagram::TrackerTelemetry(telemetry))) => {
                for sample in &telemetry.samples {
                    self.take(sample.time_us, &sample.truth_mm.expect("a simulated machine"));
                }
            }
            _ => {}
        }
        Ok(received)
    }
}

impl Listened {
    fn take(&mut self, time_us: u64, positions: &[f64]) {
        self.samples += 1;
        self.digest.add(time_us);
        positions
            .iter()
            .for_each(|position| self.digest.add(position.to_bits()));
    }
}

/// FNV-1a of 64 bits.
struct Fnv(u64);

impl Default for Fnv {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Fnv {
    fn add(&mut self, value: u64) {
        for byte in value.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }
}
