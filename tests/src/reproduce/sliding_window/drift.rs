//! 100 m of driving and ten revolutions, without a scan: landmarks in the window stay where they are.

use std::fmt::Write as _;

use floorguard_mapping::sliding_window::{CellPolicy, WindowPoint};
use floorguard_types::geometry::Point3;
use floorguard_types::time::Stamp;

use super::rig::Stand;
use super::tables::RESOLUTIONS;
use super::window;

/// Metres there and back, and the swing of the turns to both sides, radians.
const LEG: f64 = 0.5;
const SWING: f64 = 0.5;
const DISTANCE: f64 = 100.0;
const TURNED: f64 = 10.0 * std::f64::consts::TAU;
/// Steps of odometry.
const STEPS: u32 = 40_000;

/// How far landmarks moved.
#[derive(Clone, Debug)]
pub struct Drift {
    /// For each edge of a cell: the largest distance of a landmark from its true place, metres; infinite if one is gone.
    pub worst: [f64; 3],
}

/// Landmarks ahead and to both sides, far enough apart that none falls onto another.
fn landmarks() -> Vec<[f64; 3]> {
    let mut places = Vec::new();
    for number in 0..9 {
        let azimuth = f64::from(number - 4) * 0.25;
        let range = if number % 2 == 0 { 1.6 } else { 2.4 };
        places.push([range * azimuth.cos(), range * azimuth.sin(), 0.213 + 0.2 * f64::from(number)]);
    }
    places
}

/// Straight legs of 0.5 m there and back while the robot swings to both sides: 100 m and ten revolutions in all.
fn stand(part: f64) -> Stand {
    let there_and_back = |way: f64, leg: f64| {
        let legs = way / leg;
        if (legs.floor() as u64).is_multiple_of(2) { legs.fract() * leg } else { (1.0 - legs.fract()) * leg }
    };
    let heading = there_and_back(TURNED * part + SWING, 2.0 * SWING) - SWING;
    Stand { x: there_and_back(DISTANCE * part, LEG), y: 0.05 * (40.0 * part).sin(), heading }
}

/// Drives, and looks for the landmarks through `read`.
///
/// # Errors
/// None in practice: the windows are built in.
pub fn drift(read: impl Fn(WindowPoint) -> WindowPoint) -> anyhow::Result<Drift> {
    let mut worst = [0.0_f64; 3];
    for (worst, resolution) in worst.iter_mut().zip(RESOLUTIONS) {
        let mut window = window(resolution, CellPolicy::Nearest)?;
        let points: Vec<Point3> =
            landmarks().iter().map(|[x, y, z]| Point3::new(*x as f32, *y as f32, *z as f32)).collect();
        window.insert_points(&points, stand(0.0).pose(), Stamp::ZERO)?;
        for step in 1..=STEPS {
            window.follow(stand(f64::from(step) / f64::from(STEPS)).pose());
        }
        let frame = window.frame_in_odometry();
        let frame =
            Stand { x: f64::from(frame.x_m), y: f64::from(frame.y_m), heading: f64::from(frame.heading_rad) };
        let found: Vec<[f64; 3]> = window
            .points()
            .map(&read)
            .map(|one| frame.place([one.point.x_m, one.point.y_m, one.point.z_m].map(f64::from)))
            .collect();
        for truth in landmarks() {
            let truth = stand(0.0).place(truth);
            let apart =
                |place: &[f64; 3]| (0..3).map(|axis| (place[axis] - truth[axis]).powi(2)).sum::<f64>().sqrt();
            *worst = worst.max(found.iter().map(apart).fold(f64::INFINITY, f64::min));
        }
    }
    Ok(Drift { worst })
}

impl Drift {
    /// At most half a cell.
    #[must_use]
    pub fn holds(&self) -> bool {
        self.worst.iter().zip(RESOLUTIONS).all(|(worst, resolution)| *worst <= 0.5 * resolution)
    }

    /// A line an edge.
    #[must_use]
    pub fn text(&self) -> String {
        let mut text =
            format!("Drift: {DISTANCE} m and ten revolutions without a scan, at most half a cell.\n");
        for (worst, resolution) in self.worst.iter().zip(RESOLUTIONS) {
            let _infallible =
                writeln!(text, "cells of {:>4.1} cm: {:.2} cm", 100.0 * resolution, 100.0 * worst);
        }
        text
    }
}
