//! The bridge: one participant of DDS, a thread that writes and one that reads.

use std::net::{IpAddr, Ipv4Addr};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::{self, JoinHandle};
use std::time::{SystemTime, UNIX_EPOCH};

use floorguard_recording::cdr::Encoder;
use floorguard_recording::{LiveMessage, MessageListener};
use rustdds::DomainParticipantBuilder;

use super::counters::{BridgeFigures, Counters};
use super::dds::{MessageWriter, Named, Participant, Quality, Refused};
use super::incoming::Listener;
use super::loopback;
use super::moment::RobotMoment;
use super::outgoing::{Outgoing, Publisher, Recorded};
use super::published::{PUBLISHED, index_of};
use super::requests::RosRequest;
use super::velocities::{VelocityFeed, VelocityRoute};

/// Messages that wait for the thread that writes; what comes on top is dropped.
const QUEUE: usize = 512;
/// Requests that wait for the robot; more are refused.
const REQUESTS: usize = 16;
/// The guard's moment is shown this often, microseconds.
const SHOW_EVERY_US: u64 = 50_000;
/// The node's name.
const NODE: &str = "floorguard";

/// The bridge could not be opened.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    /// DDS refuses.
    #[error("ROS 2: DDS refuses ({0}); is the domain right, and are its ports free?")]
    Dds(#[from] Refused),
    /// The participant could not be made.
    #[error("ROS 2: no participant in domain {domain} ({cause})")]
    Participant {
        /// The domain.
        domain: u16,
        /// Why.
        cause: String,
    },
    /// The sockets could not be kept on this computer.
    #[error(
        "ROS 2: cannot keep DDS on this computer ({0}); without that it would listen on every network: give an address to allow it"
    )]
    NotKept(std::io::Error),
    /// A thread could not be started.
    #[error("ROS 2: {0}")]
    Thread(std::io::Error),
}

/// Where and what the bridge is.
#[derive(Debug, Default)]
pub struct BridgeOptions {
    /// The domain, as `ROS_DOMAIN_ID`.
    pub domain: u16,
    /// This computer's address in the network where the others are. Without it nobody but this computer is heard or reached; with
    /// it DDS listens on every network that the computer is in.
    pub address: Option<Ipv4Addr>,
    /// Velocities for the guard.
    pub velocities: Option<(VelocityFeed, VelocityRoute)>,
}

/// A robot in ROS 2, until it is dropped.
pub struct RosBridge {
    messages: RecordedSink,
    requests: Receiver<RosRequest>,
    threads: Vec<JoinHandle<()>>,
    closed: Arc<AtomicBool>,
    next_us: u64,
}

impl RosBridge {
    /// Opens the bridge.
    ///
    /// # Errors
    /// The domain's ports are taken, or the sockets cannot be kept on this computer.
    pub fn open(options: BridgeOptions) -> Result<Self, OpenError> {
        let BridgeOptions { domain, address, velocities } = options;
        let mut participant = Participant::over(take_part(domain, address)?)?;
        let (messages, waiting) = RecordedSink::over(QUEUE);
        let counters = messages.counters();
        let mut publisher = Publisher::open(&mut participant, Arc::clone(&counters))?;
        let (asked, requests) = sync_channel(REQUESTS);
        let mut listener = Listener::open(&mut participant, velocities, (asked, Arc::clone(&counters)))?;
        let presence = introduce(&mut participant)?;
        let closed = Arc::new(AtomicBool::new(false));
        let (ends, also_ends) = (Arc::clone(&closed), Arc::clone(&closed));
        let start = |name: &str, work: Box<dyn FnOnce() + Send>| {
            thread::Builder::new().name(name.to_owned()).spawn(work).map_err(OpenError::Thread)
        };
        let writes = start(
            "ros2 out",
            Box::new(move || {
                // The node is known as long as its writer lives, and everything as long as the participant does.
                let _lives = (&participant, &presence);
                publisher.run(&waiting, &ends);
            }),
        )?;
        let reads = start("ros2 in", Box::new(move || listener.run(&also_ends)))?;
        Ok(Self { messages, requests, threads: vec![writes, reads], closed, next_us: 0 })
    }

    /// Takes every message of a recording.
    #[must_use]
    pub fn listener(&self) -> Box<dyn MessageListener> {
        Box::new(self.messages.clone())
    }

    /// What went over the bridge so far.
    #[must_use]
    pub fn figures(&self) -> BridgeFigures {
        self.messages.counters.figures()
    }

    /// Shows the robot, and gives what was asked of it since. `moment` is made when it is due.
    pub fn attend(&mut self, now_us: u64, moment: impl FnOnce() -> Option<RobotMoment>) -> Vec<RosRequest> {
        if now_us >= self.next_us
            && let Some(moment) = moment()
        {
            self.next_us = now_us.saturating_add(SHOW_EVERY_US);
            self.messages.offer(Outgoing::Moment(moment, wall_us()));
        }
        self.requests.try_iter().take(REQUESTS).collect()
    }
}

impl Drop for RosBridge {
    fn drop(&mut self) {
        self.closed.store(true, Ordering::Relaxed);
        self.threads.drain(..).for_each(|thread| _ = thread.join());
    }
}

/// The recording's end of the queue.
#[derive(Clone)]
pub struct RecordedSink {
    queue: SyncSender<Outgoing>,
    counters: Arc<Counters>,
    /// Topics whose definition has gone through the queue.
    known: [bool; PUBLISHED.len()],
}

impl RecordedSink {
    /// A queue for so many messages, and its other end.
    pub fn over(capacity: usize) -> (Self, Receiver<Outgoing>) {
        let (queue, waiting) = sync_channel(capacity);
        (Self { queue, counters: Arc::default(), known: [false; PUBLISHED.len()] }, waiting)
    }

    /// What went through it.
    pub fn counters(&self) -> Arc<Counters> {
        Arc::clone(&self.counters)
    }

    /// Whether it fitted.
    fn offer(&self, outgoing: Outgoing) -> bool {
        let fits = self.queue.try_send(outgoing).is_ok();
        if !fits {
            self.counters.dropped.fetch_add(1, Ordering::Relaxed);
        }
        fits
    }
}

impl MessageListener for RecordedSink {
    fn message(&mut self, message: &LiveMessage<'_>) {
        let Some(index) = index_of(message.topic) else { return };
        let definition = (!self.known[index]).then(|| message.schema.definition());
        let clocks_us = (message.times.logged.as_micros(), wall_us());
        let data = message.data.to_vec();
        if self.offer(Outgoing::Recorded(Recorded { index, clocks_us, definition, data })) {
            self.known[index] = true;
        }
    }
}

fn wall_us() -> u64 {
    let since_1970 = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    u64::try_from(since_1970.as_micros()).unwrap_or(u64::MAX)
}

/// A participant that is kept on this computer, unless an address allows more.
pub fn take_part(domain: u16, address: Option<Ipv4Addr>) -> Result<rustdds::DomainParticipant, OpenError> {
    let before = loopback::open_sockets().map_err(OpenError::NotKept)?;
    let loopback = IpAddr::V4(Ipv4Addr::LOCALHOST);
    let networks = std::iter::once(loopback).chain(address.map(IpAddr::V4));
    let opened = DomainParticipantBuilder::new(domain).with_only_networks(networks).build();
    let participant =
        opened.map_err(|error| OpenError::Participant { domain, cause: format!("{error:?}") })?;
    if address.is_none() {
        loopback::tie_new(&before).map_err(OpenError::NotKept)?;
    }
    Ok(participant)
}

/// Tells the tools of ROS 2 which node all readers and writers belong to: `rmw_dds_common/msg/ParticipantEntitiesInfo`.
fn introduce(participant: &mut Participant) -> Result<MessageWriter, Refused> {
    let named =
        Named { topic: "ros_discovery_info".to_owned(), kind: "rmw_dds_common/msg/ParticipantEntitiesInfo" };
    let writer = participant.writer(&named, Quality::Kept(1))?;
    let mut encoder = Encoder::new();
    let bytes = |encoder: &mut Encoder, name: &[u8; 16]| name.iter().for_each(|byte| _ = encoder.u8(*byte));
    bytes(&mut encoder, &participant.name());
    encoder.length(1).text("/").text(NODE);
    let (readers, writers) = participant.entities();
    for names in [readers, writers] {
        encoder.length(names.len());
        names.iter().for_each(|name| bytes(&mut encoder, name));
    }
    writer.write(encoder.finish(), None).map_err(|error| Refused::from(&error))?;
    Ok(writer)
}
