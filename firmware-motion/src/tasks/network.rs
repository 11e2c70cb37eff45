//! The network task: requests of the PC, path states to the tracker board, telemetry to the PC.

use super::{Controller, OutboxReader};
use crate::board;
use link::{Address, Counters, Link, Node, Source, Storage};
use rtic::Mutex;
use shared::protocol::{
    Batch, Datagram, Identity, MotionSample, MotionTelemetry, PathState, Request, Response, Role,
};

/// Everything the network task owns.
pub struct Network {
    link: Link<'static>,
    device: board::Network,
    outbox: OutboxReader,
    tracker: Option<Source>,
    telemetry: Batch<MotionSample>,
}

impl Network {
    /// Listens at the board's address.
    pub fn new(
        mut device: board::Network,
        storage: &'static mut Storage<'static>,
        outbox: OutboxReader,
    ) -> Self {
        let address = Address {
            mac: device.mac(),
            ip: board::motion::ADDRESS,
            prefix: board::motion::PREFIX,
            gateway: board::motion::GATEWAY,
        };
        let identity = Identity::new(
            Role::Motion,
            env!("CARGO_PKG_VERSION"),
            board::NAME,
            board::SIMULATED_MACHINE,
        );
        Self {
            link: Link::new(&mut device, storage, address, identity, board::now_us()),
            device,
            outbox,
            tracker: None,
            telemetry: Batch::default(),
        }
    }

    /// Serves everything that waits; true if frames may be left.
    pub fn run(&mut self, controller: &mut impl Mutex<T = &'static mut Controller>) -> bool {
        self.device.acknowledge();
        self.publish();
        let mut proxy = Proxy {
            controller,
            tracker: &mut self.tracker,
        };
        self.link.poll(
            &mut self.device,
            board::Network::last_arrival_us,
            board::now_us,
            &mut proxy,
        )
    }

    /// Sends what the path ticks published since the last run.
    fn publish(&mut self) {
        while let Some((path_state, sample)) = self.outbox.dequeue() {
            if let Some(tracker) = self.tracker {
                let path_state = PathState {
                    sent_us: board::now_us(),
                    ..path_state
                };
                self.link.send(&Datagram::PathState(path_state), tracker);
                self.link.flush(&mut self.device, board::now_us());
            }
            if let Some((samples, subscriber)) = self.telemetry.push(sample).zip(self.link.subscriber()) {
                let telemetry = Datagram::MotionTelemetry(MotionTelemetry { samples });
                self.link.send(&telemetry, subscriber);
            }
        }
    }
}

/// The controller behind its lock, as the link wants to see it.
struct Proxy<'a, M> {
    controller: &'a mut M,
    tracker: &'a mut Option<Source>,
}

impl<M: Mutex<T = &'static mut Controller>> Node for Proxy<'_, M> {
    fn handle(&mut self, request: &Request, counters: &Counters) -> Response {
        if let Request::PathStatesTo { address, port } = request {
            *self.tracker = Some(Source {
                address: *address,
                port: *port,
            });
            return Response::Done;
        }
        self.controller
            .lock(|controller| controller.handle(request, counters.unsent))
    }

    /// The motion board takes no datagrams but clock requests, which the link answers.
    fn datagram(&mut self, _: &Datagram, _: Source, _: u64) {}
}
