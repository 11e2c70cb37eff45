//! The boards' end of the Ethernet: requests on TCP, datagrams on UDP, over any [`smoltcp::phy::Device`].
//!
//! A [`Link`] holds one session with a PC at a time. It does by itself what no firmware should do
//! differently: it compares the schema at [`Request::Hello`](shared::protocol::Request::Hello) and refuses
//! everything before, remembers the subscriber, answers clock requests, counts what goes wrong, gives up
//! sessions whose PC has vanished, and announces the board by ARP until the first session. Everything else
//! goes to a [`Node`].
//!
//! A network task is then a few lines. It runs on the Ethernet interrupt and at least every 10 ms, because
//! retransmissions and keep-alives fall due without a frame:
//!
//! ```
//! use link::{Counters, Link, Node, Source};
//! use shared::protocol::{Datagram, Refusal, Request, Response};
//! use smoltcp::phy::Device;
//!
//! struct Controller {
//!     // …
//! }
//!
//! /// Under RTIC it holds the shared resource and locks it in each of the two functions.
//! struct Proxy<'a>(&'a mut Controller);
//!
//! impl Node for Proxy<'_> {
//!     fn handle(&mut self, request: &Request, counters: &Counters) -> Response {
//!         // self.0.lock(|controller| controller.handle(request, counters.unsent))
//!         # Response::Refused(Refusal::NotMine)
//!     }
//!     fn datagram(&mut self, datagram: &Datagram, from: Source, arrived_us: u64) {
//!         // self.0.lock(|controller| controller.datagram(datagram, arrived_us))
//!     }
//! }
//!
//! /// The network task. `arrived` is the device's `last_arrival_us`, `clock` the board's `now_us`.
//! fn network<D: Device>(
//!     link: &mut Link, device: &mut D, arrived: fn(&D) -> u64, clock: fn() -> u64,
//!     controller: &mut Controller, telemetry: &Datagram,
//! ) {
//!     let more = link.poll(device, arrived, clock, &mut Proxy(controller));
//!     if more {
//!         // pend the Ethernet interrupt again
//!     }
//!     // Whoever sends:
//!     if let Some(subscriber) = link.subscriber() {
//!         link.send(telemetry, subscriber);
//!         link.flush(device, clock());
//!     }
//! }
//! ```
//!
//! At init, with `#[init(local = [storage: link::Storage<'static> = link::Storage::new()])]`, the link is
//! `Link::new(&mut device, cx.local.storage, address, identity, now_us())`.
//!
//! Rules of this crate: no allocation, no logging, no interrupts, no clock of its own.
#![no_std]

mod announce;
mod session;
mod stack;
mod storage;

pub use session::Node;
pub use stack::{Address, Counters, Link, Source};
pub use storage::Storage;
