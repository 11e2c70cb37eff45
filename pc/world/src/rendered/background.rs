//! A camera that renders on a thread of its own, so that the thread that measures does nothing but measure.

use camera::{Arrival, Camera, CameraError, Picture};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, TryRecvError, channel};
use std::thread::JoinHandle;
use std::time::Duration;

/// How long the camera is waited for before new strobes are looked for.
const PATIENCE: Duration = Duration::from_millis(2);
/// Niceness of the thread: emulated boards on this computer may not be late, and pictures are waited for.
#[cfg(target_os = "linux")]
const NICENESS: i32 = 10;

/// Number of a capture and the time of its strobe \[µs\].
type Strobe = (u32, u64);
type Answer = Result<(Arrival, Picture), CameraError>;

/// The near end of a camera on another thread.
pub(super) struct Background {
    strobes: Option<Sender<Strobe>>,
    answers: Receiver<Answer>,
    thread: Option<JoinHandle<()>>,
}

impl Background {
    /// Starts the thread.
    pub fn start(mut camera: Box<dyn Camera>) -> Self {
        let (strobes, strobed) = channel();
        let (answer, answers) = channel();
        let thread = std::thread::spawn(move || {
            // Where that is not granted the thread goes on as it is.
            #[cfg(target_os = "linux")]
            let _ = rustix::process::setpriority_process(None, NICENESS);
            run(camera.as_mut(), &strobed, &answer);
        });
        Self {
            strobes: Some(strobes),
            answers,
            thread: Some(thread),
        }
    }
}

/// Goes on until nobody strobes or listens any more, or the camera fails.
fn run(camera: &mut dyn Camera, strobes: &Receiver<Strobe>, answers: &Sender<Answer>) {
    let mut unanswered = 0_u32;
    loop {
        let strobe = if unanswered == 0 {
            strobes.recv().map_err(|_| TryRecvError::Disconnected)
        } else {
            strobes.try_recv()
        };
        match strobe {
            Ok((capture, time_us)) => {
                camera.strobed(capture, time_us);
                unanswered += 1;
            }
            Err(TryRecvError::Empty) => {}
            Err(TryRecvError::Disconnected) => return,
        }
        let mut picture = Picture::default();
        let answer = match camera.next(PATIENCE, &mut picture) {
            Ok(Arrival::Nothing) => continue,
            Ok(arrival) => Ok((arrival, picture)),
            Err(error) => Err(error),
        };
        unanswered -= 1;
        let failed = answer.is_err();
        if answers.send(answer).is_err() || failed {
            return;
        }
    }
}

impl Camera for Background {
    fn strobed(&mut self, capture: u32, time_us: u64) {
        if let Some(strobes) = &self.strobes {
            // The error of a camera that failed is the next answer.
            let _ = strobes.send((capture, time_us));
        }
    }

    fn next(&mut self, timeout: Duration, picture: &mut Picture) -> Result<Arrival, CameraError> {
        match self.answers.recv_timeout(timeout) {
            Ok(Ok((Arrival::Picture, rendered))) => {
                *picture = rendered;
                Ok(Arrival::Picture)
            }
            Ok(Ok((arrival, _))) => Ok(arrival),
            Ok(Err(error)) => Err(error),
            Err(RecvTimeoutError::Timeout | RecvTimeoutError::Disconnected) => Ok(Arrival::Nothing),
        }
    }
}

impl Drop for Background {
    fn drop(&mut self) {
        self.strobes = None;
        if let Some(thread) = self.thread.take() {
            // A panic in it was told there.
            drop(thread.join());
        }
    }
}
