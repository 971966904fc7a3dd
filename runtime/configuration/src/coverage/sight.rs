//! What is seen of each place around the robot: at this moment, and by the time that the body comes there.

use floorguard_guard::GuardConfig;
use floorguard_types::geometry::Point2;

use super::rays::{RayHeights, SensorRays};

/// Heights of upright objects that are distinguished, metres.
pub const HEIGHTS_M: [f32; 12] = [0.03, 0.08, 0.12, 0.16, 0.20, 0.30, 0.45, 0.60, 0.80, 1.00, 1.20, 1.40];
/// A board or bar that hangs is this thick, metres.
pub const BAR_M: f32 = 0.03;
/// Lower edges of bars: from here on, in these steps, metres; one bit each. What hangs lower stands on the floor for all that matters.
const BARS_FROM_M: f32 = 0.10;
const BAR_STEP_M: f32 = 0.02;
/// How many: the last one ends at 1.39 m.
pub(super) const BARS: usize = 64;
/// A ray this near to an edge may pass beside it, metres.
const EDGE_M: f32 = 0.002;
/// The memory sees lower objects than the field: this share of the floor clearance.
const MEMORY_CLEARANCE: f32 = 0.75;
/// The memory keeps what the lidar meets this far below it, metres.
const BELOW_LIDAR_M: f32 = 0.05;
/// Seen for this long on the way, an object is known: two scans of the scanner that agree; one turn of the lidar in each of two
/// spans of 0.3 s, of three that follow each other; three pictures of the floor camera, seconds.
const SCANNER_LOOK_S: f32 = 0.1;
const LIDAR_LOOK_S: f32 = 0.5;
const CAMERA_LOOK_S: f32 = 0.3;
const BAR_LOOK_S: f32 = 0.3;

/// Side of a place, metres.
pub(super) const PLACE_M: f32 = 0.05;
/// Places along x and y, and where they begin, metres: a little more than the window of the guard's memory.
const COUNT: [usize; 2] = [92, 90];
const BEGIN_M: [f32; 2] = [-1.20, -2.25];
/// The window of the memory along x, metres: what it reaches ahead beyond the places above is not counted on.
const WINDOW_M: [f32; 2] = [-1.00, 3.39];

/// A place of the floor, counted from the corner of the area.
pub(super) type Index = [usize; 2];

/// What the sensors see over one place at this moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sight {
    /// Upright objects are met from this height on, metres; infinite where no ray passes.
    pub upright_from_m: f32,
    /// Bars that are met, one bit each.
    bars: u64,
    /// For the memory, by sensor: scanner, lidar, camera.
    kept_from_m: [f32; 3],
    kept_bars: u64,
}

impl Sight {
    pub(super) fn of(heights: &RayHeights, guard: &GuardConfig) -> Self {
        let lidar = &guard.lidar;
        let field_m = [lidar.floor_clearance_m, lidar.body_height_m];
        let below_lidar_m = lidar.mounting.translation.z_m - BELOW_LIDAR_M;
        let memory_m = [MEMORY_CLEARANCE * lidar.floor_clearance_m, lidar.body_height_m.min(below_lidar_m)];
        let within = |[low_m, high_m]: [f32; 2]| {
            let rays = heights.lidar_m.iter().copied();
            rays.filter(move |height_m| (low_m..=high_m).contains(height_m))
        };
        let scanner = || heights.scanner_m.iter().copied().filter(|height_m| *height_m > 0.0);
        let least = |rays: &mut dyn Iterator<Item = f32>| rays.fold(f32::INFINITY, f32::min) + EDGE_M;
        let scanner_from_m = least(&mut scanner());
        let camera_from_m = heights.camera_m.unwrap_or(f32::INFINITY);
        let scanner_bars = bars_met(scanner());
        Self {
            upright_from_m: least(&mut within(field_m)).min(scanner_from_m).min(camera_from_m),
            bars: bars_met(within(field_m)) | scanner_bars,
            kept_from_m: [scanner_from_m, least(&mut within(memory_m)), camera_from_m],
            kept_bars: bars_met(within(memory_m)) | scanner_bars,
        }
    }

    /// A bar whose lower edge is at this height is met.
    #[must_use]
    pub fn meets_bar(&self, lower_edge_m: f32) -> bool {
        let step = (lower_edge_m - BARS_FROM_M) / BAR_STEP_M;
        let index = step.round();
        (0.0..BARS as f32).contains(&index)
            && (step - index).abs() < 0.01
            && self.bars & (1 << index as u32) != 0
    }
}

/// Height of the lower edge of a bar, metres.
pub(super) fn lower_edge_m(bar: usize) -> f32 {
    BARS_FROM_M + bar as f32 * BAR_STEP_M
}

fn bars_met(rays: impl Iterator<Item = f32>) -> u64 {
    let mut met = 0;
    for ray_m in rays {
        for bar in 0..BARS {
            let low_m = lower_edge_m(bar);
            if (low_m + EDGE_M..=low_m + BAR_M - EDGE_M).contains(&ray_m) {
                met |= 1 << bar;
            }
        }
    }
    met
}

/// How many of [`HEIGHTS_M`] are not seen where rays begin at a height.
pub(super) fn unseen_heights(from_m: f32) -> usize {
    HEIGHTS_M.iter().filter(|height_m| **height_m < from_m).count()
}

/// What is known of a place by the time that the body comes there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Known {
    /// How many of [`HEIGHTS_M`] are unseen.
    pub(super) heights: usize,
    /// Bars that are unseen, one bit each.
    pub(super) bars: u64,
}

/// How the robot came: its speed, m/s, along x, and where an object must have been seen before, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Approach {
    /// Along x, m/s; negative backwards.
    pub(super) speed_mps: f32,
    /// x of the edge of the body with the distance that it needs to stand.
    pub(super) beyond_m: f32,
}

/// All places.
pub(super) struct SightMap {
    places: Vec<Sight>,
}

impl SightMap {
    pub(super) fn of(rays: &SensorRays, guard: &GuardConfig) -> Self {
        let sight = |index: Index| Sight::of(&rays.over(place(index)), guard);
        Self { places: indices().map(sight).collect() }
    }

    fn at(&self, index: Index) -> Option<&Sight> {
        self.places.get(position(index))
    }

    /// Not seen at this moment.
    pub(super) fn unseen_now(&self, index: Index) -> Known {
        self.at(index).map_or(Known { heights: HEIGHTS_M.len(), bars: u64::MAX }, |sight| Known {
            heights: unseen_heights(sight.upright_from_m),
            bars: !sight.bars,
        })
    }

    /// Not known of a row of places along x after the robot came along it.
    pub(super) fn unseen_after(&self, y: usize, approach: &Approach) -> Known {
        let [near_m, far_m] = if approach.speed_mps > 0.0 {
            [approach.beyond_m, WINDOW_M[1]]
        } else {
            [WINDOW_M[0], approach.beyond_m]
        };
        let (mut heights, mut bars) = ([[0_usize; HEIGHTS_M.len()]; 3], [0_usize; BARS]);
        for sight in (0..COUNT[0])
            .filter_map(|x| (near_m..=far_m).contains(&place([x, y]).x_m).then(|| self.at([x, y])).flatten())
        {
            for (counts, from_m) in heights.iter_mut().zip(sight.kept_from_m) {
                counts.iter_mut().skip(unseen_heights(from_m)).for_each(|count| *count += 1);
            }
            for (bar, count) in bars.iter_mut().enumerate() {
                *count += usize::from(sight.kept_bars & (1 << bar) != 0);
            }
        }
        let is_enough = |count: usize, look_s: f32| {
            count > 0 && count as f32 * PLACE_M >= look_s * approach.speed_mps.abs()
        };
        let sensors = heights.iter().zip([SCANNER_LOOK_S, LIDAR_LOOK_S, CAMERA_LOOK_S]);
        let unseen =
            sensors.map(|(counts, look_s)| counts.iter().filter(|count| !is_enough(**count, look_s)).count());
        let unknown = (0..BARS).filter(|bar| !is_enough(bars[*bar], BAR_LOOK_S));
        Known {
            heights: unseen.min().unwrap_or(HEIGHTS_M.len()),
            bars: unknown.fold(0, |bits, bar| bits | (1 << bar)),
        }
    }
}

/// Every place.
pub(super) fn indices() -> impl Iterator<Item = Index> {
    (0..COUNT[1]).flat_map(|y| (0..COUNT[0]).map(move |x| [x, y]))
}

/// Number of a place in the order of [`indices`].
pub(super) const fn position([x, y]: Index) -> usize {
    y * COUNT[0] + x
}

/// How many rows of places there are.
pub(super) const fn rows() -> usize {
    COUNT[1]
}

/// The middle of a place in the robot frame.
pub(super) fn place([x, y]: Index) -> Point2 {
    Point2::new(BEGIN_M[0] + (x as f32 + 0.5) * PLACE_M, BEGIN_M[1] + (y as f32 + 0.5) * PLACE_M)
}
