//! The server: a thread of its own for all viewers.

use std::net::{SocketAddr, TcpListener};
use std::thread;
use std::time::{SystemTime, UNIX_EPOCH};

use floorguard_host::executor::{Ring, take_priority};
use floorguard_recording::{LiveMessage, MessageListener};

use super::client;
use super::viewers::{LiveFigures, Viewers};

/// The server could not be opened.
#[derive(Debug, thiserror::Error)]
#[error("{address}: Foxglove cannot listen here ({cause}); give another address or port")]
pub struct OpenError {
    address: SocketAddr,
    cause: std::io::Error,
}

/// A run for Foxglove: each message that it is given goes to the viewers that have subscribed to it. Its clones share the viewers.
#[derive(Clone)]
pub struct FoxgloveServer {
    viewers: Viewers,
    address: SocketAddr,
}

impl FoxgloveServer {
    /// Listens at an address, on a thread of its own until the program ends. `name` is what viewers show.
    ///
    /// # Errors
    /// The address is taken or is none of this computer.
    pub fn open(address: SocketAddr, name: &str) -> Result<Self, OpenError> {
        let refused = |cause| OpenError { address, cause };
        let listener = TcpListener::bind(address).map_err(refused)?;
        listener.set_nonblocking(true).map_err(refused)?;
        let address = listener.local_addr().map_err(refused)?;
        let viewers = Viewers::default();
        let (seen, name) = (viewers.clone(), name.to_owned());
        let started = thread::Builder::new().name("foxglove".to_owned());
        started.spawn(move || serve(listener, seen, name)).map_err(refused)?;
        Ok(Self { viewers, address })
    }

    /// Where it listens; with port 0 the system has chosen one.
    #[must_use]
    pub const fn address(&self) -> SocketAddr {
        self.address
    }

    /// What went over the connections so far.
    #[must_use]
    pub fn figures(&self) -> LiveFigures {
        self.viewers.figures()
    }
}

impl MessageListener for FoxgloveServer {
    fn message(&mut self, message: &LiveMessage<'_>) {
        self.viewers.publish(message);
    }
}

fn serve(listener: TcpListener, viewers: Viewers, name: String) {
    // A thread begins with the priority of the one that started it.
    let _ = take_priority(Ring::Telemetry);
    let since_1970 = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    let session = since_1970.as_millis().to_string();
    let runtime = tokio::runtime::Builder::new_current_thread().enable_io().enable_time().build();
    let served = runtime.and_then(|runtime| {
        runtime.block_on(async {
            let listener = tokio::net::TcpListener::from_std(listener)?;
            loop {
                // A connection that was gone before it was accepted is no reason to end.
                let Ok((stream, _)) = listener.accept().await else {
                    tokio::time::sleep(std::time::Duration::from_millis(50)).await;
                    continue;
                };
                let _ = stream.set_nodelay(true);
                tokio::spawn(client::serve(stream, viewers.clone(), (name.clone(), session.clone())));
            }
        })
    });
    let served: std::io::Result<()> = served;
    if let Err(error) = served {
        eprintln!("Foxglove's connections have closed: {error}; the robot goes on without them");
    }
}
