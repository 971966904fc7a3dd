//! Faults as text: `lidar:drop=5%,from=10s,to=20s`.

use std::str::FromStr;

use thiserror::Error;

use super::FaultTarget;

/// Why a fault was not understood.
#[derive(Debug, Error, PartialEq, Eq)]
pub enum FaultError {
    /// There is no colon, or no such source.
    #[error("`{0}`: a fault begins with one of {names}", names = FaultTarget::names())]
    Source(String),
    /// No such fault.
    #[error(
        "`{0}`: known faults are drop, burst, delay, reorder, duplicate, truncate, flip, stuck, silent, flap, blind, \
         extreme, past, future, drift, stranger, rate on a line; stall, overload, reset of guard, perception, computer"
    )]
    Kind(String),
    /// The fault cannot happen there.
    #[error("`{0}`: this fault cannot happen there")]
    Place(String),
    /// The number is missing or not one.
    #[error("`{0}`: not a value such as 5%, 20ms or 10s")]
    Value(String),
    /// It would end before it begins.
    #[error("`{0}`: this fault is never on; give a `to` that is later than its `from`")]
    Never(String),
}

/// What goes wrong. Shares are of all messages, 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FaultKind {
    /// Single messages get lost.
    Drop(f32),
    /// A loss takes this many messages in a row; one in a hundred messages begins one.
    Burst(u32),
    /// Everything comes later by this many microseconds.
    Delay(u64),
    /// Messages are overtaken by their successor.
    Reorder(f32),
    /// Messages come twice.
    Duplicate(f32),
    /// Messages lose their second half.
    Truncate(f32),
    /// One bit of a message is wrong.
    Flip(f32),
    /// The first message of the fault is repeated in place of every other.
    SpinningTask,
    /// Nothing comes.
    Silent,
    /// The link goes down and up again with this period, microseconds.
    Flap(u64),
    /// Lidar and safety scanner: this many degrees in front of the sensor return nothing.
    Blind(f32),
    /// Values are extreme or no numbers, in messages that are otherwise well-formed.
    Extreme(f32),
    /// The device's clock stands this many microseconds back.
    Past(u64),
    /// The device's clock is this many microseconds ahead.
    Future(u64),
    /// The device's clock runs too fast by this share of the time since the beginning of the fault; may be negative.
    Drift(f32),
    /// Messages carry the mark of another device.
    Stranger(f32),
    /// Only every n-th message comes.
    Rate(u32),
    /// Tasks do not run for this many microseconds of every second.
    Stall(u64),
    /// Tasks run during the rest of every 50 ms only.
    Overload(f32),
    /// Power is gone; afterwards the device or computer starts anew.
    Reset,
}

impl FaultKind {
    /// The fault concerns tasks and not messages.
    #[must_use]
    pub const fn halts_tasks(self) -> bool {
        matches!(self, Self::Stall(_) | Self::Overload(_))
    }
}

/// One fault at one place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaultSpec {
    /// Where.
    pub target: FaultTarget,
    /// What.
    pub kind: FaultKind,
    /// Begins, world microseconds.
    pub from_us: u64,
    /// Ends, world microseconds.
    pub to_us: u64,
}

impl FaultSpec {
    /// Reads a fault from text.
    ///
    /// # Errors
    /// Source, kind or value is unknown, or they do not fit.
    pub fn parse(text: &str) -> Result<Self, FaultError> {
        let unknown = || FaultError::Source(text.to_owned());
        let (source, rest) = text.split_once(':').ok_or_else(unknown)?;
        let target = FaultTarget::named(source.trim()).ok_or_else(unknown)?;
        let (mut kind, mut from_us, mut to_us) = (None, 0, u64::MAX);
        for item in rest.split(',').map(str::trim) {
            let (name, value) = item.split_once('=').unwrap_or((item, ""));
            match name {
                "from" => from_us = micros(value)?,
                "to" => to_us = micros(value)?,
                _ => kind = Some(parse_kind(name, value)?),
            }
        }
        let kind = kind.ok_or_else(|| FaultError::Kind(rest.to_owned()))?;
        if !target.can_suffer(kind) {
            return Err(FaultError::Place(text.to_owned()));
        }
        if to_us <= from_us {
            return Err(FaultError::Never(text.to_owned()));
        }
        Ok(Self { target, kind, from_us, to_us })
    }

    /// The fault is on at this moment.
    #[must_use]
    pub const fn applies(&self, at_us: u64) -> bool {
        at_us >= self.from_us && at_us < self.to_us
    }

    /// The tasks that it concerns do not run at this moment.
    #[must_use]
    pub fn halts_at(&self, at_us: u64) -> bool {
        let since_us = at_us.saturating_sub(self.from_us);
        self.applies(at_us)
            && match self.kind {
                FaultKind::Stall(stall_us) => since_us % 1_000_000 < stall_us,
                FaultKind::Overload(share) => since_us % 50_000 < (share * 50_000.0) as u64,
                _ => false,
            }
    }
}

impl FromStr for FaultSpec {
    type Err = FaultError;

    fn from_str(text: &str) -> Result<Self, FaultError> {
        Self::parse(text)
    }
}

fn parse_kind(name: &str, value: &str) -> Result<FaultKind, FaultError> {
    let all = |value: &str| if value.is_empty() { Ok(1.0) } else { share(value) };
    Ok(match name {
        "drop" => FaultKind::Drop(share(value)?),
        "burst" => FaultKind::Burst(number(value)? as u32),
        "delay" => FaultKind::Delay(micros(value)?),
        "reorder" => FaultKind::Reorder(share(value)?),
        "duplicate" => FaultKind::Duplicate(share(value)?),
        "truncate" => FaultKind::Truncate(share(value)?),
        "flip" => FaultKind::Flip(share(value)?),
        "stuck" => FaultKind::SpinningTask,
        "silent" => FaultKind::Silent,
        "flap" => FaultKind::Flap(micros(value)?.max(2)),
        "blind" => FaultKind::Blind(number(value.trim_end_matches("deg"))?),
        "extreme" => FaultKind::Extreme(all(value)?),
        "past" => FaultKind::Past(micros(value)?),
        "future" => FaultKind::Future(micros(value)?),
        "drift" => match value.trim().strip_prefix('-') {
            Some(back) => FaultKind::Drift(-share(back)?),
            None => FaultKind::Drift(share(value)?),
        },
        "stranger" => FaultKind::Stranger(all(value)?),
        "rate" => FaultKind::Rate((number(value)? as u32).max(1)),
        "stall" => FaultKind::Stall(micros(value)?),
        "overload" => FaultKind::Overload(share(value)?),
        "reset" => FaultKind::Reset,
        _ => return Err(FaultError::Kind(name.to_owned())),
    })
}

fn number(value: &str) -> Result<f32, FaultError> {
    let parsed = value.trim().parse::<f32>().ok().filter(|number| number.is_finite() && *number >= 0.0);
    parsed.ok_or_else(|| FaultError::Value(value.to_owned()))
}

fn share(value: &str) -> Result<f32, FaultError> {
    let percent = value.trim().strip_suffix('%');
    let share = match percent {
        Some(percent) => number(percent)? / 100.0,
        None => number(value)?,
    };
    if share <= 1.0 { Ok(share) } else { Err(FaultError::Value(value.to_owned())) }
}

fn micros(value: &str) -> Result<u64, FaultError> {
    let units = [("ms", 1.0e3), ("us", 1.0), ("s", 1.0e6)];
    let found = units.iter().find_map(|(unit, scale)| Some((value.trim().strip_suffix(unit)?, *scale)));
    let (digits, scale) = found.ok_or_else(|| FaultError::Value(value.to_owned()))?;
    Ok((f64::from(number(digits)?) * scale) as u64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wire::Stream;

    #[test]
    fn the_example_is_understood() {
        let fault = FaultSpec::parse("lidar:drop=5%,from=10s,to=20s").unwrap();
        let expected = FaultSpec {
            target: FaultTarget::Line(Stream::LidarData),
            kind: FaultKind::Drop(0.05),
            from_us: 10_000_000,
            to_us: 20_000_000,
        };
        assert_eq!(fault, expected);
        assert_eq!(FaultSpec::parse("imu:delay=20ms").unwrap().kind, FaultKind::Delay(20_000));
        assert_eq!(FaultSpec::parse("imu:drift=-1%").unwrap().kind, FaultKind::Drift(-0.01));
    }

    #[test]
    fn mistakes_are_named() {
        for wrong in [
            "lidar",
            "radar:drop=1%",
            "lidar:melt",
            "lidar:drop=150%",
            "lidar:from=3s",
            "lidar:drop=5%,from=9s,to=3s",
            "lidar:drop=5%,to=0s",
            "can:delay=5",
            "lidar:stall=1s",
            "guard:drop=1%",
            "guard:reset",
            "imu:blind=30deg",
        ] {
            assert!(FaultSpec::parse(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn tasks_halt_for_their_share() {
        let halted = |text: &str| {
            let fault = FaultSpec::parse(text).unwrap();
            (0..2_000_u64).filter(|ms| fault.halts_at(ms * 1_000)).count()
        };
        assert_eq!(halted("guard:stall=300ms"), 600);
        assert_eq!(halted("computer:overload=40%,from=1s,to=2s"), 400);
        assert_eq!(halted("computer:reset"), 0);
    }
}
