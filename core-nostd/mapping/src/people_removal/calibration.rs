//! Whether a calibration can be one: checked once, when it is loaded.

use floorguard_types::geometry::Transform3;

/// Why a calibration is refused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CalibrationError {
    /// The matrix between the sensors is no rotation: its columns are not orthonormal, or it mirrors. Calibrate again.
    NoRotation {
        /// Largest absolute row sum of RᵀR − I; at most 10⁻⁴ is taken.
        deviation: f32,
        /// Determinant; must be positive.
        determinant: f32,
    },
    /// A translation beyond 100 m, or a number that is not finite.
    Translation,
    /// A distortion coefficient beyond 100, or one that is not finite.
    Lens,
}

impl core::fmt::Display for CalibrationError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::NoRotation { deviation, determinant } => write!(
                f,
                "the matrix between camera and lidar is no rotation: RᵀR − I is {deviation} (at most 0.0001), the \
                 determinant {determinant}; calibrate again"
            ),
            Self::Translation => {
                write!(f, "the translation between camera and lidar is beyond 100 m or not finite")
            }
            Self::Lens => write!(f, "a distortion coefficient is beyond 100 or not finite"),
        }
    }
}

impl core::error::Error for CalibrationError {}

/// Largest absolute row sum of RᵀR − I.
const DEVIATION_MAX: f32 = 1.0e-4;
/// Sensors of one robot are nearer to each other.
const TRANSLATION_MAX_M: f32 = 100.0;

/// The transform, if it is rigid.
///
/// ```
/// use floorguard_mapping::people_removal::checked_mounting;
/// use floorguard_types::geometry::Transform3;
///
/// assert!(checked_mounting(Transform3::IDENTITY).is_ok());
/// let mirrored = [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// assert!(checked_mounting(Transform3 { rotation: mirrored, ..Transform3::IDENTITY }).is_err());
/// ```
///
/// # Errors
/// It is no rotation, or not finite.
pub fn checked_mounting(camera_from_lidar: Transform3) -> Result<Transform3, CalibrationError> {
    let [a, b, c] = camera_from_lidar.rotation;
    let column = |index: usize| [&a, &b, &c].map(|row| row.get(index).copied().unwrap_or(f32::NAN));
    let columns = [column(0), column(1), column(2)];
    let mut deviation = 0.0_f32;
    for (i, first) in columns.iter().enumerate() {
        let mut sum = 0.0;
        for (j, second) in columns.iter().enumerate() {
            let expected = if i == j { 1.0 } else { 0.0 };
            sum += libm::fabsf(dot(first, second) - expected);
        }
        // A NaN stays one: `max` would lose it.
        deviation = if sum.is_finite() { deviation.max(sum) } else { f32::INFINITY };
    }
    let [x, y, z] = columns;
    let determinant = dot(&cross(&x, &y), &z);
    if deviation > DEVIATION_MAX || determinant <= 0.0 {
        return Err(CalibrationError::NoRotation { deviation, determinant });
    }
    let offset = camera_from_lidar.translation;
    let near = |value: f32| value.is_finite() && libm::fabsf(value) <= TRANSLATION_MAX_M;
    if near(offset.x_m) && near(offset.y_m) && near(offset.z_m) {
        Ok(camera_from_lidar)
    } else {
        Err(CalibrationError::Translation)
    }
}

fn dot(a: &[f32; 3], b: &[f32; 3]) -> f32 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn cross(a: &[f32; 3], b: &[f32; 3]) -> [f32; 3] {
    let ([ax, ay, az], [bx, by, bz]) = (a, b);
    [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx]
}
