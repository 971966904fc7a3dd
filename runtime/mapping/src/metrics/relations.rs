//! The relation error of Kümmerle et al. 2009, "On measuring the accuracy of SLAM algorithms", section 3: every
//! reference relation between two times is compared with the same relation of the trajectory, so that no common frame
//! is needed and no error is counted more often than it was made.

use crate::se2::{Se2, wrap};

/// A reference: where the robot of the second time stood, seen from the first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relation {
    /// Seconds.
    pub from_s: f64,
    /// Seconds.
    pub to_s: f64,
    /// The second pose in the frame of the first.
    pub pose: Se2,
}

/// The error of one relation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RelationError {
    /// Which relation.
    pub relation: Relation,
    /// Metres.
    pub translation_m: f64,
    /// Radians, ≥ 0.
    pub rotation_rad: f64,
}

/// All errors of a trajectory.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RelationScore {
    /// In the order of the relations.
    pub errors: Vec<RelationError>,
    /// Relations with a time that the trajectory does not reach within the tolerance.
    pub without_pose: usize,
}

/// A line that is no relation.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: eight numbers are expected (t1 t2 x y z roll pitch yaw)")]
pub struct RelationFormat {
    /// Number of the line, from 1.
    pub line: usize,
}

/// Reads the text format of the benchmark: `t1 t2 x y z roll pitch yaw`, a relation a line.
///
/// # Errors
/// A line is damaged.
pub fn read_relations(text: &str) -> Result<Vec<Relation>, RelationFormat> {
    let mut relations = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let numbers: Option<Vec<f64>> = line.split_whitespace().map(|word| word.parse().ok()).collect();
        let damaged = RelationFormat { line: index + 1 };
        let Some([from_s, to_s, x, y, _, _, _, yaw]) = numbers.as_deref().and_then(|n| n.first_chunk::<8>())
        else {
            return Err(damaged);
        };
        relations.push(Relation { from_s: *from_s, to_s: *to_s, pose: Se2::new(*x, *y, *yaw) });
    }
    Ok(relations)
}

/// Compares a trajectory (ordered by time) with the relations; a relation counts if a pose lies within `tolerance_s` of
/// both of its times.
#[must_use]
pub fn score_relations(relations: &[Relation], trajectory: &[(f64, Se2)], tolerance_s: f64) -> RelationScore {
    let pose_at = |time_s: f64| -> Option<Se2> {
        let after = trajectory.partition_point(|(t, _)| *t < time_s);
        let near = trajectory.get(after.saturating_sub(1)..(after + 1).min(trajectory.len()))?;
        let nearest = near.iter().min_by(|a, b| (a.0 - time_s).abs().total_cmp(&(b.0 - time_s).abs()))?;
        ((nearest.0 - time_s).abs() <= tolerance_s).then_some(nearest.1)
    };
    let mut score = RelationScore::default();
    for relation in relations {
        let (Some(from), Some(to)) = (pose_at(relation.from_s), pose_at(relation.to_s)) else {
            score.without_pose += 1;
            continue;
        };
        let error = relation.pose.between(from.between(to));
        score.errors.push(RelationError {
            relation: *relation,
            translation_m: error.length_m(),
            rotation_rad: wrap(error.heading_rad).abs(),
        });
    }
    score
}

impl RelationScore {
    /// Mean translation, metres; NaN without errors.
    #[must_use]
    pub fn translation_mean_m(&self) -> f64 {
        self.errors.iter().map(|error| error.translation_m).sum::<f64>() / self.errors.len() as f64
    }

    /// Mean rotation, radians; NaN without errors.
    #[must_use]
    pub fn rotation_mean_rad(&self) -> f64 {
        self.errors.iter().map(|error| error.rotation_rad).sum::<f64>() / self.errors.len() as f64
    }

    /// Largest translation, metres.
    #[must_use]
    pub fn translation_max_m(&self) -> f64 {
        self.errors.iter().map(|error| error.translation_m).fold(0.0, f64::max)
    }
}
