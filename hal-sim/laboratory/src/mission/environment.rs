//! Dirt between missions: what the model expects in each cell of a mission, and what a mission teaches the model.
//!
//! The model knows places of 2 m. Within a place dirt lies where people walk: its cells share the place's dirt by the
//! heat map of 0.2 m, with a part for all cells alike.

use floorguard_mapping::GridCoordinates;
use floorguard_mapping::environment::{Cleaning, SinceCleaning, WallTime};

use crate::mission::TrialResult;
use floorguard_robot::environment::Model;
use floorguard_robot::site::Floor;

/// Share of a place's dirt that lies anywhere in it, whether people walk there or not.
const ANYWHERE: f32 = 0.3;
/// Units expected in each cell of a place of which nobody knows since when its dirt has been lying there, or how fast it
/// arrives: it must be cleaned and cannot be called clean unseen.
const UNKNOWN: f32 = 10.0;
/// A pass ends when the brush was elsewhere for this many positions of the path.
const PASS_GAP: usize = 6;

/// What a mission taught.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CleaningLesson {
    /// Places of which a part was cleaned.
    pub places: usize,
    /// Units picked up in them.
    pub units: f32,
}

/// The cells of a floor, with the place each lies in and its share of that place's dirt.
struct Shares(Vec<Option<(usize, f32)>>);

impl Shares {
    fn new(model: &Model, floor: &Floor) -> Self {
        let (places, heat) = (model.core.places.grid(), model.core.heat.cells());
        let visits = |cell: usize| {
            let fine = heat.geometry().cell_at(floor.cells.centre(cell));
            fine.and_then(|index| heat.get(index)).map_or(0.0, |cell| cell.visits as f32)
        };
        let mut sums = vec![(0.0_f32, 0.0_f32); places.geometry().cell_count()];
        let place_of = |cell: usize| {
            let is_floor =
                floor.clearance.clearance_m(floor.cells.centre(cell)) >= 0.5 * floor.cells.resolution_m();
            if is_floor { places.geometry().cell_at(floor.cells.centre(cell)) } else { None }
        };
        for cell in 0..floor.cells.cell_count() {
            if let Some(place) = place_of(cell) {
                sums[place].0 += visits(cell);
                sums[place].1 += 1.0;
            }
        }
        let share = |cell: usize| {
            let place = place_of(cell)?;
            let (walked, count) = sums[place];
            let (anywhere, paths) =
                if walked > 0.0 { (ANYWHERE, (1.0 - ANYWHERE) / walked) } else { (1.0, 0.0) };
            Some((place, anywhere / count + paths * visits(cell)))
        };
        Self((0..floor.cells.cell_count()).map(share).collect())
    }
}

/// Units expected in each cell of a floor at a moment; many where nobody knows. With `delta`, as many more as the doubt about the rate asks
/// for: the Poisson law with this mean has the (1 − δ) quantile of what the model predicts.
#[must_use]
pub fn expected_units(model: &Model, floor: &Floor, now: WallTime, delta: Option<f64>) -> Vec<f32> {
    let places = model.core.places.grid();
    let units = |cell: &Option<(usize, f32)>| {
        let (place, share) = (*cell)?;
        let place = places.get(place)?;
        let is_known = place.dirt.hours > 0.0 || (place.is_watched() && model.per_visit.is_learned());
        if place.cleaned.is_none() || !is_known {
            return Some(UNKNOWN);
        }
        let SinceCleaning { hours, left_units } = place.since_cleaning(now);
        let mut rate = place.dirt_rate(&model.per_visit);
        // A share of a Gamma rate has the same shape over more hours.
        rate.hours /= share.max(1.0e-6);
        Some(match delta {
            Some(delta) => rate.predict_conservatively(left_units * share, hours, delta),
            None => rate.predict(left_units * share, hours),
        })
    };
    Shares::new(model, floor).0.iter().map(|cell| units(cell).unwrap_or(0.0).min(70.0)).collect()
}

/// Learns what a mission picked up where. `pickup` is the share that a pass takes, `brush_m` the width of the brush.
pub fn teach_cleaning(
    model: &mut Model,
    (floor, result): (&Floor, &TrialResult),
    (pickup, brush_m): (f32, f32),
    now: WallTime,
) -> CleaningLesson {
    let shares = Shares::new(model, floor);
    let passes = passes(floor, result, brush_m);
    let count = model.core.places.grid().geometry().cell_count();
    let (mut units, mut picked) = (vec![0.0_f32; count], vec![0.0_f32; count]);
    for (cell, passes) in shares.0.iter().zip(passes) {
        if let Some((place, share)) = cell {
            picked[*place] += share * (1.0 - (1.0 - pickup).powi(i32::from(passes)));
        }
    }
    for (point, hits) in &result.hits {
        if let Some(place) = model.core.places.grid().geometry().cell_at(*point) {
            units[place] += *hits as f32;
        }
    }
    let mut lesson = CleaningLesson::default();
    let mut per_visit = model.per_visit;
    for ((place, units), share) in model.core.places.grid_mut().values_mut().iter_mut().zip(units).zip(picked)
    {
        if share > 0.0 {
            place.learn_cleaning(Cleaning { at: now, units, share }, &mut per_visit);
            lesson.places += 1;
            lesson.units += units;
        }
    }
    model.per_visit = per_visit;
    lesson
}

/// How often the brush passed over the middle of each cell.
fn passes(floor: &Floor, result: &TrialResult, brush_m: f32) -> Vec<u8> {
    let geometry = &floor.cells;
    let mut passes = vec![(0_u8, 0_usize); geometry.cell_count()];
    let reach = (0.5 * brush_m / geometry.resolution_m()).ceil() as i32 + 1;
    for (moment, pair) in result.path.windows(2).enumerate() {
        let steps = (pair[0].distance(pair[1]) / 0.02).ceil().max(1.0) as usize;
        for step in 0..=steps {
            let share = step as f32 / steps as f32;
            let along = |from: f32, to: f32| from + share * (to - from);
            let point = floorguard_types::geometry::Point2::new(
                along(pair[0].x_m, pair[1].x_m),
                along(pair[0].y_m, pair[1].y_m),
            );
            let GridCoordinates { column, row } = geometry.coordinates_of(point);
            for (dx, dy) in (-reach..=reach).flat_map(|dy| (-reach..=reach).map(move |dx| (dx, dy))) {
                if let Some(cell) = geometry.index(column + dx, row + dy)
                    && geometry.centre(cell).distance(point) <= 0.5 * brush_m
                {
                    let (count, last) = &mut passes[cell];
                    if *count == 0 || moment > *last + PASS_GAP {
                        *count = count.saturating_add(1);
                    }
                    *last = moment;
                }
            }
        }
    }
    passes.into_iter().map(|(count, _)| count).collect()
}
