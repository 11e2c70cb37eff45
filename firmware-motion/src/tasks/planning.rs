//! The planning task: plans ahead of the machine, a turn after every path tick on a path.
//!
//! Servo and path ticks interrupt it. What a turn offers is taken at the next path tick, if it has ended until then.

use super::{Controller, Servo, Times};
use crate::board;
use rtic::Mutex;
use shared::kinematics::Kinematics;
use shared::trajectory::{BoardPlanning, BoardPlayer, ELEMENTS, NODES, PlayerAccess};

/// What the planning task owns.
pub struct PlanningTask {
    planning: BoardPlanning,
    /// Of the machine, for the path with this number.
    kinematics: Option<Kinematics>,
    path: u32,
}

impl PlanningTask {
    /// Of no path.
    pub const fn new() -> Self {
        Self {
            planning: BoardPlanning::new(),
            kinematics: None,
            path: 0,
        }
    }

    /// One turn.
    pub fn turn(
        &mut self,
        servo: &mut impl Mutex<T = Servo>,
        controller: &mut impl Mutex<T = &'static mut Controller>,
        times: &mut impl Mutex<T = Times>,
    ) {
        let in_path = times.lock(|times| times.path.span(board::cycles()));
        let in_servo = servo.lock(|servo| servo.time.span(board::cycles()));
        let path = controller.lock(|controller| controller.player().path());
        if path != self.path {
            self.path = path;
            self.kinematics = controller.lock(|controller| controller.kinematics().cloned());
        }
        if let Some(kinematics) = &self.kinematics {
            self.planning.turn(&mut Locked(controller), kinematics);
        }
        let end = board::cycles();
        let servo_ticks = servo.lock(|servo| servo.time.since(in_servo));
        times.lock(|times| {
            let took = times.path.without(in_path, end).saturating_sub(servo_ticks);
            times.planning.add_net(took);
        });
    }
}

/// The player of the controller, behind its lock.
struct Locked<'a, M>(&'a mut M);

impl<M: Mutex<T = &'static mut Controller>> PlayerAccess<ELEMENTS, NODES> for Locked<'_, M> {
    fn with<R>(&mut self, use_it: impl FnOnce(&mut BoardPlayer) -> R) -> R {
        self.0.lock(|controller| use_it(controller.player()))
    }
}
