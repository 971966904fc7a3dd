//! The binary frame that the robot asks for (book, VectorNav: Frames).

use floorguard_types::number::truncating_usize;

/// How the frame begins: sync, groups 1 (common) and 3 (IMU), and their fields: time since start-up, angular rate and acceleration;
/// saturation.
pub const HEADER: [u8; 6] = [0xFA, 0x05, 0x21, 0x01, 0x00, 0x08];
/// Header, time, two vectors, saturation, checksum.
pub const FRAME_BYTES: usize = 42;
/// Axes of the accelerometer and of the gyroscope in the saturation field; the lowest three bits are the magnetometer's.
const SATURATED: u16 = 0x01F8;

/// One sample as the device puts it: x as printed on it, y to the right, z down.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Measurement {
    /// Since the device started, nanoseconds.
    pub since_start_ns: u64,
    /// rad/s.
    pub angular_radps: [f32; 3],
    /// Including gravity, m/s²: lying flat it measures −9.81 along z.
    pub linear_mps2: [f32; 3],
    /// Bits of the axes that are driven beyond their range: magnetometer, accelerometer, gyroscope, three each.
    pub saturation: u16,
}

/// A number of the frame is infinite or none at all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NotFinite;

impl Measurement {
    /// Reads what stands between header and checksum.
    ///
    /// # Errors
    /// [`NotFinite`]: nothing of the frame is to be used.
    pub fn decode(payload: &[u8; 34]) -> Result<Self, NotFinite> {
        let byte = |at: u32| payload.get(truncating_usize(at)).copied().unwrap_or_default();
        let number = |at: u32| {
            let bytes = [0, 1, 2, 3].map(|step: u32| byte(at.saturating_add(step)));
            f32::from_le_bytes(bytes)
        };
        let vector = |at: u32| [0, 4, 8].map(|step: u32| number(at.saturating_add(step)));
        let (angular_radps, linear_mps2) = (vector(8), vector(20));
        if !angular_radps.iter().chain(&linear_mps2).all(|number| number.is_finite()) {
            return Err(NotFinite);
        }
        let since_start_ns = u64::from_le_bytes([0, 1, 2, 3, 4, 5, 6, 7].map(byte));
        Ok(Self {
            since_start_ns,
            angular_radps,
            linear_mps2,
            saturation: u16::from_le_bytes([byte(32), byte(33)]),
        })
    }

    /// An axis of the accelerometer or of the gyroscope is driven beyond its range.
    #[must_use]
    pub const fn is_saturated(&self) -> bool {
        self.saturation & SATURATED != 0
    }
}
