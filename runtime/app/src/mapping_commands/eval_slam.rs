//! `floorguard eval slam`: a trajectory against reference relations or a true trajectory.

use std::path::Path;

use floorguard_host::outcome::{BadInput, VerdictFailed};
use floorguard_mapping_host::Se2;
use floorguard_mapping_host::metrics::{
    ErrorStatistics, StepLength, TimedPose, absolute_errors, associate, read_relations, read_tum,
    relative_errors, score_relations,
};
use serde_json::{Value, json};

use super::arguments::SlamArguments;
use crate::files::text;

/// As the command line says for each.
const TOLERANCE_RELATIONS_S: f64 = 0.1;
const TOLERANCE_TRAJECTORY_S: f64 = 0.01;

/// Runs the command.
///
/// # Errors
/// A file that cannot be read, nothing to compare, or an error beyond the limit.
pub fn run(arguments: &SlamArguments, json: bool) -> anyhow::Result<()> {
    let mut result = trajectory(&arguments.result)?;
    result.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
    let (figures, error_m) = match (&arguments.relations, &arguments.trajectory) {
        (Some(relations), _) => by_relations(arguments, relations, &result)?,
        (None, Some(truth)) => by_trajectory(arguments, truth, &result)?,
        (None, None) => return Err(BadInput("neither relations nor a true trajectory".to_owned()).into()),
    };
    if json {
        tell!("{figures}")?;
    } else {
        for (name, figure) in figures.as_object().into_iter().flatten() {
            tell!("{name:28} {figure}")?;
        }
    }
    match arguments.limit_m.filter(|limit_m| error_m > *limit_m) {
        Some(limit_m) => Err(VerdictFailed(format!("{error_m:.4} m; the limit is {limit_m} m")).into()),
        None => Ok(()),
    }
}

fn trajectory(path: &Path) -> Result<Vec<TimedPose>, BadInput> {
    let poses = read_tum(&text(path)?).map_err(|error| BadInput(format!("{}: {error}", path.display())))?;
    if poses.is_empty() {
        return Err(BadInput(format!("{}: no pose in it", path.display())));
    }
    Ok(poses)
}

/// Six digits: a micrometre or a microdegree says nothing more.
fn rounded(value: f64) -> f64 {
    (value * 1.0e6).round() / 1.0e6
}

fn by_relations(
    arguments: &SlamArguments,
    path: &Path,
    result: &[TimedPose],
) -> Result<(Value, f64), BadInput> {
    let bad = |what: &dyn std::fmt::Display| BadInput(format!("{}: {what}", path.display()));
    let relations = read_relations(&text(path)?).map_err(|error| bad(&error))?;
    let flat: Vec<(f64, Se2)> = result.iter().map(|pose| (pose.time_s, pose.flat())).collect();
    let tolerance_s = arguments.tolerance_s.unwrap_or(TOLERANCE_RELATIONS_S);
    let score = score_relations(&relations, &flat, tolerance_s);
    if score.errors.is_empty() {
        return Err(bad(&format_args!(
            "none of its {} relations has both of its times in the trajectory",
            relations.len()
        )));
    }
    let of = |value: fn(&floorguard_mapping_host::metrics::RelationError) -> f64| {
        ErrorStatistics::of(&score.errors.iter().map(value).collect::<Vec<_>>())
    };
    let (translation, rotation) =
        (of(|error| error.translation_m), of(|error| error.rotation_rad.to_degrees()));
    let figures = json!({
        "relations": score.errors.len(),
        "relations_without_pose": score.without_pose,
        "translation_mean_m": rounded(translation.mean),
        "translation_deviation_m": rounded(translation.deviation),
        "translation_max_m": rounded(translation.most),
        "rotation_mean_deg": rounded(rotation.mean),
        "rotation_deviation_deg": rounded(rotation.deviation),
        "rotation_max_deg": rounded(rotation.most),
    });
    Ok((figures, translation.mean))
}

fn by_trajectory(
    arguments: &SlamArguments,
    path: &Path,
    result: &[TimedPose],
) -> Result<(Value, f64), BadInput> {
    let mut truth = trajectory(path)?;
    truth.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
    let tolerance_s = arguments.tolerance_s.unwrap_or(TOLERANCE_TRAJECTORY_S);
    let pairs = associate(&truth, result, tolerance_s);
    let absolute = ErrorStatistics::of(&absolute_errors(&pairs));
    if absolute.count == 0 {
        let count = pairs.len();
        return Err(BadInput(format!(
            "{}: {count} of its poses lie within {tolerance_s} s of one of the result; three are needed",
            path.display()
        )));
    }
    let step = arguments.step_m.map_or(StepLength::Poses(1), StepLength::Metres);
    let relative = relative_errors(&pairs, step);
    let translation = ErrorStatistics::of(&relative.translation_m);
    let degrees: Vec<f64> = relative.rotation_rad.iter().map(|angle| angle.to_degrees()).collect();
    let rotation = ErrorStatistics::of(&degrees);
    let figures = json!({
        "pairs": absolute.count,
        "ate_rmse_m": rounded(absolute.rmse),
        "ate_mean_m": rounded(absolute.mean),
        "ate_median_m": rounded(absolute.median),
        "ate_deviation_m": rounded(absolute.deviation),
        "ate_max_m": rounded(absolute.most),
        "rpe_steps": translation.count,
        "rpe_translation_rmse_m": rounded(translation.rmse),
        "rpe_translation_mean_m": rounded(translation.mean),
        "rpe_translation_max_m": rounded(translation.most),
        "rpe_rotation_rmse_deg": rounded(rotation.rmse),
        "rpe_rotation_mean_deg": rounded(rotation.mean),
        "rpe_rotation_max_deg": rounded(rotation.most),
    });
    Ok((figures, absolute.rmse))
}
