//! A drive to a goal in a recording: the plan, the costmap around the robot, and what it says of itself.

use std::io::{Seek, Write};
use std::sync::Arc;

use floorguard_robot::navigator::{NavigationPhase, NavigationProgress};
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::time::Stamp;

use super::messages::{Diagnostic, GridImage, Severity};
use super::recorder::{RecordError, Recorder};
use super::topics;

/// Name of the drive among the diagnostics.
pub const NAVIGATION: &str = "navigation";

/// What was written of a drive.
#[derive(Default)]
pub(super) struct SeenDrive {
    newest: Option<Arc<NavigationProgress>>,
}

impl SeenDrive {
    /// Writes what changed of a drive: its frame, its plan, its costmap, its words.
    pub(super) fn write<W: Write + Seek>(
        &mut self,
        out: &mut Recorder<W>,
        (progress, now): (&Arc<NavigationProgress>, Stamp),
    ) -> Result<(), RecordError> {
        let before = self.newest.replace(Arc::clone(progress));
        out.frame(now, now, (("map", "odom"), progress.odometry_in_map))?;
        if before.as_ref().is_none_or(|before| before.plans != progress.plans) {
            out.path(topics::PLAN, (now, "map"), &poses_along(&progress.path))?;
        }
        let drawn = before.as_ref().and_then(|before| before.costmap.as_ref());
        if let Some(costmap) = &progress.costmap
            && drawn.is_none_or(|drawn| !Arc::ptr_eq(drawn, costmap))
        {
            let corner = costmap.geometry.origin_in_map();
            let grid = GridImage {
                resolution_m: costmap.geometry.resolution_m(),
                width: costmap.geometry.width().into(),
                origin: Pose2::new(corner.x_m, corner.y_m, 0.0),
                cells: &costmap.cells,
            };
            out.map(topics::COSTMAP, (now, "map"), &grid)?;
        }
        if before.as_ref().is_none_or(|before| before.words != progress.words) {
            out.diagnostics(topics::DIAGNOSTICS, now, &[diagnostic(progress)])?;
        }
        Ok(())
    }
}

/// Poses at the places of a path, each heading for the next one.
fn poses_along(path: &[Point2]) -> Vec<Pose2> {
    let next = path.iter().skip(1).chain(path.last());
    let mut heading_rad = 0.0;
    let pose = |(at, next): (&Point2, &Point2)| {
        if at.distance(*next) > 1.0e-3 {
            heading_rad = (next.y_m - at.y_m).atan2(next.x_m - at.x_m);
        }
        Pose2::new(at.x_m, at.y_m, heading_rad)
    };
    path.iter().zip(next).map(pose).collect()
}

/// What it does, in one sentence.
fn diagnostic(progress: &NavigationProgress) -> Diagnostic {
    let severity = match progress.phase {
        NavigationPhase::NeedsHelp | NavigationPhase::Unreachable => Severity::Error,
        _ => Severity::Good,
    };
    let values = [
        ("state", progress.phase.name().to_owned()),
        ("left_m", progress.left_m.map_or_else(String::new, |left_m| format!("{left_m:.1}"))),
        ("distance_m", format!("{:.1}", progress.distance_m)),
        ("plans", progress.plans.to_string()),
    ];
    Diagnostic {
        severity,
        name: NAVIGATION.to_owned(),
        message: progress.words.clone(),
        values: values.map(|(name, value)| (name.to_owned(), value)).to_vec(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn poses_head_for_the_next_place() {
        let path = [Point2::new(0.0, 0.0), Point2::new(1.0, 0.0), Point2::new(1.0, 2.0)];
        let headings: Vec<f32> = poses_along(&path).iter().map(|pose| pose.heading_rad).collect();
        let up = std::f32::consts::FRAC_PI_2;
        assert_eq!(headings, [0.0, up, up]);
        assert!(poses_along(&[]).is_empty());
    }
}
