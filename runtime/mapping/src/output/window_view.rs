//! Pictures of a sliding window and its plan.

use std::io::Cursor;

use floorguard_mapping::Occupancy;
use floorguard_mapping::sliding_window::{
    CellContent, Face, MovementArrow, OccupancyScale, Plan, PlanCell, WindowGeometry, WindowPoint,
};
use floorguard_types::geometry::{Point2, Point3};
use floorguard_types::time::Stamp;
use image::{ImageFormat, Rgb, RgbImage};

use crate::grid_map::GridMap;

/// Pixels of a cell's edge.
const CELL_PX: u32 = 4;
const PLAN_PX: u32 = 16;
/// Cells around what is known of a plan.
const MARGIN: u32 = 3;
/// Between two grids, pixels.
const GAP_PX: u32 = 8;
const PAPER: Rgb<u8> = Rgb([250, 250, 250]);
const EMPTY: Rgb<u8> = Rgb([205, 208, 212]);
const PERSON: Rgb<u8> = Rgb([214, 40, 40]);
const ARROW: Rgb<u8> = Rgb([30, 90, 220]);
/// Heights are drawn from white to black up to here, metres.
const HEIGHT_M: f32 = 2.4;

/// The colour of a place in the window's frame, if it is known.
pub type ColourOf<'a> = &'a dyn Fn(Point3) -> Option<[u8; 3]>;

/// Which heights of a plan are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlanLayer {
    /// What stands on the floor.
    Floor,
    /// What hangs above the robot.
    Ceiling,
}

fn png(image: &RgbImage) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    // Into memory: no error is possible but a picture without pixels, which is then an empty file.
    let _ = image.write_to(&mut bytes, ImageFormat::Png);
    bytes.into_inner()
}

/// Pixels row by row, three bytes each, as PNG; an empty file where they are too few.
#[must_use]
pub fn picture_png(columns: u32, rows: u32, pixels: Vec<u8>) -> Vec<u8> {
    RgbImage::from_raw(columns, rows, pixels).map(|image| png(&image)).unwrap_or_default()
}

/// The three grids beside each other as the robot sees them, left, front and right; in colours where they are known, otherwise the
/// nearer, the darker. Places of people are red. PNG.
#[must_use]
pub fn draw_faces(
    points: &[WindowPoint],
    geometry: &WindowGeometry,
    colour: Option<ColourOf<'_>>,
) -> Vec<u8> {
    let (columns, rows) = (geometry.columns() as u32, geometry.rows() as u32);
    let width = 3 * columns * CELL_PX + 2 * GAP_PX;
    let mut image = RgbImage::from_pixel(width, rows * CELL_PX, PAPER);
    for place in 0..3 {
        let from = place * (columns * CELL_PX + GAP_PX);
        fill(&mut image, [from, 0], [columns * CELL_PX, rows * CELL_PX], EMPTY);
    }
    for one in points {
        let place = match one.face {
            Face::Left => 0,
            Face::Front => 1,
            Face::Right => 2,
        };
        let (column, row) = (one.index as u32 % columns, one.index as u32 / columns);
        let grey = (55.0 * libm::hypotf(one.point.x_m, one.point.y_m)).clamp(0.0, 190.0) as u8;
        let shade = match (one.content, colour.and_then(|colour| colour(one.point))) {
            (CellContent::Person, _) => PERSON,
            (_, Some(colour)) => Rgb(colour),
            (_, None) => Rgb([grey; 3]),
        };
        // Left of the robot is left in the picture, and up is up.
        let x = place * (columns * CELL_PX + GAP_PX) + (columns - 1 - column) * CELL_PX;
        let y = (rows - 1 - row.min(rows - 1)) * CELL_PX;
        fill(&mut image, [x, y], [CELL_PX, CELL_PX], shade);
    }
    png(&image)
}

fn fill(image: &mut RgbImage, [x, y]: [u32; 2], [width, height]: [u32; 2], colour: Rgb<u8>) {
    for row in y..(y + height).min(image.height()) {
        for column in x..(x + width).min(image.width()) {
            image.put_pixel(column, row, colour);
        }
    }
}

/// Floor or ceiling from above, x to the right: unknown grey, the higher, the darker; people red, arrows blue for a second of walk.
/// PNG.
#[must_use]
pub fn draw_plan(
    plan: &Plan<Vec<PlanCell>>,
    layer: PlanLayer,
    (arrows, now): (&[MovementArrow], Stamp),
) -> Vec<u8> {
    let geometry = plan.grid().geometry();
    let (columns, rows) = (geometry.columns() as u32, geometry.rows() as u32);
    let mut image = RgbImage::from_pixel(columns * PLAN_PX, rows * PLAN_PX, EMPTY);
    for (index, cell) in plan.grid().values().iter().enumerate() {
        let height_m = match layer {
            PlanLayer::Floor => cell.floor_m(),
            PlanLayer::Ceiling => cell.ceiling_m(),
        };
        let colour = match height_m {
            _ if layer == PlanLayer::Floor && cell.is_person(now) => PERSON,
            None => continue,
            Some(height_m) => Rgb([(250.0 - 230.0 * (height_m / HEIGHT_M).clamp(0.0, 1.0)) as u8; 3]),
        };
        let (column, row) = (index as u32 % columns, index as u32 / columns);
        fill(&mut image, [column * PLAN_PX, (rows - 1 - row) * PLAN_PX], [PLAN_PX, PLAN_PX], colour);
    }
    let corner = geometry.origin_in_map();
    let pixels_per_m = PLAN_PX as f32 / geometry.resolution_m();
    for arrow in arrows {
        for step in 0..=200_u8 {
            let part = f32::from(step) / 200.0;
            let at = Point2::new(
                arrow.position_in_odometry.x_m + part * arrow.velocity_x_mps,
                arrow.position_in_odometry.y_m + part * arrow.velocity_y_mps,
            );
            let (x, y) = ((at.x_m - corner.x_m) * pixels_per_m, (at.y_m - corner.y_m) * pixels_per_m);
            if x >= 0.0 && y >= 0.0 && y < (rows * PLAN_PX) as f32 {
                let thick = if step == 0 { 5 } else { 2 };
                fill(&mut image, [x as u32, (rows * PLAN_PX) - 1 - y as u32], [thick, thick], ARROW);
            }
        }
    }
    let [low, high] = known(plan);
    let (width, height) = (high[0] - low[0], high[1] - low[1]);
    let top = rows - high[1];
    png(&image::imageops::crop_imm(
        &image,
        low[0] * PLAN_PX,
        top * PLAN_PX,
        width * PLAN_PX,
        height * PLAN_PX,
    )
    .to_image())
}

/// Columns and rows between which something is known, with a margin: the first, and the one after the last.
fn known(plan: &Plan<Vec<PlanCell>>) -> [[u32; 2]; 2] {
    let geometry = plan.grid().geometry();
    let sides = [geometry.columns() as u32, geometry.rows() as u32];
    let (mut low, mut high) = (sides, [0, 0]);
    for (index, cell) in plan.grid().values().iter().enumerate() {
        if cell.floor_m().is_some() || cell.ceiling_m().is_some() {
            let place = [index as u32 % sides[0], index as u32 / sides[0]];
            let before = place.map(|cell| cell.saturating_sub(MARGIN));
            low = [low[0].min(before[0]), low[1].min(before[1])];
            let after = [place[0] + 1 + MARGIN, place[1] + 1 + MARGIN];
            high = [high[0].max(after[0].min(sides[0])), high[1].max(after[1].min(sides[1]))];
        }
    }
    if low[0] < high[0] { [low, high] } else { [[0, 0], sides] }
}

/// The floor as a map of three values, with the order and the rounding of an occupancy export: occupied above a step of 5 cm
/// (Dalmedico et al. 2019) and where people are.
#[must_use]
pub fn plan_map(plan: &Plan<Vec<PlanCell>>, now: Stamp) -> GridMap {
    let geometry = plan.grid().geometry();
    let mut percents = vec![0; plan.grid().values().len()];
    plan.export(OccupancyScale::PUBLISHED, now, &mut percents);
    let corner = geometry.origin_in_map();
    let state = |percent: &i8| match percent {
        0 => Occupancy::Free,
        1.. => Occupancy::Occupied,
        _ => Occupancy::Unknown,
    };
    GridMap {
        columns: geometry.columns(),
        rows: geometry.rows(),
        cell_m: f64::from(geometry.resolution_m()),
        corner_m: [f64::from(corner.x_m), f64::from(corner.y_m)],
        cells: percents.iter().map(state).collect(),
    }
}
