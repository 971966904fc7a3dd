//! What goes out: messages of the recording, and what the bridge makes of them, on a thread of its own.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::Duration;

use floorguard_host::executor::{Ring, take_priority};
use floorguard_recording::decode::odometry;
use floorguard_recording::{Diagnostic, Severity, diagnostics_message, grid_message, topics};
use floorguard_types::geometry::Point2;
use floorguard_types::time::Stamp;

use super::counters::Counters;
use super::dds::{Message, MessageWriter, Named, Participant, Quality, Refused};
use super::moment::RobotMoment;
use super::published::{PUBLISHED, Published};
use super::restamp::Layout;
use super::{costmap, names, nav2};

/// A clock on the wall that is set by more than this is followed, microseconds.
const FOLLOW_US: i64 = 100_000;
/// The costmap of people comes this often, microseconds.
const COSTMAP_EVERY_US: u64 = 200_000;
/// What nav2 gets is repeated this often, microseconds, and the bridge's own figures.
const AGAIN_EVERY_US: u64 = 1_000_000;
/// How long a thread waits before it looks whether it is to end.
const WAIT: Duration = Duration::from_millis(100);
/// The frame of people and of their costmap.
const FRAME: &str = "odom";

/// Something to publish.
pub enum Outgoing {
    /// A message of the recording.
    Recorded(Recorded),
    /// What the guard does.
    Moment(RobotMoment, u64),
}

/// A message of the recording.
pub struct Recorded {
    /// Its place among [`PUBLISHED`].
    pub index: usize,
    /// When it was recorded on the robot's clock, and what the clock on the wall showed, microseconds.
    pub clocks_us: (u64, u64),
    /// The definition of its type, with the first of its messages.
    pub definition: Option<String>,
    /// The message.
    pub data: Message,
}

/// One topic.
struct Channel {
    writer: MessageWriter,
    layout: Option<Layout>,
}

/// All topics that go out.
pub struct Publisher {
    channels: Vec<Channel>,
    state: MessageWriter,
    limit: MessageWriter,
    costs: MessageWriter,
    counters: Arc<Counters>,
    /// The clock on the wall less the robot's, microseconds.
    offset_us: Option<i64>,
    place: Option<Point2>,
    reported: Option<RobotMoment>,
    /// When what comes by the clock is due: costmap, nav2, figures.
    next_us: [u64; 3],
}

impl Publisher {
    /// Opens every topic.
    ///
    /// # Errors
    /// DDS refuses one.
    pub fn open(participant: &mut Participant, counters: Arc<Counters>) -> Result<Self, Refused> {
        let channel = |participant: &mut Participant, each: &Published| {
            let named = Named { topic: names::topic(each.name), kind: each.kind };
            Ok(Channel { writer: participant.writer(&named, each.quality)?, layout: None })
        };
        let channels: Result<_, Refused> = PUBLISHED.iter().map(|each| channel(participant, each)).collect();
        let mut own = |name: &str, kind, quality| {
            participant.writer(&Named { topic: names::topic(name), kind }, quality)
        };
        Ok(Self {
            channels: channels?,
            state: own(
                "/collision_monitor_state",
                "nav2_msgs/msg/CollisionMonitorState",
                Quality::Newest(10),
            )?,
            limit: own("/speed_limit", "nav2_msgs/msg/SpeedLimit", Quality::Newest(10))?,
            costs: own("/people/costmap", "nav_msgs/msg/OccupancyGrid", Quality::Kept(1))?,
            counters,
            offset_us: None,
            place: None,
            reported: None,
            next_us: [0; 3],
        })
    }

    /// Publishes what comes until the bridge is closed.
    pub fn run(&mut self, queue: &Receiver<Outgoing>, closed: &AtomicBool) {
        let _ = take_priority(Ring::Telemetry);
        while !closed.load(Ordering::Relaxed) {
            match queue.recv_timeout(WAIT) {
                Ok(Outgoing::Recorded(recorded)) => self.recorded(recorded),
                Ok(Outgoing::Moment(moment, wall_us)) => self.moment(moment, wall_us),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return,
            }
        }
    }

    fn recorded(&mut self, recorded: Recorded) {
        let Recorded { index, clocks_us: (robot_us, wall_us), definition, mut data } = recorded;
        let offset_us = self.follow(robot_us, wall_us);
        let Some(channel) = self.channels.get_mut(index) else { return };
        if let Some(definition) = definition {
            channel.layout = Some(Layout::of(&definition));
        }
        let Some(layout) = &channel.layout else { return };
        layout.shift(&mut data, offset_us);
        match PUBLISHED.get(index).map(|each| each.recorded) {
            Some(topics::ODOMETRY) => {
                let at = odometry(&data).map(|odometry| odometry.pose);
                self.place = at.map(|pose| Point2::new(pose.x_m, pose.y_m)).or(self.place);
            }
            Some(topics::DETECTIONS) if wall_us >= self.next_us[0] => {
                self.next_us[0] = wall_us.saturating_add(COSTMAP_EVERY_US);
                self.costmap(&data, moved(robot_us, offset_us));
            }
            _ => {}
        }
        self.write(|publisher| publisher.channels.get(index).map(|channel| &channel.writer), data);
        self.figures(wall_us);
    }

    /// The clock on the wall less the robot's. A jump of the clock on the wall is followed, its trembling is not.
    fn follow(&mut self, robot_us: u64, wall_us: u64) -> i64 {
        let now_us = i64::try_from(wall_us).unwrap_or(i64::MAX) - i64::try_from(robot_us).unwrap_or(i64::MAX);
        let offset_us = self.offset_us.get_or_insert(now_us);
        if (now_us - *offset_us).abs() > FOLLOW_US {
            *offset_us = now_us;
        }
        *offset_us
    }

    fn costmap(&mut self, detections: &[u8], stamp: Stamp) {
        let (Some(place), Some(people)) = (self.place, costmap::people(detections)) else { return };
        let (origin, cells) = costmap::cells(&people, place);
        let message = grid_message(stamp, FRAME, &costmap::grid(origin, &cells));
        self.write(|publisher| Some(&publisher.costs), message);
    }

    /// nav2 hears what changes at once, and the rest now and then.
    fn moment(&mut self, moment: RobotMoment, wall_us: u64) {
        let is_news = self.reported.as_ref().is_none_or(|before| {
            (before.restraint, &before.cause) != (moment.restraint, &moment.cause)
                || nav2::limit_mps(before) != nav2::limit_mps(&moment)
        });
        if !is_news && wall_us < self.next_us[1] {
            return;
        }
        self.next_us[1] = wall_us.saturating_add(AGAIN_EVERY_US);
        let stamp = Stamp::from_micros(wall_us);
        let (state, limit) = (nav2::collision_monitor_state(&moment), nav2::speed_limit(&moment, stamp));
        self.write(|publisher| Some(&publisher.state), state);
        self.write(|publisher| Some(&publisher.limit), limit);
        self.reported = Some(moment);
    }

    fn figures(&mut self, wall_us: u64) {
        if wall_us < self.next_us[2] {
            return;
        }
        self.next_us[2] = wall_us.saturating_add(AGAIN_EVERY_US);
        let figures = self.counters.figures();
        let severity = if figures.dropped == 0 { Severity::Good } else { Severity::Warning };
        let values = figures.named().map(|(name, value)| (name.to_owned(), value.to_string()));
        let own = Diagnostic {
            severity,
            name: "ROS 2 bridge".to_owned(),
            message: figures.to_string(),
            values: values.to_vec(),
        };
        let message = diagnostics_message(Stamp::from_micros(wall_us), &[own]);
        let index = super::published::index_of(topics::DIAGNOSTICS);
        self.write(|publisher| publisher.channels.get(index?).map(|channel| &channel.writer), message);
    }

    fn write(&self, writer: impl FnOnce(&Self) -> Option<&MessageWriter>, message: Message) {
        let Some(writer) = writer(self) else { return };
        let counter = match writer.write(message, None) {
            Ok(()) => &self.counters.sent,
            Err(_) => &self.counters.refused,
        };
        counter.fetch_add(1, Ordering::Relaxed);
    }
}

/// A moment of the robot's clock on the clock on the wall.
fn moved(robot_us: u64, offset_us: i64) -> Stamp {
    Stamp::from_micros(robot_us.saturating_add_signed(offset_us))
}
