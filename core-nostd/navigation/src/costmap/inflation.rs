//! Inflation: the cost falls off with the distance from the nearest obstacle.
//!
//! Distance d from centre to centre of cells: 254 at 0, 253 up to the inscribed radius, then
//! trunc(252 · exp(−k (d − inscribed))) up to the inflation radius, else 0 (package `costmap_2d`, `InflationLayer`). The
//! distance comes from the exact transform instead of the published priority wave, which is wrong by up to a cell where
//! waves meet.

use floorguard_mapping::{GridGeometry, GridTooSmall, Parabola, squared_distances};
use floorguard_types::number::{exact_usize, nearest_f32, saturating_u8};

use super::view::Costs;

/// Widest inflation, cells.
pub const INFLATION_CELLS_MAX: usize = 45;
/// Costs kept by squared distance: 45² + 1.
const TABLE: usize = 2_026;

/// Shape of the fall-off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InflationConfig {
    /// Radius of the robot's inscribed disc, metres, ≥ 0.
    pub inscribed_radius_m: f32,
    /// Cost ends here, metres, ≥ the inscribed radius.
    pub inflation_radius_m: f32,
    /// Fall-off k, 1/m, > 0.
    pub decay_per_m: f32,
}

impl InflationConfig {
    /// As shipped with ROS navigation for a robot of 0.65 m: inflation 0.55 m, k = 10.
    pub const PUBLISHED: Self =
        Self { inscribed_radius_m: 0.325, inflation_radius_m: 0.55, decay_per_m: 10.0 };

    /// Cost at a distance ≥ 0, metres.
    #[must_use]
    pub fn cost_at(&self, distance_m: f32) -> u8 {
        if distance_m <= 0.0 {
            Costs::LETHAL
        } else if distance_m <= self.inscribed_radius_m {
            Costs::INSCRIBED
        } else if distance_m <= self.inflation_radius_m {
            let beyond_m = distance_m - self.inscribed_radius_m;
            // Truncation as published.
            saturating_u8(252.0 * libm::expf(-self.decay_per_m * beyond_m))
        } else {
            Costs::FREE
        }
    }
}

/// Why an inflation cannot be made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum InflationError {
    /// The radius spans more than [`INFLATION_CELLS_MAX`] cells: choose coarser cells or a smaller radius.
    TooManyCells(f32),
    /// A radius or the fall-off is negative, or not a number.
    Illegal,
}

impl core::fmt::Display for InflationError {
    fn fmt(&self, formatter: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::TooManyCells(cells) => {
                write!(formatter, "inflation over {cells} cells; the capacity is {INFLATION_CELLS_MAX}")
            }
            Self::Illegal => {
                write!(formatter, "radii and fall-off of the inflation must be positive numbers")
            }
        }
    }
}

impl core::error::Error for InflationError {}

/// Storage of the distance transform: squared distances, one a cell, and one parabola a column.
pub struct InflationScratch<'a> {
    /// One a cell; holds the squared distances in cells afterwards.
    pub squared_cells: &'a mut [u32],
    /// One a column.
    pub envelope: &'a mut [Parabola],
}

/// Costs by squared distance for one cell size.
#[derive(Clone, Debug)]
pub struct Inflation {
    table: [u8; TABLE],
}

impl Inflation {
    /// For cells of this edge.
    ///
    /// # Errors
    /// See [`InflationError`].
    pub fn new(config: &InflationConfig, resolution_m: f32) -> Result<Self, InflationError> {
        let legal = config.inscribed_radius_m >= 0.0
            && config.inflation_radius_m >= config.inscribed_radius_m
            && config.decay_per_m > 0.0
            && resolution_m > 0.0;
        if !legal {
            return Err(InflationError::Illegal);
        }
        let cells = config.inflation_radius_m / resolution_m;
        if cells.is_nan() || cells > nearest_f32(INFLATION_CELLS_MAX) {
            return Err(InflationError::TooManyCells(cells));
        }
        let mut table = [0; TABLE];
        for (squared, cost) in table.iter_mut().enumerate() {
            *cost = config.cost_at(libm::sqrtf(nearest_f32(squared)) * resolution_m);
        }
        Ok(Self { table })
    }

    /// Cost at a squared distance in cells.
    #[inline]
    #[must_use]
    pub fn cost(&self, squared_cells: u32) -> u8 {
        self.table.get(exact_usize(squared_cells)).copied().unwrap_or(Costs::FREE)
    }

    /// Raises costs around everything [`Costs::LETHAL`]. An unknown cell becomes known only where the robot could not stand
    /// anyway, from [`Costs::INSCRIBED`] on.
    ///
    /// # Errors
    /// The scratch is too small; no cost was changed.
    pub fn inflate(
        &self,
        geometry: &GridGeometry,
        costs: &mut [u8],
        scratch: &mut InflationScratch<'_>,
    ) -> Result<(), GridTooSmall> {
        let is_lethal = |cell: usize| costs.get(cell) == Some(&Costs::LETHAL);
        squared_distances(geometry, is_lethal, scratch.squared_cells, scratch.envelope)?;
        for (cost, squared) in costs.iter_mut().zip(scratch.squared_cells.iter()) {
            let inflated = self.cost(*squared);
            let is_raised = match *cost {
                Costs::UNKNOWN => inflated >= Costs::INSCRIBED,
                known => inflated > known,
            };
            if is_raised {
                *cost = inflated;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_types::geometry::Point2;
    use std::vec;

    /// The published figures for an inscribed radius of 0.325 m.
    #[test]
    fn costs_are_the_published_ones() {
        let config = InflationConfig::PUBLISHED;
        for (distance_m, cost) in [
            (0.0, 254),
            (0.2, 253),
            (0.325, 253),
            (0.35, 196),
            (0.40, 119),
            (0.45, 72),
            (0.50, 43),
            (0.55, 26),
            (0.56, 0),
        ] {
            assert_eq!(config.cost_at(distance_m), cost, "{distance_m} m");
        }
    }

    #[test]
    fn one_obstacle_is_inflated_by_the_formula() {
        let geometry = GridGeometry::new(41, 31, 0.05, Point2::default()).unwrap();
        let mut costs = vec![0; geometry.cell_count()];
        let obstacle = geometry.index(20, 15).unwrap();
        costs[obstacle] = Costs::LETHAL;
        costs[obstacle + 2] = Costs::UNKNOWN;
        costs[obstacle + 10] = Costs::UNKNOWN;
        let config = InflationConfig::PUBLISHED;
        let inflation = Inflation::new(&config, 0.05).unwrap();
        let (mut squared_cells, mut envelope) = (vec![0; costs.len()], vec![Parabola::default(); 41]);
        let mut scratch = InflationScratch { squared_cells: &mut squared_cells, envelope: &mut envelope };
        inflation.inflate(&geometry, &mut costs, &mut scratch).unwrap();
        for (cell, &cost) in costs.iter().enumerate() {
            let (here, there) = (geometry.coordinates(cell), geometry.coordinates(obstacle));
            let squared = (here.column - there.column).pow(2) + (here.row - there.row).pow(2);
            let cells = (squared as f32).sqrt();
            let expected = if cell == obstacle + 10 { Costs::UNKNOWN } else { config.cost_at(cells * 0.05) };
            assert_eq!(cost, expected, "{cell}");
        }
    }

    #[test]
    fn illegal_radii_are_refused() {
        let config = InflationConfig { inflation_radius_m: 3.0, ..InflationConfig::PUBLISHED };
        assert!(matches!(Inflation::new(&config, 0.05), Err(InflationError::TooManyCells(_))));
        let config = InflationConfig { inflation_radius_m: 0.1, ..InflationConfig::PUBLISHED };
        assert_eq!(Inflation::new(&config, 0.05).err(), Some(InflationError::Illegal));
        let config = InflationConfig { decay_per_m: f32::NAN, ..InflationConfig::PUBLISHED };
        assert_eq!(Inflation::new(&config, 0.05).err(), Some(InflationError::Illegal));
    }
}
