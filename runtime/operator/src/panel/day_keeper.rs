//! Adds what the robot does to the day's record, and what happens to the alerts.

use std::time::Instant;

use floorguard_configuration::Consumable;
use floorguard_robot::environment::Calendar;

use super::frame::{CauseFrame, Frame};
use super::records::{Alert, Day, MissionRecord, SharedRecords};

/// The records are written this often, seconds.
const EVERY_S: f64 = 1.0;
/// A longer pause between two pictures was not watched, seconds.
const GAP_S: f64 = 2.0;
/// Slower counts as standing, m/s.
const STANDING_MPS: f32 = 0.02;

/// What has come together since the records were written.
#[derive(Default)]
struct Since {
    on_s: f64,
    moving_s: f64,
    held_s: f64,
    driven_m: f64,
}

/// What a mission promises of the floor that it claims.
#[derive(Clone, Copy, Debug, Default)]
pub struct Promise {
    /// Confidence, percent.
    pub confidence_percent: f64,
    /// Tolerated dirt of a cell, units.
    pub tolerated_units: u8,
}

/// Keeps the day.
pub struct DayKeeper {
    records: SharedRecords,
    parts: Vec<Consumable>,
    calendar: Calendar,
    pub(super) promise: Promise,
    since: Since,
    last: Option<(f64, f32)>,
    written: Option<Instant>,
    /// When the mission that runs began, and its name.
    mission: Option<(String, String)>,
    phase: &'static str,
}

impl DayKeeper {
    /// Into these records, with the parts that wear out.
    pub fn new(records: SharedRecords, parts: &[Consumable]) -> Self {
        Self {
            records,
            parts: parts.to_vec(),
            calendar: Calendar::of_this_computer(),
            promise: Promise::default(),
            since: Since::default(),
            last: None,
            written: None,
            mission: None,
            phase: "",
        }
    }

    fn now(&self) -> String {
        self.calendar.iso(Calendar::now())
    }

    /// Something stopped the robot.
    pub fn alert(&self, cause: &CauseFrame) {
        let alert = Alert {
            at: self.now(),
            name: cause.name.clone(),
            text: cause.text.clone(),
            remedy: cause.remedy.to_owned(),
            ..Alert::default()
        };
        let now = self.now();
        let mut records = self.records.lock();
        records.on_day(date_of(&now), |day| *day.stops.entry(cause.name.clone()).or_default() += 1);
        records.alert(alert);
    }

    /// A picture was made.
    pub fn look(&mut self, frame: &Frame) {
        let (before_s, before_m) =
            self.last.replace((frame.time_s, frame.driven_m)).unwrap_or((frame.time_s, frame.driven_m));
        let lasted_s = frame.time_s - before_s;
        if (0.0..GAP_S).contains(&lasted_s) {
            self.since.on_s += lasted_s;
            self.since.moving_s += if frame.speed_mps.abs() > STANDING_MPS { lasted_s } else { 0.0 };
            self.since.held_s += if is_held(frame) { lasted_s } else { 0.0 };
            self.since.driven_m += f64::from(frame.driven_m - before_m).max(0.0);
        }
        if self.written.is_none_or(|written| written.elapsed().as_secs_f64() >= EVERY_S) {
            self.written = Some(Instant::now());
            self.write(frame);
        }
    }

    fn write(&mut self, frame: &Frame) {
        let now = self.now();
        let since = std::mem::take(&mut self.since);
        let mission = self.mission_record(frame, &now);
        let add = |day: &mut Day| {
            day.on_s += since.on_s;
            day.moving_s += since.moving_s;
            day.held_s += since.held_s;
            day.driven_m += since.driven_m;
            if let Some(cause) = frame.cause.as_ref().filter(|_| since.held_s > 0.0) {
                *day.held_by_s.entry(cause.name.clone()).or_default() += since.held_s;
                day.hold_at(place_of(frame), since.held_s);
            }
            mission.into_iter().for_each(|mission| day.mission(mission));
        };
        self.records.lock().on_day(date_of(&now), add);
        self.wear(since.moving_s, &now);
    }

    /// Parts wear while the robot drives.
    fn wear(&self, moving_s: f64, now: &str) {
        let mut records = self.records.lock();
        for part in &self.parts {
            if records.use_part(&part.name, moving_s, part.life_h) {
                records.alert(Alert {
                    at: now.to_owned(),
                    name: "a part is worn out".to_owned(),
                    text: format!("{}: {:.0} h driven with it", part.name, part.life_h),
                    remedy: "Change the part and acknowledge it at the panel.".to_owned(),
                    ..Alert::default()
                });
            }
        }
    }

    /// A mission belongs to the day on which it is heard of; one that begins anew is another.
    fn mission_record(&mut self, frame: &Frame, now: &str) -> Option<MissionRecord> {
        let mission = frame.mission.as_ref()?;
        let name = frame.queue.as_ref().map(|queue| queue.name.clone()).unwrap_or_default();
        let was_over = ["done", "cancelled"].contains(&self.phase);
        let is_over = ["done", "cancelled"].contains(&mission.phase);
        self.phase = mission.phase;
        let is_another =
            self.mission.as_ref().is_none_or(|(_, known)| *known != name) || (was_over && !is_over);
        if is_another {
            self.mission = Some((now.to_owned(), name.clone()));
        }
        if was_over && is_over && !is_another {
            return None;
        }
        let (began, _) = self.mission.clone()?;
        Some(MissionRecord {
            name,
            began,
            ended: now.to_owned(),
            phase: mission.phase.to_owned(),
            cleaned_m2: mission.cleaned_m2,
            assumed_m2: mission.assumed_m2,
            to_do_m2: mission.remaining_m2,
            confidence_percent: self.promise.confidence_percent,
            tolerated_units: self.promise.tolerated_units,
            unreachable_cells: mission.unreachable_cells,
            waited_s: mission.waited_s,
        })
    }
}

fn is_held(frame: &Frame) -> bool {
    frame.cause.is_some() && frame.limit_mps <= 0.0
}

/// In the map where there is one.
fn place_of(frame: &Frame) -> String {
    let [x_m, y_m, _] = frame.pose;
    let (x_m, y_m) = frame.mission.as_ref().map_or((x_m, y_m), |mission| {
        let [map_x_m, map_y_m, turn_rad] = mission.odometry_in_map;
        let (sin, cos) = libm::sincosf(turn_rad);
        (map_x_m + cos * x_m - sin * y_m, map_y_m + sin * x_m + cos * y_m)
    });
    // Rounded first, so that no place is called -0.
    format!("{},{}", x_m.round() + 0.0, y_m.round() + 0.0)
}

fn date_of(iso: &str) -> &str {
    iso.get(..10).unwrap_or(iso)
}
