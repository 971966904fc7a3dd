//! From layers to costs: obstacles of the map and of the sensors, zones, inflation, people, in this order.

use floorguard_mapping::{GridGeometry, GridTooSmall, Occupancy};
use floorguard_types::motion::MovingPerson;

use super::inflation::{Inflation, InflationScratch};
use super::people_layer::{PeopleCost, add_people};
use super::view::Costs;
use super::zones::Zone;

/// What a costmap is made of.
#[derive(Clone, Copy, Debug)]
pub struct CostmapLayers<'a> {
    /// Where the cells lie.
    pub geometry: &'a GridGeometry,
    /// How obstacles are widened.
    pub inflation: &'a Inflation,
    /// The map, by cell of the same raster; empty where there is none.
    pub fixed: &'a [Occupancy],
    /// What the sensors saw, by cell of the same raster; empty where there is none.
    pub observed: &'a [Occupancy],
    /// Zones in the map frame.
    pub zones: &'a [Zone],
    /// People, present and expected.
    pub people: &'a [MovingPerson],
    /// How much they cost.
    pub people_cost: PeopleCost,
}

/// A layer of another size than the costmap.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LayerMismatch {
    /// Storage is missing.
    TooSmall(GridTooSmall),
    /// A layer has this many cells, which is neither none nor as many as the costmap.
    Layer(usize),
}

impl core::fmt::Display for LayerMismatch {
    fn fmt(&self, formatter: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::TooSmall(error) => error.fmt(formatter),
            Self::Layer(cells) => write!(formatter, "a layer of {cells} cells does not fit the costmap"),
        }
    }
}

impl core::error::Error for LayerMismatch {}

/// An obstacle of either layer is one; floor of either layer is floor; else nothing is known.
const fn combined(fixed: Occupancy, observed: Occupancy) -> u8 {
    match (fixed, observed) {
        (Occupancy::Occupied, _) | (_, Occupancy::Occupied) => Costs::LETHAL,
        (Occupancy::Free, _) | (_, Occupancy::Free) => Costs::FREE,
        _ => Costs::UNKNOWN,
    }
}

/// Writes the costs of all layers; gives how many people were left out because their numbers are not legal.
///
/// # Errors
/// See [`LayerMismatch`]; no cost was changed.
pub fn compose(
    layers: &CostmapLayers<'_>,
    costs: &mut [u8],
    scratch: &mut InflationScratch<'_>,
) -> Result<usize, LayerMismatch> {
    let geometry = layers.geometry;
    let (needed, capacity) = (geometry.cell_count(), costs.len());
    let costs = costs.get_mut(..needed).ok_or(LayerMismatch::TooSmall(GridTooSmall { needed, capacity }))?;
    for layer in [layers.fixed, layers.observed] {
        if !layer.is_empty() && layer.len() != needed {
            return Err(LayerMismatch::Layer(layer.len()));
        }
    }
    for (cell, cost) in costs.iter_mut().enumerate() {
        let of = |layer: &[Occupancy]| layer.get(cell).copied().unwrap_or(Occupancy::Unknown);
        *cost = combined(of(layers.fixed), of(layers.observed));
    }
    for zone in layers.zones {
        zone.forbid(geometry, costs);
    }
    layers.inflation.inflate(geometry, costs, scratch).map_err(LayerMismatch::TooSmall)?;
    Ok(add_people(geometry, costs, layers.people, &layers.people_cost))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::costmap::{InflationConfig, ZoneKind};
    use floorguard_mapping::Parabola;
    use floorguard_types::geometry::Point2;
    use proptest::prelude::*;
    use std::vec;
    use std::vec::Vec;

    fn costs_of(geometry: &GridGeometry, fixed: &[Occupancy], zones: &[Zone]) -> Vec<u8> {
        let inflation = Inflation::new(&InflationConfig::PUBLISHED, 0.1).unwrap();
        let layers = CostmapLayers {
            geometry,
            inflation: &inflation,
            fixed,
            observed: &[],
            zones,
            people: &[],
            people_cost: PeopleCost::DEFAULT,
        };
        let (mut squared_cells, mut envelope) = (vec![0; fixed.len()], vec![Parabola::default(); 30]);
        let mut scratch = InflationScratch { squared_cells: &mut squared_cells, envelope: &mut envelope };
        let mut costs = vec![9; fixed.len()];
        compose(&layers, &mut costs, &mut scratch).unwrap();
        costs
    }

    #[test]
    fn seen_floor_opens_unknown_and_not_walls() {
        use Occupancy::{Free, Occupied, Unknown};
        assert_eq!(combined(Unknown, Free), Costs::FREE);
        assert_eq!(combined(Occupied, Free), Costs::LETHAL);
        assert_eq!(combined(Free, Occupied), Costs::LETHAL);
        assert_eq!(combined(Free, Unknown), Costs::FREE);
        assert_eq!(combined(Unknown, Unknown), Costs::UNKNOWN);
    }

    #[test]
    fn a_forbidden_zone_is_inflated_like_a_wall() {
        let geometry = GridGeometry::new(30, 20, 0.1, Point2::default()).unwrap();
        let corners = [(1.0, 0.5), (2.0, 0.5), (2.0, 1.0), (1.0, 1.0)];
        let zone = Zone {
            corners_in_map: corners.iter().map(|&(x, y)| Point2::new(x, y)).collect(),
            kind: ZoneKind::NoGo,
        };
        let costs = costs_of(&geometry, &[Occupancy::Free; 600], &[zone]);
        let at = |x_m, y_m| costs[geometry.cell_at(Point2::new(x_m, y_m)).unwrap()];
        assert_eq!((at(1.5, 0.75), at(2.15, 0.75)), (Costs::LETHAL, Costs::INSCRIBED));
        assert_eq!(at(2.85, 0.75), Costs::FREE);
    }

    proptest! {
        /// One more obstacle never makes a cell cheaper.
        #[test]
        fn costs_grow_with_obstacles(cells in prop::collection::vec(0_usize..600, 1..20)) {
            let geometry = GridGeometry::new(30, 20, 0.1, Point2::default()).unwrap();
            let mut fixed = vec![Occupancy::Free; 600];
            let mut before = costs_of(&geometry, &fixed, &[]);
            for cell in cells {
                fixed[cell] = Occupancy::Occupied;
                let after = costs_of(&geometry, &fixed, &[]);
                prop_assert!(before.iter().zip(&after).all(|(old, new)| new >= old));
                before = after;
            }
        }
    }
}
