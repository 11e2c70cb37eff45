//! The network task: requests of the PC, path states of the motion board and permits for it, captures and measurements,
//! telemetry.

use super::{Controller, OutboxReader};
use crate::board;
use link::{Address, Buffers, Counters, Link, Node, Source, Storage};
use rtic::Mutex;
use shared::protocol::{
    Batch, ClockRequest, Datagram, Identity, Request, Response, Role, TrackerSample, TrackerTelemetry,
};

/// Everything the network task owns.
pub struct Network {
    link: Link<'static>,
    device: board::Network,
    outbox: OutboxReader,
    telemetry: Batch<TrackerSample>,
}

impl Network {
    /// Listens at the board's address.
    pub fn new(
        mut device: board::Network,
        storage: &'static mut Storage<'static>,
        buffers: &'static mut Buffers,
        outbox: OutboxReader,
    ) -> Self {
        let address = Address {
            mac: device.mac(),
            ip: board::tracker::ADDRESS,
            prefix: board::tracker::PREFIX,
            gateway: board::tracker::GATEWAY,
        };
        let identity = Identity::new(
            Role::Tracker,
            env!("CARGO_PKG_VERSION"),
            board::NAME,
            board::SIMULATED_MACHINE,
        );
        Self {
            link: Link::new(&mut device, storage, buffers, address, identity, board::now_us()),
            device,
            outbox,
            telemetry: Batch::default(),
        }
    }

    /// Serves everything that waits; true if frames may be left.
    pub fn run(&mut self, controller: &mut impl Mutex<T = &'static mut Controller>) -> bool {
        self.device.acknowledge();
        self.publish(controller);
        self.link.poll(
            &mut self.device,
            board::Network::last_arrival_us,
            board::now_us,
            &mut Proxy { controller },
        )
    }

    /// Sends what the control ticks published since the last run.
    fn publish(&mut self, controller: &mut impl Mutex<T = &'static mut Controller>) {
        while let Some(published) = self.outbox.dequeue() {
            if let Some(permit) = published.permit {
                self.link.send_to_partner(&Datagram::Permit(permit));
            }
            if let Some(capture) = published.capture {
                self.link.send_to_pc(&Datagram::Capture(capture));
            }
            if published.clock_request {
                // The round trip begins now, not at the tick.
                let asked_us = board::now_us();
                controller.lock(|controller| controller.asks_clock(asked_us));
                self.link
                    .send_to_partner(&Datagram::ClockRequest(ClockRequest { asked_us }));
            }
            self.link.flush(&mut self.device, board::now_us());
            if let Some(samples) = self.telemetry.push(published.sample) {
                let telemetry = Datagram::TrackerTelemetry(TrackerTelemetry { samples });
                self.link.send_to_pc(&telemetry);
            }
        }
    }
}

/// The controller behind its lock, as the link wants to see it.
struct Proxy<'a, M> {
    controller: &'a mut M,
}

impl<M: Mutex<T = &'static mut Controller>> Node for Proxy<'_, M> {
    fn handle(&mut self, request: &Request, counters: &Counters) -> Response {
        self.controller
            .lock(|controller| controller.handle(request, counters.unsent))
    }

    fn datagram(&mut self, datagram: &Datagram, _: Source, arrived_us: u64) {
        self.controller
            .lock(|controller| controller.datagram(datagram, arrived_us));
    }

    fn session_ended(&mut self) {
        self.controller.lock(|controller| controller.session_ended());
    }
}
