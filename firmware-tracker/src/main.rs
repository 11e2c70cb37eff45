//! Firmware of the tracker board. This file is the timetable: who runs when, and what is shared with whom.
//!
//! | task | runs at | priority | body |
//! |---|---|---|---|
//! | `control_tick` | 1 kHz | 3 | [`tasks::control`]: slides → seam, plan or rest → drives; strobes |
//! | `network` | frames, and every ms | 1 | [`tasks::network`]: requests, path states, captures, measurements, telemetry |
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
    use crate::board::{self, Tick, Watchdog, tracker::Slides};
    use crate::tasks::{self, Alive, Controller, Network, Outbox, Published};
    use heapless::spsc::Queue;

    #[shared]
    struct Shared {
        /// State machine, map and control law; a request or a datagram locks it for one step.
        controller: &'static mut Controller,
        /// Whether the network task lives.
        alive: Alive,
    }

    #[local]
    struct Local {
        slides: Slides,
        tick: Tick,
        watchdog: Watchdog,
        outbox: Outbox,
        network: Network,
    }

    #[init(local = [
        controller: Controller = Controller::new(),
        storage: link::Storage<'static> = link::Storage::new(),
        buffers: link::Buffers = link::Buffers::new(),
        queue: Queue<Published, 16> = Queue::new(),
    ])]
    fn init(cx: init::Context) -> (Shared, Local) {
        let board = board::tracker::init(cx.core);
        let (outbox, reader) = cx.local.queue.split();
        let network = Network::new(board.network, cx.local.storage, cx.local.buffers, reader);
        defmt::info!(
            "tracker board {} with firmware {}",
            board::NAME,
            env!("CARGO_PKG_VERSION")
        );
        let shared = Shared {
            controller: cx.local.controller,
            alive: tasks::ALIVE_SUPERVISION,
        };
        let local = Local {
            slides: board.slides,
            tick: board.tick,
            watchdog: board.watchdog,
            outbox,
            network,
        };
        (shared, local)
    }

    #[task(binds = CONTROL_TICK, priority = 3, shared = [controller, alive], local = [tick, slides, watchdog, outbox])]
    fn control_tick(mut cx: control_tick::Context) {
        let periods = cx.local.tick.acknowledge();
        let began_us = cx.local.tick.began_us();
        let published = cx
            .shared
            .controller
            .lock(|controller| tasks::control::tick(controller, cx.local.slides, began_us, periods));
        if cx.local.outbox.enqueue(published).is_err() {
            defmt::warn!("the network task does not keep up: a sample was dropped");
        }
        if cx.shared.alive.lock(Alive::tick) {
            cx.local.watchdog.feed();
        }
        rtic::pend(board::device::Interrupt::ETHERNET);
    }

    #[task(binds = ETHERNET, priority = 1, shared = [controller, alive], local = [network])]
    fn network(mut cx: network::Context) {
        if cx.local.network.run(&mut cx.shared.controller) {
            rtic::pend(board::device::Interrupt::ETHERNET);
        }
        cx.shared.alive.lock(|alive| alive.seen(tasks::NETWORK_TASK));
    }

    #[idle]
    fn idle(_: idle::Context) -> ! {
        loop {
            board::idle();
        }
    }
}
