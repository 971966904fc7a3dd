//! The explanation as data: for the terminal, for the page and for other programs.

use std::fmt::Write as _;

use floorguard_guard::{CauseRecord, Decision, DriveLimits, SourceReport};
use floorguard_host::words::beside;
use floorguard_types::geometry::{Point2, Twist2};
use serde::Serialize;

use super::gather::Snapshot;
use super::otherwise::{Otherwise, otherwise};
use super::rule::{requirement, requirement_text};
use crate::panel::{pieces, remedy};
use crate::surroundings::{Followed, Holder, Surroundings};
use crate::words::Language;

/// Rows of the table of the seconds before, at least this far apart unless something changed, microseconds.
const ROW_US: u64 = 500_000;

/// A source at the moment.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SourceLine {
    /// Name.
    pub name: &'static str,
    /// In one word.
    pub health: String,
    /// Age of its newest measurement, ms; none before the first.
    pub age_ms: Option<u64>,
    /// What it saw, as far as words can tell, in the language.
    pub saw: String,
}

/// A cause that held.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CauseLine {
    /// In words and numbers.
    pub text: String,
    /// Requirement that it follows from.
    pub requirement: &'static str,
    /// Text of the requirement.
    pub rule: &'static str,
    /// What helps.
    pub remedy: String,
    /// Since when, seconds of the robot's clock.
    pub since_s: f64,
}

/// A row of the seconds before.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MomentLine {
    /// Robot time, seconds.
    pub at_s: f64,
    /// State shown.
    pub state: String,
    /// Measured speed, m/s.
    pub speed_mps: f32,
    /// Permitted speed, m/s.
    pub permitted_mps: f32,
    /// Greatest permitted speed, m/s.
    pub limit_mps: f32,
    /// What held or limited it; empty if nothing did.
    pub held_by: String,
    /// Distance to the nearest person, metres.
    pub person_m: Option<f32>,
}

/// The whole explanation.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Incident {
    /// Version of these fields.
    pub version: u32,
    /// The recording.
    pub file: String,
    /// The moment, seconds of the robot's clock.
    pub at_s: f64,
    /// State shown.
    pub state: String,
    /// What the guard did.
    pub action: String,
    /// Language of the words in here.
    #[serde(skip)]
    pub language: Language,
    /// What the guard did stops the robot.
    #[serde(skip)]
    pub stops: bool,
    /// What held or limited the robot.
    pub decided_by: Option<CauseLine>,
    /// What stopped it first, where that was something else.
    pub first: Option<CauseLine>,
    /// Everything else that held at the same time.
    pub others: Vec<CauseLine>,
    /// The person or obstacle that held it.
    pub holder: Option<Holder>,
    /// What would have happened otherwise.
    pub otherwise: Option<Otherwise>,
    /// Every fitted source.
    pub sources: Vec<SourceLine>,
    /// People and others that were followed, in the robot's frame.
    pub followed: Vec<Followed>,
    /// Speed at the moment, m/s.
    pub speed_mps: f32,
    /// Where the robot was in the odometry frame: x, y in metres, heading in radians.
    pub pose: [f32; 3],
    /// The seconds before.
    pub before: Vec<MomentLine>,
    /// Whether what is shown is what was decided then.
    pub repetition: String,
}

impl Incident {
    /// Of the snapshots that were gathered, in a language; `None` when there are none.
    #[must_use]
    pub fn new(
        (file, repetition): (&str, String),
        snapshots: &[Snapshot],
        (drive, language): (&DriveLimits, Language),
    ) -> Option<Self> {
        let moment = snapshots.last()?;
        let decision = &moment.decision;
        let holding = decision.holding_cause;
        let first = decision.primary_cause.filter(|first| Some(first.cause) != holding.map(|it| it.cause));
        let others = moment.causes.iter().filter(|record| {
            Some(record.cause) != holding.map(|it| it.cause) && Some(record.cause) != first.map(|it| it.cause)
        });
        let pose = moment.pose.pose_in_odometry;
        Some(Self {
            version: 1,
            file: file.to_owned(),
            at_s: seconds(moment.at.as_micros()),
            state: state_words(decision, language),
            action: language.say(&decision.action.to_string()).to_owned(),
            language,
            stops: decision.action.stops(),
            decided_by: holding.as_ref().map(|record| cause_line(record, language)),
            first: first.as_ref().map(|record| cause_line(record, language)),
            others: others.map(|record| cause_line(record, language)).collect(),
            holder: holding.and_then(|record| moment.around.holder(&record)),
            otherwise: otherwise(snapshots, drive, language),
            sources: moment.sources.iter().map(|report| source_line(report, moment, language)).collect(),
            followed: moment.around.followed.clone(),
            speed_mps: moment.pose.twist.linear_mps,
            pose: [pose.x_m, pose.y_m, pose.heading_rad],
            before: rows(snapshots, language),
            repetition,
        })
    }

    /// For the terminal.
    #[must_use]
    pub fn text(&self) -> String {
        let language = self.language;
        let mut text = String::new();
        let at = language.number(self.at_s, 3);
        let _ = writeln!(text, "{}, {at} s: {}, {}", self.file, self.state, self.action);
        let mut named = |name: &str, words: &str| {
            let _ = writeln!(text, "  {:<12}{words}", language.say(name));
        };
        match &self.decided_by {
            Some(cause) => {
                named("decided by", &cause.text);
                named("rule", &format!("{}: {}", cause.requirement, cause.rule));
                if let Some(holder) = &self.holder {
                    named("held by", &holder.words_in(language));
                }
                named("remedy", &cause.remedy);
            }
            None => named("nothing held or limited the robot", ""),
        }
        if let Some(first) = &self.first {
            named("first cause", &first.text);
        }
        for other in &self.others {
            named("also", &format!("{} ({})", other.text, other.requirement));
        }
        if let Some(otherwise) = &self.otherwise {
            named("otherwise", &otherwise.sentence);
        }
        let lines = self.sources.iter().map(|source| (language.say(source.name), source));
        let lines: Vec<_> = lines.collect();
        let wide = lines.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0);
        for (name, source) in lines {
            let age = source.age_in(language);
            let _ = writeln!(text, "  {name:<wide$} {:<10}{age:>9}  {}", source.health, source.saw);
        }
        let _ = writeln!(text, "  {}", self.repetition);
        text
    }
}

impl SourceLine {
    /// Age of its newest measurement in words.
    #[must_use]
    pub fn age_in(&self, language: Language) -> String {
        self.age_ms.map_or_else(|| language.say("never").to_owned(), |age| format!("{age} ms"))
    }
}

fn seconds(us: u64) -> f64 {
    us as f64 * 1.0e-6
}

/// A cause in words and numbers; in English as the guard writes it.
pub fn cause_words(record: &CauseRecord, language: Language) -> String {
    match language {
        Language::English => record.to_string(),
        _ => pieces::spoken(&pieces::of_cause(record), language),
    }
}

fn state_words(decision: &Decision, language: Language) -> String {
    language.say(&format!("{:?}", decision.state)).to_owned()
}

fn cause_line(record: &CauseRecord, language: Language) -> CauseLine {
    let requirement = requirement(record.cause);
    CauseLine {
        text: cause_words(record, language),
        requirement,
        rule: requirement_text(requirement),
        remedy: language.say(remedy(record)).to_owned(),
        since_s: seconds(record.raised_at.as_micros()),
    }
}

fn source_line(report: &SourceReport, moment: &Snapshot, language: Language) -> SourceLine {
    use floorguard_guard::Source;
    let number = |value: f32, digits| language.number(value.into(), digits);
    let motion = |motion: &Twist2| {
        format!("{} m/s, {} rad/s", number(motion.linear_mps, 2), number(motion.angular_radps, 2))
    };
    let saw = match report.source {
        Source::Scanner => returns(&moment.around, language),
        Source::Perception => people(&moment.around, language),
        Source::Wheels | Source::Imu => motion(&moment.pose.twist),
        Source::Command => moment.wanted.as_ref().map_or_else(String::new, motion),
        _ => String::new(),
    };
    SourceLine {
        name: report.source.name(),
        health: language.say(&report.health.to_string()).to_owned(),
        age_ms: (report.age_us < u64::MAX).then_some(report.age_us / 1_000),
        saw,
    }
}

fn returns(around: &Surroundings, language: Language) -> String {
    let within = |field: &[Point2]| {
        let inside = |hit: &&_| floorguard_configuration::polygon_contains(field, **hit);
        around.hits.iter().filter(inside).count().to_string()
    };
    language.fill(
        "{} returns, {} in the protective field, {} in the warning field",
        &[&around.hits.len().to_string(), &within(&around.protective), &within(&around.warning)],
    )
}

fn people(around: &Surroundings, language: Language) -> String {
    let Some(nearest) = around.nearest_person() else { return language.say("no people").to_owned() };
    let count = around.followed.iter().filter(|track| track.person).count();
    let (one, many) = ("{} person, the nearest {}, {} m", "{} people, the nearest {}, {} m");
    let metres = language.number(nearest.distance_m.into(), 1);
    let gaps = [count.to_string(), language.say(nearest.direction).to_owned(), metres];
    language.fill(beside(count as u64, one, many), &[&gaps[0], &gaps[1], &gaps[2]])
}

/// One row every half second, and one wherever state or cause changed.
fn rows(snapshots: &[Snapshot], language: Language) -> Vec<MomentLine> {
    let mut rows: Vec<MomentLine> = Vec::new();
    let mut next_us = 0;
    for (index, snapshot) in snapshots.iter().enumerate() {
        let row = moment_line(snapshot, language);
        let same = rows.last().is_some_and(|last| last.state == row.state && held(last) == held(&row));
        let at_us = snapshot.at.as_micros();
        if !same || at_us >= next_us || index + 1 == snapshots.len() {
            next_us = at_us + ROW_US;
            rows.push(row);
        }
    }
    rows
}

/// The cause without its figures, which are others in each row.
fn held(row: &MomentLine) -> &str {
    row.held_by.split(|letter: char| letter.is_ascii_digit()).next().unwrap_or_default()
}

fn moment_line(snapshot: &Snapshot, language: Language) -> MomentLine {
    let decision = &snapshot.decision;
    MomentLine {
        at_s: seconds(snapshot.at.as_micros()),
        state: state_words(decision, language),
        speed_mps: snapshot.pose.twist.linear_mps,
        permitted_mps: decision.permitted.linear_mps,
        limit_mps: decision.speed_limit_mps,
        held_by: decision.holding_cause.map_or_else(String::new, |record| cause_words(&record, language)),
        person_m: snapshot.around.nearest_person().map(|nearest| nearest.distance_m),
    }
}
