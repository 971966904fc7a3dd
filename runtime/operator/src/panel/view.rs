//! Makes pictures of what the tasks share. Called from beside the rings, never from within them.

use std::collections::VecDeque;
use std::sync::Arc;

use embassy_sync::blocking_mutex::raw::RawMutex;
use floorguard_configuration::PanelConfiguration;
use floorguard_guard::{CauseRecord, GuardState, Health};
use floorguard_runtime::configuration::RobotConfiguration;
use floorguard_runtime::shared::{RobotStatus, Shared, StopRecord};
use floorguard_types::geometry::Point2;
use floorguard_types::time::Stamp;

use super::frame::{CauseFrame, Frame, PersonFrame, Place, SourceFrame, place, round};
use super::headline::headline;
use super::held_history::{HeldEvent, HeldHistory, HeldKind};
use super::layers::{Layers, MissionFrame, layers, mission_frame};
use super::pieces;
use super::plain::remedy;
use super::supplies::Supplies;
use crate::surroundings::{Surroundings, followed, scan_hits};
use floorguard_recording::{LidarView, describe};
use floorguard_robot::cleaner::{MissionOrders, MissionProgress};
use floorguard_robot::navigator::NavigationProgress;

/// Stops that the page lists.
const STOPS_SHOWN: usize = 8;
/// Lidar points of a picture; more are not visible.
const POINTS_SHOWN: usize = 1_500;
/// Points between these heights are drawn, metres above the floor.
const HEIGHTS_M: std::ops::Range<f32> = 0.15..2.0;

/// What pictures are made from.
pub struct PanelView {
    title: String,
    robot: RobotConfiguration,
    lidar: LidarView,
    points: Vec<Place>,
    stops: VecDeque<CauseFrame>,
    last_place: Option<Point2>,
    driven_m: f32,
    number: u64,
    /// What the page shows besides the robot.
    pub(super) configured: PanelConfiguration,
    /// What the robot uses up.
    pub(super) supplies: Supplies,
    mission: Option<Arc<MissionProgress>>,
    /// The first report of the mission: what was claimed then nobody has cleaned in it.
    mission_begin: Option<Arc<MissionProgress>>,
    /// The drive to a goal.
    drive: Option<Arc<NavigationProgress>>,
    layers: u64,
    /// What held the robot, and what came of the resets.
    history: HeldHistory,
    /// The last reset that was refused.
    refused: Option<HeldEvent>,
    /// What the mission is ordered to do.
    pub(super) missions: Option<MissionOrders>,
}

impl PanelView {
    /// For a robot; the title tells what runs.
    #[must_use]
    pub fn new(title: &str, robot: &RobotConfiguration) -> Self {
        Self {
            title: title.to_owned(),
            robot: robot.clone(),
            lidar: LidarView::new(robot.lidar_decoder(), robot.ring_angles(), 2),
            points: Vec::new(),
            stops: VecDeque::new(),
            last_place: None,
            driven_m: 0.0,
            number: 0,
            configured: PanelConfiguration::default(),
            supplies: Supplies::new(&PanelConfiguration::default(), robot.can.inputs_node),
            mission: None,
            mission_begin: None,
            drive: None,
            layers: 0,
            history: HeldHistory::default(),
            refused: None,
            missions: None,
        }
    }

    /// Shows these, too: other robots, parts that wear out, levels.
    #[must_use]
    pub fn showing(mut self, configured: &PanelConfiguration) -> Self {
        self.configured = configured.clone();
        self.supplies = Supplies::new(configured, self.robot.can.inputs_node);
        self
    }

    /// What runs.
    pub fn title(&self) -> &str {
        &self.title
    }

    /// A lidar datagram, where the panel can have them.
    pub fn lidar_datagram(&mut self, datagram: &[u8], arrival: Stamp) {
        let Some((_, rows)) = self.lidar.push(datagram, arrival) else { return };
        let mounting = self.robot.lidar.mounting.transform();
        let points = rows.iter().map(|row| {
            let [x_m, y_m, z_m] = row.position_m;
            mounting.transform(floorguard_types::geometry::Point3::new(x_m, y_m, z_m))
        });
        let points: Vec<_> = points.filter(|point| HEIGHTS_M.contains(&point.z_m)).collect();
        let every = points.len().div_ceil(POINTS_SHOWN).max(1);
        self.points =
            points.iter().step_by(every).map(|point| place(Point2::new(point.x_m, point.y_m))).collect();
    }

    /// A stop that began.
    pub fn stop(&mut self, record: &StopRecord, start: Stamp) -> CauseFrame {
        let at_s = seconds(record.stamp, start);
        let cause = CauseFrame { at_s, ..cause_frame(&record.cause, start) };
        self.list_stop(cause.clone());
        cause
    }

    /// What holds a stopped robot has changed, or a reset was answered: that belongs to the history of the stop.
    fn note_holding(&mut self, status: &RobotStatus, start: Stamp) {
        for event in self.history.news(status) {
            let at_s = seconds(event.at, start);
            let then = if event.kind == HeldKind::Held { "then " } else { "" };
            let text = format!("{then}{}", event.line());
            let (name, pieces) = (event.name.clone(), event.pieces.clone());
            self.list_stop(CauseFrame { at_s, name, text, pieces, remedy: event.remedy });
            if event.kind != HeldKind::Held {
                self.refused = Some(event).filter(|event| event.kind == HeldKind::ResetRefused);
            }
        }
        if status.decision.state != GuardState::Latched {
            self.refused = None;
        }
    }

    fn list_stop(&mut self, frame: CauseFrame) {
        self.stops.push_front(frame);
        self.stops.truncate(STOPS_SHOWN);
    }

    /// A picture of this moment; `start` is zero on the page. `None` before the guard's first decision.
    pub fn frame<M: RawMutex>(&mut self, shared: &Shared<M>, start: Stamp) -> Option<Frame> {
        let status = shared.status.get()?;
        let decision = &status.decision;
        let pose = status.pose.pose_in_odometry;
        let here = Point2::new(pose.x_m, pose.y_m);
        self.driven_m += self.last_place.replace(here).map_or(0.0, |last| last.distance(here));
        self.number += 1;
        self.note_holding(&status, start);
        let around = self.around(shared, &status);
        let holder = decision.holding_cause.and_then(|record| around.holder(&record));
        let headline_parts = headline(&status, holder.as_ref(), shared.is_paused());
        Some(Frame {
            headline: headline_parts.words(holder.as_ref()),
            headline_parts,
            holder,
            number: self.number,
            stamp: decision.stamp,
            time_s: seconds(decision.stamp, start),
            title: self.title.clone(),
            state: format!("{:?}", decision.state),
            action: decision.action.to_string(),
            speed_mps: round(status.pose.twist.linear_mps),
            limit_mps: round(decision.speed_limit_mps),
            paused: shared.is_paused(),
            reset_allowed: decision.state == GuardState::Latched,
            reset_refused: self.refused.as_ref().map(|event| format!("{}. {}", event.line(), event.remedy)),
            reset_refused_pieces: self.refused.as_ref().map_or_else(Vec::new, |event| event.pieces.clone()),
            start_allowed: decision.state == GuardState::AwaitsStart,
            pose: [round(pose.x_m), round(pose.y_m), pose.heading_rad],
            driven_m: round(self.driven_m),
            route: self.route(),
            drive: self.drive.as_ref().map(|drive| drive.words.clone()),
            footprint: places(&around.footprint),
            protective: places(&around.protective),
            warning: places(&around.warning),
            scan: places(&around.hits),
            lidar: self.points.clone(),
            people: people(shared),
            sources: sources(&status),
            cause: decision.holding_cause.map(|record| cause_frame(&record, start)),
            first_cause: other_than(decision.primary_cause, decision.holding_cause)
                .map(|record| cause_frame(&record, start)),
            mission: self.mission_frame(),
            queue: self.missions.as_ref().map(MissionOrders::status),
            records: 0,
            supplies: None,
            camera: 0,
            robots: 0,
            stops: self.stops.iter().cloned().collect(),
        })
    }

    /// What stands around the robot, in its frame.
    fn around<M: RawMutex>(&self, shared: &Shared<M>, status: &RobotStatus) -> Surroundings {
        let set = self.robot.fields.get(status.decision.field_set);
        let mounting = self.robot.scanner.mounting.transform();
        Surroundings {
            footprint: self.robot.geometry.footprint.to_vec(),
            protective: set.map(|set| set.protective.to_vec()).unwrap_or_default(),
            warning: set.map(|set| set.warning.to_vec()).unwrap_or_default(),
            hits: shared.scan.get().map(|scan| scan_hits(&scan, &mounting)).unwrap_or_default(),
            followed: followed(shared, status.pose.pose_in_odometry),
        }
    }

    /// The cleaning mission has reported its progress; gives the floor as it is now.
    pub fn mission(&mut self, progress: &Arc<MissionProgress>) -> Layers {
        self.layers += 1;
        let was_over = self.mission.as_ref().is_some_and(|before| before.phase.is_over());
        if was_over && !progress.phase.is_over() {
            // Another mission: what it cleans counts from here on.
            self.mission_begin = None;
        }
        self.mission = Some(Arc::clone(progress));
        let first = self.mission_begin.get_or_insert_with(|| Arc::clone(progress));
        layers(progress, first, self.layers)
    }

    /// The drive to a goal has reported its progress: its path is drawn instead of the route.
    pub fn navigation(&mut self, progress: &Arc<NavigationProgress>) {
        self.drive = Some(Arc::clone(progress));
    }

    /// What the robot drives along, odometry frame.
    fn route(&self) -> Vec<Place> {
        let Some(drive) = &self.drive else {
            return self.robot.route.waypoints.iter().copied().map(place).collect();
        };
        let to_odometry = drive.odometry_in_map.inverse();
        drive.path.iter().map(|at| place(to_odometry.transform(*at))).collect()
    }

    fn mission_frame(&self) -> Option<MissionFrame> {
        let (progress, first) = self.mission.as_ref().zip(self.mission_begin.as_ref())?;
        Some(mission_frame(progress, first, self.layers))
    }
}

fn cause_frame(record: &CauseRecord, start: Stamp) -> CauseFrame {
    CauseFrame {
        at_s: seconds(record.raised_at, start),
        name: record.cause.to_string(),
        text: record.to_string(),
        pieces: pieces::of_cause(record),
        remedy: remedy(record),
    }
}

/// The first, unless the second tells of the same cause.
fn other_than(first: Option<CauseRecord>, second: Option<CauseRecord>) -> Option<CauseRecord> {
    first.filter(|record| second.is_none_or(|second| second.cause != record.cause))
}

fn seconds(stamp: Stamp, start: Stamp) -> f64 {
    stamp.as_micros().saturating_sub(start.as_micros()) as f64 * 1.0e-6
}

fn places(polygon: &[Point2]) -> Vec<Place> {
    polygon.iter().copied().map(place).collect()
}

fn people<M: RawMutex>(shared: &Shared<M>) -> Vec<PersonFrame> {
    let report = shared.people.get().unwrap_or_default();
    let tracks = report.people.iter().map(|track| PersonFrame {
        id: track.id,
        at_m: place(track.position),
        velocity_mps: place(track.velocity_mps),
        person: describe::is_person(track),
    });
    tracks.collect()
}

fn sources(status: &RobotStatus) -> Vec<SourceFrame> {
    let fitted = status.sources.iter().filter(|report| report.fitted);
    let sources = fitted.map(|report| SourceFrame {
        name: report.source.name(),
        health: report.health.to_string(),
        good: report.health == Health::Healthy,
        age_ms: (report.age_us < u64::MAX).then_some(report.age_us / 1_000),
    });
    sources.collect()
}
