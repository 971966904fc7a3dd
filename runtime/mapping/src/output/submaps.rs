//! Sub-maps: the path in pieces of some metres, each with a small map in its own frame. Who corrects the graph moves the
//! frames and need not look at a beam again.

use crate::front_end::Node;
use crate::grid_map::{GridMap, GridMapConfig, build_grid_map};
use crate::refine::ScanView;
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

/// The sub-maps of a path, in its order, each made when it is asked for; pieces in which nothing was seen are left out.
pub struct SubMaps<'a> {
    nodes: &'a [Node],
    views: &'a [ScanView],
    poses: &'a [Se2],
    config: SubMapConfig,
    /// First kept scan of the next piece.
    first: usize,
}

impl<'a> SubMaps<'a> {
    /// Of kept scans and their poses in the map.
    #[must_use]
    pub const fn new(
        nodes: &'a [Node],
        views: &'a [ScanView],
        poses: &'a [Se2],
        config: SubMapConfig,
    ) -> Self {
        Self { nodes, views, poses, config, first: 0 }
    }

    /// Last kept scan of the piece that begins at one.
    fn last_of(&self, first: usize, count: usize) -> usize {
        let mut path_m = 0.0;
        for node in first..count {
            if node > first {
                path_m += self.poses[node - 1].distance(self.poses[node]);
            }
            if path_m >= self.config.path_m || node + 1 - first >= self.config.nodes_max.max(1) {
                return node;
            }
        }
        count - 1
    }

    fn sub_map(&self, [first, last]: [usize; 2]) -> Option<SubMap> {
        let pose = self.poses[first + (last - first) / 2];
        let scans = (first..=last).map(|node| (pose.between(self.poses[node]), self.views[node].returns()));
        let map = build_grid_map(scans, &self.config.grid)?;
        let times_s = [first, last].map(|node| self.nodes[node].time_s);
        Some(SubMap { first_node: first, last_node: last, pose, times_s, map })
    }
}

impl Iterator for SubMaps<'_> {
    type Item = SubMap;

    fn next(&mut self) -> Option<SubMap> {
        let count = self.nodes.len().min(self.poses.len());
        while self.first < count {
            let piece = [self.first, self.last_of(self.first, count)];
            self.first = piece[1] + 1;
            let map = self.sub_map(piece);
            if map.is_some() {
                return map;
            }
        }
        None
    }
}

/// First line of the list of the sub-maps: the names of what each further line holds, separated by spaces.
pub const INDEX_HEAD: &str = "# file x_m y_m heading_rad first_vertex last_vertex from_s to_s\n";

/// A sub-map's line of the list. File `NAME.yaml` is a `map_server` pair whose origin is in the frame of the sub-map.
#[must_use]
pub fn index_line(map: &SubMap, name: &str) -> String {
    let (pose, [from_s, to_s]) = (map.pose, map.times_s);
    format!(
        "{name}.yaml {:.6} {:.6} {:.9} {} {} {from_s:.6} {to_s:.6}\n",
        pose.x_m, pose.y_m, pose.heading_rad, map.first_node, map.last_node
    )
}
