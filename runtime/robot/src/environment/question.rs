//! What can be asked.

use anyhow::{Context, ensure};

use super::zones::Zone;

/// Hours of the week.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WeekHours {
    /// From this full hour on, 0 to 23.
    pub from: u8,
    /// Up to this one, 1 to 24.
    pub to: u8,
    /// Which weekdays, from Monday.
    pub days: [bool; 7],
}

const DAYS: [&str; 7] = ["monday", "tuesday", "wednesday", "thursday", "friday", "saturday", "sunday"];

impl WeekHours {
    /// All weekdays.
    ///
    /// # Errors
    /// Hours out of range or in the wrong order.
    pub fn new(from: u8, to: u8, days: &[String]) -> anyhow::Result<Self> {
        ensure!(from < to && to <= 24, "hours run from 0 to 24, not from {from} to {to}");
        let mut chosen = [days.is_empty(); 7];
        for day in days {
            let day = day.to_lowercase();
            match day.as_str() {
                "workdays" => chosen[..5].fill(true),
                "weekend" => chosen[5..].fill(true),
                _ => {
                    let index = DAYS.iter().position(|name| day.len() >= 2 && name.starts_with(&day));
                    chosen[index.with_context(|| format!("'{day}' is no weekday"))?] = true;
                }
            }
        }
        Ok(Self { from, to, days: chosen })
    }

    /// An hour of the week, from Monday 00:00, is meant.
    #[must_use]
    pub fn contains(&self, hour_of_week: u8) -> bool {
        let (day, hour) = (usize::from(hour_of_week / 24), hour_of_week % 24);
        self.days.get(day) == Some(&true) && (self.from..self.to).contains(&hour)
    }

    /// `between 12:00 and 13:00 on Monday`.
    #[must_use]
    pub fn words(&self) -> String {
        let names = ["Monday", "Tuesday", "Wednesday", "Thursday", "Friday", "Saturday", "Sunday"];
        let chosen: Vec<&str> =
            names.iter().zip(self.days).filter(|(_, is)| *is).map(|(name, _)| *name).collect();
        let days = match self.days {
            [true, true, true, true, true, true, true] => "on any day".to_owned(),
            [true, true, true, true, true, false, false] => "on workdays".to_owned(),
            [false, false, false, false, false, true, true] => "on the weekend".to_owned(),
            _ => format!("on {}", chosen.join(", ")),
        };
        format!("between {:02}:00 and {:02}:00 {days}", self.from, self.to)
    }
}

/// A question of an operator.
#[derive(Clone, Debug, PartialEq)]
pub enum Question {
    /// When to clean a zone.
    BestTime {
        /// The zone.
        zone: Zone,
        /// How long the work takes.
        minutes: u32,
        /// How far to look ahead, at most seven days.
        days: u32,
        /// Encounters that an hour of waiting is worth.
        delay_cost: f32,
    },
    /// Which zone to clean now.
    BestZone {
        /// How long there is time.
        minutes: u32,
    },
    /// Whether the floor would dry before somebody steps on it.
    WetOrDry {
        /// The zone.
        zone: Zone,
        /// Presence while it dries that is accepted.
        threshold: f32,
    },
    /// Where dirt is to be expected.
    Dirt,
    /// Where people walk.
    People {
        /// When.
        hours: WeekHours,
    },
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hours_by_name() {
        let lunch = WeekHours::new(12, 13, &[]).unwrap();
        assert!(lunch.contains(12) && lunch.contains(6 * 24 + 12) && !lunch.contains(13));
        let some = WeekHours::new(9, 24, &["Tue".into(), "weekend".into()]).unwrap();
        assert_eq!(some.words(), "between 09:00 and 24:00 on Tuesday, Saturday, Sunday");
        assert!(some.contains(24 + 23) && !some.contains(9));
        for (from, to) in [(13, 12), (0, 25), (24, 24)] {
            assert!(WeekHours::new(from, to, &[]).is_err());
        }
        assert!(
            WeekHours::new(0, 1, &["t".into()]).is_err() && WeekHours::new(0, 1, &["noday".into()]).is_err()
        );
    }
}
