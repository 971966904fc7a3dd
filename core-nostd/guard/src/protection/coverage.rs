//! What the sensors of a robot can see of the room that its body goes into, and what nobody sees.
//!
//! Pure geometry of mountings, angles and ranges: no scan is needed. Ahead and behind, what counts is whether a thing is seen
//! while the robot comes near, in time to stop, because the guard's memory keeps what was seen; apart from that, whether somebody
//! who steps in from aside is seen at once. Beside the body, where its corners
//! go when it turns, a thing counts as seen only where some ray meets it now: it may have come from behind.

use heapless::Vec;

use super::config::GuardConfig;
use super::looks::LidarRays;
use super::sweep::{REACTION_S, STANDOFF_M, Stopping};
use floorguard_types::capacities::PACKET_RINGS_MAX;
use floorguard_types::geometry::{Point2, Point3, Transform3, Twist2};

/// Heights at which rays pass over a place: each ring, the scanners, and a camera's lowest.
const RAYS_MAX: usize = PACKET_RINGS_MAX + EYES_MAX;
/// Sensors beside the lidar.
pub const EYES_MAX: usize = 4;
/// Seen for this long, a thing is met by every sensor at least once, seconds: a revolution of the lidar.
const LOOK_S: f32 = 0.1;
/// The memory reaches so far from the robot's origin, ahead and behind, metres.
const MEMORY_M: [f32; 2] = [3.4, 1.4];
/// Steps of the way towards a thing, metres, and how many.
const STEP_M: f32 = 0.02;
const STEPS: usize = 170;
/// Steps of height, metres, and how many: 1.6 m.
const HEIGHT_STEP_M: f32 = 0.01;
const HEIGHTS: usize = 160;
/// A board is this thick at least, metres.
const BOARD_M: f32 = 0.03;
/// Nothing hangs lower, metres: what does stands on the floor for all that matters.
const HANGS_FROM_M: f32 = 0.10;
/// The safety scanner sees this far, metres: black clothes.
const SCANNER_RANGE_M: f32 = 3.0;
/// The lidar sees nothing nearer, metres.
const LIDAR_NEAREST_M: f32 = 0.45;
/// A depth camera tells a thing from the floor between these distances, metres, and from this height on.
const CAMERA_RANGE_M: [f32; 2] = [0.25, 2.5];
const CAMERA_THING_M: f32 = 0.02;
/// Next to the body: nearer, the body is there already, metres.
const NEXT_TO_M: f32 = 0.05;
/// Places beside a corner of the body: along it and away from it, metres.
const ALONG_M: [f32; 3] = [0.0, 0.2, 0.4];
const AWAY_M: [f32; 3] = [0.05, 0.15, 0.25];
/// Places across the body, shares of its width.
const ACROSS: [f32; 5] = [-0.5, -0.25, 0.0, 0.25, 0.5];

/// Where the body goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Region {
    /// Forward.
    Ahead,
    /// Backward.
    Rear,
    /// Where the left front corner swings.
    AheadLeft,
    /// Where the right front corner swings.
    AheadRight,
    /// Where the left rear corner swings.
    RearLeft,
    /// Where the right rear corner swings.
    RearRight,
}

impl Region {
    /// How many.
    pub const COUNT: usize = 6;
    /// All of them, in the order of their indices.
    pub const ALL: [Self; Self::COUNT] =
        [Self::Ahead, Self::Rear, Self::AheadLeft, Self::AheadRight, Self::RearLeft, Self::RearRight];

    /// In words, as a configuration names it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ahead => "ahead",
            Self::Rear => "rear",
            Self::AheadLeft => "ahead-left",
            Self::AheadRight => "ahead-right",
            Self::RearLeft => "rear-left",
            Self::RearRight => "rear-right",
        }
    }

    /// How fast a motion brings the body into it, m/s; 0 or less: it does not. `box_m`: least and greatest x and y of the body.
    #[must_use]
    pub fn speed_into_mps(self, twist: Twist2, [[rear_m, front_m], _]: [[f32; 2]; 2]) -> f32 {
        let turns = twist.angular_radps;
        match self {
            Self::Ahead => twist.linear_mps,
            Self::Rear => -twist.linear_mps,
            Self::AheadLeft => turns * front_m,
            Self::AheadRight => -turns * front_m,
            Self::RearLeft => turns * rear_m,
            Self::RearRight => -turns * rear_m,
        }
    }
}

/// A sensor beside lidar and safety scanner that looks at things.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Eye {
    /// Another scanner: its plane.
    Plane {
        /// Sensor frame in the robot frame.
        mounting: Transform3,
        /// First and last angle that it sees, radians.
        sector_rad: [f32; 2],
    },
    /// A depth camera (x right, y down, z forward in its own frame), pitched down.
    Camera {
        /// Mounting (x forward) in the robot frame.
        mounting: Transform3,
        /// Tangents of half the angles of view: across and upwards.
        half: [f32; 2],
    },
}

/// What nobody sees of a region.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// Where.
    pub region: Region,
    /// What.
    pub unseen: Unseen,
}

/// Things that nobody sees, heights in metres above the floor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Unseen {
    /// Upright things that are lower.
    Below(f32),
    /// Upright things that are lower and come into the way from aside, nearer than the robot needs to stop: people's feet.
    Moving(f32),
    /// Boards whose lower edge lies between.
    Hanging([f32; 2]),
}

/// The sensors of a robot.
#[derive(Clone, Debug)]
pub struct SensorCoverage<'a> {
    config: &'a GuardConfig,
    rays: LidarRays,
    eyes: Vec<Eye, EYES_MAX>,
    box_m: [[f32; 2]; 2],
}

type Heights = Vec<f32, RAYS_MAX>;

impl<'a> SensorCoverage<'a> {
    /// Of a configuration, with the sensors that it does not know.
    #[must_use]
    pub fn of(config: &'a GuardConfig, eyes: &[Eye]) -> Self {
        let mut rays = LidarRays::NONE;
        rays.fill(&config.lidar);
        let mut box_m = [[f32::INFINITY, f32::NEG_INFINITY]; 2];
        for corner in &config.footprint {
            for ([least_m, greatest_m], value_m) in box_m.iter_mut().zip([corner.x_m, corner.y_m]) {
                *least_m = least_m.min(value_m);
                *greatest_m = greatest_m.max(value_m);
            }
        }
        Self { config, rays, eyes: eyes.iter().take(EYES_MAX).copied().collect(), box_m }
    }

    /// Heights above a place at which some ray of some sensor passes, metres.
    #[must_use]
    pub fn heights_over(&self, place: Point2) -> Heights {
        let mut heights = Heights::new();
        let scanner = &self.config.scanner;
        let mounting = scanner.mounting.transform(Point2::default());
        let (dx, dy) = (place.x_m - mounting.x_m, place.y_m - mounting.y_m);
        if is_in_sector((dx, dy), scanner.mounting.heading_rad, scanner.sector_rad) {
            // Room for every ray of every sensor.
            let _ = heights.push(scanner.height_m);
        }
        for eye in &self.eyes {
            if let Some(height_m) = eye.height_over(place) {
                let _ = heights.push(height_m);
            }
        }
        let distance_m =
            Point2::new(place.x_m - self.rays.origin.x_m, place.y_m - self.rays.origin.y_m).norm();
        let [low_m, high_m] = self.rays.heights_m;
        if distance_m > LIDAR_NEAREST_M {
            for slope in self.rays.slopes_towards(place).iter().take(self.rays.count) {
                let height_m = self.rays.origin.z_m + slope * distance_m;
                if height_m >= low_m && height_m <= high_m {
                    let _ = heights.push(height_m);
                }
            }
        }
        heights
    }

    /// What nobody sees of a region at the drive's greatest speed, or at a lower one: upright things, boards below the lidar,
    /// boards above it.
    #[must_use]
    pub fn gaps(&self, region: Region, speed_mps: f32) -> [Option<Gap>; 4] {
        let unseen = match region {
            Region::Ahead | Region::Rear => self.unseen_on_the_way(region == Region::Rear, speed_mps),
            _ => self.unseen_beside(region),
        };
        let [low, high] = unseen.hanging();
        let moving = match region {
            Region::Ahead | Region::Rear => self.moving_unseen(region == Region::Rear, speed_mps),
            _ => None,
        };
        [unseen.upright(), moving, low, high].map(|unseen| unseen.map(|unseen| Gap { region, unseen }))
    }

    /// Least and greatest way from the edge of the body to what it sweeps until it stands, and where that edge is.
    fn stop_zone(&self, is_rear: bool, speed_mps: f32) -> (f32, f32, f32) {
        let [[rear_m, front_m], _] = self.box_m;
        let (sign, edge_m) = if is_rear { (-1.0, rear_m) } else { (1.0, front_m) };
        let twist = Twist2 { linear_mps: sign * speed_mps, angular_radps: 0.0 };
        let stopping = Stopping::from(&self.config.footprint, twist, (&self.config.drive, REACTION_S));
        (sign, edge_m, stopping.way_m() + STANDOFF_M)
    }

    /// From which height on upright things are seen at this moment, wherever the body goes until it stands.
    fn moving_unseen(&self, is_rear: bool, speed_mps: f32) -> Option<Unseen> {
        let (sign, edge_m, stops_m) = self.stop_zone(is_rear, speed_mps);
        let mut below_m = 0.0_f32;
        for share in ACROSS {
            for step in 0..STEPS {
                let ahead_m = NEXT_TO_M + step as f32 * STEP_M;
                if ahead_m > stops_m {
                    break;
                }
                let heights = self.heights_over(Point2::new(edge_m + sign * ahead_m, self.across_m(share)));
                let least_m = heights.iter().copied().fold(self.config.lidar.body_height_m, f32::min);
                below_m = below_m.max(least_m + HEIGHT_STEP_M);
            }
        }
        (below_m > LOWEST_THING_M).then_some(Unseen::Moving(below_m))
    }

    fn across_m(&self, share: f32) -> f32 {
        let [_, [right_m, left_m]] = self.box_m;
        0.5 * (right_m + left_m) + share * (left_m - right_m)
    }

    /// Of what stands or hangs in the way while the robot comes near.
    fn unseen_on_the_way(&self, is_rear: bool, speed_mps: f32) -> UnseenHeights {
        let reach_m = if is_rear { MEMORY_M[1] } else { MEMORY_M[0] };
        let (sign, edge_m, stops_m) = self.stop_zone(is_rear, speed_mps);
        let needed = LOOK_S * speed_mps;
        let mut unseen = UnseenHeights::divided_at(self.rays.origin.z_m);
        for share in ACROSS {
            let y_m = self.across_m(share);
            let (mut upright_m, mut hanging_m) = ([0.0_f32; HEIGHTS], [0.0_f32; HEIGHTS]);
            for step in 0..STEPS {
                let ahead_m = stops_m + step as f32 * STEP_M;
                if (edge_m + sign * ahead_m).abs() > reach_m {
                    break;
                }
                let heights = self.heights_over(Point2::new(edge_m + sign * ahead_m, y_m));
                count_seen(&heights, (&mut upright_m, &mut hanging_m));
            }
            unseen.add((&upright_m, &hanging_m), (needed, self.config.lidar.body_height_m));
        }
        unseen
    }

    /// Of what stands or hangs where a corner swings, at this moment.
    fn unseen_beside(&self, region: Region) -> UnseenHeights {
        let [[rear_m, front_m], [right_m, left_m]] = self.box_m;
        let (corner_x_m, inwards) = match region {
            Region::RearLeft | Region::RearRight => (rear_m, 1.0),
            _ => (front_m, -1.0),
        };
        let (side_m, outwards) = match region {
            Region::AheadLeft | Region::RearLeft => (left_m, 1.0),
            _ => (right_m, -1.0),
        };
        // The left rear corner swings to the left when the robot turns to the right; beside it, not behind it.
        let mut unseen = UnseenHeights::divided_at(self.rays.origin.z_m);
        for (along_m, away_m) in ALONG_M.iter().flat_map(|along| AWAY_M.iter().map(move |away| (along, away)))
        {
            let place = Point2::new(corner_x_m + inwards * along_m, side_m + outwards * away_m);
            let (mut upright_m, mut hanging_m) = ([0.0_f32; HEIGHTS], [0.0_f32; HEIGHTS]);
            count_seen(&self.heights_over(place), (&mut upright_m, &mut hanging_m));
            unseen.add((&upright_m, &hanging_m), (0.5 * STEP_M, self.config.lidar.body_height_m));
        }
        unseen
    }
}

/// Adds a step of the way to every height at which a thing of this place would be seen.
fn count_seen(heights: &Heights, (upright_m, hanging_m): (&mut [f32; HEIGHTS], &mut [f32; HEIGHTS])) {
    let least_m = heights.iter().copied().fold(f32::INFINITY, f32::min);
    let steps = upright_m.iter_mut().zip(hanging_m.iter_mut());
    for (index, (upright_m, hanging_m)) in steps.enumerate() {
        let height_m = index as f32 * HEIGHT_STEP_M;
        if least_m <= height_m {
            *upright_m += STEP_M;
        }
        let is_met = |ray_m: &f32| *ray_m >= height_m && *ray_m <= height_m + BOARD_M;
        if heights.iter().any(is_met) {
            *hanging_m += STEP_M;
        }
    }
}

/// The heights that are not seen at some place of a region.
struct UnseenHeights {
    below_m: f32,
    divided_m: f32,
    /// Lowest and highest edge of unseen boards, below and above the division.
    hanging_m: [[f32; 2]; 2],
}

impl UnseenHeights {
    const fn divided_at(divided_m: f32) -> Self {
        Self { below_m: 0.0, divided_m, hanging_m: [[f32::INFINITY, f32::NEG_INFINITY]; 2] }
    }

    /// Takes in a place: what is seen over less way than is needed is not seen.
    fn add(
        &mut self,
        (upright_m, hanging_m): (&[f32; HEIGHTS], &[f32; HEIGHTS]),
        (needed_m, body_m): (f32, f32),
    ) {
        let [low, high] = &mut self.hanging_m;
        for (index, (upright_m, hanging_m)) in upright_m.iter().zip(hanging_m).enumerate() {
            let height_m = index as f32 * HEIGHT_STEP_M;
            if height_m + BOARD_M > body_m {
                break;
            }
            if *upright_m < needed_m {
                self.below_m = self.below_m.max(height_m + HEIGHT_STEP_M);
            }
            if *hanging_m < needed_m && height_m >= HANGS_FROM_M {
                let [lowest_m, highest_m] = if height_m < self.divided_m { &mut *low } else { &mut *high };
                *lowest_m = lowest_m.min(height_m);
                *highest_m = highest_m.max(height_m + BOARD_M);
            }
        }
    }

    fn upright(&self) -> Option<Unseen> {
        (self.below_m > LOWEST_THING_M).then_some(Unseen::Below(self.below_m))
    }

    fn hanging(&self) -> [Option<Unseen>; 2] {
        self.hanging_m.map(|band| {
            let [lowest_m, highest_m] = band;
            (highest_m > lowest_m).then_some(Unseen::Hanging(band))
        })
    }
}

/// Lower things are driven over, metres.
const LOWEST_THING_M: f32 = 0.03;

impl Eye {
    /// The least height above a place at which it sees things.
    fn height_over(&self, place: Point2) -> Option<f32> {
        match self {
            Self::Plane { mounting, sector_rad } => {
                let floor = mounting.on_floor();
                let way = (place.x_m - floor.x_m, place.y_m - floor.y_m);
                is_in_sector(way, floor.heading_rad, *sector_rad).then_some(mounting.translation.z_m)
            }
            Self::Camera { mounting, half: [across, upwards] } => {
                let at = mounting.translation;
                let way = Point3::new(place.x_m - at.x_m, place.y_m - at.y_m, CAMERA_THING_M - at.z_m);
                let dot = |axis: usize| {
                    let [rx, ry, rz] = &mounting.rotation;
                    let part = |row: &[f32; 3]| row.get(axis).copied().unwrap_or(0.0);
                    part(rx) * way.x_m + part(ry) * way.y_m + part(rz) * way.z_m
                };
                let (depth_m, aside_m, up_m) = (dot(0), dot(1), dot(2));
                let [nearest_m, farthest_m] = CAMERA_RANGE_M;
                let is_seen = depth_m > nearest_m
                    && depth_m < farthest_m
                    && aside_m.abs() <= across * depth_m
                    && up_m.abs() <= upwards * depth_m;
                is_seen.then_some(CAMERA_THING_M)
            }
        }
    }
}

/// A way from a scanner lies in its sector and range.
fn is_in_sector((dx, dy): (f32, f32), heading_rad: f32, [first_rad, last_rad]: [f32; 2]) -> bool {
    let bearing_rad = floorguard_types::geometry::wrap_angle(libm::atan2f(dy, dx) - heading_rad);
    bearing_rad >= first_rad && bearing_rad <= last_rad && Point2::new(dx, dy).norm() < SCANNER_RANGE_M
}
