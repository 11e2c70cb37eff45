//! The boards' end of the Ethernet: requests on TCP, datagrams on UDP, over any [`smoltcp::phy::Device`].
//!
//! A [`Link`] holds one session with a PC at a time. It does by itself what no firmware should do
//! differently: it compares the schema at [`Request::Hello`](shared::protocol::Request::Hello) and refuses
//! everything before, gives the session a number and a lease that every request renews, informs the [`Node`]
//! when it ends, takes datagrams of its PC and of the other board only, answers clock requests, counts what
//! goes wrong, and announces the board by ARP until the first session. Everything else goes to the [`Node`].
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
//! /// Under RTIC it holds the shared resource and locks it in each of the functions.
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
//!     fn session_ended(&mut self) {
//!         // self.0.lock(|controller| controller.session_ended())
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
//!     link.send_to_pc(telemetry);
//!     link.flush(device, clock());
//! }
//! ```
//!
//! At init, with `storage: link::Storage<'static> = link::Storage::new()` and `buffers: link::Buffers = link::Buffers::new()` in its
//! `local`, the link is `Link::new(&mut device, cx.local.storage, cx.local.buffers, address, identity, now_us())`.
//!
//! Rules of this crate: no allocation, no logging, no interrupts, no clock of its own.
#![no_std]

mod address;
mod announce;
mod counters;
mod session;
mod stack;
mod storage;

pub use address::{Address, Partner, Source};
pub use counters::Counters;
pub use session::Node;
pub use stack::Link;
pub use storage::{Buffers, Storage};
