//! A costmap of people around the robot, for planners that know nothing of people.
//!
//! Values are those of `nav_msgs/OccupancyGrid`: 100 where a body is, falling to 0 at the distance that people like to be kept.

use floorguard_recording::GridImage;
use floorguard_recording::cdr::Decoder;
use floorguard_types::geometry::{Point2, Pose2};

/// Edge of a cell, metres.
const CELL_M: f32 = 0.1;
/// Cells of a side: 12 m.
const SIDE: u16 = 120;
/// A body with its arms, metres.
const BODY_M: f32 = 0.35;
/// From here on nobody is disturbed, metres. Hall's personal distance begins at 1.2 m.
const FAR_M: f32 = 1.2;
/// Cost of a body, percent.
const BODY: f32 = 100.0;
/// People that are drawn; more than one can see.
const PEOPLE_MAX: usize = 256;
/// The class of people.
const PERSON: &str = "person";

/// Where people are, of a `vision_msgs/msg/Detection3DArray`. `None`: the message is damaged.
pub fn people(message: &[u8]) -> Option<Vec<Point2>> {
    let mut decoder = Decoder::new(message)?;
    header(&mut decoder)?;
    let count = decoder.length()?.min(PEOPLE_MAX);
    let mut people = Vec::new();
    for _ in 0..count {
        header(&mut decoder)?;
        let mut is_person = false;
        for _ in 0..decoder.length()? {
            is_person |= decoder.text()? == PERSON;
            // The score, and a pose with its covariance.
            decoder.f64s::<44>()?;
        }
        let [x_m, y_m, ..] = decoder.f64s::<10>()?;
        decoder.text()?;
        if is_person {
            people.push(Point2::new(x_m as f32, y_m as f32));
        }
    }
    Some(people)
}

fn header(decoder: &mut Decoder<'_>) -> Option<()> {
    (_, _, _) = (decoder.i32()?, decoder.u32()?, decoder.text()?);
    Some(())
}

/// Around a place, which stands on a cell's corner, so that cells keep their places while the robot drives.
pub fn cells(people: &[Point2], middle: Point2) -> (Pose2, Vec<i8>) {
    let half_m = f32::from(SIDE) / 2.0 * CELL_M;
    let corner = |at_m: f32| libm::floorf((at_m - half_m) / CELL_M) * CELL_M;
    let origin = Point2::new(corner(middle.x_m), corner(middle.y_m));
    let cost = |row: u16, column: u16| {
        let at = |cell: u16| (f32::from(cell) + 0.5) * CELL_M;
        let (x_m, y_m) = (origin.x_m + at(column), origin.y_m + at(row));
        let away = people.iter().map(|one| libm::hypotf(one.x_m - x_m, one.y_m - y_m));
        let nearest_m = away.fold(FAR_M, f32::min);
        (BODY * ((FAR_M - nearest_m) / (FAR_M - BODY_M)).clamp(0.0, 1.0)) as i8
    };
    let rows = (0..SIDE).flat_map(|row| (0..SIDE).map(move |column| (row, column)));
    let cells = rows.map(|(row, column)| cost(row, column)).collect();
    (Pose2::new(origin.x_m, origin.y_m, 0.0), cells)
}

/// The same as a map.
pub fn grid(origin: Pose2, cells: &[i8]) -> GridImage<'_> {
    GridImage { resolution_m: CELL_M, width: SIDE.into(), origin, cells }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cost_falls_from_body_to_its_distance() {
        let (origin, cells) = cells(&[Point2::new(1.0, -2.0)], Point2::new(0.03, 0.0));
        let at = |x_m: f32, y_m: f32| {
            let cell = |at_m: f32, from_m: f32| ((at_m - from_m) / CELL_M) as usize;
            cells[cell(y_m, origin.y_m) * usize::from(SIDE) + cell(x_m, origin.x_m)]
        };
        assert_eq!((at(1.0, -2.0), at(1.2, -2.0), at(2.5, -2.0), at(-5.0, 5.0)), (100, 100, 0, 0));
        let between = at(1.8, -2.0);
        assert!((30..70).contains(&between), "{between}");
        assert_eq!(cells.len(), 14_400);
    }

    #[test]
    fn no_people_is_an_empty_map() {
        assert!(cells(&[], Point2::default()).1.iter().all(|cell| *cell == 0));
        assert_eq!(people(&[0, 1, 0]), None);
    }
}
