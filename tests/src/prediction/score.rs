//! Errors of our predictor and of constant velocity on the same windows.

use std::collections::BTreeMap;

use floorguard_mapping::{GridGeometry, GridSides};
use floorguard_navigation::prediction::{
    FLOW_HEADINGS, FlowCell, PeoplePredictor, PersonTrail, PlaceFlow, PredictedPath, SEEN_STEPS, STEPS,
};
use floorguard_types::geometry::Point2;

use super::tracks::TrackSet;

/// Mean errors over windows, metres.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PredictionScore {
    /// Over all twelve steps.
    pub mean_m: f64,
    /// At the last step.
    pub final_m: f64,
}

/// Both methods on the same windows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Predictions {
    /// How many windows.
    pub windows: usize,
    /// Ours.
    pub ours: PredictionScore,
    /// The last step repeated.
    pub constant_velocity: PredictionScore,
    /// Share of all predicted places within the 95 % ellipse.
    pub covered: f64,
}

/// One window that waits for its end.
struct Window {
    person: i64,
    begin: usize,
    path: PredictedPath,
    from: Point2,
}

/// Plays recordings of one place after the other; the windows of all are counted together.
///
/// # Panics
/// Never: the raster is legal and its storage fits.
#[must_use]
pub fn evaluate(sets: &[TrackSet]) -> Predictions {
    let mut sums = Sums::default();
    for set in sets {
        play(set, &mut sums);
    }
    sums.mean()
}

fn play(set: &TrackSet, sums: &mut Sums) {
    let sides = GridSides { columns: 80, rows: 80 };
    let geometry = GridGeometry::with_sides(sides, 0.75, Point2::new(-25.5, -25.5)).expect("a raster");
    let cells = vec![FlowCell::default(); geometry.cell_count() * FLOW_HEADINGS];
    let mut predictor = PeoplePredictor::new(PlaceFlow::new(geometry, cells).expect("as many cells"));
    let mut trails: BTreeMap<i64, PersonTrail> = BTreeMap::new();
    let mut windows: Vec<Window> = Vec::new();
    for (step, people) in set.steps.iter().enumerate() {
        trails.retain(|person, _| people.contains_key(person));
        for (person, place) in people {
            predictor.observe(trails.entry(*person).or_default(), *place);
        }
        predictor.end_step();
        let (ended, going): (Vec<Window>, Vec<Window>) =
            windows.into_iter().partition(|window| step == window.begin + STEPS);
        windows = going;
        for window in ended {
            sums.add(&window, set);
        }
        for (person, trail) in &trails {
            if trail.places().len() == SEEN_STEPS
                && let Some(path) = predictor.predict(trail)
            {
                windows.push(Window { person: *person, begin: step, path, from: people[person] });
            }
        }
    }
}

#[derive(Default)]
struct Sums {
    windows: usize,
    ours: PredictionScore,
    constant_velocity: PredictionScore,
    covered: usize,
}

impl Sums {
    /// A window counts where the person was seen at all of its steps.
    fn add(&mut self, window: &Window, set: &TrackSet) {
        let truth: Option<Vec<Point2>> = (1..=STEPS)
            .map(|step| {
                set.steps.get(window.begin + step).and_then(|people| people.get(&window.person)).copied()
            })
            .collect();
        let Some(truth) = truth else { return };
        self.windows += 1;
        for (step, (place, predicted)) in truth.iter().zip(&window.path.places).enumerate() {
            let steps = step as f32 + 1.0;
            let (from, last) = (window.from, window.path.last_step);
            let straight = Point2::new(from.x_m + steps * last.x_m, from.y_m + steps * last.y_m);
            let is_last = step + 1 == STEPS;
            enter(&mut self.ours, place.distance(predicted.place_in_map), is_last);
            enter(&mut self.constant_velocity, place.distance(straight), is_last);
            self.covered += usize::from(is_covered(*place, &window.path, step));
        }
    }

    fn mean(&self) -> Predictions {
        let count = self.windows.max(1) as f64;
        let mean = |sum: PredictionScore| PredictionScore {
            mean_m: sum.mean_m / count,
            final_m: sum.final_m / count,
        };
        Predictions {
            windows: self.windows,
            ours: mean(self.ours),
            constant_velocity: mean(self.constant_velocity),
            covered: self.covered as f64 / (count * STEPS as f64),
        }
    }
}

fn enter(score: &mut PredictionScore, error_m: f32, is_last: bool) {
    score.mean_m += f64::from(error_m) / STEPS as f64;
    if is_last {
        score.final_m += f64::from(error_m);
    }
}

/// The place lies within the predicted ellipse.
fn is_covered(place: Point2, path: &PredictedPath, step: usize) -> bool {
    let predicted = path.places[step];
    let (dx, dy) = (place.x_m - predicted.place_in_map.x_m, place.y_m - predicted.place_in_map.y_m);
    let length_m = path.last_step.norm();
    let (ux, uy) = if length_m > 1e-3 {
        (path.last_step.x_m / length_m, path.last_step.y_m / length_m)
    } else {
        (1.0, 0.0)
    };
    let [along_m, across_m] = predicted.half_axes_m;
    ((dx * ux + dy * uy) / along_m).powi(2) + ((dy * ux - dx * uy) / across_m).powi(2) <= 1.0
}
