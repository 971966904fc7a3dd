//! `floorguard map edit`: a finished map is changed by hand.

use floorguard_host::outcome::{BadInput, WrongUsage};
use floorguard_mapping::Occupancy;
use floorguard_mapping_host::grid_map::{GridMap, Zone};
use floorguard_mapping_host::output::{check_place, map_server_files, replace_folder};

use super::arguments::{Corners, MapEditArguments};
use crate::files::grid_map;

/// Runs the command.
///
/// # Errors
/// A map that cannot be read, a crop that leaves nothing, or a folder that cannot take a map.
pub fn run(arguments: &MapEditArguments) -> anyhow::Result<()> {
    check_place(&arguments.out).map_err(|error| WrongUsage(error.to_string()))?;
    let mut map = grid_map(&arguments.map)?;
    let turn_rad = match arguments.turn_deg {
        Some(turn_deg) => turn_deg.to_radians(),
        None if arguments.to_walls => map.turn_to_walls_rad(),
        None => 0.0,
    };
    if turn_rad != 0.0 {
        map = map.turned(turn_rad);
        say!(
            "turned by {:.2}° about the map's origin: poses of the former map turn with it",
            turn_rad.to_degrees()
        );
    }
    if let Some(Corners(corners)) = arguments.crop {
        map = map.cropped(corners).ok_or_else(|| {
            BadInput(format!("nothing of the map lies there; it reaches from {}", extent(&map)))
        })?;
    }
    for (what, corners, state) in
        [("erased", &arguments.erase, Occupancy::Free), ("forgotten", &arguments.forget, Occupancy::Unknown)]
    {
        for corners in corners {
            let changed = map.fill(&rectangle(*corners), state);
            say!("{what}: {:.2} m²", area_m2(&map, changed));
        }
    }
    let mut files = Vec::new();
    if !arguments.no_go.is_empty() {
        files.extend(map_server_files(&map.mask(&arguments.no_go), "no_go"));
    }
    for zone in &arguments.no_go {
        let closed = map.fill(zone, Occupancy::Unknown);
        say!("not driven: {:.2} m²", area_m2(&map, closed));
    }
    files.extend(map_server_files(&map, "map"));
    replace_folder(&arguments.out, &files).map_err(|error| BadInput(error.to_string()))?;
    let free_m2 = map.area_m2(Occupancy::Free);
    say!("map: {} ({free_m2:.0} m² free floor, from {})", arguments.out.display(), extent(&map));
    Ok(())
}

fn rectangle(Corners([[x1, y1], [x2, y2]]): Corners) -> Zone {
    Zone(vec![[x1, y1], [x2, y1], [x2, y2], [x1, y2]])
}

fn area_m2(map: &GridMap, cells: usize) -> f64 {
    cells as f64 * map.cell_m * map.cell_m
}

fn extent(map: &GridMap) -> String {
    let [x, y] = map.corner_m;
    let (width, height) = (map.columns as f64 * map.cell_m, map.rows as f64 * map.cell_m);
    format!("{x:.2}, {y:.2} to {:.2}, {:.2} m", x + width, y + height)
}
