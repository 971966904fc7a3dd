//! One mission from start to end, and what it came to.

mod judge;

use floorguard_cleaning::{Brush, CleanRule};
use floorguard_mapping::poisson_tail;
use floorguard_mapping::{DirtCell, Grid};
use floorguard_sim::robot::BrushDeck;
use floorguard_types::geometry::{Point2, Twist2};
use floorguard_types::random::Pcg32;

use super::config::{MissionConfig, Strategy};
use super::faults::Faults;
use super::memory::{Memory, about};
use super::navigator::{NavigationRequest, Navigator};
use super::outcome::TrialResult;
use super::people::Crowd;
use super::promise::Promise;
use super::truth::Truth;
use floorguard_host::executor::StopFlag;
use floorguard_robot::site::Floor;
use floorguard_robot::site::Localiser;

/// Control period, s.
const PERIOD_S: f32 = 0.1;
/// A memory is kept this often, s: the robot goes 0.1 m meanwhile, which is within the doubt of a restart.
const MEMORY_S: f32 = 1.0;
/// A mission that takes longer is broken off, s: a shift.
const TIME_LIMIT_S: f32 = 8.0 * 3_600.0;

/// Runs one mission on dirt of which the robot knows what is to be expected. The seed decides everything but the times
/// of the computer.
pub fn run(
    floor: &Floor,
    config: &MissionConfig,
    expected: &[f32],
    seed: u64,
) -> anyhow::Result<TrialResult> {
    run_believing(floor, config, (expected, expected), seed)
}

/// As [`run`], with dirt of which `expected` units lie in each cell while the robot believes in `believed`.
pub fn run_believing(
    floor: &Floor,
    config: &MissionConfig,
    dirt: (&[f32], &[f32]),
    seed: u64,
) -> anyhow::Result<TrialResult> {
    run_keeping(floor, config, dirt, (seed, MissionStorage::default()))
}

/// Takes the memory of a mission and keeps it.
pub type MemoryWriter<'a> = dyn FnMut(&Memory) -> anyhow::Result<()> + 'a;

/// What becomes of the memory of a mission.
#[derive(Default)]
pub struct MissionStorage<'a> {
    /// The memory with which the mission goes on. The simulated world, which has no memory of its own, is driven up to
    /// the same moment first; the robot then knows what it remembers and nothing else.
    pub from: Option<&'a Memory>,
    /// Called with the memory about once a second of the mission.
    pub keep: Option<&'a mut MemoryWriter<'a>>,
    /// Set by somebody who wants the mission to be broken off.
    pub ended: Option<&'a StopFlag>,
}

/// Somebody has broken off the mission.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("broken off")]
pub struct Interrupted;

/// As [`run_believing`], for a mission that outlives a power cut.
///
/// # Errors
/// A memory of another mission, or one that cannot be kept; [`Interrupted`].
pub fn run_keeping(
    floor: &Floor,
    config: &MissionConfig,
    (expected, believed): (&[f32], &[f32]),
    (seed, storage): (u64, MissionStorage<'_>),
) -> anyhow::Result<TrialResult> {
    let stream = |number| Pcg32::new(seed, number);
    let tolerated = u32::from(config.tolerated_units);
    let cells: Vec<DirtCell> = believed
        .iter()
        .map(|&units| DirtCell::poisson(units, poisson_tail(tolerated, f64::from(units)) as f32))
        .collect();
    let once = CleanRule::per_cell(config.tolerated_units, config.delta);
    let mut dirty: Vec<bool> = cells.iter().map(|cell| once.needs_cleaning(cell)).collect();
    let believed_dirty = (0..dirty.len()).filter(|&i| dirty[i] && floor.reachable[i]).collect();
    // Judged are also the cells that are dirtier than the robot believes.
    for (dirty, &units) in dirty.iter_mut().zip(expected) {
        let tail = poisson_tail(tolerated, f64::from(units)) as f32;
        *dirty |= once.needs_cleaning(&DirtCell::poisson(units, tail));
    }
    let mut mission = Mission {
        floor,
        config,
        promise: Promise::new(config, believed_dirty),
        truth: Truth::new(floor, expected, config.true_pickup, stream(1)),
        localiser: Localiser::new(floor, config.belief(), Grid::new(floor.cells, cells)?, stream(2)),
        navigator: Navigator::new(
            floor,
            config.strategy,
            (config.robot.follow, config.robot.brush.width_m),
            stream(3),
        ),
        faults: Faults::new(config.faults, stream(4)),
        crowd: Crowd::new(floor, config.people, stream(5)),
        seed,
        about: about(identity(floor, config, (expected, believed), seed)),
        memory: None,
        remembers: false,
        next_memory_s: 0.0,
        cuts_s: Vec::new(),
        result: TrialResult::default(),
    };
    mission.drive_to_the_end(storage)?;
    Ok(mission.judge(&dirty))
}

/// What makes a mission this one and no other.
fn identity<'a>(
    floor: &'a Floor,
    config: &MissionConfig,
    (expected, believed): (&'a [f32], &'a [f32]),
    seed: u64,
) -> impl Iterator<Item = u32> + use<'a> {
    let settings = format!("{config:?}").into_bytes();
    let cells = (floor.cells.width(), floor.cells.height());
    [seed as u32, (seed >> 32) as u32, u32::from(cells.0), u32::from(cells.1)]
        .into_iter()
        .chain(settings.into_iter().map(u32::from))
        .chain(expected.iter().chain(believed).map(|units| units.to_bits()))
        .chain(floor.reachable.iter().map(|&reachable| u32::from(reachable)))
}

struct Mission<'a> {
    floor: &'a Floor,
    config: &'a MissionConfig,
    promise: Promise,
    truth: Truth,
    localiser: Localiser,
    navigator: Navigator,
    faults: Faults,
    crowd: Crowd,
    seed: u64,
    about: u32,
    /// What would be left after a power cut.
    memory: Option<Memory>,
    remembers: bool,
    next_memory_s: f32,
    cuts_s: Vec<f32>,
    result: TrialResult,
}

impl Mission<'_> {
    fn drive_to_the_end(&mut self, mut storage: MissionStorage<'_>) -> anyhow::Result<()> {
        self.remembers = self.config.faults.resets > 0.0 || storage.from.is_some() || storage.keep.is_some();
        if let Some(memory) = storage.from {
            anyhow::ensure!(memory.about == self.about, "the memory is that of another mission");
            for &cut_s in &memory.cuts_s {
                self.drive_until(cut_s);
                let then = self.remember();
                self.go_on(&then);
            }
            self.drive_until(memory.time_s);
            self.go_on(memory);
        }
        while self.truth.time_s < TIME_LIMIT_S {
            if self.config.distance_limit_m.is_some_and(|limit| self.truth.distance_m >= limit) {
                break;
            }
            if self.remember_if_due()
                && let (Some(keep), Some(memory)) = (&mut storage.keep, &self.memory)
            {
                keep(memory)?;
            }
            if storage.ended.is_some_and(StopFlag::is_stopped) {
                return Err(Interrupted.into());
            }
            if !self.step() {
                self.result.is_complete = true;
                break;
            }
        }
        Ok(())
    }

    /// What the world was until a power cut: the same steps again.
    fn drive_until(&mut self, time_s: f32) {
        while self.truth.time_s < time_s {
            self.remember_if_due();
            if !self.step() {
                break;
            }
        }
    }

    /// Goes on after a power cut that came to all of the robot.
    fn go_on(&mut self, memory: &Memory) {
        self.restart(memory);
        self.cuts_s.push(memory.time_s);
        self.next_memory_s = self.truth.time_s;
    }

    fn remember_if_due(&mut self) -> bool {
        let is_due = self.remembers && self.truth.time_s >= self.next_memory_s;
        if is_due {
            self.next_memory_s = self.truth.time_s + MEMORY_S;
            self.memory = Some(self.remember());
        }
        is_due
    }

    fn remember(&mut self) -> Memory {
        let visits = self.navigator.visits().iter().enumerate();
        Memory {
            about: self.about,
            time_s: self.truth.time_s,
            pose_in_map: self.localiser.pose(self.truth.odometry),
            lanes_left: self.navigator.lanes_left() as u32,
            cuts_s: self.cuts_s.clone(),
            cells: self.localiser.remembered(),
            visits: visits.filter(|v| *v.1 > 0).map(|(cell, &count)| (cell as u32, count)).collect(),
        }
    }

    /// Power comes back: the robot knows what the memory says.
    fn restart(&mut self, memory: &Memory) {
        self.localiser.restore((&memory.cells, memory.pose_in_map), self.truth.odometry);
        let robot = &self.config.robot;
        let mut navigator = Navigator::new(
            self.floor,
            self.config.strategy,
            (robot.follow, robot.brush.width_m),
            Pcg32::new(self.seed, 3),
        );
        navigator.resume((memory.lanes_left as usize, &memory.visits), &self.navigator);
        self.navigator = navigator;
    }

    /// One control period; `false` at the end of the mission.
    fn step(&mut self) -> bool {
        let fault = self.faults.step(PERIOD_S);
        if fault.resets
            && let Some(memory) = self.memory.take()
        {
            self.restart(&memory);
            self.memory = Some(memory);
        }
        if fault.jumps {
            self.truth.displace(self.floor, 0.1, 0.1);
        }
        // Driving at random needs no map: its bumper feels where the walls really are.
        let pose = match self.config.strategy {
            Strategy::Random => self.truth.pose,
            _ => self.localiser.pose(self.truth.odometry),
        };
        let twist = match self.navigator.next_request(
            (self.floor, &mut self.localiser, &self.promise),
            (pose, self.truth.time_s),
            PERIOD_S,
        ) {
            NavigationRequest::Drive(twist) => self.permitted(twist),
            NavigationRequest::Done => return false,
        };
        self.truth.grip = fault.grip;
        let Brush { width_m, offset_m } = self.config.robot.brush;
        let brush = Some(BrushDeck { width_m, offset_m });
        let (hits, bumped) = self.truth.drive(self.floor, twist, PERIOD_S, brush);
        if self.config.people > 0 {
            self.crowd.step(self.floor, self.truth.pose, PERIOD_S);
            self.crowd.judge(self.floor, self.truth.pose, twist != Twist2::ZERO);
        }
        if bumped {
            self.result.bumps += 1;
            self.navigator.bumped(pose);
        }
        if hits > 0 {
            self.result.hits.push((Point2::new(pose.x_m, pose.y_m), hits));
        }
        self.localiser.collect(hits, fault.is_silent);
        if self.localiser.is_due(self.truth.odometry) {
            self.update();
        }
        true
    }

    /// Yields to people: stands still while somebody is near.
    fn permitted(&mut self, wanted: Twist2) -> Twist2 {
        if self.config.people > 0 && self.crowd.is_robot_to_wait(self.floor, self.truth.pose) {
            self.result.waited_s += PERIOD_S;
            self.navigator.waited(PERIOD_S);
            return Twist2::ZERO;
        }
        wanted
    }

    fn update(&mut self) {
        let people = self.crowd.places();
        let scan = self.truth.scan(self.floor, &self.config.robot.sensor, &people);
        self.localiser.update(self.floor, self.truth.odometry, &scan, self.config.uses_dirt_sensor);
        let (best, pose) = (self.localiser.best(), self.truth.pose);
        let error = (best.x_m - pose.x_m).hypot(best.y_m - pose.y_m);
        self.result.errors.push((self.truth.time_s, error));
        self.result.path.push(Point2::new(pose.x_m, pose.y_m));
    }
}
