//! The memory of what was seen, and the sweep of the body through it, against plain geometry.

use super::fixtures::{config, forward, rectangle};
use crate::protection::Row;
use crate::*;
use floorguard_types::geometry::{Point2, Pose2, Twist2};
use floorguard_types::random::Pcg32;
use floorguard_types::time::Stamp;

fn twist(linear_mps: f32, angular_radps: f32) -> Twist2 {
    Twist2 { linear_mps, angular_radps }
}

/// Distance from a rectangle, by its definition.
fn gap_m(point: (f64, f64)) -> f64 {
    let (dx, dy) = ((-0.45 - point.0).max(point.0 - 0.95), (-0.4 - point.1).max(point.1 - 0.4));
    if dx <= 0.0 && dy <= 0.0 { dx.max(dy) } else { dx.max(0.0).hypot(dy.max(0.0)) }
}

/// Way of the fastest point of the body until the body comes nearer than `kept_m`, by ten thousand small steps.
fn plain_free_m(twist: Twist2, point: Point2, (path_m, kept_m): (f64, f64)) -> f64 {
    let (v, w) = (f64::from(twist.linear_mps), f64::from(twist.angular_radps));
    let corners = [(-0.45, -0.4), (0.95, -0.4), (0.95, 0.4), (-0.45, 0.4)];
    let fastest = corners.iter().map(|(x, y)| (v - w * y).hypot(w * x)).fold(0.0, f64::max);
    let steps = 10_000;
    let step_s = path_m / fastest / f64::from(steps);
    let (mut x, mut y, mut heading) = (0.0_f64, 0.0_f64, 0.0_f64);
    for step in 0..steps {
        let (dx, dy) = (f64::from(point.x_m) - x, f64::from(point.y_m) - y);
        let (sin, cos) = heading.sin_cos();
        if gap_m((cos * dx + sin * dy, cos * dy - sin * dx)) < kept_m {
            return path_m * f64::from(step) / f64::from(steps);
        }
        let middle = heading + 0.5 * w * step_s;
        x += v * step_s * middle.cos();
        y += v * step_s * middle.sin();
        heading += w * step_s;
    }
    path_m
}

#[test]
fn fg_req_027_distance_to_contact_equals_small_steps() {
    let outline = rectangle([-0.45, 0.95], 0.4);
    let mut random = Pcg32::new(7, 1);
    let mut touched = 0;
    for _ in 0..1_500 {
        let motion = twist(random.uniform_between(-1.0, 1.0), random.uniform_between(-0.8, 0.8));
        let point = Point2::new(random.uniform_between(-1.6, 2.4), random.uniform_between(-1.5, 1.5));
        let (px, py) = (f64::from(point.x_m), f64::from(point.y_m));
        if gap_m((px, py)) < 0.06 {
            continue;
        }
        let path_m = 1.2_f32;
        let sweep = Sweep::along(&outline, motion, path_m).unwrap();
        let found_m = if sweep.is_near(point) { sweep.free_m(point, path_m) } else { path_m };
        let expected_m = plain_free_m(motion, point, (f64::from(path_m), f64::from(MARGIN_M)));
        touched += u32::from(expected_m < f64::from(path_m));
        // A point that only grazes the margin may be missed by a hair: then the body passes it all the same.
        let grazes = plain_free_m(motion, point, (f64::from(path_m), f64::from(MARGIN_M) - 0.012));
        assert!(
            (f64::from(found_m) - expected_m).abs() < 0.02 || f64::from(found_m) <= grazes + 0.01,
            "{motion:?} {point:?}: {found_m} {expected_m}"
        );
    }
    assert!(touched > 60, "{touched}");
    assert!(Sweep::along(&outline, Twist2::ZERO, 1.0).is_none());
    assert!(Sweep::along(&outline, twist(f32::NAN, 0.0), 1.0).is_none());
}

#[test]
fn fg_req_027_inside_the_margin_nothing_comes_nearer() {
    let outline = rectangle([-0.45, 0.95], 0.4);
    let free_m =
        |motion: Twist2, point: Point2| Sweep::along(&outline, motion, 0.5).unwrap().free_m(point, 0.5);
    let beside = Point2::new(0.2, 0.42);
    assert_eq!(free_m(forward(0.5), beside), 0.5, "along a wall");
    assert_eq!(free_m(twist(0.0, -0.5), Point2::new(0.9, 0.42)), 0.5, "the front turns away");
    assert!(free_m(twist(0.0, 0.5), Point2::new(0.9, 0.42)) < 0.02, "the front turns towards it");
    assert!(free_m(twist(0.0, 0.5), Point2::new(-0.4, -0.42)) < 0.04, "the tail turns towards it");
    assert_eq!(free_m(twist(-0.2, 0.0), Point2::new(0.97, 0.0)), 0.5, "away from a wall ahead");
    assert!(free_m(forward(0.2), Point2::new(0.97, 0.0)) < 0.01, "towards it");
}

/// Two wheels 0.5 m apart of which the outer one brakes with the least braking, and the inner one in proportion: integrated in small
/// steps, without the formula.
#[test]
fn fg_req_081_outer_wheel_brakes_the_turn() {
    let mut config = config();
    (config.drive.wheelbase_m, config.drive.wheel_lever_m) = (0.25, 0.25);
    for motion in [twist(0.5, 0.8), twist(0.0, 0.8), twist(-0.25, 0.3), forward(0.7)] {
        let wheels_mps = [-0.25, 0.25].map(|y_m: f32| (motion.linear_mps - motion.angular_radps * y_m).abs());
        let outer_mps = wheels_mps[0].max(wheels_mps[1]);
        let fastest_mps = fastest_mps(&config.footprint, motion);
        let (mut share, mut path_m) = (1.0_f32, fastest_mps * (REACTION_S + config.drive.response_s));
        for _ in 0..1_000_000 {
            path_m += fastest_mps * share * 1.0e-4;
            // Worn brakes: the way is a tenth longer.
            share -= config.drive.braking_mps2 / 1.1 / outer_mps * 1.0e-4;
            if share <= 0.0 {
                break;
            }
        }
        let computed_m = Stopping::from(&config.footprint, motion, (&config.drive, REACTION_S)).path_m();
        assert!((computed_m - path_m).abs() < 2.0e-3, "{motion:?}: {computed_m} {path_m}");
    }
}

#[test]
fn fg_req_027_stopping_chain_and_share_are_inverse() {
    let config = config();
    let from = |motion| Stopping::from(&config.footprint, motion, (&config.drive, REACTION_S));
    for mps in [0.1_f32, 0.3, 0.6, 1.0] {
        let expected_m = mps * (0.22 + 0.15) + 1.1 * mps * mps / 1.6;
        assert!((from(forward(mps)).path_m() - expected_m).abs() < 1.0e-5);
    }
    for motion in [forward(1.0), twist(0.0, 0.8), twist(-0.25, 0.3), twist(0.4, -0.8)] {
        let whole = from(motion);
        for path_m in [0.01_f32, 0.1, 0.3, 0.5] {
            let share = whole.share_within(path_m);
            let slower = from(twist(motion.linear_mps * share, motion.angular_radps * share));
            assert!(
                share == 1.0 || (slower.path_m() - path_m).abs() < 1.0e-4,
                "{motion:?} {path_m}: {share}"
            );
        }
        assert_eq!((whole.share_within(0.0), whole.share_within(-1.0)), (0.0, 0.0));
        assert_eq!(whole.share_within(whole.path_m()), 1.0);
    }
}

fn count(memory: &LocalMemory) -> usize {
    let mut cells = 0;
    memory.for_each(|_| cells += 1);
    cells
}

fn at(ms: u64) -> Stamp {
    Stamp::from_micros(1_000_000 + ms * 1_000)
}

fn memory() -> std::boxed::Box<LocalMemory> {
    let mut memory = std::boxed::Box::new(LocalMemory::EMPTY);
    memory.forget();
    memory
}

/// A ray passes through a cell at a height.
fn look(memory: &mut LocalMemory, cell: Cell, height_m: f32) {
    if memory.run(cell).is_refuted_at_m(height_m) {
        memory.clear_lidar(cell);
    }
}

/// Nothing happens for a span of time.
fn pass_span(memory: &mut LocalMemory, spans: u64) {
    memory.follow(Twist2::ZERO, at(spans * 310));
}

/// The lidar meets each height in two spans of time.
fn meet_twice(memory: &mut LocalMemory, cell: Cell, heights_m: &[f32]) {
    for span in 1..3 {
        heights_m.iter().for_each(|height_m| memory.meet(cell, *height_m, 0.05));
        pass_span(memory, span);
    }
}

#[test]
fn fg_req_028_only_rays_through_heights_clear_them() {
    let cell = Cell::of(Point2::new(1.0, 0.3));
    let with = |heights_m: &[f32], passes_m: &[f32]| {
        let mut memory = memory();
        meet_twice(&mut memory, cell, heights_m);
        passes_m.iter().for_each(|height_m| look(&mut memory, cell, *height_m));
        assert_eq!(memory.holds(cell), count(&memory) == 1);
        memory.holds(cell)
    };
    let board = [0.503, 0.511, 0.527];
    assert!(with(&board, &[]));
    assert!(with(&board, &[0.54, 0.60, 0.75, 0.49, 0.30]), "looks above and below a board say nothing of it");
    assert!(!with(&board, &[0.515]), "a look through its place does");
    assert!(!with(&[0.4, 0.45, 0.5, 0.55, 0.6], &[0.53]), "a person is gone who is looked through");
    assert!(with(&[0.5, 0.8], &[0.65]), "between two boards there is nothing to look through");
    assert!(!with(&[0.51], &[0.51]) && with(&[0.51], &[0.53]));
    // The scanner's plane is another matter.
    let mut memory = memory();
    memory.set_scanned(cell, true);
    meet_twice(&mut memory, cell, &[0.5]);
    look(&mut memory, cell, 0.5);
    assert_eq!((memory.holds(cell), count(&memory)), (false, 1));
    memory.set_scanned(cell, false);
    assert_eq!(count(&memory), 0);
}

#[test]
fn fg_req_028_who_went_takes_the_edges_along() {
    let place = Cell::of(Point2::new(1.0, 0.3));
    let at_x = |cells: i32| Cell { x: place.x + cells, y: place.y };
    let mut memory = memory();
    for span in 1..3 {
        for (cells, heights_m) in
            [(0, [0.40, 0.50]), (1, [0.45, 0.45]), (-1, [0.40, 0.44]), (2, [0.45, 0.45])]
        {
            heights_m.iter().for_each(|height_m| memory.meet(at_x(cells), *height_m, 0.12));
        }
        pass_span(&mut memory, span);
    }
    memory.set_scanned(place, true);
    memory.leave(place);
    let held = [-1, 0, 1, 2].map(|cells| memory.holds(at_x(cells)));
    assert_eq!(
        held,
        [true, false, false, true],
        "heights above it and its thin edge go, a board beside it stays"
    );
    assert!((0..16).all(|_| memory.check_next()));
}

#[test]
fn fg_req_028_what_one_span_meets_is_not_kept() {
    let cell = Cell::of(Point2::new(1.0, 0.3));
    let mut memory = memory();
    pass_span(&mut memory, 0);
    for _ in 0..100 {
        memory.meet(cell, 0.5, 0.05);
    }
    assert_eq!((count(&memory), memory.holds(cell)), (0, true), "not yet");
    (1..4).for_each(|span| pass_span(&mut memory, span));
    assert!(!memory.holds(cell), "and no more");
    memory.meet(cell, 0.7, 0.05);
    pass_span(&mut memory, 4);
    memory.meet(cell, 0.7, 0.05);
    assert_eq!(count(&memory), 1, "two spans agree");
    look(&mut memory, cell, 0.6);
    assert_eq!(count(&memory), 1, "the height of the first time is forgotten");
    look(&mut memory, cell, 0.7);
    assert_eq!((count(&memory), memory.holds(cell)), (0, false));
}

/// A ring crosses a level surface, and the next one comes there half a second later.
#[test]
fn fg_req_028_spans_agree_across_an_empty_one() {
    let cell = Cell::of(Point2::new(1.0, 0.3));
    for (empty, kept) in [(0, 1), (1, 1), (2, 0)] {
        let mut memory = memory();
        pass_span(&mut memory, 0);
        memory.meet(cell, 0.09, 0.05);
        (0..=empty).for_each(|span| pass_span(&mut memory, span + 1));
        memory.meet(cell, 0.09, 0.05);
        assert_eq!(count(&memory), kept, "{empty} spans between");
        assert!((0..16).all(|_| memory.check_next()));
    }
}

/// What rays have just met is not refuted by others that pass beside it.
#[test]
fn fg_req_028_met_cells_are_fresh_for_two_spans() {
    let cell = Cell::of(Point2::new(1.0, 0.3));
    let mut memory = memory();
    memory.follow(Twist2::ZERO, at(0));
    assert!(!memory.is_fresh(cell), "never met");
    memory.meet(cell, 0.5, 0.05);
    let fresh = [1, 2, 3].map(|span| (memory.is_fresh(cell), pass_span(&mut memory, span)).0);
    assert_eq!(fresh, [true, true, false]);
    assert!(memory.run(cell).ends_below_m(0.5) && !memory.run(cell).ends_below_m(0.45));
}

/// Encoders and drives are often heard last: what the lidar has met by then is known when the robot may start.
#[test]
fn fg_req_028_memory_agrees_before_wheels_are_heard() {
    let mut guard = Supervisor::new(config(), at(0)).unwrap();
    for step in 1..70 {
        guard.memory.meet(Cell::of(Point2::new(3.1, 0.3)), 0.1, 0.05);
        guard.tick(at(10 * step));
    }
    assert_eq!(count(&guard.memory), 1);
}

#[test]
fn fg_req_028_only_distance_clears_not_time() {
    let mut memory = memory();
    let place = Point2::new(1.0, -0.5);
    memory.set_scanned(Cell::of(place), true);
    for second in 0..3_600 {
        memory.follow(Twist2::ZERO, at(second * 1_000));
    }
    assert_eq!(count(&memory), 1, "an hour later");
    // Ten metres in a circle of 1.6 m radius come back to it; straight on it is lost behind.
    let mut now_ms = 3_600_000;
    let mut go = |memory: &mut LocalMemory, motion: Twist2, ms: u64| {
        for _ in 0..ms / 10 {
            now_ms += 10;
            memory.follow(motion, at(now_ms));
        }
    };
    go(&mut memory, twist(0.0, 0.8), 3_000);
    assert_eq!(count(&memory), 1, "turned on the spot");
    go(&mut memory, twist(0.0, -0.8), 3_000);
    go(&mut memory, forward(0.5), 8_000);
    assert_eq!(count(&memory), 0, "four metres ahead");
    assert!(memory.check_next());
}

#[test]
fn fg_req_028_window_moves_and_keeps_places() {
    let mut memory = memory();
    let mut random = Pcg32::new(3, 3);
    let mut now_ms = 0;
    let mut known = std::vec::Vec::new();
    for _ in 0..3_000 {
        now_ms += 10;
        let motion = twist(random.uniform_between(-0.2, 1.0), random.uniform_between(-0.8, 0.8));
        memory.follow(motion, at(now_ms));
        let pose = memory.pose_at(at(now_ms));
        let place =
            pose.transform(Point2::new(random.uniform_between(-1.0, 2.0), random.uniform_between(-1.5, 1.5)));
        memory.set_scanned(Cell::of(place), true);
        known.push(Cell::of(place));
    }
    let pose = memory.pose_at(at(now_ms));
    let mut found = std::vec::Vec::new();
    memory.for_each(|cell| found.push(cell));
    assert!(found.iter().all(|cell| known.contains(cell)), "nothing is made up");
    let near = |cell: &&Cell| cell.middle().distance(Point2::new(pose.x_m, pose.y_m)) < 0.9;
    let lately = &known[known.len() - 100..];
    assert!(lately.iter().filter(near).all(|cell| found.contains(cell)), "nothing near is lost");
    assert!(found.len() > 100, "{}", found.len());
    assert!((0..16).all(|_| memory.check_next()), "the sums hold");
}

#[test]
fn fg_req_028_a_flipped_bit_of_the_memory_is_noticed() {
    let mut memory = memory();
    for index in 0..200_u16 {
        let place = Point2::new(f32::from(index) * 0.013, f32::from(index % 40) * 0.05 - 1.0);
        memory.meet(Cell::of(place), 0.3 + f32::from(index % 9) * 0.1, 0.05);
        memory.set_scanned(Cell::of(place), index % 3 == 0);
    }
    pass_span(&mut memory, 1);
    memory.meet(Cell::of(Point2::new(0.5, 0.5)), 0.4, 0.05);
    let noticed = |memory: &mut LocalMemory| (0..16).any(|_| !memory.check_next());
    assert!(!noticed(&mut memory));
    fn word(row: &mut Row, index: usize) -> &mut u64 {
        let Row { by_lidar, by_scanner, lately: [now, last, before], passed, floor, .. } = row;
        [by_lidar, by_scanner, now, last, before, passed, floor].into_iter().nth(index).unwrap()
    }
    for row in 0..memory.rows.len() {
        for index in 0..7 {
            let bit = 1 << ((row * 7 + index * 11) % 64);
            *word(&mut memory.rows[row], index) ^= bit;
            assert!(noticed(&mut memory), "row {row}");
            *word(&mut memory.rows[row], index) ^= bit;
        }
    }
    assert!(!noticed(&mut memory));
}

#[test]
fn fg_req_028_what_the_body_stands_on_is_forgotten() {
    let mut memory = memory();
    let body = Body::around(&config().footprint);
    for (x_m, y_m) in [(0.2, 0.1), (0.9, 0.38), (0.97, 0.0), (-0.3, 0.43)] {
        memory.set_scanned(Cell::of(Point2::new(x_m, y_m)), true);
    }
    memory.forget_inside(&config().footprint, (Pose2::default(), body));
    let mut left = std::vec::Vec::new();
    memory.for_each(|cell| left.push(cell));
    assert!(!left.contains(&Cell::of(Point2::new(0.2, 0.1))), "{left:?}");
    assert_eq!(left.len(), 3, "at its edge objects stay: {left:?}");
}

#[test]
fn fg_req_028_lone_height_in_lone_cell_is_ignored() {
    let place = Cell::of(Point2::new(1.0, 0.3));
    let obstacles = |memory: &LocalMemory| {
        let mut cells = std::vec::Vec::new();
        memory.for_each_obstacle((&LidarRays::NONE, false), |cell, _| cells.push(cell));
        cells
    };
    for (dx, dy) in [(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (-1, 1), (1, -1), (-1, -1)] {
        let mut memory = memory();
        meet_twice(&mut memory, place, &[0.5]);
        assert_eq!((obstacles(&memory).len(), count(&memory)), (0, 1));
        memory.meet(place, 0.53, 0.05);
        assert_eq!(obstacles(&memory), [place], "two heights are an object");
        let mut memory = self::memory();
        meet_twice(&mut memory, place, &[0.5]);
        let beside = Cell { x: place.x + dx, y: place.y + dy };
        memory.set_scanned(beside, true);
        let found = obstacles(&memory);
        assert!(found.len() == 2 && found.contains(&place) && found.contains(&beside), "{found:?}");
        look(&mut memory, place, 0.5);
        assert_eq!(obstacles(&memory), [beside], "the scanner's stands alone");
        let apart = Cell { x: place.x + 2 * dx, y: place.y + 2 * dy };
        memory.set_scanned(beside, false);
        memory.set_scanned(apart, true);
        assert_eq!(obstacles(&memory), [apart]);
    }
}
