//! The quadratic potential of the published planner.
//!
//! A wave that comes from two neighbours at right angles arrives as a plane wave (ROS packages `navfn` and `global_planner`,
//! class `QuadraticCalculator`): an approximation of the eikonal equation that is smoother than steps along the raster.

/// A cell that no wave has reached.
pub const UNREACHED: f32 = 1.0e10;

/// Potential of a cell with step cost `cost` ≥ 1, from the lower potential of its left and right neighbours and the lower one
/// of its upper and lower neighbours.
#[must_use]
pub fn potential(horizontal: f32, vertical: f32, cost: f32) -> f32 {
    let (lower, higher) = (horizontal.min(vertical), horizontal.max(vertical));
    let apart = higher - lower;
    if apart >= cost {
        return lower + cost;
    }
    let share = apart / cost;
    // The published fit of the plane wave.
    lower + cost * (-0.2301 * share * share + 0.5307 * share + 0.7040)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equals_the_published_values() {
        for (horizontal, vertical, cost, expected) in [
            (0.0, 0.0, 50.0, 35.2),
            (0.0, 25.0, 50.0, 45.5913),
            (0.0, 50.0, 50.0, 50.0),
            (100.0, 120.0, 53.0, 146.189),
        ] {
            assert!((potential(horizontal, vertical, cost) - expected).abs() < 1e-3);
            assert_eq!(potential(vertical, horizontal, cost), potential(horizontal, vertical, cost));
        }
        assert_eq!(potential(7.0, UNREACHED, 50.0), 57.0);
    }
}
