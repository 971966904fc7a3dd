//! What a cycle of the local planners costs, and the prediction of thirty people.

use floorguard_mapping::{GridGeometry, GridSides};
use floorguard_navigation::costmap::CostmapView;
use floorguard_navigation::local::{
    Dwa, DwaConfig, DwaScratch, LocalPlanner, LocalSituation, Mppi, MppiSample, StepCell,
};
use floorguard_navigation::prediction::{FLOW_HEADINGS, FlowCell, PeoplePredictor, PersonTrail, PlaceFlow};
use floorguard_types::geometry::{Point2, Pose2, Twist2};
use floorguard_types::motion::{AlwaysPermitted, Gear, MovingPerson, Waypoint};
use floorguard_types::random::Pcg32;

use super::navigation::{NavigationTime, fastest_ms};
use crate::barn::{jackal, mppi};

/// Cells of the local costmap: 4 m × 4 m at 5 cm.
const SIDE: u16 = 80;
/// Cycles of a round: the clock of the thread counts in ticks of some milliseconds.
const CYCLES: u32 = 400;
/// Predictions of everybody in a round.
const PREDICTIONS: u32 = 20_000;

pub(super) fn local_planners() -> Vec<NavigationTime> {
    vec![dwa(), ours(&[]), ours(&people()), predictions()]
}

/// A floor with something on both sides of the path.
fn costs() -> Vec<u8> {
    let side = i32::from(SIDE);
    let cost = |cell: i32| {
        let (x, y) = ((cell % side - side / 2) as f32 * 0.05, (cell / side - side / 2) as f32 * 0.05);
        let nearest = [(0.9, 0.6), (0.6, -0.7), (1.5, 0.5), (-0.5, 0.9)]
            .map(|(u, v): (f32, f32)| (x - u).hypot(y - v) - 0.1)
            .into_iter()
            .fold(f32::MAX, f32::min);
        match nearest {
            near if near <= 0.0 => 254,
            near if near <= 0.215 => 253,
            near if near <= 0.55 => (252.0 * (-6.0 * (near - 0.215)).exp()) as u8,
            _ => 0,
        }
    };
    (0..side * side).map(cost).collect()
}

fn path() -> Vec<Waypoint> {
    let waypoint =
        |step: i32| Waypoint { pose_in_map: Pose2::new(step as f32 * 0.05, 0.0, 0.0), gear: Gear::Ahead };
    (0..60).map(waypoint).collect()
}

fn people() -> Vec<MovingPerson> {
    let person = |number: i32| MovingPerson {
        position_in_map: Point2::new(1.0 + 0.4 * number as f32, 1.5 - 0.8 * number as f32),
        velocity_in_map_mps: Point2::new(-0.6, 0.3),
        position_deviation_m: 0.1,
        velocity_deviation_mps: 0.15,
    };
    (0..5).map(person).collect()
}

/// A cycle in the fastest of some rounds.
fn cycle_ms(planner: &mut dyn LocalPlanner, people: &[MovingPerson]) -> f64 {
    let (costs, path) = (costs(), path());
    let corner = Point2::new(-2.0, -2.0);
    let geometry = GridGeometry::new(SIDE, SIDE, 0.05, corner).expect("a raster");
    let situation = LocalSituation {
        pose_in_map: Pose2::default(),
        twist: Twist2 { linear_mps: 0.4, angular_radps: 0.0 },
        costmap: CostmapView::new(geometry, &costs, 1).expect("as many costs"),
        path: &path,
        people,
        guard: &AlwaysPermitted,
        speed_limit_mps: f32::INFINITY,
    };
    let (ms, _) = fastest_ms(3, || {
        for _ in 0..CYCLES {
            std::hint::black_box(planner.command(&situation));
        }
    });
    ms / f64::from(CYCLES)
}

fn dwa() -> NavigationTime {
    let cells = usize::from(SIDE) * usize::from(SIDE);
    let (mut path, mut goal) = (vec![StepCell::default(); cells], vec![StepCell::default(); cells]);
    let scratch = DwaScratch { path: &mut path, goal: &mut goal };
    let ms = cycle_ms(&mut Dwa::new(DwaConfig::PUBLISHED, &jackal(), scratch), &[]);
    NavigationTime {
        task: "dynamic window",
        input: "80 × 80 cells".into(),
        ms,
        note: "at most 0.3 ms".into(),
    }
}

fn ours(people: &[MovingPerson]) -> NavigationTime {
    let mut planner = Mppi::new(mppi(), jackal(), vec![MppiSample::default(); 1_000], 1);
    let ms = cycle_ms(&mut planner, people);
    let input = format!("1,000 samples, {} people", people.len());
    NavigationTime { task: "predictive control", input, ms, note: "at most 5 ms".into() }
}

fn predictions() -> NavigationTime {
    let sides = GridSides { columns: 80, rows: 80 };
    let geometry = GridGeometry::with_sides(sides, 0.75, Point2::new(-30.0, -30.0)).expect("a raster");
    let cells = vec![FlowCell::default(); geometry.cell_count() * FLOW_HEADINGS];
    let mut predictor = PeoplePredictor::new(PlaceFlow::new(geometry, cells).expect("as many cells"));
    let mut random = Pcg32::new(3, 3);
    let mut trails = vec![PersonTrail::default(); 30];
    for step in 0..40 {
        for (number, trail) in trails.iter_mut().enumerate() {
            let path_m = 0.4 * step as f32 + random.uniform_between(-0.05, 0.05);
            predictor.observe(trail, Point2::new(path_m - 8.0, number as f32 - 15.0));
        }
        predictor.end_step();
    }
    let (ms, _) = fastest_ms(3, || {
        for _ in 0..PREDICTIONS {
            for trail in &trails {
                std::hint::black_box(predictor.predict(trail));
            }
        }
    });
    let ms = ms / f64::from(PREDICTIONS);
    let note = format!("{:.1} µs; at most 20 µs", ms * 1e3);
    NavigationTime { task: "prediction", input: "30 people, 12 steps".into(), ms, note }
}
