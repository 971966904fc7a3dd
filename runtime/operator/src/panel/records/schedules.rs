//! Missions that begin by the clock.

use anyhow::ensure;
use floorguard_robot::environment::{Calendar, CivilMoment};
use serde::{Deserialize, Serialize};

/// Schedules that are kept.
const SCHEDULES_MAX: usize = 32;
/// Letters of a name.
const NAME_MAX: usize = 40;
/// A robot that is switched on this long after the time still begins, minutes.
const LATE_MAX_MIN: u16 = 10;
/// Minutes of a day.
const DAY_MIN: u16 = 24 * 60;

/// A mission on days of the week.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Schedule {
    /// What people call it.
    pub name: String,
    /// Days of the week, 1 Monday to 7 Sunday, each once, in their order.
    pub weekdays: Vec<u8>,
    /// When, on the clock on the wall, minutes after midnight.
    pub minute: u16,
    /// Names of the areas to clean; none: the whole floor.
    pub areas: Vec<String>,
    /// The date on which it began last; empty before the first time.
    #[serde(default)]
    pub began: String,
}

impl Schedule {
    /// Whether it begins now: on its day, at most ten minutes after its time, and not twice on one day. An hour that the clock
    /// leaves out in spring is left out, too.
    #[must_use]
    pub fn is_due(&self, now: &CivilMoment) -> bool {
        let late_min = now.minute.checked_sub(self.minute);
        self.weekdays.contains(&now.weekday)
            && late_min.is_some_and(|late_min| late_min < LATE_MAX_MIN)
            && self.began != now.date
    }

    fn check(&self) -> anyhow::Result<()> {
        let letters = self.name.chars().count();
        ensure!((1..=NAME_MAX).contains(&letters), "a name has 1 to {NAME_MAX} letters");
        let in_order = self.weekdays.windows(2).all(|pair| matches!(pair, [a, b] if a < b));
        ensure!(
            !self.weekdays.is_empty() && in_order && self.weekdays.iter().all(|day| (1..=7).contains(day)),
            "choose days of the week"
        );
        ensure!(self.minute < DAY_MIN, "a day has {DAY_MIN} minutes");
        ensure!(self.areas.len() <= SCHEDULES_MAX && self.began.len() <= 10, "too much for one schedule");
        Ok(())
    }
}

/// Refuses what the clock cannot do.
///
/// # Errors
/// Too many, two of one name, no day, no time of day.
pub(super) fn check_schedules(schedules: &[Schedule]) -> anyhow::Result<()> {
    ensure!(schedules.len() <= SCHEDULES_MAX, "at most {SCHEDULES_MAX} schedules");
    for (index, schedule) in schedules.iter().enumerate() {
        schedule.check()?;
        let is_twice = schedules.iter().take(index).any(|other| other.name == schedule.name);
        ensure!(!is_twice, "two schedules have the name {}", schedule.name);
    }
    Ok(())
}

/// Those that begin now; they are marked as begun on this date.
pub(super) fn take_due(schedules: &mut [Schedule], calendar: &Calendar) -> Vec<Schedule> {
    let Some(now) = calendar.civil(Calendar::now()) else { return Vec::new() };
    take_due_at(schedules, &now)
}

fn take_due_at(schedules: &mut [Schedule], now: &CivilMoment) -> Vec<Schedule> {
    let due = schedules.iter_mut().filter(|schedule| schedule.is_due(now));
    due.map(|schedule| {
        schedule.began.clone_from(&now.date);
        schedule.clone()
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(zone: &str, text: &str) -> CivilMoment {
        let calendar = Calendar::named(zone).unwrap();
        calendar.civil(calendar.parse(text).unwrap()).unwrap()
    }

    fn nightly() -> Schedule {
        let (name, areas) = ("night".to_owned(), vec!["hall".to_owned()]);
        Schedule { name, weekdays: vec![1, 2, 3, 4, 5], minute: 22 * 60, areas, began: String::new() }
    }

    #[test]
    fn schedule_begins_once_on_its_days() {
        let mut schedules = [nightly()];
        for (moment, begins) in [
            ("2026-11-23T21:59:59", false), // Monday.
            ("2026-11-23T22:00:00", true),
            ("2026-11-23T22:00:01", false),
            ("2026-11-24T22:09:59", true), // Switched on late.
            ("2026-11-25T22:10:00", false),
            ("2026-11-28T22:00:00", false), // Saturday.
            ("2026-11-30T22:03:00", true),
        ] {
            let due = take_due_at(&mut schedules, &at("Europe/Berlin", moment));
            assert_eq!(due.len(), usize::from(begins), "{moment}");
        }
    }

    /// The hour that comes twice in autumn begins one mission; the same moment is another hour elsewhere.
    #[test]
    fn clock_changes_begin_no_second_mission() {
        let mut schedules = [Schedule { weekdays: vec![7], minute: 2 * 60 + 30, ..nightly() }];
        let begun = |moment: &str, schedules: &mut [Schedule]| {
            take_due_at(schedules, &at("Europe/Berlin", moment)).len()
        };
        assert_eq!(begun("2026-10-25T00:30:00Z", &mut schedules), 1);
        assert_eq!(begun("2026-10-25T01:30:00Z", &mut schedules), 0);
        let mut spring = [Schedule { weekdays: vec![7], minute: 2 * 60 + 30, ..nightly() }];
        assert_eq!(begun("2027-03-28T01:30:00Z", &mut spring), 0, "there is no half past two");
    }

    #[test]
    fn nonsense_is_no_schedule() {
        let wrong = [
            Schedule { weekdays: vec![], ..nightly() },
            Schedule { weekdays: vec![0], ..nightly() },
            Schedule { weekdays: vec![3, 2], ..nightly() },
            Schedule { minute: 1_440, ..nightly() },
            Schedule { name: String::new(), ..nightly() },
        ];
        for schedule in wrong {
            assert!(check_schedules(std::slice::from_ref(&schedule)).is_err(), "{schedule:?}");
        }
        assert!(check_schedules(&[nightly(), nightly()]).is_err());
        assert!(check_schedules(&[nightly()]).is_ok());
    }
}
