//! What surrounded the robot at each moment of the slider, packed for the page's script.

use floorguard_types::geometry::Point2;

/// Directions around the robot, each of four degrees; the first begins behind it and they go on to its right, front and left.
const SECTORS: usize = 90;
/// A step of the distance, metres; letters reach to 6.3 m.
const STEP_M: f32 = 0.1;
/// A letter for each distance; `-` where nothing was seen.
const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._";

/// The fields that are watched together, outlines in the robot's frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Fields {
    /// The protective field.
    pub protective: Vec<Point2>,
    /// The warning field.
    pub warning: Vec<Point2>,
}

/// The nearest return in each sector as a letter; empty without any.
pub fn seen(hits: &[Point2]) -> String {
    let mut nearest = [usize::MAX; SECTORS];
    for hit in hits {
        let turn = libm::atan2f(hit.y_m, hit.x_m) / std::f32::consts::TAU + 0.5;
        let sector = (turn * SECTORS as f32) as usize % SECTORS;
        let step = libm::roundf(hit.norm() / STEP_M) as usize;
        if let Some(known) = nearest.get_mut(sector) {
            *known = step.min(*known);
        }
    }
    if hits.is_empty() {
        return String::new();
    }
    nearest.iter().map(|step| LETTERS.get(*step).map_or('-', |letter| char::from(*letter))).collect()
}

/// Pairs of outlines for a script, protective field first.
pub fn outlines(fields: &[Fields]) -> String {
    let pairs =
        fields.iter().map(|pair| format!("[{},{}]", outline(&pair.protective), outline(&pair.warning)));
    format!("[{}]", pairs.collect::<Vec<_>>().join(","))
}

/// An outline for a script: x and y of each corner in the robot's frame, centimetres.
pub fn outline(points: &[Point2]) -> String {
    let corners = points.iter().map(|point| format!("{:.0},{:.0}", point.x_m * 100.0, point.y_m * 100.0));
    format!("[{}]", corners.collect::<Vec<_>>().join(","))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Unpacked as the page's script does it.
    fn unpacked(seen: &str) -> Vec<Point2> {
        let place = |(sector, letter): (usize, char)| {
            let step = LETTERS.iter().position(|known| char::from(*known) == letter)?;
            let turn = ((sector as f32 + 0.5) / SECTORS as f32 - 0.5) * std::f32::consts::TAU;
            let (sin, cos) = libm::sincosf(turn);
            Some(Point2::new(step as f32 * STEP_M * cos, step as f32 * STEP_M * sin))
        };
        seen.chars().enumerate().filter_map(place).collect()
    }

    #[test]
    fn nearest_return_of_each_sector_survives() {
        let hits = [(2.0, 0.1), (1.0, 0.05), (-3.0, 0.2), (0.0, -4.0), (30.0, 30.0)];
        let packed = seen(&hits.map(|(x_m, y_m)| Point2::new(x_m, y_m)));
        assert_eq!((packed.len(), packed.matches('-').count()), (SECTORS, SECTORS - 3));
        for (x_m, y_m) in [(1.0, 0.05), (-3.0, 0.2), (0.0, -4.0)] {
            let place = Point2::new(x_m, y_m);
            let found = unpacked(&packed).into_iter().any(|other| other.distance(place) < 0.2);
            assert!(found, "{x_m}, {y_m}: {packed}");
        }
        assert_eq!(seen(&[]), "");
        assert_eq!(outline(&[Point2::new(0.5, -0.25)]), "[50,-25]");
    }
}
