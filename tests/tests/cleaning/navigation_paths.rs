//! Shortest paths against an independent library (crate `pathfinding`): on 200 random maps and on recorded buildings. Paths of the
//! lattice through a recorded office, both ways.

use std::collections::HashMap;

use floorguard_mapping::{GridCoordinates, GridGeometry, GridSides};
use floorguard_navigation::costmap::{CostmapView, footprint_cost};
use floorguard_navigation::global::{GridSearch, SearchEnd, SearchMethod, StepCosts};
use floorguard_tests::bench::{Office, OfficePath};
use floorguard_tests::data::recording;
use floorguard_types::geometry::Point2;
use floorguard_types::random::Pcg32;
use pathfinding::prelude::dijkstra_all;

const BUILDINGS: [&str; 4] = ["Freiburg52_scan", "lab_a_scan_furnitures", "lab_c_scan", "lab_intel"];

/// What a step into a cell costs, from the definition: 3 · cost + 50, the outermost ring and everything from 253 on shut.
fn step_into(costs: &[u8], (columns, rows): (i32, i32), (x, y): (i32, i32)) -> Option<u32> {
    let is_inner = x > 0 && y > 0 && x < columns - 1 && y < rows - 1;
    let cost = is_inner.then(|| u32::from(costs[(y * columns + x) as usize]))?;
    (cost < 253).then_some(3 * cost + 50)
}

/// All distances by the library.
fn expected(costs: &[u8], sides: (i32, i32), start: (i32, i32)) -> HashMap<(i32, i32), ((i32, i32), u32)> {
    dijkstra_all(&start, |&(x, y)| {
        let offsets = [(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (-1, 1), (1, -1), (-1, -1)];
        let open = |x: i32, y: i32| step_into(costs, sides, (x, y)).is_some();
        let steps = offsets.into_iter().filter_map(|(dx, dy)| {
            let by = step_into(costs, sides, (x + dx, y + dy))?;
            let is_diagonal = dx != 0 && dy != 0;
            let is_cut = is_diagonal && !(open(x + dx, y) && open(x, y + dy));
            (!is_cut).then_some(((x + dx, y + dy), if is_diagonal { by * 181 / 128 } else { by }))
        });
        steps.collect::<Vec<_>>()
    })
}

/// Everything reached has the library's distance, and nothing else is reached; A* agrees at some goals. Gives how many cells.
fn compare(costs: &[u8], (columns, rows): (i32, i32), random: &mut Pcg32) -> usize {
    let sides = GridSides { columns: columns as u32, rows: rows as u32 };
    let geometry = GridGeometry::with_sides(sides, 0.05, Point2::default()).expect("a raster");
    let view = CostmapView::new(geometry, costs, 1).expect("as many costs");
    let place = |cell: usize| {
        let GridCoordinates { column, row } = geometry.coordinates(cell);
        (column, row)
    };
    let free: Vec<usize> =
        (0..costs.len()).filter(|&cell| step_into(costs, (columns, rows), place(cell)).is_some()).collect();
    if free.is_empty() {
        return 0;
    }
    let start = free[random.below(free.len() as u32) as usize];
    let expected = expected(costs, (columns, rows), place(start));
    let room = costs.len().max(4_096);
    let mut search = GridSearch::new(vec![0; costs.len()], vec![0; room], StepCosts::new(false));
    assert_eq!(search.run(view, start, None, SearchMethod::Dijkstra), SearchEnd::Exhausted);
    for cell in 0..costs.len() {
        let distance = expected.get(&place(cell)).map(|(_, distance)| *distance);
        let distance = if cell == start { Some(0) } else { distance };
        assert_eq!(search.distance(cell), distance, "cell {cell}");
    }
    for _ in 0..5 {
        let goal = free[random.below(free.len() as u32) as usize];
        let distance = expected.get(&place(goal)).map(|(_, distance)| *distance);
        let distance = if goal == start { Some(0) } else { distance };
        let end = search.run(view, start, Some(goal), SearchMethod::AStar);
        assert_eq!((end == SearchEnd::Reached).then(|| search.distance(goal)).flatten(), distance);
    }
    expected.len()
}

#[test]
fn random_maps_have_the_library_costs() {
    let mut random = Pcg32::new(24, 1);
    for map in 0..200 {
        let (columns, rows) = (20 + random.below(60) as i32, 20 + random.below(60) as i32);
        let walls = 0.05 + 0.35 * (map % 10) as f32 / 9.0;
        let cost = |random: &mut Pcg32| match random.bernoulli(walls) {
            true => 253 + random.below(3) as u8,
            false if random.bernoulli(0.5) => 0,
            false => random.below(253) as u8,
        };
        let costs: Vec<u8> = (0..columns * rows).map(|_| cost(&mut random)).collect();
        compare(&costs, (columns, rows), &mut random);
    }
}

#[test]
fn buildings_have_the_library_costs() {
    let mut random = Pcg32::new(24, 2);
    for name in BUILDINGS {
        let Some(path) = recording(&format!("grid_maps/{name}.png")) else { continue };
        let picture = image::open(path).expect("a picture").into_luma8();
        // White is free, everything else is shut; shades near walls as extra costs.
        let shade = |grey: u8| if grey >= 250 { 0 } else { 254 };
        let costs: Vec<u8> = picture.pixels().map(|pixel| shade(pixel.0[0])).collect();
        let reached = compare(&costs, (picture.width() as i32, picture.height() as i32), &mut random);
        println!("{name}: {reached} cells have the library's distances");
    }
}

/// 56 m through doors and corridors, on every pose with the whole outline on free floor, and few poses looked at.
#[test]
fn lattice_crosses_a_recorded_office() {
    let Some(office) = Office::load() else { return };
    let [left, right] = office.ends;
    assert!(right.x_m - left.x_m > 50.0, "{left:?} {right:?}");
    for [from, to] in [[left, right], [right, left]] {
        let OfficePath { path, time_s, examined } = office.across([from, to]).expect("a path");
        println!("{} waypoints, {time_s} s, {examined} poses", path.len());
        assert!(
            path.iter().all(|at| footprint_cost(office.costmap(), office.outline(), at.pose_in_map).is_ok())
        );
        assert_eq!(path.first().map(|at| at.pose_in_map), Some(from));
        let end = path.last().expect("a path has an end").place_in_map();
        assert!(end.distance(Point2::new(to.x_m, to.y_m)) <= 0.3 + 1e-3);
        assert!(examined < 20_000, "{examined}");
    }
}
