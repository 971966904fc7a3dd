//! Moments and clocks for people: reads them, writes them, and knows when clocks change.

use anyhow::{Context, anyhow};
use floorguard_mapping::environment::WallTime;
use jiff::{Timestamp, Zoned, civil::DateTime, tz::TimeZone};

/// A moment as the clock on the wall shows it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CivilMoment {
    /// The date, `2026-11-24`.
    pub date: String,
    /// Day of the week, 1 Monday to 7 Sunday.
    pub weekday: u8,
    /// Minutes after midnight, 0 to 1,439.
    pub minute: u16,
}

/// The calendar of a place.
#[derive(Clone, Debug)]
pub struct Calendar {
    name: String,
    zone: TimeZone,
}

impl Default for Calendar {
    fn default() -> Self {
        Self { name: "UTC".to_owned(), zone: TimeZone::UTC }
    }
}

impl Calendar {
    /// That of this computer; UTC where it has no name.
    #[must_use]
    pub fn of_this_computer() -> Self {
        let zone = TimeZone::system();
        zone.iana_name().and_then(|name| Self::named(name).ok()).unwrap_or_default()
    }

    /// By a name such as `Europe/Berlin`, by `UTC`, or by an offset such as `+02:00`.
    ///
    /// # Errors
    /// A name that the time zone database of the computer does not know.
    pub fn named(name: &str) -> anyhow::Result<Self> {
        let zone = match name {
            "UTC" => TimeZone::UTC,
            _ if name.starts_with(['+', '-']) => {
                TimeZone::posix(&posix_offset(name)?).map_err(|error| anyhow!("time zone {name}: {error}"))?
            }
            _ => TimeZone::get(name).map_err(|_| {
                anyhow!("time zone '{name}' is not known here; write Europe/Berlin, +02:00 or UTC")
            })?,
        };
        Ok(Self { name: name.to_owned(), zone })
    }

    /// The name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// How far the clock on the wall is ahead of UTC at a moment, s.
    #[must_use]
    pub fn offset_s(&self, at: WallTime) -> i32 {
        timestamp(at).map_or(0, |at| self.zone.to_offset(at).seconds())
    }

    /// Reads `2026-04-06T08:00`, with seconds, a `Z` or an offset if you like; without them the clock on the wall.
    ///
    /// # Errors
    /// Anything else, or an hour that the clock leaves out.
    pub fn parse(&self, text: &str) -> anyhow::Result<WallTime> {
        let wrong = || format!("'{text}' is not a moment; write 2026-04-06T08:00 or 2026-04-06T08:00:00Z");
        let micros = match text.parse::<Timestamp>() {
            Ok(at) => at.as_microsecond(),
            Err(_) => {
                let civil: DateTime = text.parse().with_context(wrong)?;
                let zoned = civil.to_zoned(self.zone.clone()).with_context(wrong)?;
                zoned.timestamp().as_microsecond()
            }
        };
        Ok(WallTime::from_micros(micros))
    }

    /// Now, by the clock of the computer.
    #[must_use]
    pub fn now() -> WallTime {
        WallTime::from_micros(Timestamp::now().as_microsecond())
    }

    /// `Monday 2026-04-06 08:00`, on the clock on the wall.
    #[must_use]
    pub fn words(&self, at: WallTime) -> String {
        self.zoned(at)
            .map_or_else(|| "an unknown time".to_owned(), |at| at.strftime("%A %Y-%m-%d %H:%M").to_string())
    }

    /// RFC 3339, on the clock on the wall.
    #[must_use]
    pub fn iso(&self, at: WallTime) -> String {
        self.zoned(at).map_or_else(String::new, |at| at.strftime("%Y-%m-%dT%H:%M:%S%:z").to_string())
    }

    /// Date, day of the week and time of day; `None` for a moment that no calendar has.
    #[must_use]
    pub fn civil(&self, at: WallTime) -> Option<CivilMoment> {
        let at = self.zoned(at)?;
        let weekday = u8::try_from(at.weekday().to_monday_one_offset()).ok()?;
        let minute = u16::try_from(at.hour()).ok()? * 60 + u16::try_from(at.minute()).ok()?;
        Some(CivilMoment { date: at.strftime("%Y-%m-%d").to_string(), weekday, minute })
    }

    fn zoned(&self, at: WallTime) -> Option<Zoned> {
        Some(timestamp(at)?.to_zoned(self.zone.clone()))
    }
}

fn timestamp(at: WallTime) -> Option<Timestamp> {
    Timestamp::from_microsecond(at.as_micros()).ok()
}

/// `+02:00` as POSIX writes it, with the sign turned.
fn posix_offset(text: &str) -> anyhow::Result<String> {
    let (sign, rest) = text.split_at(1);
    let (hours, minutes) = rest.split_once(':').unwrap_or((rest, "00"));
    let number = |part: &str, most: u8| part.parse::<u8>().ok().filter(|value| *value <= most);
    let (hours, minutes) = number(hours, 14)
        .zip(number(minutes, 59))
        .with_context(|| format!("'{text}' is not an offset such as +02:00"))?;
    Ok(format!("<{sign}{hours:02}>{}{hours:02}:{minutes:02}", if sign == "+" { '-' } else { '+' }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_and_writes_moments() {
        let utc = Calendar::default();
        let at = utc.parse("2026-04-06T08:00").unwrap();
        assert_eq!(at.as_seconds(), 1_775_462_400);
        assert_eq!(utc.parse("2026-04-06T08:00:00Z").unwrap(), at);
        assert_eq!(utc.parse("2026-04-06T10:00:00+02:00").unwrap(), at);
        assert_eq!(utc.words(at), "Monday 2026-04-06 08:00");
        let east = Calendar::named("+02:00").unwrap();
        assert_eq!((east.offset_s(at), east.parse("2026-04-06T10:00").unwrap()), (7_200, at));
        assert_eq!(east.iso(at), "2026-04-06T10:00:00+02:00");
        assert_eq!(Calendar::named("-03:30").unwrap().offset_s(at), -12_600);
    }

    #[test]
    fn refuses_nonsense() {
        for text in ["", "yesterday", "2026-13-01T00:00", "8:00"] {
            assert!(Calendar::default().parse(text).is_err(), "{text}");
        }
        for name in ["Nowhere/Atlantis", "+25:00", "+x", ""] {
            assert!(Calendar::named(name).is_err(), "{name}");
        }
        assert_eq!(Calendar::default().offset_s(WallTime::from_micros(i64::MAX)), 0);
    }
}
