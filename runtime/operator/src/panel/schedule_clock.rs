//! Begins the missions that are due, by the clock of the robot's computer.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use floorguard_robot::cleaner::MissionOrder;
use floorguard_robot::environment::Calendar;

use super::hub::mission_of;
use super::records::{Alert, Schedule, SharedRecords};

/// The clock is read this often.
const EVERY: Duration = Duration::from_secs(1);

/// Reads the clock.
pub struct ScheduleClock {
    records: SharedRecords,
    calendar: Calendar,
    looked: Option<Instant>,
    due: VecDeque<MissionOrder>,
    /// The robot has a mission that can be ordered.
    pub(super) has_mission: bool,
}

impl ScheduleClock {
    /// Of these records.
    pub fn new(records: SharedRecords) -> Self {
        let calendar = Calendar::of_this_computer();
        Self { records, calendar, looked: None, due: VecDeque::new(), has_mission: false }
    }

    /// Looks at the clock when it is time to. What is due waits behind the missions that were ordered before it; a robot that
    /// waits for its start command waits for it all the same.
    pub fn look(&mut self) {
        if !self.has_mission || self.looked.is_some_and(|looked| looked.elapsed() < EVERY) {
            return;
        }
        self.looked = Some(Instant::now());
        let due = self.records.lock().take_due(&self.calendar);
        due.into_iter().for_each(|schedule| self.begin(&schedule));
    }

    fn begin(&mut self, schedule: &Schedule) {
        let mut records = self.records.lock();
        let order = mission_of(&schedule.areas, &records.kept().areas);
        match order.filter(|order| order.check().is_ok()) {
            Some(order) => self.due.push_back(order),
            None => records.alert(Alert {
                at: self.calendar.iso(Calendar::now()),
                name: "a scheduled mission did not begin".to_owned(),
                text: format!("{}: an area of it is not on the map any more", schedule.name),
                remedy: "Choose other areas for the schedule, or remove it.".to_owned(),
                ..Alert::default()
            }),
        }
    }

    /// The next order.
    pub fn order(&mut self) -> Option<MissionOrder> {
        self.due.pop_front()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::panel::Records;
    use floorguard_robot::cleaner::{Area, AreaKind};

    /// A schedule for this minute begins once; one whose area is gone gives an alert.
    #[test]
    fn what_is_due_becomes_an_order() {
        let calendar = Calendar::of_this_computer();
        let now = calendar.civil(Calendar::now()).expect("a date");
        let schedule = |name: &str, area: &str| Schedule {
            name: name.to_owned(),
            weekdays: (1..=7).collect(),
            minute: now.minute,
            areas: vec![area.to_owned()],
            began: String::new(),
        };
        let mut records = Records::default();
        let corners_m = vec![[0.0, 0.0], [2.0, 0.0], [2.0, 2.0]];
        records.set_areas(vec![Area { name: "hall".to_owned(), kind: AreaKind::Clean, corners_m }]).unwrap();
        records.set_schedules(vec![schedule("nightly", "hall"), schedule("old", "lobby")]).unwrap();
        let records = SharedRecords::new(records);
        let mut clock = ScheduleClock::new(records.clone());
        clock.look();
        assert_eq!(clock.order(), None, "a robot without a mission cleans nothing");
        clock.has_mission = true;
        clock.look();
        assert!(matches!(clock.order(), Some(MissionOrder::Begin { name, .. }) if name == "hall"));
        assert_eq!(clock.order(), None);
        assert!(records.lock().kept().alerts.newest().is_some_and(|alert| alert.text.contains("old")));
        clock.looked = None;
        clock.look();
        assert_eq!(clock.order(), None, "once a day");
    }
}
