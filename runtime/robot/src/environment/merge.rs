//! Models of several robots in one building become one: what each of them saw counts, in whatever order they are named.
//!
//! Counts and hours add up. Sums of single precision depend on the order of their parts, so the models are put in the order of their
//! bytes first: the same models make the same file, to the bit.

use std::collections::{BTreeMap, BTreeSet};

use anyhow::{Context, ensure};
use floorguard_mapping::environment::{
    Complex, Contest, DirtPerVisit, DirtSeen, Environment, HeatCell, HourBin, Place, SpectrumParts, WallTime,
    Week,
};
use floorguard_types::geometry::Point2;

use super::codec::encode;
use super::model::{HOURS, Model, PERIODS};

type ModelPlace = Place<HOURS, PERIODS>;

/// One model of several. Its rectangle covers all of theirs; its zones are those of all, the first of a name. What a robot was
/// watching when it was saved is learned first.
///
/// # Errors
/// No model, clocks of different time zones, or a rectangle that no model can hold.
pub fn merge(name: &str, mut models: Vec<Model>) -> anyhow::Result<Model> {
    for model in &mut models {
        if let Some(newest) = model.core.newest() {
            model.settle(newest);
        }
    }
    let mut sorted: Vec<(Vec<u8>, Model)> =
        models.into_iter().map(|model| Ok((encode(&model)?, model))).collect::<anyhow::Result<_>>()?;
    sorted.sort_by(|(a, _), (b, _)| a.cmp(b));
    let models: Vec<Model> = sorted.into_iter().map(|(_, model)| model).collect();
    let mut merged = frame(name, &models)?;
    for model in &models {
        add_places(&mut merged, model)?;
    }
    add_hours(&mut merged, &models)?;
    merged.per_visit = per_visit(&models);
    let mut names = BTreeSet::new();
    let zones = models.iter().flat_map(|model| &model.zones);
    merged.zones = zones.filter(|zone| names.insert(zone.name.clone())).cloned().collect();
    let newest: Option<WallTime> =
        models.iter().filter_map(|model| model.core.newest()).max_by_key(|at| at.as_micros());
    let Environment { heat, places, .. } = *merged.core;
    merged.core = Box::new(Environment::new(heat, places, newest));
    Ok(merged)
}

/// An empty model that covers all.
fn frame(name: &str, models: &[Model]) -> anyhow::Result<Model> {
    let first = models.first().context("no model to merge")?;
    for model in models {
        let (clock, other) = (first.calendar.name(), model.calendar.name());
        ensure!(clock == other, "the clock of {} is {clock}, that of {} is {other}", first.name, model.name);
    }
    let corner = |model: &Model, last: bool| {
        let geometry = model.core.places.grid().geometry();
        geometry.centre(if last { geometry.cell_count().saturating_sub(1) } else { 0 })
    };
    let bound = |last: bool, pick: fn(f32, f32) -> f32| {
        let all = models.iter().map(|model| corner(model, last));
        all.reduce(|a, b| Point2::new(pick(a.x_m, b.x_m), pick(a.y_m, b.y_m))).unwrap_or_default()
    };
    let mut merged =
        Model::over(name, first.calendar.clone(), (bound(false, f32::min), bound(true, f32::max)))?;
    merged.generation = models.iter().map(|model| model.generation).max().unwrap_or(0);
    Ok(merged)
}

fn add_places(merged: &mut Model, model: &Model) -> anyhow::Result<()> {
    let outside = || format!("{} lies on another raster", model.name);
    let (from, to) = (model.core.heat.cells(), *merged.core.heat.cells().geometry());
    for (cell, index) in from.values().iter().zip(0_usize..) {
        if *cell == HeatCell::default() {
            continue;
        }
        let target = to.cell_at(from.geometry().centre(index)).with_context(outside)?;
        let sum = merged.core.heat.cells_mut().values_mut().get_mut(target).with_context(outside)?;
        sum.visits = sum.visits.saturating_add(cell.visits);
        sum.dwell_cs = sum.dwell_cs.saturating_add(cell.dwell_cs);
        sum.watched_cs = sum.watched_cs.saturating_add(cell.watched_cs);
    }
    let (from, to) = (model.core.places.grid(), *merged.core.places.grid().geometry());
    for (place, index) in from.values().iter().zip(0_usize..) {
        if *place == Place::EMPTY {
            continue;
        }
        let target = to.cell_at(from.geometry().centre(index)).with_context(outside)?;
        let sum = merged.core.places.grid_mut().values_mut().get_mut(target).with_context(outside)?;
        *sum = joined(sum, place);
    }
    Ok(())
}

/// What two robots know of a place.
fn joined(a: &ModelPlace, b: &ModelPlace) -> ModelPlace {
    let mut bins = [HourBin::default(); HOURS];
    for ((sum, a), b) in bins.iter_mut().zip(a.week.bins()).zip(b.week.bins()) {
        sum.visits = a.visits.saturating_add(b.visits);
        sum.watched_ds = a.watched_ds.saturating_add(b.watched_ds);
    }
    let mut place = Place::EMPTY;
    place.week = Week::from_bins(bins);
    place.spectrum.restore(joined_spectrum(&a.spectrum.parts(), &b.spectrum.parts()));
    let ((losses_a, weight_a), (losses_b, weight_b)) = (a.contest.parts(), b.contest.parts());
    let mut losses = *losses_a;
    losses.iter_mut().zip(losses_b).for_each(|(sum, loss)| *sum += loss);
    place.contest = Contest::from_parts(losses, weight_a + weight_b);
    place.spread = (a.spread.0 + b.spread.0, a.spread.1 + b.spread.1);
    place.stays = (a.stays.0.saturating_add(b.stays.0), a.stays.1.saturating_add(b.stays.1));
    place.dirt = DirtSeen { units: a.dirt.units + b.dirt.units, hours: a.dirt.hours + b.dirt.hours };
    // The newest cleaning says how the place was left.
    let newest = |(at, left): &(WallTime, f32)| (at.as_micros(), left.to_bits());
    place.cleaned = a.cleaned.into_iter().chain(b.cleaned).max_by_key(newest);
    let number = a.slice().number.max(b.slice().number);
    place.restore_slice(floorguard_mapping::environment::PlaceSlice { number, visits: 0, watched_cs: 0 });
    place
}

fn joined_spectrum(a: &SpectrumParts<PERIODS>, b: &SpectrumParts<PERIODS>) -> SpectrumParts<PERIODS> {
    let add = |a: &[Complex; PERIODS], b: &[Complex; PERIODS]| {
        let mut sums = *a;
        for (sum, more) in sums.iter_mut().zip(b) {
            *sum = Complex { re: sum.re + more.re, im: sum.im + more.im };
        }
        sums
    };
    let spans = a.span.into_iter().chain(b.span);
    SpectrumParts {
        weight: a.weight + b.weight,
        sum: a.sum + b.sum,
        span: spans.reduce(|(from, to), (other_from, other_to)| (from.min(other_from), to.max(other_to))),
        signal: add(&a.signal, &b.signal),
        sampling: add(&a.sampling, &b.sampling),
    }
}

/// Hours of cells go into the table in the order of their keys: where it is full, the same ones are lost.
fn add_hours(merged: &mut Model, models: &[Model]) -> anyhow::Result<()> {
    let to = *merged.core.heat.cells().geometry();
    let mut all: BTreeMap<(usize, u8), (u16, u32)> = BTreeMap::new();
    for model in models {
        let from = model.core.heat.cells().geometry();
        for entry in model.core.heat.hours().iter() {
            let Some((cell, hour)) = entry.cell_and_hour() else { continue };
            let target =
                to.cell_at(from.centre(cell)).with_context(|| format!("{}: a cell outside", model.name))?;
            let (visits, dwell_cs) = all.entry((target, hour)).or_default();
            *visits = visits.saturating_add(entry.visits);
            *dwell_cs = dwell_cs.saturating_add(entry.dwell_cs);
        }
    }
    for ((cell, hour), (visits, dwell_cs)) in all {
        merged.core.heat.hours_mut().add(cell, hour, visits, dwell_cs);
    }
    Ok(())
}

/// What all learned of the dirt of a visitor, with what is assumed before once.
fn per_visit(models: &[Model]) -> DirtPerVisit {
    let prior = DirtPerVisit::PRIOR;
    let learned = models.iter().map(|model| &model.per_visit);
    learned.fold(prior, |sum, more| DirtPerVisit {
        units: sum.units + (more.units - prior.units).max(0.0),
        visits: sum.visits + (more.visits - prior.visits).max(0.0),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::environment::{Calendar, Recording, TrackPoint, decode, teach_recording};

    const MONDAY_S: i64 = 1_775_433_600;

    /// A robot that sees somebody cross a room every so many seconds, for half an hour, from an hour on.
    fn robot(corner_m: f32, hour: i64, every_s: i64) -> Model {
        let corners = (Point2::new(corner_m, 0.1), Point2::new(corner_m + 3.8, 1.9));
        let mut model = Model::over("room", Calendar::named("+01:00").unwrap(), corners).unwrap();
        let mut recording = Recording::default();
        for tenth in 0..18_000_i64 {
            let (person, step) = (tenth / (every_s * 10), tenth % (every_s * 10));
            if step < 50 {
                let position = Point2::new(corner_m + 0.1 + step as f32 * 0.07, 1.0);
                let point = TrackPoint { id: person as u64, position };
                recording.moments.entry(tenth * 100_000).or_default().push(point);
            }
        }
        teach_recording(&mut model, &recording, WallTime::from_seconds(MONDAY_S + hour * 3_600)).unwrap();
        model
    }

    fn again(model: &Model) -> Model {
        decode(&encode(model).unwrap()).unwrap()
    }

    #[test]
    fn order_of_models_changes_no_bit() {
        let robots = [robot(0.1, 8, 30), robot(2.1, 11, 17), robot(0.1, 15, 60)];
        let order = |indices: [usize; 3]| {
            let chosen = indices.into_iter().filter_map(|index| robots.get(index)).map(again);
            encode(&merge("hall", chosen.collect()).unwrap()).unwrap()
        };
        let merged = order([0, 1, 2]);
        for other in [[0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
            assert!(order(other) == merged, "{other:?}");
        }
        let merged = decode(&merged).unwrap();
        let visits = |model: &Model| {
            model.core.heat.cells().values().iter().map(|cell| u64::from(cell.visits)).sum::<u64>()
        };
        assert_eq!(visits(&merged), robots.iter().map(visits).sum::<u64>());
        let hours = |model: &Model| {
            model.core.places.grid().values().iter().map(|place| place.week.total().hours).sum::<f32>()
        };
        let all: f32 = robots.iter().map(hours).sum();
        assert!((hours(&merged) - all).abs() < 0.01 && all > 1.0, "{} of {all}", hours(&merged));
        assert_eq!(merged.core.places.grid().geometry().width(), 3);
    }

    #[test]
    fn one_model_stays_as_it_is() {
        let one = robot(0.1, 8, 30);
        let mut settled = again(&one);
        settled.settle(one.core.newest().unwrap());
        let merged = merge("room", vec![again(&one)]).unwrap();
        assert!(encode(&merged).unwrap() == encode(&settled).unwrap());
    }
}
