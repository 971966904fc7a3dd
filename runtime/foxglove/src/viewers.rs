//! Who watches: channels, what each viewer has subscribed to, and its queue. The telemetry thread puts in, the connections take out.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use floorguard_recording::{LiveMessage, topics, truth};
use floorguard_types::time::Stamp;
use tokio::sync::mpsc::{Receiver, Sender, channel};

use super::protocol::{self, Channel, Request};

/// Viewers at once; more are refused.
pub const VIEWERS_MAX: usize = 16;
/// Frames that wait for a viewer; what comes on top is dropped.
const QUEUE_FRAMES: usize = 512;
/// Subscriptions of a viewer; there are fewer channels.
const SUBSCRIPTIONS_MAX: usize = 256;
/// The robot's clock is sent this often, microseconds.
const TIME_EVERY_US: u64 = 50_000;
/// Topics that come seldom: who subscribes gets the newest message at once.
const KEPT: [&str; 10] = [
    topics::TF_STATIC,
    topics::MAP,
    topics::CLAIMED,
    topics::DIRT,
    topics::SEEN_DIRT,
    topics::PLAN,
    topics::COSTMAP,
    topics::FIELDS,
    topics::STOPS,
    truth::TRUE_THINGS,
];

/// A frame for a viewer.
pub enum Frame {
    /// JSON.
    Text(String),
    /// A message or a time.
    Binary(Vec<u8>),
}

/// What went over the connections.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LiveFigures {
    /// Messages that were put into viewers' queues.
    pub sent: u64,
    /// Messages that did not fit.
    pub dropped: u64,
    /// Connections that were opened.
    pub connections: u64,
}

#[derive(Default)]
struct Counters {
    sent: AtomicU64,
    dropped: AtomicU64,
    connections: AtomicU64,
}

struct Viewer {
    frames: Sender<Frame>,
    /// The viewer's number by channel.
    subscribed: BTreeMap<u32, u32>,
    dropped: Arc<AtomicU64>,
}

#[derive(Default)]
struct Watched {
    channels: BTreeMap<&'static str, Channel>,
    /// The newest message of a topic that comes seldom, as time and content.
    kept: BTreeMap<u32, (u64, Vec<u8>)>,
    viewers: BTreeMap<u64, Viewer>,
    next_viewer: u64,
    time_us: u64,
}

/// A viewer's side of its queue.
pub struct Seat {
    /// Its number.
    pub number: u64,
    /// What to send.
    pub frames: Receiver<Frame>,
    /// What was dropped for it so far.
    pub dropped: Arc<AtomicU64>,
}

/// All viewers of a run. The lock is held for copying only, never while something is sent.
#[derive(Clone, Default)]
pub struct Viewers {
    watched: Arc<Mutex<Watched>>,
    counters: Arc<Counters>,
}

fn nanoseconds(stamp: Stamp) -> u64 {
    stamp.as_micros().saturating_mul(1_000)
}

impl Viewer {
    /// Whether the frame fitted.
    fn offer(&self, frame: Frame) -> bool {
        let fits = self.frames.try_send(frame).is_ok();
        if !fits {
            self.dropped.fetch_add(1, Ordering::Relaxed);
        }
        fits
    }
}

impl Viewers {
    fn locked(&self) -> MutexGuard<'_, Watched> {
        self.watched.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What went over the connections so far.
    pub fn figures(&self) -> LiveFigures {
        let read = |counter: &AtomicU64| counter.load(Ordering::Relaxed);
        LiveFigures {
            sent: read(&self.counters.sent),
            dropped: read(&self.counters.dropped),
            connections: read(&self.counters.connections),
        }
    }

    /// A message of the run: to each viewer that has subscribed to its channel. Nothing waits.
    pub fn publish(&self, message: &LiveMessage<'_>) {
        let mut watched = self.locked();
        let number = watched.channels.len() as u32 + 1;
        let is_new = !watched.channels.contains_key(message.topic);
        let channel = watched
            .channels
            .entry(message.topic)
            .or_insert_with(|| Channel::new(number, message.topic, message.schema));
        let (id, advertisement) =
            (channel.id, is_new.then(|| protocol::advertise(std::iter::once(&*channel))));
        let log_time_ns = nanoseconds(message.times.logged);
        if KEPT.contains(&message.topic) {
            watched.kept.insert(id, (log_time_ns, message.data.to_vec()));
        }
        for viewer in watched.viewers.values() {
            advertisement.iter().for_each(|text| _ = viewer.offer(Frame::Text(text.clone())));
            let Some(subscription) = viewer.subscribed.get(&id) else { continue };
            let frame = Frame::Binary(protocol::message_data(*subscription, log_time_ns, message.data));
            let counter = if viewer.offer(frame) { &self.counters.sent } else { &self.counters.dropped };
            counter.fetch_add(1, Ordering::Relaxed);
        }
        let logged_us = message.times.logged.as_micros();
        if logged_us >= watched.time_us.saturating_add(TIME_EVERY_US) {
            watched.time_us = logged_us;
            let viewers = watched.viewers.values();
            // A viewer that stalls is not sent the time either; what it loses so is not counted.
            viewers.for_each(|viewer| _ = viewer.frames.try_send(Frame::Binary(protocol::time(log_time_ns))));
        }
    }

    /// A place for another viewer, which hears first who speaks and which channels there are; `None` when all are taken.
    pub fn seat(&self, (name, session): (&str, &str)) -> Option<Seat> {
        let mut watched = self.locked();
        if watched.viewers.len() >= VIEWERS_MAX {
            return None;
        }
        let (sender, frames) = channel(QUEUE_FRAMES);
        let dropped = Arc::new(AtomicU64::new(0));
        let viewer = Viewer { frames: sender, subscribed: BTreeMap::new(), dropped: Arc::clone(&dropped) };
        viewer.offer(Frame::Text(protocol::server_info(name, session)));
        viewer.offer(Frame::Text(protocol::advertise(watched.channels.values())));
        let number = watched.next_viewer;
        watched.next_viewer += 1;
        watched.viewers.insert(number, viewer);
        self.counters.connections.fetch_add(1, Ordering::Relaxed);
        Some(Seat { number, frames, dropped })
    }

    /// A viewer has gone.
    pub fn leave(&self, number: u64) {
        self.locked().viewers.remove(&number);
    }

    /// What a viewer asks for.
    pub fn request(&self, number: u64, request: Request) {
        let mut watched = self.locked();
        let Watched { kept, viewers, .. } = &mut *watched;
        let Some(viewer) = viewers.get_mut(&number) else { return };
        match request {
            Request::Subscribe { subscriptions } => {
                for subscription in subscriptions {
                    if viewer.subscribed.len() >= SUBSCRIPTIONS_MAX {
                        break;
                    }
                    viewer.subscribed.insert(subscription.channel_id, subscription.id);
                    if let Some((log_time_ns, data)) = kept.get(&subscription.channel_id) {
                        let frame = protocol::message_data(subscription.id, *log_time_ns, data);
                        viewer.offer(Frame::Binary(frame));
                    }
                }
            }
            Request::Unsubscribe { subscription_ids } => {
                viewer.subscribed.retain(|_, id| !subscription_ids.contains(id));
            }
            Request::Other => {}
        }
    }
}
