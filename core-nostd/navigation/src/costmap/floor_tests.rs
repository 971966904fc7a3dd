//! Costs of a floor for tests.

use std::vec;
use std::vec::Vec;

use super::{CostmapLayers, Inflation, InflationConfig, InflationScratch, PeopleCost, compose};
use floorguard_mapping::{GridGeometry, Occupancy, Parabola};
use floorguard_types::geometry::Point2;

/// Costs of a floor on which some places are occupied, without zones and people.
pub(crate) fn costs_of(
    geometry: &GridGeometry,
    shape: &InflationConfig,
    is_occupied: impl Fn(Point2) -> bool,
) -> Vec<u8> {
    let fixed: Vec<Occupancy> = (0..geometry.cell_count())
        .map(|cell| if is_occupied(geometry.centre(cell)) { Occupancy::Occupied } else { Occupancy::Free })
        .collect();
    let inflation = Inflation::new(shape, geometry.resolution_m()).unwrap();
    let layers = CostmapLayers {
        geometry,
        inflation: &inflation,
        fixed: &fixed,
        observed: &[],
        zones: &[],
        people: &[],
        people_cost: PeopleCost::DEFAULT,
    };
    let mut squared_cells = vec![0; fixed.len()];
    let mut envelope = vec![Parabola::default(); geometry.columns()];
    let mut scratch = InflationScratch { squared_cells: &mut squared_cells, envelope: &mut envelope };
    let mut costs = vec![0; fixed.len()];
    compose(&layers, &mut costs, &mut scratch).unwrap();
    costs
}
