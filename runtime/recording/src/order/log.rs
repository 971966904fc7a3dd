//! Writes the order: rows of the tap become entries, and the entries of some milliseconds a message.

use floorguard_guard::Cause;
use floorguard_robot::assembly::{Direction, TapRow};

use super::bytes::Writer;
use super::decision_row::DecisionRow;
use super::entry::{cause_key, tag, write_advice};

/// A message is not much longer than this, bytes.
const MESSAGE_BYTES: usize = 1 << 16;

/// The order in the making.
#[derive(Clone, Debug, Default)]
pub struct OrderLog {
    out: Writer,
    has_causes: bool,
    has_ended: bool,
    at_us: u64,
    decision: Option<DecisionRow>,
}

impl OrderLog {
    /// Adds a row. True when the message is long enough to be taken.
    pub fn note(&mut self, row: &TapRow) -> bool {
        if self.has_ended {
            return false;
        }
        if !self.has_causes {
            self.has_causes = true;
            self.causes();
        }
        self.entry(row);
        self.out.0.len() >= MESSAGE_BYTES
    }

    /// Rows were lost among those that were noted since the last message: nothing of them is kept, and the order ends.
    pub fn lose(&mut self) {
        if !self.has_ended {
            self.has_ended = true;
            self.out.0.clear();
            self.out.byte(tag::LOST);
        }
    }

    /// The message, if there is anything in it.
    pub fn take(&mut self) -> Option<Vec<u8>> {
        (!self.out.0.is_empty()).then(|| std::mem::take(&mut self.out.0))
    }

    /// A later version may have others, or others by the same number.
    fn causes(&mut self) {
        let all = Cause::all();
        self.out.byte(tag::CAUSES);
        self.out.number(all.len() as u64);
        all.iter().for_each(|cause| self.out.text(&cause_key(*cause)));
    }

    fn entry(&mut self, row: &TapRow) {
        let line = |line: floorguard_runtime::tape::TapeLine| line.number() as u8;
        match row {
            TapRow::Delivered { line: from, .. } => self.out.0.extend([tag::DELIVERED, line(*from)]),
            TapRow::Sent(..) => self.out.byte(tag::SENT),
            TapRow::Began(at) => {
                self.out.byte(tag::BEGAN);
                self.stamp(at.as_micros());
            }
            TapRow::Latches(at, latches) => {
                self.out.byte(tag::LATCHES);
                self.stamp(at.as_micros());
                self.out.number(*latches);
            }
            TapRow::Failed(from, Direction::Read) => self.out.0.extend([tag::READ_FAILED, line(*from)]),
            TapRow::Failed(from, Direction::Write) => self.out.0.extend([tag::WRITE_FAILED, line(*from)]),
            TapRow::Command(stamp, wanted) => {
                self.out.byte(tag::COMMAND);
                self.out.number(stamp.as_micros());
                self.out.fraction(wanted.linear_mps);
                self.out.fraction(wanted.angular_radps);
            }
            TapRow::Advice(advice) => {
                self.out.byte(tag::ADVICE);
                write_advice(advice, &mut self.out);
            }
            TapRow::Operator(button) => self.out.0.extend([tag::OPERATOR, line(*button)]),
            TapRow::Polled(poll) => {
                let row = poll.decision.as_ref().map(DecisionRow::new);
                let news = row.filter(|row| self.decision.replace(*row) != Some(*row));
                self.out.byte(if news.is_some() { tag::POLLED_AND_DECIDED } else { tag::POLLED });
                self.out.byte(poll.task.number());
                self.stamp(poll.at.as_micros());
                self.out.number(poll.decisions.into());
                if let Some(row) = news {
                    row.write(&mut self.out);
                }
            }
        }
    }

    /// The guard ring's clock never runs backwards.
    fn stamp(&mut self, at_us: u64) {
        self.out.number(at_us.saturating_sub(self.at_us));
        self.at_us = self.at_us.max(at_us);
    }
}

#[cfg(test)]
mod tests {
    use super::super::entry::{OrderEntry, OrderReader, read_entries};
    use super::*;
    use floorguard_guard::{Advice, AdvisedPerson};
    use floorguard_robot::assembly::{GuardTask, Poll};
    use floorguard_runtime::tape::TapeLine;
    use floorguard_types::geometry::Twist2;
    use floorguard_types::time::Stamp;

    fn rows() -> Vec<TapRow> {
        let at = Stamp::from_micros;
        let mut advice = Box::new(Advice { stamp: at(3), speed_limit_mps: Some(0.25), ..Advice::default() });
        assert!(advice.people.push(AdvisedPerson { id: 7, ..AdvisedPerson::default() }).is_ok());
        let poll = |us, decisions| {
            TapRow::Polled(Poll { task: GuardTask::Can, at: at(us), decisions, decision: None })
        };
        vec![
            TapRow::Began(at(1_000)),
            TapRow::Latches(at(1_001), 5),
            TapRow::Delivered { at: at(2_000), arrival: at(2_000), line: TapeLine::Can, bytes: vec![1] },
            TapRow::Failed(TapeLine::Imu, Direction::Write),
            TapRow::Command(at(9), Twist2 { linear_mps: 0.5, angular_radps: -0.1 }),
            TapRow::Advice(advice),
            TapRow::Operator(TapeLine::Start),
            poll(2_000, 0),
            poll(2_400, 2),
        ]
    }

    fn entries(log: &mut OrderLog) -> Vec<OrderEntry> {
        let mut read = Vec::new();
        let message = log.take().unwrap();
        assert!(read_entries(&mut OrderReader::default(), &message, |entry| read.push(entry)));
        read
    }

    #[test]
    fn rows_come_back_as_entries_in_their_order() {
        let mut log = OrderLog::default();
        rows().iter().for_each(|row| assert!(!log.note(row)));
        let read = entries(&mut log);
        assert_eq!(read.len(), rows().len());
        assert_eq!(read[1], OrderEntry::Latches(Stamp::from_micros(1_001), 5));
        let OrderEntry::Advice(advice) = &read[5] else { panic!("{read:?}") };
        assert_eq!((advice.people[0].id, advice.speed_limit_mps), (7, Some(0.25)));
        let OrderEntry::Polled(poll) = &read[8] else { panic!("{read:?}") };
        assert_eq!((poll.at.as_micros(), poll.decisions, poll.task), (2_400, 2, Some(GuardTask::Can)));
    }

    /// A late source and a lost one have the same words.
    #[test]
    fn causes_have_distinct_keys() {
        let keys: std::collections::BTreeSet<String> = Cause::all().into_iter().map(cause_key).collect();
        assert_eq!(keys.len(), Cause::all().len());
    }

    #[test]
    fn lost_rows_end_the_order() {
        let mut log = OrderLog::default();
        rows().iter().for_each(|row| assert!(!log.note(row)));
        log.lose();
        assert_eq!(entries(&mut log), [OrderEntry::Lost]);
        assert!(!log.note(&rows()[0]) && log.take().is_none());
    }
}
