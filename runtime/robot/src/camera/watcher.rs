//! What a camera's pictures mean for the robot, picture by picture: floor and objects, people, dirt, and what to
//! log.

use floorguard_guard::FloorSight;
use floorguard_perception::people::PeopleView;
use floorguard_runtime::configuration::RobotConfiguration;
use floorguard_types::geometry::Pose2;
use floorguard_types::sensing::ImageSize;
use floorguard_types::time::{Age, Stamp};

use super::dirt_stage::{DirtStage, SeenDirt};
use super::floor_stage::FloorStage;
use super::frame_source::{ColourPicture, FrameEvent, FrameSource};
use super::log_throttle::LogThrottle;
use super::pairing::{Pair, Pairing};
use super::people::DepthPeopleStage;
use floorguard_configuration::CameraConfiguration;

/// Unpaired colour pictures in a row that are reported.
const ALONE_MAX: u32 = 30;

/// People get a picture this often, microseconds.
const SHOWN_EVERY_US: u64 = 1_000_000;

/// The memory of one camera.
pub struct Watcher {
    floor: FloorStage,
    people: DepthPeopleStage,
    /// None without a colour camera.
    dirt: Option<DirtStage>,
    pairing: Pairing,
    throttle: [LogThrottle; 2],
    size: ImageSize,
    shown: Option<Stamp>,
}

/// The result of one poll of the streams.
#[derive(Default)]
pub struct Attended {
    /// To be published, if there is something new.
    pub sight: Option<FloorSight>,
    /// For the list of people.
    pub people: Option<PeopleView>,
    /// For people, about once a second.
    pub picture: Option<ColourPicture>,
    /// For the console.
    pub words: Vec<String>,
}

impl Watcher {
    /// For a camera on a robot; `None` for a mounting that makes no plane.
    #[must_use]
    pub fn new(robot: &RobotConfiguration, camera: &CameraConfiguration, has_colour: bool) -> Option<Self> {
        let dirt = if has_colour { Some(DirtStage::new(camera.size, camera.camera)?) } else { None };
        Some(Self {
            floor: FloorStage::new(robot, camera)?,
            people: DepthPeopleStage::new(camera),
            dirt,
            pairing: Pairing::default(),
            throttle: Default::default(),
            size: camera.size,
            shown: None,
        })
    }

    /// What is reported while no picture is usable.
    #[must_use]
    pub fn blind(&self, stamp: Stamp) -> FloorSight {
        self.floor.blind(stamp)
    }

    /// The map of dirt so far, with a colour camera.
    #[must_use]
    pub fn seen(&self, now: Stamp) -> Option<SeenDirt> {
        self.dirt.as_ref().map(|dirt| dirt.seen(now))
    }

    /// Takes what both streams have; the robot's pose is its odometry's. `clock` is asked after each picture came.
    pub fn attend(
        &mut self,
        source: &mut impl FrameSource,
        robot: Pose2,
        clock: impl Fn() -> Stamp,
    ) -> Attended {
        let mut attended = Attended::default();
        self.attend_depth(source, robot, &clock, &mut attended);
        if self.dirt.is_some() {
            self.attend_colour(source, &clock, &mut attended);
        }
        attended
    }

    fn attend_depth(
        &mut self,
        source: &mut impl FrameSource,
        robot: Pose2,
        clock: &impl Fn() -> Stamp,
        attended: &mut Attended,
    ) {
        let event = source.depth(clock());
        let now = clock();
        let why = match event {
            FrameEvent::Nothing => return,
            FrameEvent::Picture(stamp, depth_mm) => {
                let robot = source.pose().unwrap_or(robot);
                attended.sight = Some(self.floor.process(&depth_mm, robot, (stamp, now)));
                let plane = self.floor.plane();
                attended.people =
                    plane.and_then(|plane| self.people.process(&depth_mm, (plane, robot), stamp));
                let pair = self.pairing.depth(stamp, robot);
                self.judge(pair, now, attended);
                self.floor.why_blind().map(str::to_owned)
            }
            FrameEvent::Damaged(problem) => {
                attended.sight = Some(self.floor.lost(now));
                Some(problem.to_string())
            }
            FrameEvent::Silent(why) => {
                attended.sight = Some(self.floor.lost(now));
                Some(why)
            }
        };
        let [throttle, _] = &mut self.throttle;
        match why {
            Some(why) if throttle.trouble(&why, now) => {
                attended.words.push(format!("depth: {why}; the floor is unknown"));
            }
            None if throttle.well(now) => attended.words.push("depth: the floor is known again".to_owned()),
            _ => {}
        }
    }

    fn attend_colour(
        &mut self,
        source: &mut impl FrameSource,
        clock: &impl Fn() -> Stamp,
        attended: &mut Attended,
    ) {
        let event = source.colour(clock());
        let now = clock();
        match event {
            FrameEvent::Nothing => {}
            FrameEvent::Picture(stamp, rgb) => {
                attended.picture = self.show(&rgb, now);
                let pair = self.pairing.colour(stamp, rgb);
                self.judge(pair, now, attended);
                if self.pairing.alone >= ALONE_MAX {
                    self.pairing.alone = 0;
                    self.blind_to_dirt("no depth picture was taken at the same time", now, attended);
                }
            }
            FrameEvent::Damaged(problem) => self.blind_to_dirt(&problem.to_string(), now, attended),
            FrameEvent::Silent(why) => self.blind_to_dirt(&why, now, attended),
        }
    }

    /// A copy for people, when the last is old enough.
    fn show(&mut self, rgb: &[u8], now: Stamp) -> Option<ColourPicture> {
        let is_new = |shown: &Stamp| !matches!(shown.age(now), Age::Past(age_us) if age_us >= SHOWN_EVERY_US);
        if self.shown.as_ref().is_some_and(is_new) {
            return None;
        }
        self.shown = Some(now);
        Some(ColourPicture { rgb: rgb.to_vec(), size: self.size })
    }

    /// A colour picture with its depth picture: dirt.
    fn judge(&mut self, pair: Option<Pair>, now: Stamp, attended: &mut Attended) {
        let (Some(dirt), Some(pair)) = (&mut self.dirt, pair) else { return };
        self.pairing.alone = 0;
        let outcome = dirt.process(&pair.rgb, &self.floor, pair.robot, (pair.stamp, now));
        let [_, throttle] = &mut self.throttle;
        match outcome {
            Ok(_) if throttle.well(now) => attended.words.push("colour: dirt is seen again".to_owned()),
            Ok(_) => {}
            Err(why) => self.report_blind(&why.to_string(), now, attended),
        }
    }

    /// Nothing came that can be judged.
    fn blind_to_dirt(&mut self, why: &str, now: Stamp, attended: &mut Attended) {
        if let Some(dirt) = &mut self.dirt {
            dirt.miss();
        }
        self.report_blind(why, now, attended);
    }

    fn report_blind(&mut self, why: &str, now: Stamp, attended: &mut Attended) {
        let [_, throttle] = &mut self.throttle;
        if throttle.trouble(why, now) {
            attended.words.push(format!("colour: {why}; what lies here is unknown, not clean"));
        }
    }
}

#[cfg(test)]
#[path = "watcher_tests.rs"]
mod tests;
