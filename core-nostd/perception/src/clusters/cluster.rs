//! A cluster that stands out of the floor: which returns make one, and what is known of it.

use floorguard_types::geometry::Point3;
use floorguard_types::profile::{Board, Profile, Size};

/// When cells belong together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClusterLimits {
    /// Horizontal distances of neighbours may differ by this many metres.
    pub gap_m: f32,
    /// Clusters with fewer returns are dropped.
    pub points_min: u16,
    /// Returns farther than this are not grouped, metres (the outermost published ring ends at 40 m).
    pub range_max_m: f32,
    /// Clusters kept, at most those of the profile.
    pub clusters_max: usize,
    /// Provisional names, at most those of the profile.
    pub labels_max: usize,
}

impl ClusterLimits {
    /// The values of the parameters' own documentation.
    pub const DEFAULT: Self = Self {
        gap_m: 0.2,
        points_min: 5,
        range_max_m: 40.0,
        clusters_max: usize::MAX,
        labels_max: usize::MAX,
    };

    /// With the capacity of the microcontroller: the same input gives the same clusters on every machine.
    pub const AS_ON_BOARD: Self = Self {
        clusters_max: <Board as Profile>::Clusters::N,
        labels_max: <Board as Profile>::Labels::N,
        ..Self::DEFAULT
    };
}

impl Default for ClusterLimits {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// One cluster.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cluster {
    /// Returns.
    pub points: u16,
    /// Smallest x, y, z in the robot's frame, metres.
    pub lower: Point3,
    /// Largest x, y, z.
    pub upper: Point3,
    /// Mean of the returns.
    pub centroid: Point3,
    /// Horizontal distance from the sensor of the nearest return, metres.
    pub nearest_m: f32,
    /// Something nearer hides its left or its right edge.
    pub occluded: bool,
    /// Whether it moves by itself; `None` if that was not judged.
    pub moving: Option<bool>,
    hidden_edges: u16,
    sums: [f32; 3],
    /// The label that all its labels lead to.
    pub(super) root: u16,
}

/// Rings with a hidden edge that make a cluster occluded; one alone is a stray return.
const HIDDEN_EDGES_MIN: u16 = 2;

impl Cluster {
    /// A cluster of which the first return and its distance are known; it is not included yet.
    pub(crate) fn start(root: u16, (point, nearest_m): (Point3, f32)) -> Self {
        Self {
            points: 0,
            lower: point,
            upper: point,
            centroid: point,
            nearest_m,
            occluded: false,
            moving: None,
            hidden_edges: 0,
            sums: [0.0; 3],
            root,
        }
    }

    pub(crate) fn include(&mut self, point: Point3, nearest_m: f32, hidden_edges: u16) {
        let mut growth = Growth::of(self);
        growth.include(point, nearest_m, hidden_edges);
        growth.put_back(self);
    }

    pub(crate) fn finish(&mut self) {
        let count = f32::from(self.points.max(1));
        let [x, y, z] = self.sums;
        self.occluded = self.hidden_edges >= HIDDEN_EDGES_MIN;
        self.centroid = Point3::new(x / count, y / count, z / count);
    }

    /// Width, depth and height of the box around it, metres.
    #[must_use]
    pub fn extent_m(&self) -> [f32; 3] {
        [self.upper.x_m - self.lower.x_m, self.upper.y_m - self.lower.y_m, self.upper.z_m - self.lower.z_m]
    }
}

/// What of a cluster changes with each of its returns: in registers, as long as returns of the same cluster
/// follow.
#[derive(Clone, Copy)]
pub(super) struct Growth {
    points: u16,
    hidden_edges: u16,
    lower: Point3,
    upper: Point3,
    sums: [f32; 3],
    nearest_m: f32,
}

impl Growth {
    #[inline]
    pub(super) fn of(cluster: &Cluster) -> Self {
        let Cluster { points, hidden_edges, lower, upper, sums, nearest_m, .. } = *cluster;
        Self { points, hidden_edges, lower, upper, sums, nearest_m }
    }

    #[inline]
    pub(super) fn put_back(self, cluster: &mut Cluster) {
        (cluster.points, cluster.hidden_edges) = (self.points, self.hidden_edges);
        (cluster.lower, cluster.upper) = (self.lower, self.upper);
        (cluster.sums, cluster.nearest_m) = (self.sums, self.nearest_m);
    }

    #[inline]
    pub(super) fn include(&mut self, point: Point3, nearest_m: f32, hidden_edges: u16) {
        self.points = self.points.saturating_add(1);
        self.hidden_edges = self.hidden_edges.saturating_add(hidden_edges);
        let Point3 { x_m, y_m, z_m } = point;
        self.lower = Point3::new(self.lower.x_m.min(x_m), self.lower.y_m.min(y_m), self.lower.z_m.min(z_m));
        self.upper = Point3::new(self.upper.x_m.max(x_m), self.upper.y_m.max(y_m), self.upper.z_m.max(z_m));
        let [x, y, z] = self.sums;
        self.sums = [x + x_m, y + y_m, z + z_m];
        self.nearest_m = self.nearest_m.min(nearest_m);
    }
}
