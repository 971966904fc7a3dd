//! Where the window of the memory lies, by places on the floor.

use super::memory_window::MemoryWindow;
use super::{Cell, LocalMemory};
use floorguard_types::geometry::{Point2, Twist2};
use floorguard_types::time::Stamp;

fn forward(linear_mps: f32) -> Twist2 {
    Twist2 { linear_mps, angular_radps: 0.0 }
}

struct Driven {
    memory: std::boxed::Box<LocalMemory>,
    now_ms: u64,
}

impl Driven {
    fn new() -> Self {
        let mut memory = std::boxed::Box::new(LocalMemory::EMPTY);
        memory.forget();
        let mut driven = Self { memory, now_ms: 0 };
        driven.go(Twist2::ZERO, 0.1);
        driven
    }

    fn go(&mut self, motion: Twist2, seconds: f32) {
        for _ in 0..(seconds * 100.0) as u32 {
            self.now_ms += 10;
            self.memory.follow(motion, Stamp::from_micros(1_000_000 + self.now_ms * 1_000));
        }
    }

    /// A place so far ahead of the robot's origin is kept when something is met there.
    fn keeps(&mut self, x_m: f32) -> bool {
        let cell = Cell::of(self.memory.pose().transform(Point2::new(x_m, 0.0)));
        self.memory.set_scanned(cell, true);
        let mut is_kept = false;
        self.memory.for_each(|kept| is_kept |= kept == cell);
        is_kept
    }
}

#[test]
fn fg_req_028_ground_never_driven_is_kept_behind() {
    let mut driven = Driven::new();
    assert!(!driven.keeps(-2.1) && driven.keeps(3.5));
    driven.go(forward(-0.2), 0.5);
    assert!(driven.keeps(-2.1), "a box of 10 cm is seen 2.1 m behind the origin");
    assert!(!driven.keeps(3.5) && driven.keeps(2.2));
    driven.go(forward(0.2), 0.5);
    assert!(!driven.keeps(-2.1) && driven.keeps(3.5), "at once when it drives ahead");
}

#[test]
fn fg_req_028_way_back_needs_no_ground_behind() {
    let mut driven = Driven::new();
    driven.go(forward(0.5), 8.0);
    driven.go(forward(-0.25), 4.0);
    assert!(driven.keeps(3.5) && !driven.keeps(-1.3), "a metre back of four");
    driven.go(forward(-0.25), 8.0);
    assert!(driven.keeps(-2.1), "three metres back");
}

#[test]
fn fg_req_028_turned_robot_backs_onto_new_ground() {
    let mut driven = Driven::new();
    driven.go(forward(0.5), 8.0);
    driven.go(Twist2 { linear_mps: 0.0, angular_radps: 0.8 }, 4.0);
    assert!(driven.keeps(3.5), "it stands, and may drive ahead");
    driven.go(forward(-0.2), 0.5);
    assert!(driven.keeps(-2.1));
    // The wheels of a robot that turns on the spot, or whose steering turns, say that it drives a little.
    driven.go(Twist2 { linear_mps: 0.02, angular_radps: 0.3 }, 0.5);
    assert!(driven.keeps(-2.1), "it turns, and may back again");
}

/// What leaves the window ahead while the robot backs is so far away that the lidar sees it again: a box of 8 cm from 2.7 m on.
#[test]
fn fg_req_028_what_leaves_ahead_is_seen_again() {
    for nearest_m in [1.1, 1.6, 2.1] {
        let mut driven = Driven::new();
        driven.go(forward(0.5), 8.0);
        for backed in 0..30_u8 {
            let ahead_m = nearest_m + 0.1 * f32::from(backed);
            let from_lidar_m = ahead_m - 0.5;
            assert!(driven.keeps(ahead_m) || from_lidar_m > 2.7, "{nearest_m} m: lost {ahead_m} m ahead");
            driven.go(forward(-0.2), 0.5);
        }
    }
}

#[test]
fn fg_req_028_numbers_that_are_none_move_nothing_away() {
    let mut driven = Driven::new();
    driven.go(Twist2 { linear_mps: f32::NAN, angular_radps: f32::NAN }, 0.05);
    let mut window = MemoryWindow::BEGUN;
    window.follow(Twist2 { linear_mps: f32::NAN, angular_radps: 0.0 }, 0.01);
    window.follow(Twist2 { linear_mps: f32::INFINITY, angular_radps: 0.0 }, 0.01);
    window.follow(forward(-0.2), f32::NAN);
    assert!((0.0..=1.35).contains(&window.middle_m()), "{window:?}");
}
