//! The costmap as planners see it.

use floorguard_mapping::{GridCoordinates, GridGeometry};
use floorguard_types::geometry::Point2;

/// The values of a costmap with a meaning of their own (package `costmap_2d`, file `cost_values.h`).
pub struct Costs;

impl Costs {
    /// Nothing near.
    pub const FREE: u8 = 0;
    /// The inscribed disc of a robot whose base point lies here touches an obstacle: a collision for every heading.
    pub const INSCRIBED: u8 = 253;
    /// An obstacle.
    pub const LETHAL: u8 = 254;
    /// Not observed.
    pub const UNKNOWN: u8 = 255;
}

/// A costmap to plan on. Invariant: as many costs as the geometry has cells.
#[derive(Clone, Copy, Debug)]
pub struct CostmapView<'a> {
    geometry: GridGeometry,
    costs: &'a [u8],
    revision: u32,
}

impl<'a> CostmapView<'a> {
    /// Costs by index of the cell; `revision` changes whenever they do. `None`: fewer costs than cells.
    #[must_use]
    pub fn new(geometry: GridGeometry, costs: &'a [u8], revision: u32) -> Option<Self> {
        let costs = costs.get(..geometry.cell_count())?;
        Some(Self { geometry, costs, revision })
    }

    /// Where the cells lie in the map frame.
    #[must_use]
    pub const fn geometry(&self) -> &GridGeometry {
        &self.geometry
    }

    /// All costs, by index.
    #[must_use]
    pub const fn costs(&self) -> &'a [u8] {
        self.costs
    }

    /// Changes whenever a cost does.
    #[must_use]
    pub const fn revision(&self) -> u32 {
        self.revision
    }

    /// Cost of a cell; [`Costs::UNKNOWN`] outside.
    #[inline]
    #[must_use]
    pub fn cost(&self, column: i32, row: i32) -> u8 {
        self.geometry
            .index(column, row)
            .and_then(|cell| self.costs.get(cell))
            .copied()
            .unwrap_or(Costs::UNKNOWN)
    }

    /// Cost at a point of the map frame; [`Costs::UNKNOWN`] outside.
    #[inline]
    #[must_use]
    pub fn cost_at(&self, point_in_map: Point2) -> u8 {
        let GridCoordinates { column, row } = self.geometry.coordinates_of(point_in_map);
        self.cost(column, row)
    }
}
