//! The result of a check for a machine.

use floorguard_configuration::{Coverage, DirectionLimit, HostedConfiguration, Refusal, SensorGap, Unseen};
use serde::Serialize;

use super::CheckArguments;

#[derive(Serialize)]
struct Checked {
    file: String,
    verdict: &'static str,
    refusals: Vec<String>,
    warnings: Vec<String>,
    gaps: Vec<GapRow>,
    /// Directions that are slower for a gap.
    limits: Vec<LimitRow>,
    /// Nothing where a sensor looks beside the rear.
    unknown_rear: Option<UnknownRearRow>,
}

/// Speeds are those of the fastest point of the body.
#[derive(Serialize)]
struct LimitRow {
    direction: &'static str,
    limit_mps: f32,
    configured_mps: f32,
    /// The gap that costs it, by name.
    gap: String,
    /// What is in the gap may be touched so fast at most.
    touched_mps: f32,
}

/// Every turn is slower until the robot has driven ahead.
#[derive(Serialize)]
struct UnknownRearRow {
    limit_mps: f32,
    known_after_m: f32,
}

#[derive(Serialize)]
struct GapRow {
    name: String,
    region: &'static str,
    kind: &'static str,
    /// Heights between which it is, metres.
    from_m: f32,
    to_m: f32,
    /// Least and greatest x and y of the places where it is widest, robot frame, metres.
    around_m: [[f32; 2]; 2],
    is_accepted: bool,
    reached_mps: f32,
    motions: Vec<MotionRow>,
}

#[derive(Serialize)]
struct MotionRow {
    motion: &'static str,
    reached_mps: f32,
    steps: Vec<StepRow>,
}

#[derive(Serialize)]
struct StepRow {
    from_mps: f32,
    heights_m: [f32; 2],
}

/// One object.
pub(super) fn text(
    arguments: &CheckArguments,
    configuration: &HostedConfiguration,
    (coverage, refusals): (&Coverage, &[Refusal]),
) -> serde_json::Result<String> {
    serde_json::to_string(&Checked {
        file: arguments.file.display().to_string(),
        verdict: if refusals.is_empty() { "good" } else { "failed" },
        refusals: refusals.iter().map(ToString::to_string).collect(),
        warnings: configuration.warnings(),
        gaps: coverage.gaps.iter().map(|gap| row(gap, configuration)).collect(),
        limits: configuration.direction_limits(coverage).iter().map(limit).collect(),
        unknown_rear: unknown_rear(configuration),
    })
}

fn limit(limit: &DirectionLimit) -> LimitRow {
    LimitRow {
        direction: limit.direction.name(),
        limit_mps: limit.limit_mps,
        configured_mps: limit.configured_mps,
        gap: limit.because.gap.to_string(),
        touched_mps: limit.because.touched_mps,
    }
}

fn unknown_rear(configuration: &HostedConfiguration) -> Option<UnknownRearRow> {
    let unseen = &configuration.robot.unseen;
    (unseen.known_after_m > 0.0)
        .then_some(UnknownRearRow { limit_mps: unseen.unknown_rear_mps, known_after_m: unseen.known_after_m })
}

fn row(found: &SensorGap, configuration: &HostedConfiguration) -> GapRow {
    let (kind, [from_m, to_m]) = match found.gap.unseen {
        Unseen::Below(height_m) => ("below", [0.0, height_m]),
        Unseen::SteppingIn(height_m) => ("stepping-in", [0.0, height_m]),
        Unseen::Hanging(heights_m) => ("hanging", heights_m),
    };
    let motions = found.motions.iter().map(|motion| MotionRow {
        motion: motion.motion.name(),
        reached_mps: motion.reached_mps,
        steps: motion
            .steps
            .iter()
            .map(|step| StepRow { from_mps: step.from_mps, heights_m: step.heights_m })
            .collect(),
    });
    GapRow {
        name: found.gap.to_string(),
        region: found.gap.region.name(),
        kind,
        from_m,
        to_m,
        around_m: found.around_m.map(|corner| [corner.x_m, corner.y_m]),
        is_accepted: configuration.accepted_gaps.iter().any(|accepted| accepted.is_same(&found.gap)),
        reached_mps: found.reached_mps(),
        motions: motions.collect(),
    }
}
