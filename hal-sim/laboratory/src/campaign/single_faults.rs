//! Random single faults: the robot stops or goes on as it should, and says which source it was.

use floorguard_sim::{FaultSpec, Stream};
use floorguard_types::random::Pcg32;

use super::summary::RunOutcome;
use super::watched;
use crate::world::{Observation, Plan};

const DURATION_S: u64 = 20;
/// The robot must stand this long after a fault that leaves it without a source: deadline 0.3 s, response 0.15 s,
/// 1.25 s of braking from full speed, and a quarter of a second between two samples.
const STANDS_AFTER_S: f64 = 2.0;
/// It may still roll this far, metres.
const ROLLS_M: f32 = 0.05;

/// What must come of a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Expected {
    /// The robot stands while the fault lasts.
    Stands,
    /// It goes on: the fault is within what the design tolerates.
    GoesOn,
    /// Either is right, as long as nobody is hurt and the right source is named.
    Either,
}

/// A fault that was drawn.
struct Case {
    scenario: &'static str,
    text: String,
    from_s: u64,
    to_s: u64,
    expected: Expected,
    stream: Stream,
}

/// Sources that may be named for a line. Perception lives from the lidar, and the mission from the wheels.
const fn sources(stream: Stream) -> &'static [&'static str] {
    match stream {
        Stream::LidarData | Stream::LidarPosition => &["lidar", "perception"],
        Stream::ScannerSerial | Stream::ScannerData => &["safety scanner"],
        Stream::RearScannerSerial => &["rear safety scanner"],
        Stream::ImuSerial => &["inertial sensor"],
        Stream::Can => &["wheel encoders", "drive", "safety inputs", "wanted command", "perception"],
    }
}

impl Case {
    fn draw(seed: u64) -> Self {
        use Expected::{Either, GoesOn, Stands};
        let mut random = Pcg32::new(seed, 57);
        let scenarios = ["empty", "supermarket", "crossing", "warehouse"];
        let scenario = scenarios[random.below(4) as usize];
        let (from_s, lasts_s) = (4 + u64::from(random.below(4)), 3 + u64::from(random.below(5)));
        let lines = [
            ("lidar", Stream::LidarData),
            ("scanner", Stream::ScannerSerial),
            ("imu", Stream::ImuSerial),
            ("can", Stream::Can),
            ("position", Stream::LidarPosition),
        ];
        let (name, stream) = lines[random.below(5) as usize];
        let loses = |expected| if stream == Stream::LidarPosition { GoesOn } else { expected };
        let (kind, expected) = match random.below(12) {
            0 => ("silent".to_owned(), loses(Stands)),
            1 => ("stuck".to_owned(), loses(Stands)),
            2 => ("drop=100%".to_owned(), loses(Stands)),
            3 => ("truncate=100%".to_owned(), loses(Stands)),
            4 => ("delay=800ms".to_owned(), loses(Either)),
            5 => (format!("drop={}%", 1 + random.below(3)), loses(Either)),
            6 => ("duplicate=20%".to_owned(), loses(Either)),
            7 => ("reorder=10%".to_owned(), loses(Either)),
            8 => (format!("flip={}%", 1 + random.below(50)), loses(Either)),
            9 => (format!("burst={}", 2 + random.below(30)), loses(Either)),
            10 => ("flap=400ms".to_owned(), loses(Either)),
            // Only what measures with beams can be blind; any other line loses a burst now and then.
            _ if stream == Stream::LidarData => ("blind=120deg".to_owned(), Either),
            _ if stream == Stream::ScannerSerial => ("blind=120deg".to_owned(), GoesOn),
            _ => ("burst=20".to_owned(), loses(Either)),
        };
        let text = format!("{name}:{kind},from={from_s}s,to={}s", from_s + lasts_s);
        Self { scenario, text, from_s, to_s: from_s + lasts_s, expected, stream }
    }

    /// Why it counts as failed.
    fn judge(&self, seen: &Observation) -> Option<String> {
        let verdict = &seen.verdict;
        if !verdict.passed {
            return Some(verdict.why_not());
        }
        let allowed = sources(self.stream);
        if let Some(wrong) = verdict.faulty_sources.iter().find(|name| !allowed.contains(&name.as_str())) {
            return Some(format!("{wrong} is named as faulty and was not"));
        }
        // From when it must stand to the end of the fault.
        let rolled_m = seen.path_m(self.from_s as f64 + STANDS_AFTER_S, self.to_s as f64);
        match self.expected {
            Expected::Stands if rolled_m > ROLLS_M => {
                Some(format!("it rolled {rolled_m:.2} m under the fault"))
            }
            Expected::Stands if verdict.faulty_sources.is_empty() => Some("no source is named".to_owned()),
            Expected::GoesOn if !verdict.faulty_sources.is_empty() => {
                Some(format!("{} named without need", verdict.faulty_sources.join(", ")))
            }
            _ => None,
        }
    }
}

/// One fault.
#[must_use]
pub fn single_fault(seed: u64) -> RunOutcome {
    let case = Case::draw(seed);
    let command = format!(
        "floorguard simulate --scenario {} --seed {seed} --duration {DURATION_S} --fault {}",
        case.scenario, case.text
    );
    let plan = Plan::named(case.scenario, seed, DURATION_S * 1_000_000).map_err(anyhow::Error::from);
    let played = plan.and_then(|mut plan| {
        plan.faults.push(FaultSpec::parse(&case.text)?);
        watched(&plan)
    });
    match played {
        Ok(seen) => RunOutcome {
            command,
            failure: case.judge(&seen),
            verdict: Some(seen.verdict),
            ..RunOutcome::default()
        },
        Err(error) => RunOutcome { command, failure: Some(error.to_string()), ..RunOutcome::default() },
    }
}
