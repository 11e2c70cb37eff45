//! The network task: requests of the PC, path states to the tracker board and its permits, telemetry to the PC.

use super::{Controller, OutboxReader, Servo};
use crate::board;
use link::{Address, Buffers, Counters, Link, Node, Partner, Source, Storage};
use rtic::Mutex;
use shared::motion::{ControllerAccess, answer};
use shared::protocol::{
    Batch, Datagram, Identity, MotionSample, MotionTelemetry, PathState, Request, Response, Role,
};

/// Everything the network task owns.
pub struct Network {
    link: Link<'static>,
    device: board::Network,
    outbox: OutboxReader,
    telemetry: Batch<MotionSample>,
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
            link: Link::new(&mut device, storage, buffers, address, identity, board::now_us()),
            device,
            outbox,
            telemetry: Batch::default(),
        }
    }

    /// Serves everything that waits; true if frames may be left.
    pub fn run(
        &mut self,
        controller: &mut impl Mutex<T = &'static mut Controller>,
        servo: &mut impl Mutex<T = Servo>,
    ) -> bool {
        self.device.acknowledge();
        self.publish();
        let mut proxy = Proxy {
            controller,
            servo,
            tracker: None,
        };
        let more = self.link.poll(
            &mut self.device,
            board::Network::last_arrival_us,
            board::now_us,
            &mut proxy,
        );
        if let Some(tracker) = proxy.tracker {
            self.link.set_partner(tracker);
        }
        more
    }

    /// Sends what the path ticks published since the last run.
    fn publish(&mut self) {
        while let Some((path_state, sample)) = self.outbox.dequeue() {
            let path_state = PathState {
                sent_us: board::now_us(),
                ..path_state
            };
            self.link.send_to_partner(&Datagram::PathState(path_state));
            self.link.flush(&mut self.device, board::now_us());
            if let Some(samples) = self.telemetry.push(sample) {
                let telemetry = Datagram::MotionTelemetry(MotionTelemetry { samples });
                self.link.send_to_pc(&telemetry);
            }
        }
    }
}

/// The controller and the servo loops behind their locks, as the link wants to see them.
struct Proxy<'a, M, S> {
    controller: &'a mut M,
    servo: &'a mut S,
    /// Told by the PC in this run.
    tracker: Option<Partner>,
}

impl<M: Mutex<T = &'static mut Controller>, S> ControllerAccess for Proxy<'_, M, S> {
    fn with<R>(&mut self, use_it: impl FnOnce(&mut Controller) -> R) -> R {
        self.controller.lock(|controller| use_it(controller))
    }
}

impl<M: Mutex<T = &'static mut Controller>, S: Mutex<T = Servo>> Node for Proxy<'_, M, S> {
    fn handle(&mut self, request: &Request, counters: &Counters) -> Response {
        if let Request::PathStatesTo {
            address,
            port,
            session,
        } = request
        {
            self.tracker = Some(Partner {
                source: Source {
                    address: *address,
                    port: *port,
                },
                session: *session,
            });
            return Response::Done;
        }
        answer(self, request, counters.unsent)
    }

    /// Permits of the tracker; they take effect at the next servo tick.
    fn datagram(&mut self, datagram: &Datagram, _: Source, arrived_us: u64) {
        let lease = self
            .controller
            .lock(|controller| controller.datagram(datagram, arrived_us));
        if let Some(lease) = lease {
            self.servo.lock(|servo| servo.loops.renew(lease));
        }
    }

    fn session_ended(&mut self) {
        self.controller.lock(|controller| controller.session_ended());
    }
}
