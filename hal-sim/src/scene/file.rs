//! The scene's part of a scenario file.

use serde::{Deserialize, Serialize};

use super::{DropTruth, Material, OccupiedCells, Scene, SceneBuilder};

/// A wall or panel.
#[derive(Clone, Debug, Deserialize, Serialize)]
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
#[derive(Clone, Debug, Deserialize, Serialize)]
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
    /// Lower face of a box, a post or a fork above the floor, metres: a board, a rail.
    #[serde(default)]
    pub from_m: f32,
    /// Surface of a box or a post.
    #[serde(default)]
    pub material: Material,
    /// It comes so long after the start, seconds, and is on no map: a trolley that is left, a door that shuts. It waits until neither
    /// the robot nor a person is in its way. None: it stands there, and on the map.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub appears_s: Option<f32>,
}

impl FurnitureFile {
    /// A matte piece that stands on the floor from the start, not turned: size and height in metres.
    #[must_use]
    pub const fn new(kind: FurnitureKind, at_m: [f32; 2], (size_m, height_m): ([f32; 2], f32)) -> Self {
        let material = Material::Matte;
        Self { kind, at_m, yaw_deg: 0.0, size_m, height_m, from_m: 0.0, material, appears_s: None }
    }

    /// From its middle to its farthest corner, metres; of some kinds more.
    #[must_use]
    pub fn reach_m(&self) -> f32 {
        match self.kind {
            // A basket of 0.9 m; a drive unit behind the tines.
            FurnitureKind::Trolley => 0.55,
            FurnitureKind::Forks => self.size_m[0] + 0.5,
            _ => 0.5 * libm::hypotf(self.size_m[0], self.size_m[1]),
        }
    }
}

/// Kinds of furniture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
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
    /// A round post; its diameter is the first size.
    Post,
    /// A pallet truck with its tines along its own x.
    Forks,
}

/// A hole in the floor: a loading dock, a stairwell.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct DropFile {
    /// Middle, metres.
    pub at_m: [f32; 2],
    /// Along its own x and y, metres.
    pub size_m: [f32; 2],
    /// Counter-clockwise, degrees.
    #[serde(default)]
    pub yaw_deg: f32,
    /// How much lower the floor is, metres.
    pub depth_m: f32,
}

impl FurnitureKind {
    /// For reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Box => "box",
            Self::Shelf => "shelf",
            Self::Table => "table",
            Self::Trolley => "trolley",
            Self::Ramp => "ramp",
            Self::Post => "post",
            Self::Forks => "forks",
        }
    }
}

/// A map that stands in the scene.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct MapFile {
    /// Description or picture of a ROS `map_server` map, beside the scenario file.
    pub file: String,
    /// Metres.
    #[serde(default = "wall_height")]
    pub height_m: f32,
}

/// Everything that stands still.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct SceneFile {
    /// Walls and panels.
    #[serde(default)]
    pub wall: Vec<WallFile>,
    /// Furniture.
    #[serde(default)]
    pub furniture: Vec<FurnitureFile>,
    /// Holes in the floor.
    #[serde(default)]
    pub drop: Vec<DropFile>,
    /// A map of walls; the loader reads it into `occupied`.
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
    /// Builds the scene as it is on the map: without what comes later.
    #[must_use]
    pub fn build(&self) -> Scene {
        self.build_with(&[])
    }

    /// Builds the scene with those of its furniture that have come since the start, by their indices, the last ones last.
    #[must_use]
    pub fn build_with(&self, came: &[usize]) -> Scene {
        let mut builder = SceneBuilder::default();
        for (wall, number) in self.wall.iter().zip(1..) {
            builder.named(format!("wall {number}"));
            builder.wall(wall.from_m, wall.to_m, wall.height_m, wall.material);
        }
        for (piece, number) in self.furniture.iter().zip(1..).filter(|(piece, _)| piece.appears_s.is_none()) {
            place(piece, number, &mut builder);
        }
        for drop in &self.drop {
            builder.hole(DropTruth {
                centre_m: drop.at_m,
                size_m: drop.size_m,
                yaw_rad: drop.yaw_deg.to_radians(),
                depth_m: drop.depth_m,
            });
        }
        if let Some(map) = &self.map {
            builder.named("map".to_owned());
            self.occupied.build(map.height_m, &mut builder);
        }
        for (index, piece) in came.iter().filter_map(|index| Some((index, self.furniture.get(*index)?))) {
            place(piece, index + 1, &mut builder);
        }
        builder.build()
    }
}

fn place(piece: &FurnitureFile, number: usize, builder: &mut SceneBuilder) {
    builder.named(format!("{} {number}", piece.kind.name()));
    let heights = (piece.from_m, piece.height_m);
    let place = (piece.at_m[0], piece.at_m[1], piece.yaw_deg.to_radians());
    let size = (piece.size_m[0], piece.size_m[1]);
    match piece.kind {
        FurnitureKind::Box => builder.cuboid(place, size, heights, piece.material),
        FurnitureKind::Shelf => builder.shelf(place, size, piece.height_m),
        FurnitureKind::Table => builder.table(place, size, piece.height_m),
        FurnitureKind::Trolley => builder.trolley(place),
        FurnitureKind::Ramp => builder.ramp(place, size, piece.height_m),
        FurnitureKind::Post => {
            builder.post((place.0, place.1), size.0 / 2.0, heights, piece.material);
        }
        FurnitureKind::Forks => builder.forks(place, size.0, heights),
    }
}
