//! What a sensor of the machine can look at, from its mounting alone.

/// Directions in which a sensor looks.
#[derive(Clone, Debug, PartialEq)]
pub enum SensorView {
    /// Beams in the level plane of the sensor, symmetric about straight ahead.
    Plane {
        /// To the left and to the right, radians.
        half_angle_rad: f32,
        /// From beam to beam, radians.
        step_rad: f32,
    },
    /// Rings of beams all around.
    Rings {
        /// Of each ring above the horizon, radians.
        elevations_rad: Vec<f32>,
        /// From beam to beam, radians.
        step_rad: f32,
    },
    /// A pinhole camera without roll.
    Camera {
        /// Downwards from the horizon, radians.
        pitch_rad: f32,
        /// Columns and rows.
        size: [u16; 2],
        /// Focal length, pixels.
        focal_px: f32,
    },
    /// One beam straight down: a switch that feels for the floor.
    Down,
}

/// A sensor on the robot.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensor {
    /// For reports.
    pub name: String,
    /// Robot frame, metres: forward, left, up.
    pub at_m: [f32; 3],
    /// Counter-clockwise, radians.
    pub yaw_rad: f32,
    /// Where it looks.
    pub view: SensorView,
    /// Nearest and farthest that it measures, metres.
    pub range_m: [f32; 2],
    /// From the measurement to the order to brake, seconds.
    pub delay_s: f32,
    /// What is lower above the floor is indistinguishable from the floor, metres.
    pub above_floor_m: f32,
    /// It tells a hole in the floor from a floor that sends nothing back.
    pub sees_holes: bool,
    /// So many beams on an object are a sight of it.
    pub beams_min: usize,
}

/// Every so many pixels a camera's view is asked.
const STRIDE: u16 = 3;

/// Beams within this of a direction, sensor frame, radians.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Window {
    pub(crate) azimuth_rad: f32,
    pub(crate) elevation_rad: f32,
    pub(crate) half_rad: f32,
}

impl Window {
    fn azimuth_has(&self, azimuth_rad: f32) -> bool {
        // Steep views and near objects: every azimuth.
        self.half_rad + self.elevation_rad.abs() > 1.3
            || crate::motion::wrapped(azimuth_rad - self.azimuth_rad).abs()
                <= self.half_rad / libm::cosf(self.elevation_rad)
    }

    fn elevation_has(&self, elevation_rad: f32) -> bool {
        (elevation_rad - self.elevation_rad).abs() <= self.half_rad
    }
}

fn direction(azimuth_rad: f32, elevation_rad: f32) -> [f32; 3] {
    let (sin_a, cos_a) = libm::sincosf(azimuth_rad);
    let (sin_e, cos_e) = libm::sincosf(elevation_rad);
    [cos_e * cos_a, cos_e * sin_a, sin_e]
}

impl SensorView {
    /// Unit directions of the beams in a window, sensor frame.
    pub(crate) fn beams(&self, window: &Window) -> Vec<[f32; 3]> {
        match self {
            Self::Plane { half_angle_rad, step_rad } => {
                let beams = ring(0.0, *step_rad, window).into_iter();
                beams.filter(|beam| libm::atan2f(beam[1], beam[0]).abs() <= half_angle_rad + 1.0e-5).collect()
            }
            Self::Rings { elevations_rad, step_rad } => elevations_rad
                .iter()
                .flat_map(|elevation_rad| ring(*elevation_rad, *step_rad, window))
                .collect(),
            Self::Camera { pitch_rad, size, focal_px } => camera((*pitch_rad, *size, *focal_px), window),
            Self::Down => vec![[0.0, 0.0, -1.0]],
        }
    }
}

fn ring(elevation_rad: f32, step_rad: f32, window: &Window) -> Vec<[f32; 3]> {
    if !window.elevation_has(elevation_rad) {
        return Vec::new();
    }
    let count = libm::roundf(core::f32::consts::TAU / step_rad.max(1.0e-3)) as i32;
    let azimuths = (-count / 2..count - count / 2).map(|at| at as f32 * step_rad);
    azimuths
        .filter(|azimuth_rad| window.azimuth_has(*azimuth_rad))
        .map(|azimuth_rad| direction(azimuth_rad, elevation_rad))
        .collect()
}

fn camera((pitch_rad, size, focal_px): (f32, [u16; 2], f32), window: &Window) -> Vec<[f32; 3]> {
    let (sin, cos) = libm::sincosf(pitch_rad);
    let [columns, rows] = size;
    let middle = size.map(|count| (f32::from(count) - 1.0) / 2.0);
    let mut beams = Vec::new();
    for row in (0..rows).step_by(usize::from(STRIDE)) {
        for column in (0..columns).step_by(usize::from(STRIDE)) {
            let x = (f32::from(column) - middle[0]) / focal_px;
            let y = (f32::from(row) - middle[1]) / focal_px;
            let length = libm::sqrtf(1.0 + x * x + y * y);
            let beam = [cos - y * sin, -x, -sin - y * cos].map(|value| value / length);
            let azimuth_rad = libm::atan2f(beam[1], beam[0]);
            if window.azimuth_has(azimuth_rad) && window.elevation_has(libm::asinf(beam[2])) {
                beams.push(beam);
            }
        }
    }
    beams
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: Window = Window { azimuth_rad: 0.0, elevation_rad: 0.0, half_rad: 4.0 };

    #[test]
    fn devices_have_the_beams_of_their_datasheets() {
        let half_degree = 0.5_f32.to_radians();
        let scanner = SensorView::Plane { half_angle_rad: 135.0_f32.to_radians(), step_rad: half_degree };
        assert_eq!(scanner.beams(&ALL).len(), 541);
        let lidar = SensorView::Rings { elevations_rad: vec![-0.2, 0.0], step_rad: 0.4_f32.to_radians() };
        assert_eq!(lidar.beams(&ALL).len(), 2 * 900);
    }

    #[test]
    fn a_window_keeps_what_lies_in_it() {
        let half_degree = 0.5_f32.to_radians();
        let scanner = SensorView::Plane { half_angle_rad: 2.0, step_rad: half_degree };
        let window = Window { azimuth_rad: 0.5, elevation_rad: 0.05, half_rad: 0.1 };
        let beams = scanner.beams(&window);
        assert!((20..=24).contains(&beams.len()), "{}", beams.len());
        assert!(scanner.beams(&Window { elevation_rad: 0.3, ..window }).is_empty());
    }

    /// A camera that looks down by 45°: the middle of its picture meets the floor as far ahead as it is high.
    #[test]
    fn camera_view_follows_its_tilt() {
        let view = SensorView::Camera {
            pitch_rad: core::f32::consts::FRAC_PI_4,
            size: [160, 120],
            focal_px: 131.25,
        };
        let beams = view.beams(&ALL);
        let middle = beams.iter().min_by(|a, b| {
            let off = |beam: &&[f32; 3]| (beam[0] - core::f32::consts::FRAC_1_SQRT_2).abs() + beam[1].abs();
            off(a).total_cmp(&off(b))
        });
        assert!(middle.is_some_and(|beam| (beam[0] + beam[2]).abs() < 0.03), "{middle:?}");
    }
}
