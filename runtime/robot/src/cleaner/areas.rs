//! Areas that an operator draws on the map: what a mission cleans, where the robot never drives, where it drives slowly.
//!
//! They serve the mission. They are no safety function: the guard does not know them, and a robot that does not know where it
//! is may enter one.

use anyhow::ensure;
use floorguard_types::geometry::Point2;
use serde::{Deserialize, Serialize};

/// Areas of a plan at most.
pub const AREAS_MAX: usize = 32;
/// Corners of an area at most.
const CORNERS_MAX: usize = 32;
/// Letters of a name at most.
const NAME_MAX: usize = 40;
/// Corners lie within this distance of the map's origin, metres.
const FAR_M: f32 = 2_000.0;

/// What an area is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum AreaKind {
    /// A mission that names it cleans only there.
    Clean,
    /// The robot does not drive there.
    NoGo,
    /// The robot drives slowly there.
    Slow,
}

/// An area of the map.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Area {
    /// Its name; no other area has it.
    pub name: String,
    /// What it is for.
    pub kind: AreaKind,
    /// Corners in order, map frame, metres.
    pub corners_m: Vec<[f32; 2]>,
}

impl Area {
    /// The place lies in it. Even-odd rule: a polygon that crosses itself has holes.
    #[must_use]
    pub fn contains(&self, place: Point2) -> bool {
        let next = self.corners_m.iter().cycle().skip(1);
        let crossings = self.corners_m.iter().zip(next).filter(|([ax_m, ay_m], [bx_m, by_m])| {
            let spans = (*ay_m > place.y_m) != (*by_m > place.y_m);
            spans && place.x_m < ax_m + (bx_m - ax_m) * (place.y_m - ay_m) / (by_m - ay_m)
        });
        crossings.count() % 2 == 1
    }

    fn check(&self) -> anyhow::Result<()> {
        let name = self.name.trim();
        ensure!(!name.is_empty(), "an area needs a name");
        ensure!(
            name.chars().count() <= NAME_MAX && !name.chars().any(char::is_control),
            "a name has {NAME_MAX} letters at most"
        );
        let corners = self.corners_m.len();
        ensure!(
            (3..=CORNERS_MAX).contains(&corners),
            "{name}: {corners} corners; an area has 3 to {CORNERS_MAX}"
        );
        let is_near = |metres: &f32| metres.is_finite() && metres.abs() <= FAR_M;
        ensure!(self.corners_m.iter().flatten().all(is_near), "{name}: a corner lies nowhere near the map");
        Ok(())
    }
}

/// Refuses areas that a plan cannot have.
///
/// # Errors
/// Too many, two of one name, or one without a name or with too few or too many corners.
pub fn check_areas(areas: &[Area]) -> anyhow::Result<()> {
    ensure!(areas.len() <= AREAS_MAX, "{} areas; {AREAS_MAX} at most", areas.len());
    for (index, area) in areas.iter().enumerate() {
        area.check()?;
        let twice = areas.iter().take(index).any(|other| other.name.trim() == area.name.trim());
        ensure!(!twice, "two areas are called {}", area.name);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(name: &str, corners_m: &[[f32; 2]]) -> Area {
        Area { name: name.to_owned(), kind: AreaKind::NoGo, corners_m: corners_m.to_vec() }
    }

    #[test]
    fn polygon_contains_its_inside_only() {
        let l_shape = area("L", &[[0.0, 0.0], [4.0, 0.0], [4.0, 1.0], [1.0, 1.0], [1.0, 4.0], [0.0, 4.0]]);
        for (x_m, y_m, inside) in
            [(0.5, 0.5, true), (3.5, 0.5, true), (0.5, 3.5, true), (2.0, 2.0, false), (-0.1, 0.5, false)]
        {
            assert_eq!(l_shape.contains(Point2::new(x_m, y_m)), inside, "{x_m} {y_m}");
        }
    }

    #[test]
    fn unusable_areas_are_refused() {
        let good = area("hall", &[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]);
        assert!(check_areas(std::slice::from_ref(&good)).is_ok());
        assert!(check_areas(&[good.clone(), good.clone()]).is_err(), "two of one name");
        assert!(check_areas(&vec![good.clone(); AREAS_MAX + 1]).is_err());
        assert!(check_areas(&[area("line", &[[0.0, 0.0], [1.0, 0.0]])]).is_err());
        assert!(check_areas(&[area("  ", &good.corners_m)]).is_err());
        assert!(check_areas(&[area("far", &[[0.0, 0.0], [f32::NAN, 0.0], [1.0, 1.0]])]).is_err());
    }
}
