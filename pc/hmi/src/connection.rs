//! The connection of a viewer: made again whenever it is lost, on a thread of its own.

use crate::settings::Settings;
use crate::sockets::{fingerprint, is_wait};
use crate::viewing::wire::{LARGEST, Message, PATH};
use crate::viewing::{self, News};
use rustls::client::WebPkiServerVerifier;
use rustls::client::danger::{HandshakeSignatureValid, ServerCertVerified, ServerCertVerifier};
use rustls::crypto::{CryptoProvider, ring, verify_tls12_signature, verify_tls13_signature};
use rustls::pki_types::{CertificateDer, ServerName, UnixTime};
use rustls::{
    ClientConfig, ClientConnection, DigitallySignedStruct, RootCertStore, SignatureScheme, StreamOwned,
};
use std::net::{TcpStream, ToSocketAddrs};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};
use tungstenite::protocol::WebSocketConfig;
use tungstenite::{ClientRequestBuilder, Error, HandshakeError, WebSocket};
use view::look::Look;
use view::screen::Viewer;

/// Longest wait for a connection, and for each step of it.
const CONNECTING: Duration = Duration::from_secs(2);
/// A connection on which nothing comes for so long is made again. That what is shown is old is said long before.
const LOST: Duration = Duration::from_secs(3);
/// Longest wait for a message, before it is seen whether the viewer is closed.
const TURN: Duration = Duration::from_millis(100);
/// Time between two tries.
const AGAIN: Duration = Duration::from_millis(500);
/// Messages that wait for the screen.
const WAITING: usize = 64;

/// The screen that is watched.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// HOST:PORT.
    pub address: String,
    /// What it lets in by.
    pub token: String,
    /// SHA-256 of its certificate; without it, an authority that this computer trusts has signed that.
    pub fingerprint: Option<String>,
}

/// A screen that watches `place`, with what is kept in `settings`.
pub fn viewer(place: Place, settings: Settings) -> Viewer {
    let (address, look) = (place.address.clone(), settings.look.clone());
    let keep = move |look: &Look| {
        let written = settings.write(look, settings.access.pins());
        written.map_err(|error| config::sentence(error.as_ref()))
    };
    Viewer::new(address, Box::new(Connection::open(place)), look, keep)
}

/// See the module.
#[derive(Debug)]
pub struct Connection {
    news: Receiver<News>,
    stop: Arc<AtomicBool>,
}

impl Connection {
    /// Begins to watch.
    pub fn open(place: Place) -> Self {
        let (sender, news) = sync_channel(WAITING);
        let stop = Arc::new(AtomicBool::new(false));
        let stopped = Arc::clone(&stop);
        std::thread::spawn(move || keep(&place, &sender, &stopped));
        Self { news, stop }
    }
}

impl viewing::Connection for Connection {
    fn news(&mut self) -> Vec<News> {
        self.news.try_iter().collect()
    }
}

impl Drop for Connection {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
    }
}

/// Watches until the viewer is closed.
fn keep(place: &Place, news: &SyncSender<News>, stop: &AtomicBool) {
    while !stop.load(Ordering::Relaxed) {
        let why = match connect(place) {
            Ok(socket) => {
                if news.send(News::Connected).is_err() {
                    return;
                }
                watch(socket, news, stop)
            }
            Err(why) => why,
        };
        if news.send(News::Lost(why)).is_err() {
            return;
        }
        std::thread::sleep(AGAIN);
    }
}

type Socket = WebSocket<StreamOwned<ClientConnection, TcpStream>>;

/// Or a sentence why not.
fn connect(place: &Place) -> Result<Socket, String> {
    let Place { address, token, .. } = place;
    let cannot = |error: &dyn std::fmt::Display| format!("cannot reach {address}: {error}");
    let host = address
        .rsplit_once(':')
        .map_or(address.as_str(), |(host, _)| host);
    let host = host.trim_matches(['[', ']']).to_owned();
    let name = ServerName::try_from(host).map_err(|error| cannot(&error))?;
    let mut found = address.to_socket_addrs().map_err(|error| cannot(&error))?;
    let found = found.next().ok_or_else(|| cannot(&"there is no such host"))?;
    let tcp = TcpStream::connect_timeout(&found, CONNECTING).map_err(|error| cannot(&error))?;
    let set = tcp
        .set_nodelay(true)
        .and_then(|()| tcp.set_read_timeout(Some(CONNECTING)))
        .and_then(|()| tcp.set_write_timeout(Some(CONNECTING)));
    set.map_err(|error| cannot(&error))?;
    let trust = Arc::new(Trust::of(place.fingerprint.as_deref()));
    let tls = ClientConnection::new(Arc::new(trust.client()), name).map_err(|error| cannot(&error))?;
    let uri = format!("wss://{address}{PATH}").parse();
    let uri = uri.map_err(|error: tungstenite::http::uri::InvalidUri| cannot(&error))?;
    let request = ClientRequestBuilder::new(uri).with_header("Authorization", format!("Bearer {token}"));
    let config = WebSocketConfig::default()
        .max_message_size(Some(LARGEST))
        .max_frame_size(Some(LARGEST));
    let stream = StreamOwned::new(tls, tcp);
    let (socket, _) = tungstenite::client::client_with_config(request, stream, Some(config)).map_err(
        |error| match error {
            HandshakeError::Failure(Error::Http(answer)) if answer.status() == 401 => {
                format!("{address} does not know this token; that on its page Screen is right")
            }
            HandshakeError::Failure(Error::Http(answer)) if answer.status() == 404 => {
                format!("{address} is of another version")
            }
            HandshakeError::Failure(error) => trust.refused(address).unwrap_or_else(|| cannot(&error)),
            HandshakeError::Interrupted(_) => cannot(&"there is no answer"),
        },
    )?;
    let shorter = socket.get_ref().sock.set_read_timeout(Some(TURN));
    shorter.map_err(|error| cannot(&error))?;
    Ok(socket)
}

/// Tells what comes until the end of `socket`; why it ended.
fn watch(mut socket: Socket, news: &SyncSender<News>, stop: &AtomicBool) -> String {
    let mut heard = Instant::now();
    while !stop.load(Ordering::Relaxed) {
        match socket.read() {
            Ok(tungstenite::Message::Binary(bytes)) => {
                heard = Instant::now();
                let message = match Message::decode(&bytes) {
                    Ok(message) => message,
                    Err(error) => return format!("a message was not understood: {error}"),
                };
                if news.send(News::Message(Box::new(message))).is_err() {
                    return String::new();
                }
            }
            Ok(tungstenite::Message::Close(Some(frame))) if !frame.reason.is_empty() => {
                return frame.reason.to_string();
            }
            Ok(_) => {}
            Err(Error::Io(error)) if is_wait(&error) && heard.elapsed() < LOST => {}
            Err(Error::Io(error)) if is_wait(&error) => return "nothing comes any more".to_owned(),
            Err(error) => return error.to_string(),
        }
    }
    // Nobody waits for it.
    let _ = socket.close(None);
    String::new()
}

/// Which certificates are trusted.
#[derive(Debug)]
struct Trust {
    provider: Arc<CryptoProvider>,
    by: By,
    /// One that was refused.
    refused: Mutex<Option<String>>,
}

#[derive(Debug)]
enum By {
    /// SHA-256 of the only one.
    Fingerprint(String),
    /// Those that have signed it; none where the computer trusts nobody.
    Authorities(Option<Arc<WebPkiServerVerifier>>),
}

impl Trust {
    fn of(fingerprint: Option<&str>) -> Self {
        let provider = Arc::new(ring::default_provider());
        let by = match fingerprint {
            Some(fingerprint) => By::Fingerprint(fingerprint.replace(':', "").to_ascii_lowercase()),
            None => {
                let mut roots = RootCertStore::empty();
                roots.add_parsable_certificates(rustls_native_certs::load_native_certs().certs);
                let verifier =
                    WebPkiServerVerifier::builder_with_provider(Arc::new(roots), Arc::clone(&provider));
                By::Authorities(verifier.build().ok())
            }
        };
        Self {
            provider,
            by,
            refused: Mutex::default(),
        }
    }

    fn client(self: &Arc<Self>) -> ClientConfig {
        let verifier: Arc<dyn ServerCertVerifier> = Arc::clone(self) as _;
        ClientConfig::builder_with_provider(Arc::clone(&self.provider))
            .with_protocol_versions(rustls::ALL_VERSIONS)
            .unwrap_or_else(|error| unreachable!("the provider has both versions: {error}"))
            .dangerous()
            .with_custom_certificate_verifier(verifier)
            .with_no_client_auth()
    }

    /// That a certificate was refused, as a sentence.
    fn refused(&self, address: &str) -> Option<String> {
        let fingerprint = self
            .refused
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .take()?;
        Some(format!(
            "the certificate of {address} is not trusted: its fingerprint is {fingerprint}; if the page Screen there says the same, \
             watch with --fingerprint {fingerprint}"
        ))
    }

    fn is_trusted(
        &self,
        certificate: &CertificateDer<'_>,
        chain: &[CertificateDer<'_>],
        name: &ServerName<'_>,
        now: UnixTime,
    ) -> bool {
        match &self.by {
            By::Fingerprint(only) => fingerprint(certificate) == *only,
            By::Authorities(Some(authorities)) => authorities
                .verify_server_cert(certificate, chain, name, &[], now)
                .is_ok(),
            By::Authorities(None) => false,
        }
    }
}

impl ServerCertVerifier for Trust {
    fn verify_server_cert(
        &self,
        certificate: &CertificateDer<'_>,
        chain: &[CertificateDer<'_>],
        name: &ServerName<'_>,
        _ocsp: &[u8],
        now: UnixTime,
    ) -> Result<ServerCertVerified, rustls::Error> {
        if self.is_trusted(certificate, chain, name, now) {
            return Ok(ServerCertVerified::assertion());
        }
        let fingerprint = fingerprint(certificate);
        *self.refused.lock().unwrap_or_else(PoisonError::into_inner) = Some(fingerprint);
        Err(rustls::Error::InvalidCertificate(
            rustls::CertificateError::ApplicationVerificationFailure,
        ))
    }

    fn verify_tls12_signature(
        &self,
        message: &[u8],
        certificate: &CertificateDer<'_>,
        signed: &DigitallySignedStruct,
    ) -> Result<HandshakeSignatureValid, rustls::Error> {
        let algorithms = &self.provider.signature_verification_algorithms;
        verify_tls12_signature(message, certificate, signed, algorithms)
    }

    fn verify_tls13_signature(
        &self,
        message: &[u8],
        certificate: &CertificateDer<'_>,
        signed: &DigitallySignedStruct,
    ) -> Result<HandshakeSignatureValid, rustls::Error> {
        let algorithms = &self.provider.signature_verification_algorithms;
        verify_tls13_signature(message, certificate, signed, algorithms)
    }

    fn supported_verify_schemes(&self) -> Vec<SignatureScheme> {
        self.provider
            .signature_verification_algorithms
            .supported_schemes()
    }
}
