//! Takes something from the robot, to see whether its judges notice. Nothing of this is in the robot's own code.

use floorguard_sim::FaultSpec;
use floorguard_sim::scenario::MisplacedFile;
use floorguard_types::geometry::Point2;

use crate::world::Plan;

/// Half the width of a field that is none, metres.
const NEEDLE_M: f32 = 0.01;
/// A sensor up there sees nothing and says so all the time, metres.
const AWAY_M: f32 = 150.0;

/// What is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Spoil {
    /// Protective and warning fields are 2 cm wide.
    NeedleFields,
    /// The scanner talks, and looks at nothing.
    BlindScanner,
    /// The lidar talks, and looks at nothing.
    BlindLidar,
    /// A line is cut, as `--fault` names it.
    Cut(&'static str),
    /// The bumpers are never pressed.
    NoBumpers,
    /// The switches that feel for the floor never open.
    NoFloorSwitches,
    /// The scanner's protective field is never entered: no number of beams is enough.
    NoScanRule,
    /// The lidar's protective field is never entered: no number of returns is enough.
    NoPacketRule,
    /// Both of them.
    NoProtectiveRules,
    /// Something in the warning field slows nothing down.
    NoWarningRule,
    /// Somebody near slows nothing down.
    NoPersonRule,
}

impl Spoil {
    /// Takes it from the robot of a plan.
    ///
    /// # Errors
    /// There is no such line.
    pub fn apply(self, plan: &mut Plan) -> anyhow::Result<()> {
        plan.is_spoiled = true;
        let away = Some(MisplacedFile { z_m: AWAY_M, ..MisplacedFile::default() });
        let speed_mps = plan.robot.limits.speed_mps;
        let thresholds = &mut plan.robot.thresholds;
        match self {
            Self::NeedleFields => needles(plan),
            Self::BlindScanner => plan.scenario.scanner_misplaced = away,
            Self::BlindLidar => plan.scenario.lidar_misplaced = away,
            Self::Cut(line) => plan.faults.push(FaultSpec::parse(&format!("{line}:drop=100%"))?),
            Self::NoBumpers => plan.scenario.deaf_bumpers = true,
            Self::NoFloorSwitches => plan.scenario.without_floor_switches = true,
            Self::NoScanRule => thresholds.scan_adjacent_beams = u8::MAX,
            Self::NoPacketRule => thresholds.packet_returns = u8::MAX,
            Self::NoProtectiveRules => {
                (thresholds.scan_adjacent_beams, thresholds.packet_returns) = (u8::MAX, u8::MAX);
            }
            Self::NoWarningRule => thresholds.warning_speed_mps = speed_mps,
            Self::NoPersonRule => thresholds.person_speed_mps = speed_mps,
        }
        Ok(())
    }
}

/// Fields as long as they are that enclose the body, as they must, and are 2 cm wide ahead of it and behind it.
fn needles(plan: &mut Plan) {
    let body = &plan.robot.geometry.footprint;
    let fold = |of: fn(&Point2) -> f32, pick: fn(f32, f32) -> f32, from: f32| body.iter().map(of).fold(from, pick);
    let (rear_m, front_m) = (fold(|p| p.x_m, f32::min, f32::MAX), fold(|p| p.x_m, f32::max, f32::MIN));
    let (right_m, left_m) = (fold(|p| p.y_m, f32::min, f32::MAX), fold(|p| p.y_m, f32::max, f32::MIN));
    for field in &mut plan.robot.fields {
        for outline in [&mut field.protective, &mut field.warning] {
            let low_m = outline.iter().map(|corner| corner.x_m).fold(rear_m, f32::min);
            let high_m = outline.iter().map(|corner| corner.x_m).fold(front_m, f32::max);
            let corners = [
                (low_m, -NEEDLE_M),
                (rear_m, -NEEDLE_M),
                (rear_m, right_m),
                (front_m, right_m),
                (front_m, -NEEDLE_M),
                (high_m, -NEEDLE_M),
                (high_m, NEEDLE_M),
                (front_m, NEEDLE_M),
                (front_m, left_m),
                (rear_m, left_m),
                (rear_m, NEEDLE_M),
                (low_m, NEEDLE_M),
            ];
            *outline = corners.into_iter().map(|(x_m, y_m)| Point2::new(x_m, y_m)).collect();
        }
    }
}
