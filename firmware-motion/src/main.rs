//! Firmware of the motion board. This file is the timetable: who runs when, and what is shared with whom.
//!
//! | task | runs at | priority | body |
//! |---|---|---|---|
//! | `switch` | between two servo ticks | 5 | [`tasks::servo`]: lines that the path switches then |
//! | `servo_tick` | 4 kHz | 4 | [`tasks::servo`]: gratings → PID → drives, trips, beams |
//! | `path_tick` | 1 kHz | 3 | [`tasks::path`]: pose along the path → kinematics → references |
//! | `planning` | after path ticks on a path | 2 | [`tasks::planning`]: a turn of planning ahead |
//! | `network` | frames, and every ms | 1 | [`tasks::network`]: requests, path states, telemetry |
//! | `idle` | else | 0 | waits |
//!
//! The firmware is the same on every board: a feature selects the board crate and nothing else. On the host
//! it compiles to an empty program.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(all(target_os = "none", feature = "mps2-an500"))]
use board_mps2_an500 as board;
#[cfg(all(target_os = "none", feature = "nucleo-h723zg"))]
use board_nucleo_h723zg as board;
#[cfg(all(
    target_os = "none",
    not(any(feature = "mps2-an500", feature = "nucleo-h723zg"))
))]
compile_error!("select a board: --features mps2-an500 or --features nucleo-h723zg");

#[cfg(target_os = "none")]
mod tasks;

#[cfg(not(target_os = "none"))]
fn main() {}

// RTIC's expansion declares its interrupt handlers with unsafe code; the bodies are safe.
#[cfg(target_os = "none")]
#[allow(unsafe_code)]
#[rtic::app(device = crate::board::device, peripherals = false)]
mod app {
    use crate::board::{
        self, Tick, Watchdog,
        motion::{Axes, ProcessLines},
    };
    use crate::tasks::{self, Controller, Network, PathTask, PlanningTask, Published, Servo};
    use heapless::spsc::Queue;

    #[shared]
    struct Shared {
        /// Servo loops, and who is alive; the servo tick has the last word.
        servo: Servo,
        /// Gates and digital outputs.
        lines: ProcessLines,
        /// State machine, path, homing; a request locks it for one step.
        controller: &'static mut Controller,
        /// What path ticks and turns of planning take.
        times: tasks::Times,
    }

    #[local]
    struct Local {
        axes: Axes,
        servo_tick: Tick,
        watchdog: Watchdog,
        path_tick: Tick,
        path: PathTask,
        planning: &'static mut PlanningTask,
        network: Network,
    }

    #[init(local = [
        controller: Controller = Controller::new(),
        planning_task: PlanningTask = PlanningTask::new(),
        storage: link::Storage<'static> = link::Storage::new(),
        buffers: link::Buffers = link::Buffers::new(),
        queue: Queue<Published, 16> = Queue::new(),
    ])]
    fn init(cx: init::Context) -> (Shared, Local) {
        let board = board::motion::init(cx.core);
        let (outbox, reader) = cx.local.queue.split();
        let network = Network::new(board.network, cx.local.storage, cx.local.buffers, reader);
        defmt::info!(
            "motion board {} with firmware {}",
            board::NAME,
            env!("CARGO_PKG_VERSION")
        );
        let controller = cx.local.controller;
        controller.set_permit_us(board::PERMIT_US);
        let shared = Shared {
            servo: Servo::new(),
            lines: board.lines,
            controller,
            times: tasks::Times::new(),
        };
        let local = Local {
            axes: board.axes,
            servo_tick: board.servo_tick,
            watchdog: board.watchdog,
            path_tick: board.path_tick,
            path: PathTask::new(outbox),
            planning: cx.local.planning_task,
            network,
        };
        (shared, local)
    }

    #[task(binds = SysTick, priority = 5, shared = [lines])]
    fn switch(mut cx: switch::Context) {
        cx.shared.lines.lock(ProcessLines::switch);
    }

    #[task(binds = SERVO_TICK, priority = 4, shared = [servo, lines], local = [axes, watchdog, servo_tick])]
    fn servo_tick(cx: servo_tick::Context) {
        let elapsed = cx.local.servo_tick.acknowledge();
        let began_us = cx.local.servo_tick.began_us();
        let (mut servo, mut lines) = (cx.shared.servo, cx.shared.lines);
        let local = cx.local;
        servo.lock(|servo| {
            tasks::servo::tick(servo, local.axes, &mut lines, local.watchdog, (began_us, elapsed));
        });
    }

    #[task(binds = PATH_TICK, priority = 3, shared = [servo, controller, times], local = [path_tick, path])]
    fn path_tick(mut cx: path_tick::Context) {
        let elapsed = cx.local.path_tick.acknowledge();
        let began_us = cx.local.path_tick.began_us();
        let told = cx.local.path.tick(
            &mut cx.shared.servo,
            &mut cx.shared.controller,
            &mut cx.shared.times,
            began_us,
            elapsed,
        );
        if !told.published {
            defmt::warn!("the network task does not keep up: a path state was dropped");
        }
        if told.plans {
            rtic::pend(board::device::Interrupt::SOFT_0);
        }
        rtic::pend(board::device::Interrupt::ETHERNET);
    }

    #[task(binds = SOFT_0, priority = 2, shared = [servo, controller, times], local = [planning])]
    fn planning(mut cx: planning::Context) {
        cx.local.planning.turn(
            &mut cx.shared.servo,
            &mut cx.shared.controller,
            &mut cx.shared.times,
        );
    }

    #[task(binds = ETHERNET, priority = 1, shared = [servo, controller], local = [network])]
    fn network(mut cx: network::Context) {
        if cx
            .local
            .network
            .run(&mut cx.shared.controller, &mut cx.shared.servo)
        {
            rtic::pend(board::device::Interrupt::ETHERNET);
        }
        cx.shared
            .servo
            .lock(|servo| servo.alive.seen(tasks::NETWORK_TASK));
    }

    #[idle]
    fn idle(_: idle::Context) -> ! {
        loop {
            board::idle();
        }
    }
}
