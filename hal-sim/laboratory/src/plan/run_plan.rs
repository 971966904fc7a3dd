//! What to simulate: scenario, seed, duration, faults, and the robot that drives the scenario's route.

use std::path::Path;
use std::sync::Arc;

use floorguard_runtime::configuration::{ImuModel, RangingModel, RobotConfiguration, ScannerModel};
use floorguard_runtime::mission::{Route, RouteLimits};
use floorguard_sim::FaultSpec;
use floorguard_sim::dirt::DirtFile;
use floorguard_sim::robot::RobotParameters;
use floorguard_sim::scenario::{Scenario, ScenarioError};
use floorguard_sim::simulation::Simulation;
use floorguard_types::geometry::{Point2, Pose2};

use super::mission_plan::{navigation_of_scenario, plan_of_scenario};
use super::outside::OutsideProgram;
use super::recorded_lidar::RecordedLidar;
use super::true_robot::{true_robot, unplayable};
use floorguard_configuration::{
    ActuatedLidarConfiguration, CommandConfiguration, EXAMPLE, NavigationConfiguration, bridged_scanner_keys,
    parse,
};
use floorguard_robot::assembly::Stages;
use floorguard_robot::cleaner::{CleaningOrders, MissionPlan, MissionStrategy};
use floorguard_robot::learning::LearningSetup;
use floorguard_robot::navigator::{DriveOrders, NavigationPlan, NavigationSettings};

/// So fast a simulated robot may be behind a scanner that is no safety device, m/s.
const ACCEPTED_MPS: f32 = 0.3;

/// A run of the simulator.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Name of the scenario, for reports.
    pub name: String,
    /// The scenario.
    pub scenario: Scenario,
    /// The scenario's dirt, until a mission is planned.
    dirt: Option<DirtFile>,
    /// Seed of all randomness.
    pub seed: u64,
    /// Simulated time, microseconds.
    pub duration_us: u64,
    /// What goes wrong.
    pub faults: Vec<FaultSpec>,
    /// The robot.
    pub robot: RobotConfiguration,
    /// Its file; the route is the scenario's.
    pub robot_toml: String,
    /// Which stages of the robot run.
    pub stages: Stages,
    /// What the robot cleans; without a mission it drives the scenario's route, and no dirt lies there.
    pub mission: Option<MissionPlan>,
    /// Where the robot drives; it then neither cleans nor drives the scenario's route, and the run ends when it is there or
    /// gives up.
    pub navigation: Option<NavigationPlan>,
    /// Somebody outside orders its goals, one after another, and the run does not end with them.
    pub drive_orders: Option<DriveOrders>,
    /// Somebody outside orders what it cleans beside that, part by part.
    pub cleaning_orders: Option<CleaningOrders>,
    /// How it drives to a goal.
    pub navigation_settings: NavigationSettings,
    /// The run ends when the mission has nothing left to clean; `duration_us` is then the longest that it may take.
    pub until_clean: bool,
    /// A floor camera with rendered pictures.
    pub has_camera: bool,
    /// How the robot learns; without it, it does not.
    pub learning: Option<LearningSetup>,
    /// When the emergency stop is pressed and released, microseconds.
    pub emergency_stop_us: Vec<(u64, u64)>,
    /// One firing of the lidar in so many is measured, and those after it repeat it: 1 for a lidar as it is.
    pub lidar_grain: usize,
    /// Its packets come in place of those of the simulated lidar.
    pub lidar: Option<Arc<RecordedLidar>>,
    /// The program that drives the robot from outside instead of the route; with `outside` its script.
    pub command: Option<CommandConfiguration>,
    /// A lidar that a motor turns: in real time its bytes cross real carriers, too.
    pub actuated_lidar: Option<ActuatedLidarConfiguration>,
    /// What that program sends in virtual time.
    pub outside: Option<OutsideProgram>,
    /// Something was taken from the robot to see whether its judges notice: its faults excuse nothing.
    pub is_corrupted: bool,
}

/// Why a plan cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum PlanError {
    /// The scenario.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// The robot.
    #[error(transparent)]
    Robot(#[from] floorguard_configuration::Refused),
    /// The mission.
    #[error("the mission: {0:#}")]
    Mission(anyhow::Error),
    /// The scenario's route is longer than the robot's memory.
    #[error("the route of the scenario has {0} waypoints, the robot remembers {max}", max = floorguard_runtime::mission::ROUTE_WAYPOINTS_MAX)]
    Route(usize),
}

impl Plan {
    /// A built-in scenario with the example robot.
    ///
    /// # Errors
    /// No scenario of that name.
    pub fn named(name: &str, seed: u64, duration_us: u64) -> Result<Self, PlanError> {
        Self::of(name, Scenario::named(name)?, seed, duration_us)
    }

    /// A scenario with the example robot on the scenario's route.
    ///
    /// # Errors
    /// The route is too long.
    pub fn of(name: &str, mut scenario: Scenario, seed: u64, duration_us: u64) -> Result<Self, PlanError> {
        let mut robot = parse("robot.toml", EXAMPLE)?.robot;
        let to_odometry = scenario.start_pose().inverse();
        let waypoints = &scenario.route.waypoints_m;
        let mut route = Route { repeat: scenario.route.repeat, ..Route::default() };
        for [x_m, y_m] in waypoints {
            let place = to_odometry.transform(Point2::new(*x_m, *y_m));
            route.waypoints.push(place).map_err(|_| PlanError::Route(waypoints.len()))?;
        }
        let defaults = RouteLimits::default();
        robot.route_limits = RouteLimits {
            speed_mps: scenario.route.speed_mps.clamp(0.05, robot.limits.speed_mps),
            turn_radps: defaults.turn_radps.min(robot.limits.turn_radps),
            ..defaults
        };
        robot.route = route;
        let dirt = scenario.dirt.take();
        let navigation = NavigationConfiguration::of_limits(&robot.limits);
        Ok(Self {
            name: name.to_owned(),
            scenario,
            dirt,
            mission: None,
            navigation: None,
            drive_orders: None,
            cleaning_orders: None,
            navigation_settings: (&navigation).into(),
            seed,
            duration_us,
            faults: Vec::new(),
            robot,
            robot_toml: EXAMPLE.to_owned(),
            stages: Stages::All,
            until_clean: false,
            has_camera: false,
            learning: None,
            emergency_stop_us: Vec::new(),
            lidar_grain: 1,
            lidar: None,
            command: None,
            actuated_lidar: None,
            outside: None,
            is_corrupted: false,
        })
    }

    /// With the robot of a file of one's own: body, base, sensors and their mountings, speeds, deadlines, thresholds, fields and
    /// learning. The scenario says what to drive. What the simulator cannot play is refused.
    ///
    /// # Errors
    /// The file is refused, or has what no simulated robot has.
    pub fn with_robot(mut self, path: &Path) -> anyhow::Result<Self> {
        let name = path.display().to_string();
        let read = floorguard_configuration::load(path)?;
        let example = parse("robot.toml", EXAMPLE)?;
        if let Some(why) = unplayable(&read.robot, &example.robot) {
            anyhow::bail!("{name}: {why}");
        }
        self.robot_toml = std::fs::read_to_string(path)?;
        let (route, mut route_limits) = (self.robot.route, self.robot.route_limits);
        let limits = read.robot.limits;
        route_limits.speed_mps = route_limits.speed_mps.min(limits.speed_mps);
        route_limits.turn_radps = route_limits.turn_radps.min(limits.turn_radps);
        let navigation = read.navigation.unwrap_or_else(|| NavigationConfiguration::of_limits(&limits));
        self.navigation_settings = (&navigation).into();
        self.actuated_lidar = read.carriers.actuated_lidar;
        self.robot = RobotConfiguration { route, route_limits, ..read.robot };
        if let Some(learning) = &read.learning {
            let folder = path.parent().unwrap_or(Path::new("."));
            let mut say = |what: &str| say!("  {what}");
            let learning = LearningSetup::open(learning, folder, &mut say);
            self.learning = learning.map_err(|error| anyhow::anyhow!("{name}: {error:#}"))?;
        }
        Ok(self)
    }

    /// With dirt on the floor and a robot that cleans it. By default: the guarantee where the scenario has dirt,
    /// otherwise the route and no mission.
    ///
    /// # Errors
    /// The scene makes no map.
    pub fn cleaning(mut self, strategy: Option<MissionStrategy>) -> Result<Self, PlanError> {
        if strategy.is_none() && self.dirt.is_none() {
            return Ok(self);
        }
        self.scenario.dirt = self.dirt.take();
        let strategy = strategy.unwrap_or(MissionStrategy::Guarantee);
        let mission = plan_of_scenario(&self.scenario, strategy, self.seed);
        self.mission = Some(mission.map_err(PlanError::Mission)?);
        Ok(self)
    }

    /// With a goal instead of the route, on the map that a survey would draw of the scene; no dirt lies there.
    ///
    /// # Errors
    /// The scene makes no map.
    pub fn navigating(mut self, goal_in_map: Pose2) -> Result<Self, PlanError> {
        let drive = (self.navigation_settings, goal_in_map);
        let navigation =
            navigation_of_scenario(&self.scenario, drive, self.seed).map_err(PlanError::Mission)?;
        self.navigation = Some(navigation);
        Ok(self)
    }

    /// With places to look from, one after another, instead of the route.
    ///
    /// # Errors
    /// No place is given, or the scene makes no map.
    pub fn touring(self, places_in_map: &[Pose2]) -> anyhow::Result<Self> {
        let [first, rest @ ..] = places_in_map else { anyhow::bail!("a tour needs a place") };
        let mut plan = self.navigating(*first)?;
        plan.navigation = plan.navigation.map(|drive| drive.touring(rest));
        Ok(plan)
    }

    /// With a goal instead of the route, and back to where the robot began, which it is to meet exactly.
    ///
    /// # Errors
    /// The scene makes no map.
    pub fn docking(self, goal_in_map: Pose2) -> Result<Self, PlanError> {
        let mut plan = self.navigating(goal_in_map)?;
        plan.navigation = plan.navigation.map(NavigationPlan::docking);
        Ok(plan)
    }

    /// Driving where somebody outside orders, from its start on.
    ///
    /// # Errors
    /// The scene makes no map.
    pub fn ordered(self) -> Result<Self, PlanError> {
        let start = self.scenario.start_pose();
        Ok(Self { drive_orders: Some(DriveOrders::default()), ..self.navigating(start)? })
    }

    /// Cleaning what somebody outside orders: what is expected to be dirty where the scenario has dirt, and lanes elsewhere.
    ///
    /// # Errors
    /// The scene makes no map.
    pub fn cleaning_on_order(self) -> Result<Self, PlanError> {
        let has_dirt = self.dirt.is_some();
        let strategy = if has_dirt { MissionStrategy::Guarantee } else { MissionStrategy::Systematic };
        Ok(Self { cleaning_orders: Some(CleaningOrders::default()), ..self.cleaning(Some(strategy))? })
    }

    /// With an empty map of this side around the start, metres, that the robot is to complete; no dirt lies there.
    ///
    /// # Errors
    /// The side makes no map.
    pub fn exploring(mut self, side_m: f32) -> Result<Self, PlanError> {
        let start = self.scenario.start_pose();
        let plan = NavigationPlan::exploring(self.navigation_settings, start, (side_m, self.seed));
        self.navigation = Some(plan.map_err(PlanError::Mission)?);
        Ok(self)
    }

    /// With another safety scanner in the same place.
    ///
    /// # Errors
    /// The example robot cannot carry it.
    pub fn with_scanner(mut self, model: ScannerModel) -> Result<Self, PlanError> {
        let fitted = match model {
            ScannerModel::S300 => return Ok(self),
            ScannerModel::MicroScan3 { beams } => {
                format!("model = \"microscan3\"\nsource = \"udp:0.0.0.0:6060\"\nbeams = {beams}\n")
            }
            ScannerModel::Ranging(RangingModel::Bridged(shape)) => {
                format!("{}accept_uncertified_mps = {ACCEPTED_MPS:?}\n", bridged_scanner_keys(&shape))
            }
            ScannerModel::Ranging(model) => format!(
                "model = \"{}\"\nsource = \"tcp:192.168.0.10:10940\"\naccept_uncertified_mps = {ACCEPTED_MPS:?}\n",
                model.key()
            ),
        };
        let lines = "model = \"s300\"\nsource = \"serial:/dev/ttyUSB0\"\nbaud = 500000\n";
        self.robot_toml = self.robot_toml.replace(lines, &fitted);
        let robot = parse("robot.toml", &self.robot_toml)?.robot;
        self.robot.scanner = robot.scanner;
        if let ScannerModel::Ranging(_) = model {
            // It is slower, and reacts later.
            (self.robot.unseen, self.robot.limits, self.robot.fields) =
                (robot.unseen, robot.limits, robot.fields);
        }
        Ok(self)
    }

    /// With another inertial sensor in the place of the MTi, on its line.
    ///
    /// # Errors
    /// The example robot cannot carry it.
    pub fn with_imu(mut self, model: ImuModel) -> Result<Self, PlanError> {
        if model == ImuModel::default() {
            return Ok(self);
        }
        let fitted = format!("[imu]\nmodel = \"{}\"\n", model.key());
        self.robot_toml = self.robot_toml.replace("[imu]\n", &fitted);
        self.robot.imu = parse("robot.toml", &self.robot_toml)?.robot.imu;
        Ok(self)
    }

    /// With another lidar in the place of the VLP-16: the keys of `[lidar]` that say which, such as `model = "pandar-xt16"`, with its
    /// mounting where that is another.
    ///
    /// # Errors
    /// The example robot cannot carry it.
    pub fn with_lidar(mut self, keys: &str) -> Result<Self, PlanError> {
        let fitted = format!("[lidar]\n{}\n", keys.trim_end());
        self.robot_toml = self.robot_toml.replace("[lidar]\nmodel = \"vlp16\"\n", &fitted);
        if keys.contains("mounting = ")
            && let Some((before, after)) = self.robot_toml.split_once(&fitted)
        {
            // The example's own mounting is the next line that has one.
            let (kept, rest) = after.split_once("mounting = ").unwrap_or((after, ""));
            let rest = rest.split_once('\n').map_or("", |(_, rest)| rest);
            self.robot_toml = format!("{before}{fitted}{kept}{rest}");
        }
        let robot = parse("robot.toml", &self.robot_toml)?.robot;
        self.robot.lidar = robot.lidar;
        if robot.lidar.model.later_s() > 0.0 {
            // It shows everything later, and the robot reacts later.
            (self.robot.unseen, self.robot.limits, self.robot.fields) =
                (robot.unseen, robot.limits, robot.fields);
        }
        Ok(self)
    }

    /// The simulator with this plan's robot in it.
    ///
    /// # Errors
    /// The scenario cannot be played.
    pub fn simulation(&self) -> Result<Simulation, ScenarioError> {
        let mut simulation = Simulation::with_robot(&self.scenario, self.seed, self.robot_parameters())?;
        simulation.coarse_lidar(self.lidar_grain);
        Ok(simulation)
    }

    /// The true robot.
    #[must_use]
    pub fn robot_parameters(&self) -> RobotParameters {
        true_robot(&self.robot)
    }

    /// Where the odometry frame lies in the world.
    #[must_use]
    pub fn odometry_in_world(&self) -> Pose2 {
        self.scenario.start_pose()
    }
}
