//! A picture of a map: walls, floor, the path, and the places that were recognised.

use std::io::Cursor;

use floorguard_mapping::Occupancy;
use image::{ImageFormat, Rgb, RgbImage};

use crate::grid_map::GridMap;
use crate::pose_graph::{Edge, EdgeKind};
use crate::se2::Se2;

/// What is drawn.
#[derive(Clone, Copy, Debug)]
pub struct Picture<'a> {
    /// Black walls, white floor, grey for what was not seen.
    pub map: &'a GridMap,
    /// The path, blue; its start green, its end orange.
    pub path: &'a [Se2],
    /// Poses of the graph.
    pub poses: &'a [Se2],
    /// Its edges; loops are drawn red.
    pub edges: &'a [Edge],
}

/// A picture is enlarged up to so many pixels a side, by whole numbers...
const SIDE_PX: usize = 1_600;
/// ... up to this factor.
const FACTOR_MAX: usize = 4;
const PATH: Rgb<u8> = Rgb([30, 100, 220]);
const LOOP: Rgb<u8> = Rgb([220, 40, 40]);
const START: Rgb<u8> = Rgb([30, 160, 60]);
const END: Rgb<u8> = Rgb([240, 140, 20]);

struct Canvas<'a> {
    image: RgbImage,
    map: &'a GridMap,
    factor: usize,
}

/// Draws it; PNG.
#[must_use]
pub fn draw(picture: &Picture<'_>) -> Vec<u8> {
    let map = picture.map;
    let factor = (SIDE_PX / map.columns.max(map.rows).max(1)).clamp(1, FACTOR_MAX);
    let image = RgbImage::from_fn((map.columns * factor) as u32, (map.rows * factor) as u32, |x, y| {
        let (column, row) = (x as usize / factor, map.rows - 1 - y as usize / factor);
        match map.at(column as i64, row as i64) {
            Occupancy::Free => Rgb([255, 255, 255]),
            Occupancy::Unknown => Rgb([205, 208, 212]),
            Occupancy::Occupied => Rgb([20, 24, 28]),
        }
    });
    let mut canvas = Canvas { image, map, factor };
    for pair in picture.path.windows(2) {
        canvas.line(pair[0], pair[1], PATH);
    }
    for edge in picture.edges.iter().filter(|edge| edge.kind == EdgeKind::Loop) {
        if let (Some(from), Some(to)) = (picture.poses.get(edge.from), picture.poses.get(edge.to)) {
            canvas.line(*from, *to, LOOP);
            canvas.dot(*from, 2, LOOP);
            canvas.dot(*to, 2, LOOP);
        }
    }
    if let (Some(first), Some(last)) = (picture.path.first(), picture.path.last()) {
        canvas.dot(*first, 5, START);
        canvas.dot(*last, 5, END);
    }
    let mut bytes = Cursor::new(Vec::new());
    // Into memory: no error is possible but a picture without pixels, which is then an empty file.
    let _ = canvas.image.write_to(&mut bytes, ImageFormat::Png);
    bytes.into_inner()
}

impl Canvas<'_> {
    fn pixel(&self, pose: Se2) -> [f64; 2] {
        let pixels = self.factor as f64 / self.map.cell_m;
        let height = (self.map.rows * self.factor) as f64;
        [(pose.x_m - self.map.corner_m[0]) * pixels, height - (pose.y_m - self.map.corner_m[1]) * pixels]
    }

    fn put(&mut self, x: f64, y: f64, colour: Rgb<u8>) {
        let (x, y) = (x.floor(), y.floor());
        if x >= 0.0 && y >= 0.0 && x < f64::from(self.image.width()) && y < f64::from(self.image.height()) {
            self.image.put_pixel(x as u32, y as u32, colour);
        }
    }

    fn line(&mut self, from: Se2, to: Se2, colour: Rgb<u8>) {
        let ([x0, y0], [x1, y1]) = (self.pixel(from), self.pixel(to));
        let steps = (x1 - x0).abs().max((y1 - y0).abs()).ceil().clamp(1.0, 100_000.0);
        for step in 0..=steps as u32 {
            let share = f64::from(step) / steps;
            let (x, y) = (x0 + share * (x1 - x0), y0 + share * (y1 - y0));
            self.put(x, y, colour);
            self.put(x + 1.0, y, colour);
            self.put(x, y + 1.0, colour);
        }
    }

    fn dot(&mut self, pose: Se2, radius_px: i32, colour: Rgb<u8>) {
        let [x, y] = self.pixel(pose);
        for dy in -radius_px..=radius_px {
            for dx in -radius_px..=radius_px {
                if dx * dx + dy * dy <= radius_px * radius_px {
                    self.put(x + f64::from(dx), y + f64::from(dy), colour);
                }
            }
        }
    }
}
