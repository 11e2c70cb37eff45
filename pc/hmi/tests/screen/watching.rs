//! Viewers, as their connections are.

use hmi::connection::{Connection, Place};
use hmi::screen;
use hmi::serving::Server;
use hmi::serving::identity::Identity;
use hmi::serving::page::Page;
use hmi::serving::token::Token;
use hmi::viewing::watched::Watched;
use hmi::viewing::wire::{Message, PATH};
use hmi::viewing::{Connection as _, News};
use rcgen::{KeyPair, PublicKeyData};
use rustls::crypto::ring;
use rustls::pki_types::pem::PemObject;
use rustls::pki_types::{CertificateDer, ServerName};
use rustls::{ClientConfig, ClientConnection, RootCertStore, StreamOwned};
use std::io::{Read, Write};
use std::net::{Ipv4Addr, SocketAddr, TcpStream};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};
use tungstenite::WebSocket;
use tungstenite::protocol::Role;

/// Environment variable with the folder of the page for browsers.
const BROWSER_VARIABLE: &str = "SEAMWRIGHT_BROWSER";
/// Longest wait for anything.
const PATIENCE: Duration = Duration::from_secs(120);
/// Any port that is free, here.
pub const HERE: SocketAddr = SocketAddr::new(std::net::IpAddr::V4(Ipv4Addr::LOCALHOST), 0);

/// What serves, and what it is known by.
pub struct Service {
    folder: tempfile::TempDir,
    pub identity: Identity,
    pub token: Token,
}

impl Service {
    pub fn new() -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        Self {
            identity: Identity::own(Some(folder.path()), "127.0.0.1").expect("a certificate"),
            token: Token::random().expect("random numbers"),
            folder,
        }
    }

    pub fn start(&self, address: SocketAddr) -> Server {
        Server::start(address, &self.identity, &self.token, None).expect("it serves")
    }

    /// The same, with what `cargo xtask browser` has made.
    pub fn start_with_page(&self, address: SocketAddr) -> Server {
        let folder =
            std::env::var_os(BROWSER_VARIABLE).expect("cargo xtask test --browser says where the page is");
        self.start_with(address, Path::new(&folder))
    }

    /// The same, with the page in `folder`.
    pub fn start_with(&self, address: SocketAddr, folder: &Path) -> Server {
        let page = Page::read(folder, &self.token).expect("a page");
        Server::start(address, &self.identity, &self.token, Some(page)).expect("it serves")
    }

    /// Public key of the certificate, in DER.
    pub fn public_key(&self) -> Vec<u8> {
        let key = std::fs::read_to_string(self.file("key")).expect("a key");
        let key = KeyPair::from_pem(&key).expect("a key");
        key.subject_public_key_info()
    }

    pub fn place(&self, address: SocketAddr) -> Place {
        Place {
            address: address.to_string(),
            token: self.token.text().to_owned(),
            fingerprint: Some(self.identity.fingerprint()),
        }
    }

    /// The file with `part` in its name.
    fn file(&self, part: &str) -> PathBuf {
        let files = std::fs::read_dir(self.folder.path()).expect("a folder");
        let mut files = files.map(|file| file.expect("a file").path());
        files
            .find(|file| file.to_string_lossy().contains(part))
            .expect("a file")
    }

    /// A connection by TLS alone.
    pub fn raw(&self, address: SocketAddr) -> Raw {
        let mut roots = RootCertStore::empty();
        let certificate = CertificateDer::from_pem_file(self.file("certificate")).expect("a certificate");
        roots.add(certificate).expect("trusted");
        let config = ClientConfig::builder_with_provider(Arc::new(ring::default_provider()))
            .with_safe_default_protocol_versions()
            .expect("versions")
            .with_root_certificates(roots)
            .with_no_client_auth();
        let name = ServerName::try_from("127.0.0.1").expect("a name");
        let tls = ClientConnection::new(Arc::new(config), name).expect("TLS");
        let socket = TcpStream::connect(address).expect("connected");
        socket.set_read_timeout(Some(PATIENCE)).expect("set");
        Raw(StreamOwned::new(tls, socket))
    }

    /// The same, as a viewer that is let in.
    pub fn let_in(&self, address: SocketAddr) -> WebSocket<StreamOwned<ClientConnection, TcpStream>> {
        let mut raw = self.raw(address);
        let head = raw.upgrade(&format!("Authorization: Bearer {}\r\n", self.token.text()));
        assert!(head.starts_with("HTTP/1.1 101 "), "{head}");
        WebSocket::from_raw_socket(raw.0, Role::Client, None)
    }
}

/// A connection by TLS.
pub struct Raw(pub StreamOwned<ClientConnection, TcpStream>);

impl Raw {
    /// Asks for messages with `header`; the head of the answer.
    pub fn upgrade(&mut self, header: &str) -> String {
        self.send(&format!(
            "GET {PATH} HTTP/1.1\r\nHost: here\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n\
             Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n{header}\r\n"
        ));
        let mut head = Vec::new();
        let mut byte = [0];
        while !head.ends_with(b"\r\n\r\n") {
            match self.0.read(&mut byte) {
                Ok(1) => head.push(byte[0]),
                _ => break,
            }
        }
        String::from_utf8(head).expect("text")
    }

    pub fn send(&mut self, text: &str) {
        self.0.write_all(text.as_bytes()).expect("sent");
        self.0.flush().expect("sent");
    }

    /// All that is answered until the end.
    pub fn answer(mut self) -> String {
        let mut all = Vec::new();
        // However it ends.
        let _ = self.0.read_to_end(&mut all);
        String::from_utf8_lossy(&all).into_owned()
    }
}

/// A viewer, and what it has seen.
pub struct Watcher {
    connection: Connection,
    pub watched: Watched,
    pub lost: Vec<String>,
    pub is_connected: bool,
    pub messages: usize,
    /// Of all messages but those that were all that there is.
    pub bytes: usize,
    pub largest_all: usize,
    /// Pictures of each camera with a seam in them.
    pub seams: [usize; 2],
    captures: [u32; 2],
    began: Instant,
}

impl Watcher {
    pub fn new(place: Place) -> Self {
        Self {
            connection: Connection::open(place),
            watched: Watched::default(),
            lost: Vec::new(),
            is_connected: false,
            messages: 0,
            bytes: 0,
            largest_all: 0,
            seams: [0; 2],
            captures: [0; 2],
            began: Instant::now(),
        }
    }

    pub fn now(&self) -> Duration {
        self.began.elapsed()
    }

    pub fn turn(&mut self) {
        for news in self.connection.news() {
            match news {
                News::Connected => {
                    self.watched.reconnected();
                    self.is_connected = true;
                }
                News::Lost(why) => {
                    self.lost.push(why);
                    self.is_connected = false;
                }
                News::Message(message) => self.take(*message),
            }
        }
    }

    fn take(&mut self, message: Message) {
        let bytes = message.encode().expect("as it came").len();
        self.messages += 1;
        if message.is_all {
            self.largest_all = self.largest_all.max(bytes);
        } else {
            self.bytes += bytes;
        }
        let now = self.now();
        self.watched.take(message, now);
        for (side, picture) in self.watched.live.pictures.iter().enumerate() {
            if let Some(picture) = picture
                && picture.capture != self.captures[side]
            {
                self.captures[side] = picture.capture;
                self.seams[side] += usize::from(picture.seam.is_some());
            }
        }
    }

    /// Waits until `done`.
    pub fn until(&mut self, what: &str, mut done: impl FnMut(&Self) -> bool) {
        let end = Instant::now() + PATIENCE;
        loop {
            self.turn();
            if done(self) {
                return;
            }
            assert!(Instant::now() < end, "waited too long: {what}; {:?}", self.lost);
            std::thread::sleep(Duration::from_millis(5));
        }
    }
}

/// The pages that a viewer has not.
pub const COMMANDING: [screen::Page; 4] = [
    screen::Page::SetUp,
    screen::Page::Teach,
    screen::Page::Welds,
    screen::Page::Parameters,
];
