//! People in the picture: their surfaces are erased and masked, and two sweeps show where they walk.

use std::fmt::Write as _;
use std::path::Path;

use floorguard_mapping::sliding_window::{
    CellContent, CellPolicy, Face, MovementArrow, MovementArrows, PersonBox, PersonBoxes, Plan, PlanCell,
    SightLimits, WindowPoint,
};
use floorguard_types::geometry::Point2;
use floorguard_types::time::Stamp;

use super::picture::{draw, face_squares};
use super::rig::{Rig, Stand, Sweep};
use super::scene::{Scene, Solid, Walker};
use super::{Window, window};

/// Height of the camera, metres.
const CAMERA: f64 = 0.70;
/// A surface so near to the body is the body's: a cell and three deviations of the lidar, metres.
const BODY_REACH: f64 = 0.15;
/// A sweep over the middle of the window.
const SWEEP: Sweep = Sweep { half: 0.5, middle: 0.0, speed: 0.5 };

/// The box of a body in a picture from the origin.
fn box_of(place: [f64; 2]) -> PersonBox {
    let distance = place[0].hypot(place[1]);
    let (middle, half) = (place[1].atan2(place[0]), (Walker::RADIUS / distance).asin());
    // Feet are seen at the near side of the body, the head too: it is higher than the camera.
    let near = distance - Walker::RADIUS;
    PersonBox {
        azimuth_min_rad: (middle - half) as f32,
        azimuth_max_rad: (middle + half) as f32,
        elevation_min_rad: (-CAMERA).atan2(near) as f32 - 0.02,
        elevation_max_rad: (Walker::HEIGHT - CAMERA).atan2(near) as f32 + 0.02,
    }
}

/// Takes one scan, and the picture of its time if there is one.
fn step(window: &mut Window, rig: &mut Rig, (scene, has_boxes): (&Scene, bool)) -> anyhow::Result<Stamp> {
    let begin = rig.seconds();
    if has_boxes {
        let boxes: Vec<PersonBox> = scene.walkers.iter().map(|walker| box_of(walker.at(begin))).collect();
        let stamp = Stamp::from_micros((begin * 1e6).round() as u64 + 1);
        let base_in_odometry = Stand::default().pose();
        window.take_people(&PersonBoxes { stamp, base_in_odometry, boxes: &boxes }, stamp)?;
    }
    let scan = rig.scan(scene, |_| Stand::default());
    let beams = scan.beams.to_vec();
    let scan = floorguard_mapping::sliding_window::ColumnScan { beams: &beams, ..scan };
    window.insert(&scan, &rig.motor, Stand::default().pose())?;
    Ok(rig.now())
}

/// A person who stands before a wall, and leaves.
#[derive(Clone, Debug)]
pub struct Erasure {
    /// Surfaces of the body in the window before there is a box.
    pub before: usize,
    /// With boxes.
    pub masked: usize,
    /// Places of people with boxes.
    pub marks: usize,
    /// The plan's cell of the person is blocked by them while they stand, and free two seconds and a sweep after they left.
    pub blocked_then_free: [bool; 2],
    /// Share of the wall behind them that the window shows again.
    pub wall_back: f64,
    pictures: Vec<Vec<WindowPoint>>,
}

fn of_body(points: &[WindowPoint], place: [f64; 2], content: CellContent) -> usize {
    let body = Solid::Cylinder { middle: place, radius: Walker::RADIUS, heights: [0.1, Walker::HEIGHT] };
    let is_near = |one: &&WindowPoint| {
        let point = [one.point.x_m, one.point.y_m, one.point.z_m].map(f64::from);
        one.content == content && point[2] > 0.1 && body.distance(point) <= BODY_REACH
    };
    points.iter().filter(is_near).count()
}

/// Share of the columns behind the body in which the wall is seen.
fn wall_share(points: &[WindowPoint]) -> f64 {
    let seen = (-5..=5).filter(|column| {
        points.iter().any(|one| {
            let aside = (f64::from(one.point.y_m) - 0.05 * f64::from(*column)).abs() < 0.05;
            aside && (one.point.x_m - 3.0).abs() < 0.15 && one.content == CellContent::Surface
        })
    });
    seen.count() as f64 / 11.0
}

/// A person stands 1.5 m ahead, a wall is at 3 m. Without `has_boxes` the window never hears of them: what the judge must
/// refuse.
///
/// # Errors
/// A scan or boxes that the window refuses: none in practice.
pub fn erasure(has_boxes: bool) -> anyhow::Result<Erasure> {
    let place = [1.5, 0.0];
    let wall = Solid::wall([3.0, -2.5], [3.1, 2.5]);
    let person = Walker { start: place, velocity: [0.0; 2] };
    let with = Scene { solids: vec![wall], walkers: vec![person] };
    let without = Scene { solids: vec![wall], walkers: Vec::new() };
    let (mut window, mut rig) = (window(0.05, CellPolicy::Nearest)?, Rig::new(SWEEP, 70));
    let storage = vec![PlanCell::UNKNOWN; 50 * 50];
    let mut plan = Plan::square(50, Point2::default(), storage).expect("a plan of 10 m")?;
    let limits = SightLimits::of_threshold(1.0);
    let mut pictures = Vec::new();
    let mut blocked = Vec::new();
    // Two sweeps without boxes, three with, and two after the person has left.
    for (scene, ends, boxes) in [(&with, 2, false), (&with, 5, has_boxes), (&without, 8, has_boxes)] {
        let mut now = rig.now();
        while rig.sweep.number(rig.seconds()) < ends {
            now = step(&mut window, &mut rig, (scene, boxes))?;
        }
        if ends > 2 {
            let all = floorguard_mapping::sliding_window::SweptWedge::ALL;
            plan.enter((&window, window.frame_in_odometry()), all, (&limits, now));
            let cell = plan.grid().geometry().cell_at(Point2::new(1.35, 0.01)).expect("a cell");
            let cell = plan.grid().values()[cell];
            let is_obstacle = cell.floor_m().is_some_and(|height| height > 0.05);
            blocked.push((cell.is_person(now), is_obstacle));
        }
        pictures.push(window.points().collect::<Vec<_>>());
    }
    let person_then_free = [blocked[0] == (true, false), blocked[1] == (false, false)];
    Ok(Erasure {
        before: of_body(&pictures[0], place, CellContent::Surface),
        masked: of_body(&pictures[1], place, CellContent::Surface),
        marks: of_body(&pictures[1], place, CellContent::Person),
        blocked_then_free: person_then_free,
        wall_back: wall_share(&pictures[2]),
        pictures,
    })
}

impl Erasure {
    /// The body is in the window without boxes and not with them; its place is blocked and then free; the wall is back.
    #[must_use]
    pub fn holds(&self) -> bool {
        self.before >= 50
            && self.masked == 0
            && self.marks >= 50
            && self.blocked_then_free == [true; 2]
            && self.wall_back >= 0.9
    }

    /// What was found.
    #[must_use]
    pub fn text(&self) -> String {
        format!(
            "Erasure: a person 1.5 m ahead, a wall at 3 m.\n\
             surfaces of the body without boxes {}, with boxes {}, places of people {}; place blocked while they stand: {}, \
             free after they left: {}; wall seen again: {:.0} %\n",
            self.before,
            self.masked,
            self.marks,
            self.blocked_then_free[0],
            self.blocked_then_free[1],
            100.0 * self.wall_back,
        )
    }

    /// The grid ahead without boxes, with them, and after the person has left.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn draw(&self, folder: &Path) -> anyhow::Result<()> {
        let names = ["without_boxes", "with_boxes", "after"];
        for (points, name) in self.pictures.iter().zip(names) {
            let title = format!("a person before a wall, {}: places of people red", name.replace('_', " "));
            let path = folder.join(format!("erasure_{name}.svg"));
            draw(&path, &title, &face_squares(points, Face::Front, 0.05), &[])?;
        }
        Ok(())
    }
}

/// Walkers and their arrows.
#[derive(Clone, Debug)]
pub struct Arrows {
    walks: Vec<Walk>,
}

#[derive(Clone, Debug)]
struct Walk {
    name: &'static str,
    velocity: [f64; 2],
    arrows: Vec<MovementArrow>,
}

/// Walks within the sweep: from where, how fast.
const WALKS: [(&str, [f64; 2], [f64; 2]); 4] = [
    ("to the left", [2.0, -0.8], [0.0, 0.4]),
    ("to the right", [2.0, 0.8], [0.0, -0.4]),
    ("nearer", [3.4, 0.1], [-0.5, 0.0]),
    ("stands", [2.0, 0.2], [0.0, 0.0]),
];
/// A quick sweep over the middle of the window, 1.2 s from end to end.
const QUICK: Sweep = Sweep { half: 0.45, middle: 0.0, speed: 0.75 };
/// Errors of the mean velocity and of one arrow, m/s.
const MEAN_MAX: f64 = 0.15;
const SINGLE_MAX: f64 = 0.35;

/// Follows each walker for four seconds.
///
/// # Errors
/// A scan or boxes that the window refuses: none in practice.
pub fn arrows() -> anyhow::Result<Arrows> {
    let wall = Solid::wall([3.6, -2.5], [3.7, 2.5]);
    let mut walks = Vec::new();
    for (name, start, velocity) in WALKS {
        let scene = Scene { solids: vec![wall], walkers: vec![Walker { start, velocity }] };
        let (mut window, mut rig) = (window(0.05, CellPolicy::Nearest)?, Rig::new(QUICK, 30));
        let (mut found, mut arrows) = (Vec::new(), MovementArrows::new());
        let mut sweep = 0;
        while rig.seconds() < 4.0 {
            let now = step(&mut window, &mut rig, (&scene, true))?;
            let returns: Vec<Point2> = window.person_returns().collect();
            for place in &returns {
                arrows.take(*place, now);
            }
            if rig.sweep.number(rig.seconds()) > sweep {
                sweep = rig.sweep.number(rig.seconds());
                arrows.end_sweep();
                found.extend_from_slice(arrows.arrows());
            }
        }
        walks.push(Walk { name, velocity, arrows: found });
    }
    Ok(Arrows { walks })
}

impl Walk {
    fn error(&self, velocity: [f64; 2]) -> f64 {
        (velocity[0] - self.velocity[0]).hypot(velocity[1] - self.velocity[1])
    }

    fn mean(&self) -> [f64; 2] {
        let mean = |of: fn(&MovementArrow) -> f32| {
            self.arrows.iter().map(|arrow| f64::from(of(arrow))).sum::<f64>() / self.arrows.len() as f64
        };
        [mean(|arrow| arrow.velocity_x_mps), mean(|arrow| arrow.velocity_y_mps)]
    }

    fn worst(&self) -> f64 {
        let velocity =
            |arrow: &MovementArrow| [f64::from(arrow.velocity_x_mps), f64::from(arrow.velocity_y_mps)];
        self.arrows.iter().map(|arrow| self.error(velocity(arrow))).fold(0.0, f64::max)
    }

    fn holds(&self) -> bool {
        self.arrows.len() >= 2 && self.error(self.mean()) <= MEAN_MAX && self.worst() <= SINGLE_MAX
    }
}

impl Arrows {
    /// Every walker has arrows, and they point where they walk.
    #[must_use]
    pub fn holds(&self) -> bool {
        self.walks.len() == WALKS.len() && self.walks.iter().all(Walk::holds)
    }

    /// A line a walker.
    #[must_use]
    pub fn text(&self) -> String {
        let mut text = format!(
            "Arrows: walkers for four seconds, at most {MEAN_MAX} m/s off in the mean and {SINGLE_MAX} m/s at worst.\n\
             walk           true m/s        mean of the arrows   arrows   worst error\n"
        );
        for walk in &self.walks {
            let [x, y] = walk.mean();
            let _infallible = writeln!(
                text,
                "{:<12} {:>5.2} {:>5.2}   {x:>14.2} {y:>5.2} {:>8} {:>13.2}",
                walk.name,
                walk.velocity[0],
                walk.velocity[1],
                walk.arrows.len(),
                walk.worst(),
            );
        }
        text
    }

    /// The arrows from above, a second long.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn draw(&self, folder: &Path) -> anyhow::Result<()> {
        for walk in &self.walks {
            let line: Vec<(f64, f64)> = walk
                .arrows
                .iter()
                .flat_map(|arrow| {
                    let (x, y) = (
                        f64::from(arrow.position_in_odometry.x_m),
                        f64::from(arrow.position_in_odometry.y_m),
                    );
                    let tip = (x + f64::from(arrow.velocity_x_mps), y + f64::from(arrow.velocity_y_mps));
                    [(x, y), tip, (x, y)]
                })
                .collect();
            let body = |arrow: &MovementArrow| super::picture::Square {
                x: f64::from(arrow.position_in_odometry.x_m),
                y: f64::from(arrow.position_in_odometry.y_m),
                edge: 0.1,
                colour: plotters::style::RGBColor(220, 40, 60),
            };
            let robot = super::picture::Square {
                x: 0.0,
                y: 0.0,
                edge: 0.3,
                colour: plotters::style::RGBColor(90, 90, 90),
            };
            let squares: Vec<_> = walk.arrows.iter().map(body).chain([robot]).collect();
            let path = folder.join(format!("arrow_{}.svg", walk.name.replace(' ', "_")));
            draw(&path, &format!("a person {}, seen from above", walk.name), &squares, &line)?;
        }
        Ok(())
    }
}
