//! A PC that sees the seam: it answers each capture with where the seam is beside the centres of the pictures.

use shared::config::TrackerConfig;
use shared::io::SLIDES;
use shared::protocol::framing::{MAX_DATAGRAM, decode_datagram, encode_datagram};
use shared::protocol::{Capture, Datagram, Measurement, Request, Response, SideMeasurement};
use std::collections::VecDeque;
use std::f64::consts::TAU;
use std::net::{Ipv4Addr, UdpSocket};
use virtual_nucleo::pair::Pair;
use virtual_nucleo::session::Session;
use virtual_nucleo::time::Time;

/// From a capture's datagram to its answer.
const PROCESSING: Time = Time::ms(8);

/// Where the seam is beside the plan at path position `s` \[mm\]: U1, V1, U2, V2 \[mm\].
pub fn seam(s: f64) -> [f64; SLIDES] {
    std::array::from_fn(|slide| 0.4 * (TAU * (s / 120.0 + slide as f64 / 7.0)).sin())
}

/// The cameras, and what lies behind them.
pub struct Cameras {
    socket: UdpSocket,
    /// Number of the tracker board's session.
    pub session: u32,
    lead_mm: f64,
    waiting: VecDeque<(Time, Measurement)>,
}

impl Cameras {
    /// A socket of the PC to which `board` sends from now on; the number of its session.
    pub fn subscribe(pair: &mut Pair, session: &mut Session, board: usize) -> (UdpSocket, u32) {
        let socket = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).expect("a port");
        socket.set_nonblocking(true).expect("a socket");
        let port = socket.local_addr().expect("a socket").port();
        match session.ask(pair, board, &Request::Subscribe { port }) {
            Ok(Response::Session { number }) => (socket, number),
            other => panic!("{other:?}"),
        }
    }

    /// Takes the captures of the tracker board, whose parameters are `config`.
    pub fn new(pair: &mut Pair, session: &mut Session, config: &TrackerConfig) -> Self {
        let (socket, session) = Self::subscribe(pair, session, 1);
        Self {
            socket,
            session,
            lead_mm: config.head.camera_lead_mm,
            waiting: VecDeque::new(),
        }
    }

    /// Takes what has come, and answers what is due.
    pub fn step(&mut self, pair: &Pair) {
        let mut buffer = [0; MAX_DATAGRAM];
        while let Ok(length) = self.socket.recv(&mut buffer) {
            if let Ok((_, Datagram::Capture(capture))) = decode_datagram(&buffer[..length]) {
                self.waiting
                    .push_back((pair.now() + PROCESSING, self.measure(&capture)));
            }
        }
        let [_, (_, port)] = pair.ports().expect("there are some");
        while let Some((due, measurement)) = self.waiting.front() {
            if *due > pair.now() {
                break;
            }
            let datagram = Datagram::Measurement(*measurement);
            let bytes = encode_datagram(self.session, &datagram, &mut buffer).expect("it fits");
            self.socket
                .send_to(bytes, (Ipv4Addr::LOCALHOST, port))
                .expect("the board's port");
            self.waiting.pop_front();
        }
    }

    /// What pictures would show.
    fn measure(&self, capture: &Capture) -> Measurement {
        let seam = seam(capture.s_mm + self.lead_mm);
        let off: [f64; SLIDES] = std::array::from_fn(|slide| seam[slide] - capture.slides_mm[slide]);
        Measurement {
            capture: capture.number,
            sides: [0, 1].map(|side| {
                Some(SideMeasurement {
                    along_mm: 0.0,
                    delta_u_mm: off[2 * side],
                    delta_v_mm: off[2 * side + 1],
                })
            }),
        }
    }
}
