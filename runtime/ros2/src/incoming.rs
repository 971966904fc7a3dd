//! What comes in: velocities, places and services, on a thread of its own, so that nothing that goes out delays them.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::SyncSender;
use std::thread;
use std::time::Duration;

use floorguard_host::executor::{Ring, take_priority};

use super::counters::Counters;
use super::dds::{MessageReader, Named, Participant, Refused};
use super::names;
use super::requests::{RosRequest, place};
use super::services::{self, Service};
use super::velocities::{Velocities, VelocityFeed, VelocityRoute};

/// The readers are looked at this often; a velocity waits for it.
const LOOK_EVERY: Duration = Duration::from_millis(4);
/// Samples of a reader at once; the rest waits for the next look.
const AT_ONCE: usize = 16;

/// A place, and what it means.
struct PlaceReader {
    reader: MessageReader,
    meaning: fn(floorguard_types::geometry::Pose2) -> RosRequest,
}

/// Everything that comes in.
pub struct Listener {
    velocities: Option<(Velocities, Vec<MessageReader>)>,
    places: Vec<PlaceReader>,
    services: Vec<Service>,
    requests: SyncSender<RosRequest>,
    counters: Arc<Counters>,
}

impl Listener {
    /// Opens every topic and service.
    ///
    /// # Errors
    /// DDS refuses one.
    pub fn open(
        participant: &mut Participant,
        feed: Option<(VelocityFeed, VelocityRoute)>,
        (requests, counters): (SyncSender<RosRequest>, Arc<Counters>),
    ) -> Result<Self, Refused> {
        let mut read = |name: &str, kind| {
            let named = Named { topic: names::topic(name), kind };
            participant.reader(&named, false)
        };
        let velocities = match feed {
            Some((feed, route)) => {
                let kinds = ["geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped"];
                let readers: Result<_, Refused> =
                    kinds.into_iter().map(|kind| read(&route.topic, kind)).collect();
                Some((Velocities::new(feed, &route), readers?))
            }
            None => None,
        };
        let places = vec![
            PlaceReader {
                reader: read("/goal_pose", "geometry_msgs/msg/PoseStamped")?,
                meaning: RosRequest::Goal,
            },
            PlaceReader {
                reader: read("/initialpose", "geometry_msgs/msg/PoseWithCovarianceStamped")?,
                meaning: RosRequest::Relocate,
            },
        ];
        Ok(Self { velocities, places, services: services::open(participant)?, requests, counters })
    }

    /// Takes what comes until the bridge is closed.
    pub fn run(&mut self, closed: &AtomicBool) {
        let _ = take_priority(Ring::Telemetry);
        while !closed.load(Ordering::Relaxed) {
            self.look();
            thread::sleep(LOOK_EVERY);
        }
    }

    fn look(&mut self) {
        let (requests, counters) = (&self.requests, &self.counters);
        let count = |is_understood: bool| {
            let counter = if is_understood { &counters.received } else { &counters.not_understood };
            counter.fetch_add(1, Ordering::Relaxed);
        };
        if let Some((velocities, readers)) = &mut self.velocities {
            for reader in readers {
                samples(reader, |sample| count(velocities.take(sample)));
            }
        }
        for PlaceReader { reader, meaning } in &mut self.places {
            samples(reader, |sample| {
                let ordered = place(sample.value()).map(*meaning);
                count(ordered.is_some_and(|ordered| requests.try_send(ordered).is_ok()));
            });
        }
        for service in &mut self.services {
            service.attend(|request| {
                let is_taken = requests.try_send(request).is_ok();
                count(is_taken);
                is_taken
            });
        }
    }
}

fn samples(reader: &mut MessageReader, mut take: impl FnMut(&super::dds::Sample)) {
    for _ in 0..AT_ONCE {
        match reader.take_next_sample() {
            Ok(Some(sample)) => take(&sample),
            Ok(None) | Err(_) => return,
        }
    }
}
