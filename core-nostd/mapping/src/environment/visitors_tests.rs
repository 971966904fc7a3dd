//! Walks whose counts are plain to see.

use super::*;
use std::collections::BTreeMap;

type Seen = BTreeMap<usize, (u32, u64)>;

fn raster() -> GridGeometry {
    GridGeometry::new(50, 50, 0.2, Point2::new(0.0, 0.0)).unwrap()
}

/// Plays positions every 0.1 s; visits and µs for each cell.
fn play<const N: usize>(
    visitors: &mut Visitors<N, 64>,
    id: u64,
    path: impl Iterator<Item = (f32, f32)>,
) -> Seen {
    let mut seen = Seen::new();
    for (i, (x_m, y_m)) in path.enumerate() {
        let at = WallTime::from_micros(i as i64 * 100_000);
        let person = PersonAt { id, position_in_map: Point2::new(x_m, y_m) };
        visitors.follow(&raster(), (person, at), |f| {
            let entry = seen.entry(f.cell).or_default();
            entry.0 += u32::from(f.is_visit);
            entry.1 += u64::from(f.dwell_us);
        });
    }
    seen
}

#[test]
fn straight_walk_visits_each_cell_once() {
    let mut visitors = Visitors::<4, 64>::default();
    // 1.3 m/s along a row: from x = 0.5 to 5.7.
    let seen = play(&mut visitors, 7, (0..41).map(|i| (0.5 + 0.13 * i as f32, 1.1)));
    assert_eq!(seen.len(), 27, "cells 2 to 28");
    assert!(seen.values().all(|(visits, _)| *visits == 1), "{seen:?}");
    assert_eq!(seen.values().map(|(_, us)| us).sum::<u64>(), 4_000_000);
}

#[test]
fn fast_step_fills_cells_jump_does_not() {
    let mut visitors = Visitors::<4, 64>::default();
    let seen = play(&mut visitors, 1, [(0.1, 0.1), (2.1, 0.1)].into_iter());
    assert_eq!(seen.len(), 11);
    let mut visitors = Visitors::<4, 64>::default();
    let seen = play(&mut visitors, 1, [(0.1, 0.1), (9.1, 0.1)].into_iter());
    assert_eq!(seen.len(), 2);
}

#[test]
fn a_false_track_that_stands_never_counts() {
    let mut visitors = Visitors::<4, 64>::default();
    let jitter = |i: i32| (2.0 + 0.3 * ((i % 7) as f32 / 7.0), 2.0 + 0.3 * ((i % 5) as f32 / 5.0));
    assert!(play(&mut visitors, 3, (0..3_000).map(jitter)).is_empty());
}

#[test]
fn standing_on_a_border_is_one_visit() {
    let mut visitors = Visitors::<4, 64>::default();
    let walk = (0..20).map(|i| (1.0 + 0.1 * i as f32, 1.1));
    let stand = (0..400).map(|i| (if i % 2 == 0 { 2.99 } else { 3.01 }, 1.1));
    let seen = play(&mut visitors, 3, walk.chain(stand));
    let cell = raster().cell_at(Point2::new(2.99, 1.1)).unwrap();
    assert_eq!((seen[&cell].0, seen[&(cell + 1)].0), (1, 1));
    assert_eq!(seen.values().map(|(_, us)| us).sum::<u64>(), 41_900_000);
}

#[test]
fn who_returns_after_a_minute_counts_again() {
    let mut visitors = Visitors::<4, 64>::default();
    let there = (0..20).map(|i| (1.1 + 0.1 * i as f32, 1.1));
    let waits = (0..640).map(|_| (3.0, 1.1));
    let back = (0..20).map(|i| (3.0 - 0.1 * i as f32, 1.1));
    let seen = play(&mut visitors, 3, there.chain(waits).chain(back));
    assert_eq!(seen[&raster().cell_at(Point2::new(1.5, 1.1)).unwrap()].0, 2);
}

#[test]
fn full_table_counts_drops_and_reuses_slots() {
    let mut visitors = Visitors::<2, 8>::default();
    let person = |id| PersonAt { id, position_in_map: Point2::new(1.0, 1.0) };
    for id in 0..5 {
        visitors.follow(&raster(), (person(id), WallTime::from_seconds(1)), |_| {});
    }
    assert_eq!(visitors.dropped(), 3);
    visitors.follow(&raster(), (person(9), WallTime::from_seconds(62)), |_| {});
    assert_eq!(visitors.dropped(), 3);
}

#[test]
fn hostile_positions_and_times_are_harmless() {
    let mut visitors = Visitors::<2, 8>::default();
    let mut count = 0;
    for (x_m, at) in
        [(f32::NAN, 0), (1.0, i64::MAX), (1e30, i64::MIN), (-1e30, 0), (f32::INFINITY, 1), (2.0, 2)]
    {
        let person = PersonAt { id: 1, position_in_map: Point2::new(x_m, 1.0) };
        visitors.follow(&raster(), (person, WallTime::from_micros(at)), |_| count += 1);
    }
    assert_eq!(count, 0);
}
