//! Takes one protection from the robot of a plan, to see whether its judges notice. Nothing of this is in the robot's own code:
//! a rule is deleted by thresholds that nothing reaches, a sensor by a mounting from which it measures nothing.

use floorguard_guard::Thresholds;
use floorguard_sim::FaultSpec;
use floorguard_sim::scenario::MisplacedFile;
use floorguard_types::geometry::Point2;

use crate::plan::Plan;

/// Half the width of a field of needles, metres: no body fits into it.
const NEEDLE_M: f32 = 0.01;
/// A sensor at this height measures nothing and goes on talking, metres.
const AWAY_M: f32 = 150.0;
/// Nothing is as near as this, metres; the guard refuses 0.
const NEVER_NEAR_M: f32 = 1.0e-3;
/// More than any difference of speeds, m/s or rad/s.
const ANY: f32 = 1.0e3;
/// Longer than any run, microseconds.
const NEVER_US: u64 = 1_000_000_000;

/// What is taken away.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Removal {
    /// Protective and warning fields are 2 cm wide ahead of the body and behind it.
    Fields,
    /// The scanner talks, and measures nothing.
    ScannerReturns,
    /// The lidar talks, and measures nothing.
    LidarReturns,
    /// The scanner's line is silent.
    Scanner,
    /// The lidar's line is silent.
    Lidar,
    /// The inertial sensor's line is silent.
    Imu,
    /// The wheel encoders are silent.
    Encoders,
    /// Emergency stop, bumpers and floor switches are silent.
    Inputs,
    /// The bumpers are never pressed.
    Bumpers,
    /// The floor switches never open.
    FloorSwitches,
    /// Nobody's emergency stop is heard.
    EmergencyStop,
    /// Rule `ScanProtective`, no number of beams is enough, and the memory, which holds the robot without it.
    ScanRule,
    /// Rule `LidarProtective`, no number of returns is enough, and the memory, which holds the robot without it.
    LidarRule,
    /// Both of them.
    ProtectiveRules,
    /// Rules `WayClosed` and `WayNarrow`: nothing is near enough to be remembered.
    MemoryRules,
    /// Rule `Warning`: something in the warning field slows nothing down.
    WarningRule,
    /// Rule `PersonNear`: somebody near slows nothing down.
    PersonRule,
    /// Rule `Overspeed`: no speed lasts too long.
    OverspeedRule,
    /// Rule `SpeedDisagreement`: encoders and drive may differ by any speed.
    SpeedRule,
    /// Rules `TurnDisagreement` and `SteeringDisagreement`: any difference is permitted.
    TurnRules,
    /// Rule `SourceLost` of the scanner: its silence is never too long.
    ScannerLostRule,
}

impl Removal {
    /// All.
    pub const ALL: [Self; 21] = [
        Self::Fields,
        Self::ScannerReturns,
        Self::LidarReturns,
        Self::Scanner,
        Self::Lidar,
        Self::Imu,
        Self::Encoders,
        Self::Inputs,
        Self::Bumpers,
        Self::FloorSwitches,
        Self::EmergencyStop,
        Self::ScanRule,
        Self::LidarRule,
        Self::ProtectiveRules,
        Self::MemoryRules,
        Self::WarningRule,
        Self::PersonRule,
        Self::OverspeedRule,
        Self::SpeedRule,
        Self::TurnRules,
        Self::ScannerLostRule,
    ];

    /// A source says nothing at all: the robot must not become ready.
    #[must_use]
    pub const fn is_silence(self) -> bool {
        matches!(self, Self::Scanner | Self::Lidar | Self::Imu | Self::Encoders | Self::Inputs)
    }

    /// Takes it from the robot of a plan.
    ///
    /// # Errors
    /// The simulator knows no such line.
    pub fn apply(self, plan: &mut Plan) -> anyhow::Result<()> {
        plan.is_corrupted = true;
        let away = Some(MisplacedFile { z_m: AWAY_M, ..MisplacedFile::default() });
        let mut silence = |line: &str| -> anyhow::Result<()> {
            plan.faults.push(FaultSpec::parse(&format!("{line}:drop=100%"))?);
            Ok(())
        };
        match self {
            Self::Scanner => silence("scanner")?,
            Self::Lidar => silence("lidar")?,
            Self::Imu => silence("imu")?,
            Self::Encoders => silence("encoders")?,
            Self::Inputs => silence("inputs")?,
            Self::Fields => make_needles(plan),
            Self::ScannerReturns => plan.scenario.scanner_misplaced = away,
            Self::LidarReturns => plan.scenario.lidar_misplaced = away,
            Self::Bumpers => plan.scenario.deaf_bumpers = true,
            Self::FloorSwitches => plan.scenario.without_floor_switches = true,
            Self::EmergencyStop => plan.emergency_stop_us.clear(),
            Self::ScannerLostRule => plan.robot.deadlines.scanner_us = NEVER_US,
            rule => rule.delete_threshold(&mut plan.robot.thresholds, plan.robot.limits.speed_mps),
        }
        Ok(())
    }

    fn delete_threshold(self, thresholds: &mut Thresholds, speed_mps: f32) {
        if matches!(self, Self::ScanRule | Self::ProtectiveRules) {
            thresholds.scan_adjacent_beams = u8::MAX;
        }
        if matches!(self, Self::LidarRule | Self::ProtectiveRules) {
            thresholds.packet_returns = u8::MAX;
        }
        if matches!(self, Self::ScanRule | Self::LidarRule | Self::ProtectiveRules | Self::MemoryRules) {
            thresholds.memory_reach_m = NEVER_NEAR_M;
        }
        if self == Self::OverspeedRule {
            thresholds.overspeed_us = NEVER_US;
        }
        if self == Self::SpeedRule {
            thresholds.speed_disagreement_mps = ANY;
        }
        if self == Self::TurnRules {
            thresholds.turn_disagreement_radps = ANY;
        }
        if self == Self::WarningRule {
            thresholds.warning_speed_mps = speed_mps;
        }
        if self == Self::PersonRule {
            (thresholds.person_near_m, thresholds.person_speed_mps) = (NEVER_NEAR_M, speed_mps);
        }
    }
}

/// Fields as long as they are that enclose the body, as the configuration demands, and are 2 cm wide ahead of it and behind it.
fn make_needles(plan: &mut Plan) {
    let body = &plan.robot.geometry.footprint;
    let fold =
        |of: fn(&Point2) -> f32, pick: fn(f32, f32) -> f32, from: f32| body.iter().map(of).fold(from, pick);
    let (rear_m, front_m) = (fold(|p| p.x_m, f32::min, f32::MAX), fold(|p| p.x_m, f32::max, f32::MIN));
    let (right_m, left_m) = (fold(|p| p.y_m, f32::min, f32::MAX), fold(|p| p.y_m, f32::max, f32::MIN));
    for field in &mut plan.robot.fields {
        for outline in [&mut field.protective, &mut field.warning] {
            let low_m = outline.iter().map(|corner| corner.x_m).fold(rear_m, f32::min);
            let high_m = outline.iter().map(|corner| corner.x_m).fold(front_m, f32::max);
            let corners = [
                [low_m, -NEEDLE_M],
                [rear_m, -NEEDLE_M],
                [rear_m, right_m],
                [front_m, right_m],
                [front_m, -NEEDLE_M],
                [high_m, -NEEDLE_M],
                [high_m, NEEDLE_M],
                [front_m, NEEDLE_M],
                [front_m, left_m],
                [rear_m, left_m],
                [rear_m, NEEDLE_M],
                [low_m, NEEDLE_M],
            ];
            *outline = corners.into_iter().map(|[x_m, y_m]| Point2::new(x_m, y_m)).collect();
        }
    }
}
