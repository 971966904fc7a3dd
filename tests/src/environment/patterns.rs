//! Places whose visitors follow a week that we know.

use floorguard_mapping::environment::LocalTime;

/// A place: visitors an hour at any moment of the week.
#[derive(Clone, Copy)]
pub struct Pattern {
    /// Name.
    pub name: &'static str,
    /// Visitors an hour, by weekday (0 is Monday) and hour of the day with its fraction.
    rate: fn(u8, f32) -> f32,
}

impl Pattern {
    /// Visitors an hour.
    #[must_use]
    pub fn rate(&self, at: LocalTime) -> f32 {
        let hour = (at.second_of_week() % 86_400) as f32 / 3_600.0;
        (self.rate)(at.weekday(), hour)
    }
}

fn bump(hour: f32, middle: f32, width: f32) -> f32 {
    let off = (hour - middle) / width;
    (-0.5 * off * off).exp()
}

/// The places.
pub const PATTERNS: [Pattern; 6] = [
    Pattern {
        name: "office",
        rate: |day, hour| {
            let works = day < 5 && (8.0..18.0).contains(&hour);
            if works { 14.0 - 7.0 * bump(hour, 12.5, 0.6) } else { 0.3 }
        },
    },
    Pattern {
        name: "supermarket",
        rate: |day, hour| {
            let opens = day < 6 && (7.0..21.0).contains(&hour);
            let busy = if day == 5 { 1.8 } else { 1.0 };
            if opens {
                busy * (8.0 + 6.0 * bump(hour, 11.0, 1.5) + 16.0 * bump(hour, 17.5, 1.5))
            } else {
                0.2
            }
        },
    },
    Pattern {
        name: "canteen",
        rate: |day, hour| {
            if day < 5 { 0.3 + 18.0 * bump(hour, 8.0, 0.6) + 50.0 * bump(hour, 12.3, 0.7) } else { 0.3 }
        },
    },
    Pattern {
        name: "airport",
        rate: |day, hour| {
            let week =
                1.0 + 0.35 * (core::f32::consts::TAU * (f32::from(day) + hour / 24.0 - 4.0) / 7.0).cos();
            week * (12.0 - 9.0 * (core::f32::consts::TAU * (hour - 2.0) / 24.0).cos())
        },
    },
    Pattern {
        name: "three shifts",
        rate: |_, hour| {
            let turns = [5.9, 13.9, 21.9];
            3.0 + turns.iter().map(|turn| 40.0 * bump(hour, *turn, 0.25)).sum::<f32>()
        },
    },
    Pattern { name: "always the same", rate: |_, _| 4.0 },
];
