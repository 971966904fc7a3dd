//! From the robot's configuration to what the guard must know.

use core::f32::consts::PI;

use floorguard_drivers::motor_drives::{MotorDrivesConfiguration, MotorProtocol};
use floorguard_drivers::three_wheel_base::BaseConfiguration;
use floorguard_drivers::velodyne::Model;
use floorguard_drivers::wheel_drives::WheelDrivesConfiguration;
use floorguard_guard::{
    DriveLimits, FieldSet, GuardConfig, LidarGeometry, ScannerGeometry, Source, SourceRules,
};
use floorguard_localisation::odometry::{Ackermann, SideWheels, Tricycle, WheelGeometry};
use floorguard_types::capacities::PACKET_RINGS_MAX;
use floorguard_types::geometry::Pose2;

use super::robot::{BaseKind, DriveTrain, Geometry, Limits, RobotConfiguration};
use super::sources::{LidarModel, ScannerConfiguration, ScannerModel};

/// Lower than this a return is floor: half a brush height and the error of a tilted lidar, metres.
const FLOOR_CLEARANCE_M: f32 = 0.08;
/// Nothing of the robot is higher, metres.
const BODY_HEIGHT_M: f32 = 1.40;

/// The drives' own ramps are this much steeper than what the guard counts on: the guard shapes the motion.
const RAMP_RESERVE: f32 = 1.8;
/// The front wheel turns a little less than a quarter to either side, radians.
const STEERING_MAX_RAD: f32 = 1.5;

impl Limits {
    /// What the guard knows of the drive.
    #[must_use]
    pub const fn drive(&self, geometry: &Geometry) -> DriveLimits {
        DriveLimits {
            speed_mps: self.speed_mps,
            turn_radps: self.turn_radps,
            acceleration_mps2: self.acceleration_mps2,
            braking_mps2: self.braking_mps2,
            response_s: self.response_s,
            wheelbase_m: geometry.wheelbase_m,
            wheel_lever_m: geometry.wheel_lever_m,
        }
    }
}

impl ScannerConfiguration {
    /// What the guard knows of it.
    #[must_use]
    pub fn geometry(&self) -> ScannerGeometry {
        let mounting = self.mounting;
        ScannerGeometry {
            mounting: Pose2::new(mounting.position.x_m, mounting.position.y_m, mounting.yaw_rad),
            first_angle_rad: self.model.first_angle_rad(),
            step_rad: self.model.step_rad(),
            beams: self.model.beams(),
            sector_rad: self.sector_rad,
        }
    }
}

impl RobotConfiguration {
    /// What the guard must know. [`GuardConfig::validate`] has the last word.
    #[must_use]
    pub fn guard(&self) -> GuardConfig {
        let mut fields = heapless::Vec::new();
        for field in &self.fields {
            // Same capacity: never full.
            let _ = fields.push(FieldSet {
                travel: field.direction.travel(),
                speed_max_mps: field.speed_max_mps,
                protective: field.protective.clone(),
                warning: field.warning.clone(),
            });
        }
        GuardConfig {
            footprint: self.geometry.footprint.clone(),
            fields,
            scanner: self.scanner.geometry(),
            rear_scanner: self.rear_scanner.as_ref().map(ScannerConfiguration::geometry),
            lidar: LidarGeometry {
                mounting: self.lidar.mounting.transform(),
                elevations_rad: self.elevations_rad(),
                self_mask: self.geometry.footprint.clone(),
                floor_clearance_m: FLOOR_CLEARANCE_M,
                body_height_m: BODY_HEIGHT_M,
            },
            drive: self.limits.drive(&self.geometry),
            thresholds: self.thresholds,
            unseen: self.unseen,
            sources: self.source_rules(),
        }
    }

    /// The measuring wheels.
    #[must_use]
    pub fn wheels(&self) -> WheelGeometry {
        WheelGeometry {
            track_m: self.geometry.track_m,
            ticks_per_m: self.geometry.ticks_per_m,
            speed_max_mps: self.limits.speed_mps,
        }
    }

    /// The devices on the CAN bus.
    #[must_use]
    pub fn base(&self) -> BaseConfiguration {
        BaseConfiguration {
            traction_node: self.can.drive_node,
            steering_node: self.can.steering_node,
            left_encoder_node: self.can.left_encoder_node,
            right_encoder_node: self.can.right_encoder_node,
            inputs_node: self.can.inputs_node,
            dirt_sensor_node: self.can.dirt_sensor_node,
            inputs: self.can.inputs,
            acceleration_mps2: self.limits.acceleration_mps2 * RAMP_RESERVE,
            deceleration_mps2: self.limits.braking_mps2 * RAMP_RESERVE,
            quick_stop_mps2: self.limits.braking_mps2 * RAMP_RESERVE,
            ..BaseConfiguration::default()
        }
    }

    /// The wheel drives on the CAN bus, of a base without a steered wheel.
    #[must_use]
    pub fn wheel_drives(&self) -> WheelDrivesConfiguration {
        let ramp_mps2 = self.limits.braking_mps2 * RAMP_RESERVE;
        WheelDrivesConfiguration {
            wheel_nodes: self.can.wheel_nodes,
            inputs_node: self.can.inputs_node,
            dirt_sensor_node: self.can.dirt_sensor_node,
            inputs: self.can.inputs,
            acceleration_mps2: self.limits.acceleration_mps2 * RAMP_RESERVE,
            deceleration_mps2: ramp_mps2,
            track_m: self.geometry.track_m,
            lever_m: self.geometry.wheelbase_m,
            ..WheelDrivesConfiguration::default()
        }
    }

    /// The safety controller's gateway is on the bus of the drives.
    #[must_use]
    pub fn has_inputs(&self) -> bool {
        self.base == BaseKind::CanBus && (self.motors.is_none() || self.can.inputs_node != 0)
    }

    /// The motor controllers, of a base that has such.
    #[must_use]
    pub fn motor_drives(&self) -> Option<MotorDrivesConfiguration> {
        let ramp_mps2 = self.limits.braking_mps2 * RAMP_RESERVE;
        self.motors.map(|motors| MotorDrivesConfiguration {
            counts_per_turn: match motors.protocol {
                // There a metre is a turn, and both wheels of a side are counted together.
                MotorProtocol::WheelLine if motors.wheels > 2 => 0.5 * self.geometry.ticks_per_m,
                MotorProtocol::WheelLine => self.geometry.ticks_per_m,
                _ => motors.counts_per_turn,
            },
            inputs_node: self.can.inputs_node,
            inputs: self.can.inputs,
            acceleration_mps2: self.limits.acceleration_mps2 * RAMP_RESERVE,
            deceleration_mps2: ramp_mps2,
            track_m: self.geometry.track_m,
            lever_m: self.geometry.wheelbase_m,
            ..motors
        })
    }

    /// The kinematics of a base without a steered wheel.
    #[must_use]
    pub const fn side_wheels(&self) -> SideWheels {
        SideWheels { track_m: self.geometry.track_m }
    }

    /// The kinematics of a base that steers as a car does.
    #[must_use]
    pub const fn ackermann(&self) -> Ackermann {
        let Geometry { wheelbase_m, track_m, .. } = self.geometry;
        let steering_max_rad = match self.train {
            DriveTrain::Ackermann { steering_max_rad } => steering_max_rad,
            _ => STEERING_MAX_RAD,
        };
        Ackermann { wheelbase_m, track_m, steering_max_rad }
    }

    /// The kinematics.
    #[must_use]
    pub const fn tricycle(&self) -> Tricycle {
        Tricycle { wheelbase_m: self.geometry.wheelbase_m, steering_max_rad: STEERING_MAX_RAD }
    }

    /// The Velodyne decoder's name for the lidar; `None`: tell from the packets, or it is none of that family.
    #[must_use]
    pub const fn lidar_model(&self) -> Option<Model> {
        match self.lidar.model {
            LidarModel::Auto
            | LidarModel::PandarXt16
            | LidarModel::PandarXt32
            | LidarModel::Ouster(_)
            | LidarModel::Bridged(_)
            | LidarModel::LivoxMid360(_) => None,
            LidarModel::Vlp16 => Some(Model::Vlp16),
            LidarModel::PuckHiRes => Some(Model::HiRes),
            LidarModel::Vlp32c => Some(Model::Vlp32C),
            LidarModel::Hdl32e => Some(Model::Hdl32E),
        }
    }

    /// As many as the capacity: packets of a larger lidar are refused.
    fn elevations_rad(&self) -> heapless::Vec<f32, PACKET_RINGS_MAX> {
        self.lidar_elevations_deg().iter().map(|elevation_deg| elevation_deg * (PI / 180.0)).collect()
    }

    fn source_rules(&self) -> [SourceRules; Source::COUNT] {
        let mut rules = GuardConfig::default_sources();
        if let Some(rule) = rules.get_mut(Source::RearScanner.index()).filter(|_| self.rear_scanner.is_some())
        {
            *rule = GuardConfig::RULES_OF_SCANNER;
        }
        let mut stop_after = |source: Source, stop_us: u64| {
            if let Some(rule) = rules.get_mut(source.index()) {
                rule.stop_after_us = Some(stop_us);
                rule.limit_after_us = rule.limit_after_us.min(stop_us);
            }
        };
        stop_after(Source::Scanner, self.deadlines.scanner_us);
        if self.rear_scanner.is_some() {
            stop_after(Source::RearScanner, self.deadlines.rear_scanner_us);
        }
        stop_after(Source::Lidar, self.deadlines.lidar_us);
        stop_after(Source::Wheels, self.deadlines.odometry_us);
        stop_after(Source::Command, self.deadlines.command_us);
        if let (ScannerModel::Ranging(model), Some(rule)) =
            (self.scanner.model, rules.get_mut(Source::Scanner.index()))
        {
            rule.limit_after_us += model.older_us();
            rule.stop_after_us = rule.stop_after_us.map(|stop_us| stop_us + model.older_us());
        }
        // What is not there cannot be late; what that costs is printed when the robot starts.
        let fitted = [
            (Source::Imu, self.imu.is_some()),
            (Source::Lidar, self.has_lidar),
            (Source::Discrete, self.has_inputs()),
        ];
        for (source, is_fitted) in fitted {
            if let Some(rule) = rules.get_mut(source.index()) {
                rule.fitted = is_fitted;
            }
        }
        rules
    }
}
