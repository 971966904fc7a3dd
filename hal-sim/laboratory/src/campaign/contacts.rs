//! Worlds that hurt, one trial after the other, judged by true geometry: what came of each is a row that can be kept,
//! merged with rows of other machines, and added up.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use floorguard_contact_judge::{ContactCounts, Report};
use floorguard_sim::hazards::{Hazard, HazardFamily};
use serde::{Deserialize, Serialize};

use super::{watched, watched_by};
use crate::world::{Observation, Plan};
use floorguard_operator::telemetry::{RunSinks, Tape};
use floorguard_robot::assembly::Stages;

/// People have crossed and routes have ended by then, seconds.
const DURATION_S: u64 = 25;
/// After the last command by hand the robot comes to rest, seconds.
const REST_S: f32 = 3.0;
/// Every second firing of the lidar is cast, 0.4° apart, and the one after it repeats it.
const LIDAR_GRAIN: usize = 2;

/// The plan of a trial.
///
/// # Errors
/// The world cannot be played.
pub fn contact_plan(seed: u64, trial: u64) -> anyhow::Result<Plan> {
    let hazard = Hazard::drawn(seed, trial);
    let by_hand_s: f32 = hazard.scenario.manoeuvre.iter().map(|manoeuvre| manoeuvre.seconds).sum();
    let duration_us = match hazard.scenario.manoeuvre.is_empty() {
        true => DURATION_S * 1_000_000,
        false => ((by_hand_s + REST_S) * 1.0e6) as u64,
    };
    let name = format!("hazard:{seed}:{trial}");
    let world_seed = seed.wrapping_mul(1_000_003).wrapping_add(trial);
    let mut plan = Plan::of(&name, hazard.scenario, world_seed, duration_us)?;
    plan.lidar_grain = LIDAR_GRAIN;
    Ok(plan)
}

/// What came of a trial.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ContactRow {
    /// Seed of the campaign.
    pub seed: u64,
    /// Number of the trial.
    pub trial: u64,
    /// What the world is about.
    pub family: String,
    /// It passed.
    pub passed: bool,
    /// Why not.
    pub failures: Vec<String>,
    /// Contacts by kind.
    pub counts: ContactCounts,
    /// Every contact in words.
    pub contacts: Vec<String>,
    /// The body would have hit what a sensor had seen.
    pub missed_stops: u32,
    /// The body would have hit what no sensor had seen.
    pub missed_unseen: u32,
    /// Stops for something in the way.
    pub stops: u32,
    /// Those without need.
    pub nuisance_stops: u32,
    /// Answers to its own protective field that came late.
    pub late_field_stops: u32,
    /// What came of the job.
    pub job: String,
    /// Robot time, seconds.
    pub duration_s: f64,
    /// Metres.
    pub distance_m: f64,
    /// Of the robot time: moving, turning, reversing, seconds.
    pub moving_s: [f64; 3],
    /// Fingerprint of the robot's outputs.
    pub digest: String,
}

impl ContactRow {
    fn of((seed, trial): (u64, u64), seen: &Observation) -> Self {
        let verdict = &seen.verdict;
        let bodies: &Report = &verdict.bodies;
        let moving_s = bodies.duration_s * bodies.moving_share;
        Self {
            passed: verdict.passed,
            failures: verdict.failures.clone(),
            counts: bodies.counts,
            contacts: bodies.contacts.iter().map(floorguard_contact_judge::Contact::line).collect(),
            missed_stops: bodies.missed_stops,
            missed_unseen: bodies.missed_unseen,
            stops: verdict.stops,
            nuisance_stops: bodies.nuisance_stops,
            late_field_stops: verdict.late_field_stops,
            job: format!("{:?}", bodies.job),
            duration_s: bodies.duration_s,
            distance_m: bodies.travelled_m,
            moving_s: [moving_s, moving_s * bodies.turning_share, moving_s * bodies.reversing_share],
            digest: verdict.digest.clone(),
            ..Self::begun(seed, trial)
        }
    }

    fn begun(seed: u64, trial: u64) -> Self {
        let family = Hazard::drawn(seed, trial).family.name().to_owned();
        Self { seed, trial, family, ..Self::default() }
    }

    /// It passed, and the moving robot touched something: no sensor had seen it in time, or nobody could have avoided it.
    #[must_use]
    pub const fn passed_with_contact(&self) -> bool {
        self.passed && self.counts.while_moving() > 0
    }

    /// The command that plays the trial again.
    #[must_use]
    pub fn command(&self) -> String {
        format!("floorguard campaign contacts --seed {} --first {} --trials 1", self.seed, self.trial)
    }
}

/// Plays a trial; a run that breaks is a trial that did not pass.
#[must_use]
pub fn contact_trial(seed: u64, trial: u64) -> ContactRow {
    contact_trial_with(seed, trial, |_| {})
}

/// The same with a plan that somebody has changed.
#[must_use]
pub fn contact_trial_with(seed: u64, trial: u64, change: impl FnOnce(&mut Plan)) -> ContactRow {
    let played = contact_plan(seed, trial).and_then(|mut plan| {
        change(&mut plan);
        watched(&plan)
    });
    match played {
        Ok(seen) => ContactRow::of((seed, trial), &seen),
        Err(error) => ContactRow { failures: vec![format!("{error:#}")], ..ContactRow::begun(seed, trial) },
    }
}

/// A trial on the host with the stages of the microcontroller, and all input of its robot.
#[derive(Clone, Debug)]
pub struct TapedContactTrial {
    /// What came of it on the host.
    pub row: ContactRow,
    /// The tape for the emulated board.
    pub tape: Vec<u8>,
}

/// Plays the first `seconds` of a trial with the stages of the microcontroller, and records all input of the robot.
///
/// `None` where somebody drives by hand: a tape holds a route, and what comes from devices. A job that is cut short is not judged.
///
/// # Errors
/// The world cannot be played.
pub fn taped_contact_trial(seed: u64, trial: u64, seconds: u64) -> anyhow::Result<Option<TapedContactTrial>> {
    let mut plan = contact_plan(seed, trial)?;
    if !plan.scenario.manoeuvre.is_empty() {
        return Ok(None);
    }
    plan.duration_us = plan.duration_us.min(seconds * 1_000_000);
    plan.stages = Stages::AsOnBoard;
    let mut sinks = RunSinks::default();
    sinks.tape = Tape::new(&plan.robot, plan.duration_us);
    let seen = watched_by(&plan, &mut sinks)?;
    Ok(Some(TapedContactTrial { row: ContactRow::of((seed, trial), &seen), tape: sinks.tape.finish() }))
}

/// Rows added up.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ContactSummary {
    /// Trials.
    pub trials: u64,
    /// Trials that did not pass.
    pub failed: u64,
    /// Contacts by kind.
    pub counts: ContactCounts,
    /// Sum over all trials.
    pub missed_stops: u64,
    /// Sum over all trials.
    pub missed_unseen: u64,
    /// Sum over all trials.
    pub stops: u64,
    /// Sum over all trials.
    pub nuisance_stops: u64,
    /// Robot time, hours.
    pub hours: f64,
    /// Metres.
    pub distance_m: f64,
    /// Share of the time in motion in which the robot turned.
    pub turning_share: f64,
    /// Share of the time in motion in which it drove backwards.
    pub reversing_share: f64,
    /// Trials that passed although the moving robot touched something: no sensor had seen it in time, or nobody could have
    /// avoided it.
    pub passed_with_contact: u64,
    /// By family.
    pub families: BTreeMap<String, FamilyCounts>,
}

/// What came of the trials of a family.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct FamilyCounts {
    /// Trials.
    pub trials: u64,
    /// Trials that did not pass.
    pub failed: u64,
    /// Contacts of the moving robot that a sensor had seen in time.
    pub seen: u64,
    /// Those that no sensor had seen in time.
    pub unseen: u64,
    /// Those that nobody could have avoided.
    pub unavoidable: u64,
    /// People who walked into the standing robot.
    pub walked_into_standing: u64,
}

impl FamilyCounts {
    fn words(&self) -> String {
        format!(
            "{:6} trials, {:5} failed; contacts: {:4} seen, {:4} unseen, {:4} unavoidable, {:4} of people with the standing robot",
            self.trials, self.failed, self.seen, self.unseen, self.unavoidable, self.walked_into_standing
        )
    }

    fn add(&mut self, row: &ContactRow) {
        self.trials += 1;
        self.failed += u64::from(!row.passed);
        self.seen += u64::from(row.counts.avoidable_by_sensors);
        self.unseen += u64::from(row.counts.unseen());
        self.unavoidable += u64::from(row.counts.unavoidable());
        self.walked_into_standing += u64::from(row.counts.walked_into_standing);
    }
}

impl ContactSummary {
    /// Adds up rows; a trial counts once.
    #[must_use]
    pub fn of(rows: &[ContactRow]) -> Self {
        let mut sum = Self::default();
        let mut moving_s = [0.0; 3];
        let once: BTreeMap<(u64, u64), &ContactRow> =
            rows.iter().map(|row| ((row.seed, row.trial), row)).collect();
        for row in once.values() {
            sum.trials += 1;
            sum.failed += u64::from(!row.passed);
            sum.counts.add(&row.counts);
            sum.missed_stops += u64::from(row.missed_stops);
            sum.missed_unseen += u64::from(row.missed_unseen);
            sum.stops += u64::from(row.stops);
            sum.nuisance_stops += u64::from(row.nuisance_stops);
            sum.hours += row.duration_s / 3_600.0;
            sum.distance_m += row.distance_m;
            moving_s.iter_mut().zip(row.moving_s).for_each(|(sum, seconds)| *sum += seconds);
            sum.passed_with_contact += u64::from(row.passed_with_contact());
            sum.families.entry(row.family.clone()).or_default().add(row);
        }
        let share = |part: f64| if moving_s[0] > 0.0 { part / moving_s[0] } else { 0.0 };
        (sum.turning_share, sum.reversing_share) = (share(moving_s[1]), share(moving_s[2]));
        sum
    }

    /// In a few lines; the first one says what counts.
    #[must_use]
    pub fn words(&self) -> String {
        let counts = &self.counts;
        let mut text = String::new();
        let _ = writeln!(
            text,
            "{} trials, {} failed, {} passed with a contact; {} contacts while the robot moved: {}; missed stops {} seen, {} UNSEEN",
            self.trials,
            self.failed,
            self.passed_with_contact,
            counts.while_moving(),
            counts.headline(),
            self.missed_stops,
            self.missed_unseen
        );
        let _ = writeln!(
            text,
            "  with people {} (of these driven into {}), with objects {}, over edges {}; beyond the limits of a short impact {}",
            counts.people_while_moving,
            counts.drove_into_people,
            counts.drove_into_things,
            counts.over_edges,
            counts.harmful
        );
        let _ = writeln!(
            text,
            "  stops {} ({} without need); {:.2} hours, {:.0} m, {:.0} % of the motion turning, {:.0} % in reverse",
            self.stops,
            self.nuisance_stops,
            self.hours,
            self.distance_m,
            100.0 * self.turning_share,
            100.0 * self.reversing_share
        );
        for family in HazardFamily::ALL {
            if let Some(counts) = self.families.get(family.name()) {
                let _ = writeln!(text, "  {:11} {}", family.name(), counts.words());
            }
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A low box and a thin bar, which the lidar meets for a moment each; the memory of the microcontroller keeps the box, too.
    #[test]
    fn fg_req_066_box_and_bar_seen_for_a_moment_hold() {
        for trial in [17, 40] {
            let row = contact_trial(1, trial);
            assert!(
                row.passed && row.counts.while_moving() == 0,
                "{trial}: {:?} {:?}",
                row.failures,
                row.contacts
            );
        }
        let on_board = contact_trial_with(1, 17, |plan| plan.stages = Stages::AsOnBoard);
        assert_eq!(on_board.missed_stops, 0, "{:?}", on_board.contacts);
    }

    /// Half a cell is empty at the tip of an oblique box: the rays that pass beside it do not refute what others meet.
    #[test]
    fn fg_req_028_tip_of_an_oblique_box_holds() {
        let row = contact_trial(3, 13);
        assert!(row.passed && row.counts.while_moving() == 0, "{:?} {:?}", row.failures, row.contacts);
    }

    /// Boxes behind a robot that backs from where it was switched on: 10 and 20 cm high, and one that hangs from 16 to 36 cm.
    #[test]
    fn fg_req_028_low_boxes_behind_hold() {
        for trial in [187, 1_057, 1_132] {
            let row = contact_trial(7, trial);
            assert!(row.passed && row.missed_stops == 0, "{trial}: {:?} {:?}", row.failures, row.contacts);
        }
    }

    /// Boxes beside the flank of which the scanner meets the far side alone, and boxes of which the lidar met the upper part behind what its
    /// lowest ring passes over: beside a robot that turns, and behind a post.
    #[test]
    fn fg_req_069_near_sides_never_seen_hold() {
        for (seed, trial) in [(8, 441), (8, 486), (8, 240), (7, 1_282)] {
            let row = contact_trial(seed, trial);
            assert!(row.passed && row.missed_stops == 0, "{trial}: {:?} {:?}", row.failures, row.contacts);
        }
    }

    /// The switches under the robot's front feel floor: a ramp that it drives up is seen by none of its sensors. Its bumper feels the ramp
    /// where that is as high, and not what lies beside it (trial 1566).
    #[test]
    fn switches_feel_floor_and_bumpers_objects() {
        for (trial, drove_into) in [(894, "ramp"), (1_566, "box")] {
            let row = contact_trial(7, trial);
            assert!(row.passed && row.counts.went_on == 0, "{trial}: {:?} {:?}", row.failures, row.contacts);
            let [contact] = row.contacts.as_slice() else { panic!("{trial}: {:?}", row.contacts) };
            assert!(contact.contains(drove_into) && contact.contains("no sensor"), "{contact}");
        }
    }

    /// A box that is too low for lidar and scanner presses the bumper: it holds as long as the box is there, against a reset, too.
    #[test]
    fn touched_bumper_holds_against_reset() {
        let row = contact_trial(1, 59);
        assert!(row.passed && row.counts.went_on == 0, "{:?} {:?}", row.failures, row.contacts);
        assert_eq!(row.counts.drove_into_things, 1, "{:?}", row.contacts);
    }

    #[test]
    fn rows_round_trip_and_trials_count_once() {
        let mut row = ContactRow::begun(7, 3);
        row.counts.drove_into_things = 2;
        row.moving_s = [10.0, 4.0, 1.0];
        let text = serde_json::to_string(&row).unwrap();
        assert_eq!(serde_json::from_str::<ContactRow>(&text).unwrap(), row);
        let mut other = ContactRow { passed: true, ..ContactRow::begun(7, 4) };
        (other.counts.drove_into_things, other.counts.avoidable) = (1, 1);
        other.counts.walked_into_standing = 3;
        let sum = ContactSummary::of(&[row.clone(), other, row]);
        assert_eq!((sum.trials, sum.failed, sum.counts.while_moving()), (2, 1, 3));
        assert!((sum.turning_share - 0.4).abs() < 1e-9);
        let expected = "2 trials, 1 failed, 1 passed with a contact; 3 contacts while the robot moved: 0 seen in time by a sensor, \
                        1 UNSEEN by every sensor, 2 that nobody could have avoided; 3 people walked into the standing robot";
        assert!(sum.words().starts_with(expected), "{}", sum.words());
    }
}
