//! The whole published way in a simulated building: survey, people by a camera's boxes, removal, and a tour of revisits that is
//! driven until what people hid has been seen, at most three times.

use floorguard_mapping::people_removal::{PointVerdict, PositionMethod, RevisitRule, Sighting, revisits};
use floorguard_mapping_host::clean::{
    AreaCount, CleanConfig, Cleaner, PeopleInImages, PersonBoxes, RemovedAreas, Thinned, Track,
};
use floorguard_types::geometry::{Point3, Pose2};

use super::building::Building;
use super::camera::{camera, picture};
use super::chance::Chance;
use super::render::{Drive, Survey};
use super::score::Score;
use super::walkers::{Walker, people, standing};

/// Tours at most.
const ROUNDS: usize = 3;
/// Sweeps from one picture to the next.
const PICTURE_EVERY: usize = 2;
/// Half the duration of a sweep, seconds.
const MIDDLE_S: f32 = 0.05;
/// At each pose of the tour: five sweeps and a little more, seconds.
const DWELL_S: f32 = 0.6;
/// Between survey and tour, seconds.
const PAUSE_S: f32 = 20.0;
/// Cubes of the clouds, metres.
const CUBE_M: f32 = 0.03;
/// The floor of simulated buildings.
const FLOOR_M: f32 = 0.0;

/// What one round left.
#[derive(Clone, Copy, Debug)]
pub struct Round {
    /// Poses of the tour that was driven before; 0 for the survey.
    pub stops: usize,
    /// Floor below what was removed, and how much of it was seen.
    pub areas: AreaCount,
    /// By labels of all returns so far.
    pub score: Score,
    /// Of the static points of the cloud, cubes of 3 cm, those that the cleaned cloud holds, 0 to 1. A wall that a box took in one
    /// drive stays if another drive saw it.
    pub static_points_kept: f64,
    /// People that were seen in the newest drive.
    pub seen: usize,
}

/// A building and who is in it.
pub struct Revisited {
    building: Building,
    people: Vec<Walker>,
    drives: Vec<(Drive, Track)>,
    seed: u64,
}

/// Clouds of the last round.
pub struct RevisitClouds {
    /// What stays.
    pub kept: Vec<Point3>,
    /// What was removed.
    pub removed: Vec<Point3>,
    /// Kept points over floor that people had hidden.
    pub filled: Vec<Point3>,
}

impl Revisited {
    /// A random building; half of the people walk, the others stand through the survey and leave before or during the tours.
    #[must_use]
    pub fn new(seed: u64, rooms: usize, count: usize) -> Self {
        let mut chance = Chance(seed);
        let building = Building::random(&mut chance, rooms);
        let drive = Drive::new(&building.route(), 0.0);
        let end_s = drive.end_s();
        let walkers = count / 2;
        let mut all = people(&building, walkers, 4.0 * end_s, &mut chance);
        all.extend((walkers..count).map(|_| {
            let leaves_s = end_s + chance.between(0.2, 1.5) * PAUSE_S;
            standing(&building, leaves_s, &mut chance)
        }));
        let track = drive.track();
        Self { building, people: all, drives: vec![(drive, track)], seed }
    }

    /// A short stretch of corridor; a person stands in it all through the survey and leaves before the tour.
    #[must_use]
    pub fn short() -> Self {
        let building = Building::random(&mut Chance(1), 1);
        let drive = Drive::new(&[[1.0, 0.0], [2.2, 0.0]], 0.0);
        let leaves_s = drive.end_s() + 1.0;
        let person = Walker { course: vec![[-1.0, 4.6, 0.5], [leaves_s, 4.6, 0.5]], height_m: 1.75 };
        let track = drive.track();
        Self { building, people: vec![person], drives: vec![(drive, track)], seed: 9 }
    }

    /// A building that was surveyed so, and who was in it.
    #[must_use]
    pub(super) fn of(building: Building, people: Vec<Walker>, survey: Drive, seed: u64) -> Self {
        let track = survey.track();
        Self { building, people, drives: vec![(survey, track)], seed }
    }

    /// Surveys and drives the tours; ends earlier once nobody was seen in the newest drive.
    ///
    /// # Panics
    /// Never: the edge of the voxels is a valid one.
    pub fn run(&mut self) -> (Vec<Round>, RevisitClouds) {
        let [_, x, y, heading] = self.drives[0].0.last();
        let mut from = [x, y, heading];
        self.run_by(|_| true, &mut |tour, start_s| {
            let drive = corridor_tour(tour, from, start_s);
            let [_, x, y, heading] = drive.last();
            from = [x, y, heading];
            drive
        })
    }

    /// The same, where somebody else drives the tours: of the poses to look from and the time at which it begins becomes a drive.
    pub(super) fn run_by(
        &mut self,
        is_reachable: impl Fn(Pose2) -> bool,
        drive_tour: &mut dyn FnMut(&[Pose2], f32) -> Drive,
    ) -> (Vec<Round>, RevisitClouds) {
        let mut rounds = Vec::new();
        let mut stops = 0;
        loop {
            let (round, clouds, sightings) = self.cleaned(stops);
            let is_done = round.seen == 0 || rounds.len() == ROUNDS;
            rounds.push(round);
            if is_done {
                return (rounds, clouds);
            }
            let [time_s, x, y, heading] = self.drives[self.drives.len() - 1].0.last();
            let start = Pose2::new(x, y, heading);
            let tour = revisits(&sightings, start, RevisitRule::default(), &is_reachable);
            let drive = drive_tour(&tour, time_s + PAUSE_S);
            let track = drive.track();
            self.drives.push((drive, track));
            stops = tour.len();
        }
    }

    /// All drives so far, cleaned together; people that the newest of them saw.
    fn cleaned(&self, stops: usize) -> (Round, RevisitClouds, Vec<Sighting>) {
        let mut cleaner = Cleaner::new(&CleanConfig::vlp16()).expect("voxels of 0.1 m");
        let mut of_drives = Vec::new();
        for number in 0..self.drives.len() {
            of_drives.push(self.observe(number, &mut cleaner));
        }
        let (mut kept, mut removed) = (Thinned::new(CUBE_M), Thinned::new(CUBE_M));
        let (mut all_static, mut kept_static) = (Thinned::new(CUBE_M), Thinned::new(CUBE_M));
        let mut score = Score::default();
        for (number, (drive, track)) in self.drives.iter().enumerate() {
            // Who stood there in one drive may be gone in the next: boxes count for their own drive.
            let seen = of_drives[number].sightings().entries();
            let boxes = PersonBoxes::new(seen, &[], FLOOR_M, cleaner.space());
            let mut verdicts = Vec::new();
            self.survey(drive).for_each(self.seed + number as u64, |labelled| {
                let boxes = boxes.of_sweep(labelled.sweep.start_s + 0.5 * labelled.sweep.duration_s());
                let _ = cleaner.judge(&labelled.sweep, track, &mut verdicts);
                let points = cleaner.points_in_map().iter().zip(&verdicts).zip(&labelled.labels);
                for ((point, verdict), label) in points {
                    let is_removed = *verdict == PointVerdict::Moved || boxes.contains(*point);
                    score.enter(*label > 0, is_removed);
                    if is_removed {
                        removed.enter(*point)
                    } else {
                        kept.enter(*point)
                    }
                    if *label == 0 {
                        all_static.enter(*point);
                        if !is_removed {
                            kept_static.enter(*point);
                        }
                    }
                }
            });
        }
        let mut areas = RemovedAreas::new(removed.points().iter().copied(), FLOOR_M);
        areas.see(kept.points().iter().copied());
        let newest = of_drives.pop().map(|images| images.sightings().entries().to_vec()).unwrap_or_default();
        let clouds = RevisitClouds {
            filled: areas.filled_points(kept.points()),
            kept: kept.points().to_vec(),
            removed: removed.points().to_vec(),
        };
        let static_points_kept = kept_static.points().len() as f64 / all_static.points().len().max(1) as f64;
        (Round { stops, areas: areas.count(), score, static_points_kept, seen: newest.len() }, clouds, newest)
    }

    fn survey<'a>(&'a self, drive: &'a Drive) -> Survey<'a> {
        Survey { building: &self.building, people: &self.people, drive }
    }

    /// First pass of a drive, with its pictures.
    fn observe(&self, number: usize, cleaner: &mut Cleaner) -> PeopleInImages {
        let (drive, track) = &self.drives[number];
        let mut chance = Chance(self.seed ^ (number as u64 + 77));
        let times = drive.sweep_starts().step_by(PICTURE_EVERY).map(|start_s| start_s + MIDDLE_S);
        let scene = (&self.building, &self.people[..]);
        let pictures = times.map(|time_s| picture(scene, drive, time_s, &mut chance)).collect();
        let mut images = PeopleInImages::new(camera(), pictures, PositionMethod::DepthMode)
            .expect("pictures of one size, in order");
        self.survey(drive).for_each(self.seed + number as u64, |labelled| {
            cleaner.observe(&labelled.sweep, track);
            let middle_s = labelled.sweep.start_s + 0.5 * labelled.sweep.duration_s();
            images.enter(middle_s, cleaner.points_in_map(), track);
        });
        images
    }
}

/// By the corridor from stop to stop, as if there were no obstacles on it.
fn corridor_tour(tour: &[Pose2], from: [f32; 3], start_s: f32) -> Drive {
    let mut drive = Drive::begin(from, start_s);
    for stop in tour {
        let [_, x, y, _] = drive.last();
        if (stop.x_m - x).hypot(stop.y_m - y) > 0.3 {
            drive.go_to([x, 0.0]);
            drive.go_to([stop.x_m, 0.0]);
            drive.go_to([stop.x_m, stop.y_m]);
        }
        drive.face(stop.heading_rad);
        drive.wait(DWELL_S);
    }
    drive
}
