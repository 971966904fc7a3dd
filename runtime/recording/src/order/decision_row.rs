//! A decision of the guard as it is kept: every bit that the drives and the display got.

use std::fmt;

use floorguard_guard::{Action, Cause, CauseRecord, Decision, GuardState, Health, Unit};

use super::bytes::{Reader, Writer};

/// A cause in a kept decision. Fractions are kept as their bits, so that equal means equal to the bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CauseRow {
    /// Which; `None` for one that this version does not know.
    pub cause: Option<Cause>,
    /// What it demands, by its number.
    pub action: u8,
    /// Bits of the measured value, of the limit and of the speed that is still permitted.
    pub numbers: [u32; 3],
    /// Unit of the first two, by its number.
    pub unit: u8,
    /// Age of the measurement, microseconds.
    pub age_us: u64,
    /// When it was judged, microseconds.
    pub raised_us: u64,
    /// Of a source: how it was, by its number.
    pub health: u8,
    /// Of a source: how far its stamp was ahead, microseconds.
    pub ahead_us: u64,
}

/// A decision as it is kept, without its time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DecisionRow {
    /// Most severe demand, by its number.
    pub action: u8,
    /// State shown, by its number.
    pub state: u8,
    /// Bit 0: torque off; bit 1: the robot leaves an obstacle.
    pub flags: u8,
    /// Index of the field set.
    pub field_set: u8,
    /// Bits of the permitted speed, turning rate and speed limit.
    pub numbers: [u32; 3],
    /// First cause of the stop.
    pub first: Option<CauseRow>,
    /// What holds the robot.
    pub holding: Option<CauseRow>,
}

impl CauseRow {
    fn new(record: &CauseRecord) -> Self {
        Self {
            cause: Some(record.cause),
            action: record.action as u8,
            numbers: [record.measured, record.limit, record.speed_limit_mps].map(f32::to_bits),
            unit: record.unit as u8,
            age_us: record.age_us,
            raised_us: record.raised_at.as_micros(),
            health: record.health as u8,
            ahead_us: record.ahead_us,
        }
    }

    fn write(row: Option<&Self>, out: &mut Writer) {
        let Some(row) = row else { return out.byte(0) };
        out.byte(1);
        out.number(row.cause.map_or(u64::MAX, |cause| cause.index() as u64));
        out.byte(row.action);
        row.numbers.iter().for_each(|bits| out.fraction(f32::from_bits(*bits)));
        out.byte(row.unit);
        out.number(row.age_us);
        out.number(row.raised_us);
        out.byte(row.health);
        out.number(row.ahead_us);
    }

    /// `causes`: the recording's own list.
    fn read(reader: &mut Reader<'_>, causes: &[Option<Cause>]) -> Option<Option<Self>> {
        if reader.byte()? == 0 {
            return Some(None);
        }
        let index = reader.number()?;
        let known = usize::try_from(index).ok().and_then(|index| causes.get(index)).copied().flatten();
        Some(Some(Self {
            cause: known,
            action: reader.byte()?,
            numbers: [reader.fraction()?, reader.fraction()?, reader.fraction()?].map(f32::to_bits),
            unit: reader.byte()?,
            age_us: reader.number()?,
            raised_us: reader.number()?,
            health: reader.byte()?,
            ahead_us: reader.number()?,
        }))
    }

    /// The record of the guard, of a cause that this version knows.
    #[must_use]
    pub fn record(&self) -> Option<CauseRecord> {
        let raised_at = floorguard_types::time::Stamp::from_micros(self.raised_us);
        let mut record = CauseRecord::new(self.cause?, raised_at);
        let [measured, limit, speed_limit_mps] = self.numbers.map(f32::from_bits);
        (record.measured, record.limit, record.speed_limit_mps) = (measured, limit, speed_limit_mps);
        record.action = of_number(self.action, &ACTIONS)?;
        record.unit = of_number(self.unit, &UNITS)?;
        record.health = of_number(self.health, &HEALTHS)?;
        (record.age_us, record.ahead_us) = (self.age_us, self.ahead_us);
        Some(record)
    }
}

const ACTIONS: [Action; 5] =
    [Action::None, Action::Limit, Action::Category2, Action::Category1, Action::Category0];
const STATES: [GuardState; 6] = [
    GuardState::Init,
    GuardState::Run,
    GuardState::Slow,
    GuardState::Stop,
    GuardState::Latched,
    GuardState::AwaitsStart,
];
const UNITS: [Unit; 7] = [
    Unit::None,
    Unit::Metres,
    Unit::MetresPerSecond,
    Unit::RadiansPerSecond,
    Unit::Seconds,
    Unit::Percent,
    Unit::Code,
];
const HEALTHS: [Health; 6] =
    [Health::Healthy, Health::Stale, Health::Frozen, Health::Blind, Health::Faulty, Health::Absent];

fn of_number<T: Copy>(number: u8, list: &[T]) -> Option<T> {
    list.get(usize::from(number)).copied()
}

impl DecisionRow {
    /// Of a decision.
    #[must_use]
    pub fn new(decision: &Decision) -> Self {
        let permitted = decision.permitted;
        Self {
            action: decision.action as u8,
            state: decision.state as u8,
            flags: u8::from(decision.torque_off) | u8::from(decision.escaping) << 1,
            field_set: u8::try_from(decision.field_set).unwrap_or(u8::MAX),
            numbers: [permitted.linear_mps, permitted.angular_radps, decision.speed_limit_mps]
                .map(f32::to_bits),
            first: decision.primary_cause.as_ref().map(CauseRow::new),
            holding: decision.holding_cause.as_ref().map(CauseRow::new),
        }
    }

    /// Most severe demand; `None` for a number that this version does not know.
    #[must_use]
    pub fn action(&self) -> Option<Action> {
        of_number(self.action, &ACTIONS)
    }

    /// State shown.
    #[must_use]
    pub fn state(&self) -> Option<GuardState> {
        of_number(self.state, &STATES)
    }

    /// Speed that was permitted, m/s.
    #[must_use]
    pub fn permitted_mps(&self) -> f32 {
        f32::from_bits(self.numbers[0])
    }

    /// The robot was stopped, and not leaving an obstacle.
    #[must_use]
    pub fn holds(&self) -> bool {
        self.action().is_some_and(|action| action.stops()) && self.flags & 2 == 0
    }

    pub(super) fn write(&self, out: &mut Writer) {
        [self.action, self.state, self.flags, self.field_set].iter().for_each(|byte| out.byte(*byte));
        self.numbers.iter().for_each(|bits| out.fraction(f32::from_bits(*bits)));
        CauseRow::write(self.first.as_ref(), out);
        CauseRow::write(self.holding.as_ref(), out);
    }

    pub(super) fn read(reader: &mut Reader<'_>, causes: &[Option<Cause>]) -> Option<Self> {
        Some(Self {
            action: reader.byte()?,
            state: reader.byte()?,
            flags: reader.byte()?,
            field_set: reader.byte()?,
            numbers: [reader.fraction()?, reader.fraction()?, reader.fraction()?].map(f32::to_bits),
            first: CauseRow::read(reader, causes)?,
            holding: CauseRow::read(reader, causes)?,
        })
    }
}

impl fmt::Display for DecisionRow {
    /// State, what was permitted, and what held the robot.
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [linear_mps, angular_radps, limit_mps] = self.numbers.map(f32::from_bits);
        match self.state() {
            Some(state) => write!(out, "{state:?}")?,
            None => write!(out, "state {}", self.state)?,
        }
        write!(
            out,
            ", permitted {linear_mps:.3} m/s and {angular_radps:.3} rad/s of at most {limit_mps:.3} m/s"
        )?;
        match self.holding.map(|row| row.record()) {
            Some(Some(record)) => write!(out, ", {record}"),
            Some(None) => write!(out, ", a cause that this version does not know"),
            None => write!(out, ", no cause"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_types::time::Stamp;

    #[test]
    fn every_cause_comes_back_with_all_bits() {
        let causes: Vec<Option<Cause>> = Cause::all().into_iter().map(Some).collect();
        for cause in Cause::all() {
            let record = CauseRecord::new(cause, Stamp::from_micros(77)).metres(0.1, 0.3).aged(u64::MAX);
            let row = DecisionRow {
                numbers: [0.1_f32, -0.0, f32::NAN].map(f32::to_bits),
                holding: Some(CauseRow::new(&record)),
                ..DecisionRow::default()
            };
            let mut out = Writer::default();
            row.write(&mut out);
            assert_eq!(DecisionRow::read(&mut Reader(&out.0), &causes), Some(row));
            assert_eq!(row.holding.and_then(|row| row.record()), Some(record));
            for cut in 0..out.0.len() {
                assert_eq!(DecisionRow::read(&mut Reader(&out.0[..cut]), &causes), None);
            }
        }
    }

    #[test]
    fn lists_follow_the_numbers_of_their_types() {
        assert!(ACTIONS.iter().enumerate().all(|(index, action)| *action as usize == index));
        assert!(STATES.iter().enumerate().all(|(index, state)| *state as usize == index));
        assert!(UNITS.iter().enumerate().all(|(index, unit)| *unit as usize == index));
        assert!(HEALTHS.iter().enumerate().all(|(index, health)| *health as usize == index));
    }
}
