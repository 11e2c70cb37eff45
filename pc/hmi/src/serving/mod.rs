//! What this screen serves to viewers: what it shows, over HTTPS, to who has the token.
//!
//! - [`stage`]: what the station has it show. There is no way back from here to the station or its job.
//! - `thinning`: events of the job and the stage as messages, few enough for a tablet.
//! - `publisher`: the thread that sends them to all viewers, waiting for none.
//! - `guest`: a connection, from its request to its end.
//! - [`page`]: what a browser is given.
//! - [`identity`]: the certificate.
//! - [`token`]: what a viewer has to know.

pub mod identity;
pub mod page;
pub mod stage;
pub mod token;

mod budget;
mod guest;
mod publisher;
mod request;
mod thinning;
mod ticks;

use anyhow::Context;
use guest::Door;
use identity::Identity;
use page::Page;
use publisher::Viewers;
use stage::Stage;
use std::net::{SocketAddr, TcpListener};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Duration;
use token::Token;

/// Viewers at most.
pub const VIEWERS: usize = 10;
/// Connections at most, with those that have not shown the token yet.
const CONNECTIONS: usize = 32;
/// It is looked for new connections so often.
const POLL: Duration = Duration::from_millis(20);

/// A screen that is served, until this is dropped.
#[derive(Debug)]
pub struct Server {
    stage: Stage,
    told: Told,
    viewers: Viewers,
    stop: Arc<AtomicBool>,
}

/// What somebody has to know to watch.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Told {
    /// Where it listens.
    pub address: SocketAddr,
    /// The token.
    pub token: String,
    /// There is a page for browsers.
    pub has_page: bool,
    /// SHA-256 of the certificate, in hexadecimal digits.
    pub fingerprint: String,
}

impl Told {
    /// What a browser opens, where there is a page for it.
    pub fn link(&self) -> Option<String> {
        let Self { address, token, .. } = self;
        self.has_page.then(|| format!("https://{address}/?token={token}"))
    }
}

impl Server {
    /// Serves at `address`, and the `page` to browsers; port 0 is any that is free.
    ///
    /// # Errors
    /// It cannot listen there, or the certificate and its key do not fit.
    pub fn start(
        address: SocketAddr,
        identity: &Identity,
        token: &Token,
        page: Option<Page>,
    ) -> anyhow::Result<Self> {
        let listen = || -> std::io::Result<(TcpListener, SocketAddr)> {
            let listener = TcpListener::bind(address)?;
            listener.set_nonblocking(true)?;
            let address = listener.local_addr()?;
            Ok((listener, address))
        };
        let (listener, address) =
            listen().with_context(|| format!("cannot serve viewers at {address}, which has to be an address of this computer and a free port"))?;
        let (stage, viewers, stop) = (
            Stage::default(),
            Viewers::default(),
            Arc::new(AtomicBool::new(false)),
        );
        let told = Told {
            address,
            token: token.text().to_owned(),
            has_page: page.is_some(),
            fingerprint: identity.fingerprint(),
        };
        let door = Arc::new(Door {
            tls: identity.server()?,
            token: token.clone(),
            page,
            viewers: viewers.clone(),
        });
        let shared = (stage.clone(), viewers.clone(), Arc::clone(&stop));
        std::thread::spawn(move || publisher::run(&shared.0, &shared.1, &shared.2));
        let stopped = Arc::clone(&stop);
        std::thread::spawn(move || accept(&listener, &door, &stopped));
        Ok(Self {
            stage,
            told,
            viewers,
            stop,
        })
    }

    /// Where the station shows what it has.
    pub fn stage(&self) -> Stage {
        self.stage.clone()
    }

    /// What somebody has to know to watch.
    pub fn told(&self) -> &Told {
        &self.told
    }

    /// How many watch.
    pub fn watching(&self) -> usize {
        self.viewers.count()
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
    }
}

/// Lets connections in, each on a thread of its own.
fn accept(listener: &TcpListener, door: &Arc<Door>, stop: &AtomicBool) {
    let open = Arc::new(AtomicUsize::new(0));
    while !stop.load(Ordering::Relaxed) {
        // What cannot be accepted is lost for its sender only.
        let Ok((stream, _)) = listener.accept() else {
            std::thread::sleep(POLL);
            continue;
        };
        if open.load(Ordering::Relaxed) >= CONNECTIONS {
            continue;
        }
        open.fetch_add(1, Ordering::Relaxed);
        let (door, left) = (Arc::clone(door), Arc::clone(&open));
        let guest = std::thread::Builder::new().spawn(move || {
            door.let_in(stream);
            left.fetch_sub(1, Ordering::Relaxed);
        });
        if guest.is_err() {
            open.fetch_sub(1, Ordering::Relaxed);
        }
    }
}
