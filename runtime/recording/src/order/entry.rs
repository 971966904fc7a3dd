//! The entries of the order, and how they are read.

use floorguard_guard::{Advice, AdvisedPerson, Cause};
use floorguard_robot::assembly::{Direction, GuardTask};
use floorguard_runtime::tape::TapeLine;
use floorguard_types::geometry::{Point2, Twist2};
use floorguard_types::time::Stamp;

use super::bytes::{Reader, Writer};
use super::decision_row::DecisionRow;

/// What happened in the guard ring, one after the other.
#[derive(Clone, Debug, PartialEq)]
pub enum OrderEntry {
    /// The guard began.
    Began(Stamp),
    /// It got the causes that were latched when the computer last ran.
    Latches(Stamp, u64),
    /// The next bytes of a line, as the recording holds them, reached their task.
    Delivered(TapeLine),
    /// A line failed.
    Failed(TapeLine, Direction),
    /// The next frame that the recording holds went out on the bus.
    Sent,
    /// The guard took what the mission would like.
    Command(Stamp, Twist2),
    /// The guard took an advice.
    Advice(Box<Advice>),
    /// The guard took the button for reset or start.
    Operator(TapeLine),
    /// A task was polled; the entries before, up to the poll before, belong to it.
    Polled(PolledRow),
    /// The recorder missed rows from here on: the order ends.
    Lost,
}

/// A poll of a task.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PolledRow {
    /// The task; `None` for one that this version does not have.
    pub task: Option<GuardTask>,
    /// Its time.
    pub at: Stamp,
    /// Decisions that were taken in it.
    pub decisions: u64,
    /// The last decision up to then.
    pub decision: DecisionRow,
}

pub(super) mod tag {
    pub const CAUSES: u8 = 0;
    pub const BEGAN: u8 = 1;
    pub const LATCHES: u8 = 2;
    pub const DELIVERED: u8 = 3;
    pub const READ_FAILED: u8 = 4;
    pub const WRITE_FAILED: u8 = 5;
    pub const SENT: u8 = 6;
    pub const COMMAND: u8 = 7;
    pub const ADVICE: u8 = 8;
    pub const OPERATOR: u8 = 9;
    pub const POLLED: u8 = 10;
    pub const POLLED_AND_DECIDED: u8 = 11;
    pub const LOST: u8 = 12;
}

/// What a reader of the order remembers from one message to the next.
#[derive(Clone, Debug, Default)]
pub struct OrderReader {
    /// The recording's list of causes, by what this version calls them.
    causes: Vec<Option<Cause>>,
    at_us: u64,
    decision: DecisionRow,
}

/// The entries of a message, each given to `entry`; false when the bytes are none of it.
pub fn read_entries(state: &mut OrderReader, message: &[u8], mut entry: impl FnMut(OrderEntry)) -> bool {
    let mut reader = Reader(message);
    while !reader.0.is_empty() {
        match state.next(&mut reader) {
            Some(Some(known)) => entry(known),
            // The list of causes is the reader's own business.
            Some(None) => {}
            None => return false,
        }
    }
    true
}

impl OrderReader {
    fn next(&mut self, reader: &mut Reader<'_>) -> Option<Option<OrderEntry>> {
        let line = |reader: &mut Reader<'_>| TapeLine::from_number(reader.byte()?.into());
        let kind = reader.byte()?;
        Some(Some(match kind {
            tag::CAUSES => {
                self.read_causes(reader)?;
                return Some(None);
            }
            tag::BEGAN => OrderEntry::Began(self.stamp(reader)?),
            tag::LATCHES => OrderEntry::Latches(self.stamp(reader)?, reader.number()?),
            tag::DELIVERED => OrderEntry::Delivered(line(reader)?),
            tag::READ_FAILED => OrderEntry::Failed(line(reader)?, Direction::Read),
            tag::WRITE_FAILED => OrderEntry::Failed(line(reader)?, Direction::Write),
            tag::SENT => OrderEntry::Sent,
            tag::COMMAND => {
                let stamp = Stamp::from_micros(reader.number()?);
                let wanted = Twist2 { linear_mps: reader.fraction()?, angular_radps: reader.fraction()? };
                OrderEntry::Command(stamp, wanted)
            }
            tag::ADVICE => OrderEntry::Advice(Box::new(read_advice(reader)?)),
            tag::OPERATOR => OrderEntry::Operator(line(reader)?),
            tag::POLLED | tag::POLLED_AND_DECIDED => {
                let task = GuardTask::from_number(reader.byte()?);
                let (at, decisions) = (self.stamp(reader)?, reader.number()?);
                if kind == tag::POLLED_AND_DECIDED {
                    self.decision = DecisionRow::read(reader, &self.causes)?;
                }
                OrderEntry::Polled(PolledRow { task, at, decisions, decision: self.decision })
            }
            tag::LOST => OrderEntry::Lost,
            _ => return None,
        }))
    }

    /// Times are kept as the distance from the one before.
    fn stamp(&mut self, reader: &mut Reader<'_>) -> Option<Stamp> {
        self.at_us = self.at_us.checked_add(reader.number()?)?;
        Some(Stamp::from_micros(self.at_us))
    }

    fn read_causes(&mut self, reader: &mut Reader<'_>) -> Option<()> {
        let known = Cause::all().map(|cause| (cause_key(cause), cause));
        self.causes.clear();
        for _ in 0..reader.number()? {
            let name = reader.text()?;
            self.causes.push(known.iter().find(|(text, _)| *text == name).map(|(_, cause)| *cause));
        }
        Some(())
    }
}

/// Of a cause in the list of a recording. Its words would not do: a late and a lost source have the same.
pub(super) fn cause_key(cause: Cause) -> String {
    format!("{cause:?}")
}

pub(super) fn write_advice(advice: &Advice, out: &mut Writer) {
    out.number(advice.stamp.as_micros());
    out.byte(u8::from(advice.stop) | u8::from(advice.speed_limit_mps.is_some()) << 1);
    out.fraction(advice.speed_limit_mps.unwrap_or(0.0));
    out.number(advice.people.len() as u64);
    for person in &advice.people {
        out.number(person.id.into());
        let places = [person.position, person.velocity_mps];
        places.iter().flat_map(|place| [place.x_m, place.y_m]).for_each(|number| out.fraction(number));
        out.fraction(person.position_sigma_m);
        out.fraction(person.velocity_sigma_mps);
    }
}

fn read_advice(reader: &mut Reader<'_>) -> Option<Advice> {
    let stamp = Stamp::from_micros(reader.number()?);
    let (flags, limit_mps) = (reader.byte()?, reader.fraction()?);
    let speed_limit_mps = (flags & 2 != 0).then_some(limit_mps);
    let mut advice = Advice { stamp, stop: flags & 1 != 0, speed_limit_mps, ..Advice::default() };
    for _ in 0..reader.number()? {
        let id = u32::try_from(reader.number()?).ok()?;
        let position = Point2::new(reader.fraction()?, reader.fraction()?);
        let velocity_mps = Point2::new(reader.fraction()?, reader.fraction()?);
        let [position_sigma_m, velocity_sigma_mps] = [reader.fraction()?, reader.fraction()?];
        let person = AdvisedPerson { id, position, velocity_mps, position_sigma_m, velocity_sigma_mps };
        advice.people.push(person).ok()?;
    }
    Some(advice)
}
