//! Streams and datagrams between ports of the loopback interface and sockets in the boards' net.

use smoltcp::iface::{Interface, SocketHandle, SocketSet};
use smoltcp::socket::{tcp, udp};
use smoltcp::wire::IpEndpoint;
use std::io::{self, ErrorKind, Read, Write};
use std::net::{Ipv4Addr, Shutdown, SocketAddr, TcpListener, TcpStream, UdpSocket};

/// Bytes that a stream may have under way each way.
const STREAM_BYTES: usize = 16 << 10;
/// Datagrams that may wait each way, and their bytes.
const DATAGRAMS: usize = 64;
const DATAGRAM_BYTES: usize = 64 << 10;
const LONGEST_DATAGRAM: usize = 1472;
/// Where a datagram goes that nobody is to take (RFC 863).
const DISCARD_PORT: u16 = 9;
/// Senders of datagrams that are remembered for answers.
const SENDERS: usize = 64;

/// Streams to one port of a board.
pub struct Streams {
    listener: TcpListener,
    board: IpEndpoint,
    open: Vec<Stream>,
}

struct Stream {
    host: TcpStream,
    socket: SocketHandle,
    /// Read from the board and not yet taken by the host.
    waiting: Vec<u8>,
    /// The host sends no more.
    ended: bool,
}

impl Streams {
    /// Listens at `host` for streams to `board`.
    pub fn listen(board: IpEndpoint, host: (Ipv4Addr, u16)) -> io::Result<Self> {
        let listener = TcpListener::bind(host)?;
        listener.set_nonblocking(true)?;
        Ok(Self {
            listener,
            board,
            open: Vec::new(),
        })
    }

    /// The port.
    pub fn port(&self) -> io::Result<u16> {
        Ok(self.listener.local_addr()?.port())
    }

    /// Passes on what has come. A stream whose host or board fails is closed on both sides.
    pub fn relay(
        &mut self,
        interface: &mut Interface,
        sockets: &mut SocketSet<'static>,
        next_port: &mut u16,
    ) {
        while let Ok((host, _)) = self.listener.accept() {
            if let Some(stream) = connect(host, self.board, interface, sockets, next_port) {
                self.open.push(stream);
            }
        }
        self.open.retain_mut(|stream| {
            let socket = sockets.get_mut::<tcp::Socket>(stream.socket);
            if stream.pass(socket).is_err() {
                socket.abort();
            }
            let over = !socket.is_open() && stream.waiting.is_empty();
            if over {
                // The host sees the end; an error means that it has ended before.
                let _ = stream.host.shutdown(Shutdown::Both);
                sockets.remove(stream.socket);
            }
            !over
        });
    }
}

fn connect(
    host: TcpStream,
    board: IpEndpoint,
    interface: &mut Interface,
    sockets: &mut SocketSet<'static>,
    next_port: &mut u16,
) -> Option<Stream> {
    host.set_nonblocking(true).ok()?;
    host.set_nodelay(true).ok()?;
    let buffer = || tcp::SocketBuffer::new(vec![0; STREAM_BYTES]);
    let mut socket = tcp::Socket::new(buffer(), buffer());
    socket.set_nagle_enabled(false);
    *next_port = next_port.wrapping_add(1);
    socket.connect(interface.context(), board, *next_port).ok()?;
    Some(Stream {
        host,
        socket: sockets.add(socket),
        waiting: Vec::new(),
        ended: false,
    })
}

impl Stream {
    fn pass(&mut self, socket: &mut tcp::Socket) -> io::Result<()> {
        while !self.ended && socket.may_send() && socket.can_send() {
            let mut end = false;
            let sent = socket.send(|room| match self.host.read(room) {
                Ok(0) => {
                    end = true;
                    (0, Ok(0))
                }
                Ok(length) => (length, Ok(length)),
                Err(error) => (0, Err(error)),
            });
            if end {
                self.ended = true;
                socket.close();
            }
            match sent.map_err(io::Error::other)? {
                Ok(0) => break,
                Ok(_) => {}
                Err(error) if error.kind() == ErrorKind::WouldBlock => break,
                Err(error) => return Err(error),
            }
        }
        while socket.can_recv() && self.waiting.len() < STREAM_BYTES {
            let came = socket
                .recv(|bytes| (bytes.len(), bytes.to_vec()))
                .map_err(io::Error::other)?;
            self.waiting.extend(came);
        }
        while !self.waiting.is_empty() {
            match self.host.write(&self.waiting) {
                Ok(length) => drop(self.waiting.drain(..length)),
                Err(error) if error.kind() == ErrorKind::WouldBlock => break,
                Err(error) => return Err(error),
            }
        }
        // The board has ended its side.
        if socket.state() == tcp::State::CloseWait && !socket.can_recv() && self.waiting.is_empty() {
            socket.close();
        }
        Ok(())
    }
}

/// Datagrams to one port of a board.
pub struct Datagrams {
    host: UdpSocket,
    board: IpEndpoint,
    /// Holds a datagram until the board has told its Ethernet address.
    probe: SocketHandle,
    senders: Vec<(SocketAddr, SocketHandle)>,
}

impl Datagrams {
    /// Takes datagrams for `board` at `host`.
    pub fn bind(
        board: IpEndpoint,
        host: (Ipv4Addr, u16),
        sockets: &mut SocketSet<'static>,
    ) -> io::Result<Self> {
        let host = UdpSocket::bind(host)?;
        host.set_nonblocking(true)?;
        let mut socket = socket(DISCARD_PORT).map_err(io::Error::other)?;
        let nobody = IpEndpoint::new(board.addr, DISCARD_PORT);
        // What waits is counted in bytes.
        socket.send_slice(&[0], nobody).map_err(io::Error::other)?;
        Ok(Self {
            host,
            board,
            probe: sockets.add(socket),
            senders: Vec::new(),
        })
    }

    /// Whether the board has told its Ethernet address, so that nothing waits for that.
    pub fn reached(&self, sockets: &SocketSet<'static>) -> bool {
        sockets.get::<udp::Socket>(self.probe).send_queue() == 0
    }

    /// The port.
    pub fn port(&self) -> io::Result<u16> {
        Ok(self.host.local_addr()?.port())
    }

    /// Passes on what has come; what finds no room is lost, as datagrams are.
    pub fn relay(&mut self, sockets: &mut SocketSet<'static>) {
        let mut buffer = [0; LONGEST_DATAGRAM];
        for _ in 0..DATAGRAMS {
            let Ok((length, sender)) = self.host.recv_from(&mut buffer) else {
                break;
            };
            if let Some(handle) = self.socket_of(sender, sockets) {
                let _ = sockets
                    .get_mut::<udp::Socket>(handle)
                    .send_slice(&buffer[..length], self.board);
            }
        }
        for (sender, handle) in &self.senders {
            let socket = sockets.get_mut::<udp::Socket>(*handle);
            while let Ok((bytes, _)) = socket.recv() {
                let _ = self.host.send_to(bytes, sender);
            }
        }
    }

    /// Passes a datagram of the board to a program's own port. It is lost if nothing listens there.
    pub fn pass_to(&self, port: u16, bytes: &[u8]) {
        let _ = self.host.send_to(bytes, (Ipv4Addr::LOCALHOST, port));
    }

    fn socket_of(&mut self, sender: SocketAddr, sockets: &mut SocketSet<'static>) -> Option<SocketHandle> {
        if let Some((_, handle)) = self.senders.iter().find(|(known, _)| *known == sender) {
            return Some(*handle);
        }
        if self.senders.len() >= SENDERS {
            let (_, oldest) = self.senders.remove(0);
            sockets.remove(oldest);
        }
        // Boards know a program by its port.
        let socket = socket(sender.port()).ok()?;
        let handle = sockets.add(socket);
        self.senders.push((sender, handle));
        Some(handle)
    }
}

/// A socket on this port.
fn socket(port: u16) -> Result<udp::Socket<'static>, udp::BindError> {
    let buffer = || {
        udp::PacketBuffer::new(
            vec![udp::PacketMetadata::EMPTY; DATAGRAMS],
            vec![0; DATAGRAM_BYTES],
        )
    };
    let mut socket = udp::Socket::new(buffer(), buffer());
    socket.bind(port)?;
    Ok(socket)
}
