//! Which measure is due.

use floorguard_types::geometry::Point2;

use super::reason::Obstruction;

/// What to do about an obstruction, in this order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Measure {
    /// Nothing obstructs: drive.
    #[default]
    Drive,
    /// Stand and see whether it goes away by itself.
    Wait,
    /// Forget what was seen around and look again.
    ClearCostmap,
    /// Back out along the way it came.
    BackOut,
    /// Take this place for blocked and plan anew.
    OtherWay,
    /// Stand; a person is needed.
    CallHelp,
}

impl Measure {
    /// In words, as the beginning of a sentence; the reason follows.
    #[must_use]
    pub const fn words(self) -> &'static str {
        match self {
            Self::Drive => "drives to the goal",
            Self::Wait => "waits",
            Self::ClearCostmap => "has cleared the costmap and looks again",
            Self::BackOut => "backs out along the way it came",
            Self::OtherWay => "tries the other way round",
            Self::CallHelp => "calls for help",
        }
    }

    const fn next(self) -> Self {
        match self {
            Self::Drive => Self::Wait,
            Self::Wait => Self::ClearCostmap,
            Self::ClearCostmap => Self::BackOut,
            Self::BackOut => Self::OtherWay,
            Self::OtherWay | Self::CallHelp => Self::Wait,
        }
    }
}

/// How long each measure may take, seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RecoveryTimes {
    /// Waiting.
    pub wait_s: f32,
    /// Looking again after the costmap was cleared.
    pub clear_s: f32,
    /// Backing out.
    pub back_out_s: f32,
    /// Waiting for a path the other way round.
    pub other_way_s: f32,
    /// Obstructed for so long in all since the robot last came nearer to its goal, it calls for help.
    pub help_s: f32,
}

impl RecoveryTimes {
    /// A robot among people: most of what obstructs it walks away; help after two minutes.
    pub const DEFAULT: Self =
        Self { wait_s: 6.0, clear_s: 3.0, back_out_s: 12.0, other_way_s: 4.0, help_s: 120.0 };
}

/// What the ladder learns at a moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RecoveryMoment {
    /// Seconds since the last moment, ≥ 0.
    pub lasted_s: f32,
    /// Where the robot is, map frame.
    pub place_in_map: Point2,
    /// What obstructs the robot now.
    pub obstruction: Option<Obstruction>,
    /// What is left of the path, metres, where there is one.
    pub left_m: Option<f32>,
    /// The measure that runs has nothing more to do.
    pub is_done: bool,
}

/// What is due.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RecoveryStep {
    /// The measure.
    pub measure: Measure,
    /// It begins now.
    pub is_new: bool,
    /// Why; the newest obstruction, while a measure runs.
    pub obstruction: Option<Obstruction>,
    /// Obstructed for so long since the robot last came nearer to its goal, seconds.
    pub obstructed_s: f32,
}

/// Nearer to the goal by this is forward, metres.
const FORWARD_M: f32 = 0.5;
/// Without an obstruction for this long, it is gone, seconds.
const GONE_S: f32 = 0.5;
/// An obstruction this near to the last one is the same one come back, metres.
const SAME_PLACE_M: f32 = 0.7;

/// The ladder.
#[derive(Clone, Debug)]
pub struct Recovery {
    times: RecoveryTimes,
    measure: Measure,
    for_s: f32,
    free_s: f32,
    obstructed_s: f32,
    least_left_m: f32,
    obstruction: Option<Obstruction>,
    /// Where the last obstruction began.
    began_at: Option<Point2>,
    /// The measure that ran when it went away, and for how long it had run, seconds.
    left: (Measure, f32),
}

impl Recovery {
    /// Nothing obstructs yet.
    #[must_use]
    pub const fn new(times: RecoveryTimes) -> Self {
        Self {
            times,
            measure: Measure::Drive,
            for_s: 0.0,
            free_s: 0.0,
            obstructed_s: 0.0,
            least_left_m: f32::INFINITY,
            obstruction: None,
            began_at: None,
            left: (Measure::Wait, 0.0),
        }
    }

    /// The measure that is due. Bounded: one step of the ladder a moment.
    pub fn update(&mut self, moment: &RecoveryMoment) -> RecoveryStep {
        self.note(moment);
        let before = self.measure;
        self.for_s += moment.lasted_s;
        let is_gone = self.free_s >= GONE_S;
        self.measure = match before {
            Measure::Drive if moment.obstruction.is_some() => self.begin(moment.place_in_map),
            Measure::Drive => Measure::Drive,
            // What it does about it is not cut off: the way it came is a good place to look from.
            Measure::BackOut if moment.is_done || self.for_s > self.times.back_out_s => Measure::OtherWay,
            Measure::BackOut => Measure::BackOut,
            _ if is_gone => Measure::Drive,
            _ if self.obstructed_s > self.times.help_s => Measure::CallHelp,
            Measure::Wait if self.for_s > self.times.wait_s => before.next(),
            Measure::ClearCostmap if self.for_s > self.times.clear_s => before.next(),
            Measure::OtherWay if self.for_s > self.times.other_way_s => before.next(),
            _ => before,
        };
        let is_new = self.measure != before;
        if is_new {
            let ran_s = if before == Measure::Drive { self.left.1 } else { 0.0 };
            if self.measure == Measure::Drive {
                self.left = (before, self.for_s);
            }
            (self.for_s, self.free_s) = (ran_s, 0.0);
        }
        RecoveryStep {
            measure: self.measure,
            is_new,
            obstruction: self.obstruction,
            obstructed_s: self.obstructed_s,
        }
    }

    /// The measure for an obstruction that begins: the first one, or where the ladder stood when the same one went away.
    fn begin(&mut self, place_in_map: Point2) -> Measure {
        if !self.began_at.is_some_and(|began| began.distance(place_in_map) < SAME_PLACE_M) {
            self.began_at = Some(place_in_map);
            self.left = (Measure::Wait, 0.0);
        }
        self.left.0
    }

    fn note(&mut self, moment: &RecoveryMoment) {
        if moment.left_m.is_some_and(|left_m| left_m < self.least_left_m - FORWARD_M) {
            self.least_left_m = moment.left_m.unwrap_or(self.least_left_m);
            self.obstructed_s = 0.0;
        }
        if moment.obstruction.is_some() {
            self.obstruction = moment.obstruction;
            self.free_s = 0.0;
            self.obstructed_s += moment.lasted_s;
        } else {
            self.free_s += moment.lasted_s;
        }
        if self.measure == Measure::Drive && moment.obstruction.is_none() {
            self.obstruction = None;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec;
    use std::vec::Vec;

    const STEP_S: f32 = 0.1;

    /// Measures in order, for an obstruction from 1 s to `until_s`.
    fn measures(until_s: f32, end_s: f32) -> Vec<Measure> {
        let mut recovery = Recovery::new(RecoveryTimes::DEFAULT);
        let mut seen = vec![Measure::Drive];
        for step in 0..(end_s / STEP_S) as u32 {
            let now_s = step as f32 * STEP_S;
            let is_obstructed = (1.0..until_s).contains(&now_s);
            let next = recovery.update(&RecoveryMoment {
                lasted_s: STEP_S,
                place_in_map: Point2::default(),
                obstruction: is_obstructed.then_some(Obstruction::NoVelocity),
                left_m: Some(7.0),
                is_done: false,
            });
            assert_eq!(next.is_new, seen.last() != Some(&next.measure), "at {now_s} s");
            assert!(next.measure == Measure::Drive || next.obstruction.is_some(), "a reason at {now_s} s");
            if next.is_new {
                seen.push(next.measure);
            }
        }
        seen
    }

    /// It goes away for a second every three seconds, and the robot gets nowhere meanwhile.
    #[test]
    fn flickering_obstruction_climbs_the_ladder() {
        let mut recovery = Recovery::new(RecoveryTimes::DEFAULT);
        let backs_out = (0..300_u32).any(|step| {
            let is_obstructed = step % 30 < 20;
            let moment = RecoveryMoment {
                lasted_s: STEP_S,
                place_in_map: Point2::default(),
                obstruction: is_obstructed.then_some(Obstruction::Held),
                left_m: Some(7.0),
                is_done: false,
            };
            recovery.update(&moment).measure == Measure::BackOut
        });
        assert!(backs_out);
    }

    #[test]
    fn measures_come_in_order_and_end_with_help() {
        use Measure::{BackOut, CallHelp, ClearCostmap, Drive, OtherWay, Wait};
        assert_eq!(measures(4.0, 10.0), [Drive, Wait, Drive]);
        assert_eq!(measures(8.5, 14.0), [Drive, Wait, ClearCostmap, Drive]);
        let all = measures(1_000.0, 200.0);
        assert_eq!(all[..6], [Drive, Wait, ClearCostmap, BackOut, OtherWay, Wait]);
        assert_eq!(all.last(), Some(&CallHelp));
        // Help is not the end: when what obstructs has gone, the robot drives.
        let freed = measures(150.0, 160.0);
        assert_eq!(freed[freed.len() - 2..], [CallHelp, Drive]);
    }
}
