//! Sub-maps: the path in pieces of some metres, each with a small map in its own frame. Who corrects the graph moves the
//! frames and need not look at a beam again.

use std::fmt::Write as _;

use crate::front_end::Node;
use crate::grid_map::{GridMap, GridMapConfig, build_grid_map};
use crate::se2::Se2;

/// How the path is cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SubMapConfig {
    /// Metres of path in one.
    pub path_m: f64,
    /// Kept scans in one at most.
    pub nodes_max: usize,
    /// Their maps.
    pub grid: GridMapConfig,
}

impl Default for SubMapConfig {
    fn default() -> Self {
        Self { path_m: 10.0, nodes_max: 100, grid: GridMapConfig::default() }
    }
}

/// A piece of the path with its map.
#[derive(Clone, Debug, PartialEq)]
pub struct SubMap {
    /// First kept scan, by its number in the graph.
    pub first_node: usize,
    /// Last kept scan.
    pub last_node: usize,
    /// Its frame in the map: the pose of the scan in the middle.
    pub pose: Se2,
    /// Time of the first and of the last scan, seconds.
    pub times_s: [f64; 2],
    /// The map, in its own frame.
    pub map: GridMap,
}

/// Cuts the path; pieces in which nothing was seen are left out. `poses` are those of the kept scans.
#[must_use]
pub fn sub_maps(nodes: &[Node], poses: &[Se2], config: &SubMapConfig) -> Vec<SubMap> {
    let mut maps = Vec::new();
    let (mut first, mut path_m) = (0, 0.0);
    let count = nodes.len().min(poses.len());
    for node in 0..count {
        if node > first {
            path_m += poses[node - 1].distance(poses[node]);
        }
        let is_full = path_m >= config.path_m || node + 1 - first >= config.nodes_max.max(1);
        if is_full || node + 1 == count {
            maps.extend(sub_map(nodes, poses, [first, node], &config.grid));
            (first, path_m) = (node + 1, 0.0);
        }
    }
    maps
}

fn sub_map(nodes: &[Node], poses: &[Se2], [first, last]: [usize; 2], grid: &GridMapConfig) -> Option<SubMap> {
    let pose = poses[first + (last - first) / 2];
    let scans = (first..=last).map(|node| (pose.between(poses[node]), &*nodes[node].points));
    let map = build_grid_map(scans, grid)?;
    Some(SubMap {
        first_node: first,
        last_node: last,
        pose,
        times_s: [nodes[first].time_s, nodes[last].time_s],
        map,
    })
}

/// The list of the sub-maps: a line of names, then a line each, separated by spaces. File `NAME.yaml` is a `map_server`
/// pair whose origin is in the frame of the sub-map.
#[must_use]
pub fn index_text(maps: &[SubMap], names: &[String]) -> String {
    let mut text = String::from("# file x_m y_m heading_rad first_vertex last_vertex from_s to_s\n");
    for (map, name) in maps.iter().zip(names) {
        let (pose, [from_s, to_s]) = (map.pose, map.times_s);
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{name}.yaml {:.6} {:.6} {:.9} {} {} {from_s:.6} {to_s:.6}",
            pose.x_m, pose.y_m, pose.heading_rad, map.first_node, map.last_node
        );
    }
    text
}
