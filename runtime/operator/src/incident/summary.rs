//! The explanation as data: for the terminal, for the page and for other programs.

use std::fmt::Write as _;

use floorguard_guard::{CauseRecord, DriveLimits, SourceReport};
use serde::Serialize;

use super::gather::Snapshot;
use super::otherwise::{Otherwise, otherwise};
use super::rule::{requirement, requirement_text};
use crate::panel::remedy;
use crate::surroundings::{Followed, Holder};

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
    /// What it saw, as far as words can tell.
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
    pub remedy: &'static str,
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
    /// Of the snapshots that were gathered; `None` when there are none.
    #[must_use]
    pub fn new(file: &str, snapshots: &[Snapshot], drive: &DriveLimits, repetition: String) -> Option<Self> {
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
            state: format!("{:?}", decision.state),
            action: decision.action.to_string(),
            decided_by: holding.as_ref().map(cause_line),
            first: first.as_ref().map(cause_line),
            others: others.map(cause_line).collect(),
            holder: holding.and_then(|record| moment.around.holder(&record)),
            otherwise: otherwise(snapshots, drive),
            sources: moment.sources.iter().map(|report| source_line(report, moment)).collect(),
            followed: moment.around.followed.clone(),
            speed_mps: moment.pose.twist.linear_mps,
            pose: [pose.x_m, pose.y_m, pose.heading_rad],
            before: rows(snapshots),
            repetition,
        })
    }

    /// For the terminal.
    #[must_use]
    pub fn text(&self) -> String {
        let mut text = String::new();
        let mut line = |words: String| _ = writeln!(text, "{words}");
        line(format!("{}, {:.3} s: {}, {}", self.file, self.at_s, self.state, self.action));
        match &self.decided_by {
            Some(cause) => {
                line(format!("  decided by  {}", cause.text));
                line(format!("  rule        {}: {}", cause.requirement, cause.rule));
                if let Some(holder) = &self.holder {
                    line(format!("  held by     {}", holder.words()));
                }
                line(format!("  remedy      {}", cause.remedy));
            }
            None => line("  nothing held or limited the robot".to_owned()),
        }
        if let Some(first) = &self.first {
            line(format!("  first cause {}", first.text));
        }
        for other in &self.others {
            line(format!("  also        {} ({})", other.text, other.requirement));
        }
        if let Some(otherwise) = &self.otherwise {
            line(format!("  otherwise   {}", otherwise.sentence));
        }
        for source in &self.sources {
            let age = source.age_ms.map_or_else(|| "never".to_owned(), |age| format!("{age} ms"));
            line(format!("  {:<18}{:<9}{age:>9}  {}", source.name, source.health, source.saw));
        }
        line(format!("  {}", self.repetition));
        text
    }
}

fn seconds(us: u64) -> f64 {
    us as f64 * 1.0e-6
}

fn cause_line(record: &CauseRecord) -> CauseLine {
    let requirement = requirement(record.cause);
    CauseLine {
        text: record.to_string(),
        requirement,
        rule: requirement_text(requirement),
        remedy: remedy(record),
        since_s: seconds(record.raised_at.as_micros()),
    }
}

fn source_line(report: &SourceReport, moment: &Snapshot) -> SourceLine {
    use floorguard_guard::Source;
    let around = &moment.around;
    let people = around.followed.iter().filter(|track| track.person).count();
    let saw = match report.source {
        Source::Scanner => {
            let within = |field: &[floorguard_types::geometry::Point2]| {
                let inside = |hit: &&_| floorguard_configuration::polygon_contains(field, **hit);
                around.hits.iter().filter(inside).count()
            };
            format!(
                "{} returns, {} in the protective field, {} in the warning field",
                around.hits.len(),
                within(&around.protective),
                within(&around.warning)
            )
        }
        Source::Perception => match around.nearest_person() {
            Some(nearest) => format!(
                "{}, the nearest {}, {:.1} m",
                floorguard_host::words::counted(people as u64, "person"),
                nearest.direction,
                nearest.distance_m
            ),
            None => "no people".to_owned(),
        },
        Source::Wheels | Source::Imu => {
            let twist = moment.pose.twist;
            format!("{:.2} m/s, {:.2} rad/s", twist.linear_mps, twist.angular_radps)
        }
        Source::Command => moment.wanted.map_or_else(String::new, |it| {
            format!("{:.2} m/s, {:.2} rad/s", it.linear_mps, it.angular_radps)
        }),
        _ => String::new(),
    };
    SourceLine {
        name: report.source.name(),
        health: report.health.to_string(),
        age_ms: (report.age_us < u64::MAX).then_some(report.age_us / 1_000),
        saw,
    }
}

/// One row every half second, and one wherever state or cause changed.
fn rows(snapshots: &[Snapshot]) -> Vec<MomentLine> {
    let mut rows: Vec<MomentLine> = Vec::new();
    let mut next_us = 0;
    for (index, snapshot) in snapshots.iter().enumerate() {
        let row = moment_line(snapshot);
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

fn moment_line(snapshot: &Snapshot) -> MomentLine {
    let decision = &snapshot.decision;
    MomentLine {
        at_s: seconds(snapshot.at.as_micros()),
        state: format!("{:?}", decision.state),
        speed_mps: snapshot.pose.twist.linear_mps,
        permitted_mps: decision.permitted.linear_mps,
        limit_mps: decision.speed_limit_mps,
        held_by: decision.holding_cause.map_or_else(String::new, |record| record.to_string()),
        person_m: snapshot.around.nearest_person().map(|nearest| nearest.distance_m),
    }
}
