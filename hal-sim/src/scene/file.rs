//! The scene's part of a scenario file.

use serde::Deserialize;

use super::{Material, OccupiedCells, Scene, SceneBuilder};

/// A wall or panel.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WallFile {
    /// Metres.
    pub from_m: [f32; 2],
    /// Metres.
    pub to_m: [f32; 2],
    /// Metres.
    #[serde(default = "wall_height")]
    pub height_m: f32,
    /// Surface.
    #[serde(default)]
    pub material: Material,
}

/// A piece of furniture.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FurnitureFile {
    /// What it is.
    pub kind: FurnitureKind,
    /// Middle, metres.
    pub at_m: [f32; 2],
    /// Counter-clockwise, degrees.
    #[serde(default)]
    pub yaw_deg: f32,
    /// Along its own x and y, metres.
    #[serde(default = "unit_size")]
    pub size_m: [f32; 2],
    /// Metres; of a ramp: its rise.
    #[serde(default = "wall_height")]
    pub height_m: f32,
    /// Surface of a box.
    #[serde(default)]
    pub material: Material,
}

/// Kinds of furniture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum FurnitureKind {
    /// A solid block: a column, a pallet, a carton.
    Box,
    /// Plinth, back and boards.
    Shelf,
    /// Board on four legs.
    Table,
    /// Basket on four thin legs.
    Trolley,
    /// A slope.
    Ramp,
}

/// A map that stands in the scene.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MapFile {
    /// Description or picture of a ROS `map_server` map, beside the scenario file.
    pub file: String,
    /// Metres.
    #[serde(default = "wall_height")]
    pub height_m: f32,
}

/// Everything that stands still.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SceneFile {
    /// Walls and panels.
    #[serde(default)]
    pub wall: Vec<WallFile>,
    /// Furniture.
    #[serde(default)]
    pub furniture: Vec<FurnitureFile>,
    /// A map of walls; whoever loads the file reads it into `occupied`.
    pub map: Option<MapFile>,
    /// What the map says.
    #[serde(skip)]
    pub occupied: OccupiedCells,
}

fn wall_height() -> f32 {
    2.2
}

fn unit_size() -> [f32; 2] {
    [1.0, 1.0]
}

impl SceneFile {
    /// Builds the scene.
    #[must_use]
    pub fn build(&self) -> Scene {
        let mut builder = SceneBuilder::default();
        for wall in &self.wall {
            builder.wall(wall.from_m, wall.to_m, wall.height_m, wall.material);
        }
        for piece in &self.furniture {
            let place = (piece.at_m[0], piece.at_m[1], piece.yaw_deg.to_radians());
            let size = (piece.size_m[0], piece.size_m[1]);
            match piece.kind {
                FurnitureKind::Box => builder.cuboid(place, size, (0.0, piece.height_m), piece.material),
                FurnitureKind::Shelf => builder.shelf(place, size, piece.height_m),
                FurnitureKind::Table => builder.table(place, size, piece.height_m),
                FurnitureKind::Trolley => builder.trolley(place),
                FurnitureKind::Ramp => builder.ramp(place, size, piece.height_m),
            }
        }
        if let Some(map) = &self.map {
            self.occupied.build(map.height_m, &mut builder);
        }
        builder.build()
    }
}
