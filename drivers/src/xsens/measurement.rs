//! What one MTData2 message says.

use floorguard_types::number::{truncating_u8, truncating_u16};

use super::item::{Item, Items, LocalFrame};

/// Items of the longest message: 2,048 bytes of three at least.
const ITEMS_MAX: usize = 683;
/// Norm of a quaternion may differ from 1 by this.
const NORM_TOLERANCE: f64 = 0.01;

/// Bits of the status word.
///
/// ```
/// use floorguard_drivers::xsens::StatusWord;
///
/// let status = StatusWord(1 | 1 << 19);
/// assert!(status.self_test_passed() && status.is_clipping());
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StatusWord(pub u32);

impl StatusWord {
    /// The self-test at start passed.
    #[must_use]
    pub const fn self_test_passed(self) -> bool {
        self.bit(0)
    }

    /// The orientation filter vouches for its output.
    #[must_use]
    pub const fn filter_valid(self) -> bool {
        self.bit(1)
    }

    /// Satellites give a position.
    #[must_use]
    pub const fn satellite_fix(self) -> bool {
        self.bit(2)
    }

    /// State of the estimation of the gyroscopes' bias at standstill.
    #[must_use]
    pub const fn no_rotation(self) -> NoRotation {
        match (self.0 >> 3) & 3 {
            0 => NoRotation::Done,
            2 => NoRotation::RotationDetected,
            3 => NoRotation::Running,
            _ => NoRotation::Reserved,
        }
    }

    /// The in-run compass estimation takes the motion for representative.
    #[must_use]
    pub const fn representative_motion(self) -> bool {
        self.bit(5)
    }

    /// The device's clock follows another one.
    #[must_use]
    pub const fn clock_synchronised(self) -> bool {
        self.bit(6)
    }

    /// Accelerometer axes x, y, z driven beyond their range.
    #[must_use]
    pub const fn clipping_accelerometer(self) -> [bool; 3] {
        [self.bit(8), self.bit(9), self.bit(10)]
    }

    /// Gyroscope axes x, y, z driven beyond their range.
    #[must_use]
    pub const fn clipping_gyroscope(self) -> [bool; 3] {
        [self.bit(11), self.bit(12), self.bit(13)]
    }

    /// Magnetometer axes x, y, z driven beyond their range.
    #[must_use]
    pub const fn clipping_magnetometer(self) -> [bool; 3] {
        [self.bit(14), self.bit(15), self.bit(16)]
    }

    /// Any axis of any sensor was driven beyond its range: bits 8 to 16 and their sum, bit 19.
    #[must_use]
    pub const fn is_clipping(self) -> bool {
        self.0 & 0x0009_FF00 != 0
    }

    /// A pulse on the line SyncIn, during this sample.
    #[must_use]
    pub const fn sync_in(self) -> bool {
        self.bit(21)
    }

    /// A pulse on the line SyncOut, during this sample.
    #[must_use]
    pub const fn sync_out(self) -> bool {
        self.bit(22)
    }

    /// Number of the filter mode, 0…7.
    #[must_use]
    pub fn filter_mode(self) -> u8 {
        truncating_u8((self.0 >> 23) & 7)
    }

    const fn bit(self, number: u32) -> bool {
        (self.0 >> number) & 1 != 0
    }
}

/// Estimation of the gyroscopes' bias while the device stands still.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoRotation {
    /// Finished, or never begun.
    Done,
    /// The device turned meanwhile: no bias was estimated.
    RotationDetected,
    /// Runs.
    Running,
    /// A code without meaning.
    Reserved,
}

/// Coordinated universal time as the device believes it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UtcTime {
    /// Within the second.
    pub nanoseconds: u32,
    /// As sent.
    pub year: u16,
    /// 1…12.
    pub month: u8,
    /// 1…31.
    pub day: u8,
    /// 0…23.
    pub hour: u8,
    /// 0…59.
    pub minute: u8,
    /// 0…60.
    pub second: u8,
    /// Bit 0 date valid, 1 time of day valid, 2 leap seconds known.
    pub flags: u8,
}

/// Why a message is of no use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeasurementError {
    /// An item runs past the end.
    Overrun,
    /// An item has another length than its identifier and format say.
    Length,
    /// Not a number, or infinite.
    NotFinite,
    /// An invalid quaternion.
    Norm,
}

/// One message. What was not sent is `None`.
///
/// ```
/// use floorguard_drivers::xsens::{FrameReceiver, Measurement, StatusWord};
/// use floorguard_types::time::Stamp;
///
/// # let hex = |text: &str| -> Vec<u8> {
/// #     text.split_whitespace().map(|byte| u8::from_str_radix(byte, 16).unwrap()).collect()
/// # };
/// // The manufacturer's example: counter, fine time, acceleration, rate of turn, status.
/// let bytes = hex("FA FF 36 31 10 20 02 DF C5 10 60 04 00 45 9D A0 40 20 0C BE DC 9A FA 3F 54 9F 37 41 1C BB 70
///     80 20 0C BB AA 5C 80 3B 8C 55 01 BB 81 33 00 E0 20 04 00 00 00 81 45");
/// let mut found = None;
/// FrameReceiver::new().push(&bytes, Stamp::ZERO, |message, _| found = Measurement::decode(message.data).ok());
/// let measurement = found.unwrap();
/// assert_eq!((measurement.packet_counter, measurement.status), (Some(57_285), Some(StatusWord(0x81))));
/// let [_, _, up_mps2] = measurement.acceleration_mps2.unwrap();
/// assert!((up_mps2 - 9.795_761_11).abs() < 1.0e-8);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Measurement {
    /// Counts messages, wraps at 16 bits.
    pub packet_counter: Option<u16>,
    /// Ticks of 100 µs.
    pub sample_time_fine: Option<u32>,
    /// Seconds.
    pub sample_time_coarse: Option<u32>,
    /// By satellites, or since the start.
    pub utc: Option<UtcTime>,
    /// w, x, y, z; sensor to local frame.
    pub quaternion: Option<[f64; 4]>,
    /// The local frame of the quaternion.
    pub quaternion_frame: Option<LocalFrame>,
    /// Rotation, sensor to local frame, row by row. On the wire it stands column by column: that is how it agrees with
    /// the quaternion of the same message in recorded data.
    pub rotation_matrix: Option<[[f64; 3]; 3]>,
    /// Roll, pitch, yaw, degrees.
    pub euler_deg: Option<[f64; 3]>,
    /// Including gravity, m/s².
    pub acceleration_mps2: Option<[f64; 3]>,
    /// Without gravity, local frame, m/s².
    pub free_acceleration_mps2: Option<[f64; 3]>,
    /// Increment of velocity, m/s.
    pub delta_velocity_mps: Option<[f64; 3]>,
    /// rad/s.
    pub rate_of_turn_radps: Option<[f64; 3]>,
    /// At a higher rate than the rest, including gravity, m/s².
    pub high_rate_acceleration_mps2: Option<[f64; 3]>,
    /// At a higher rate than the rest, rad/s.
    pub high_rate_of_turn_radps: Option<[f64; 3]>,
    /// Increment of orientation.
    pub delta_quaternion: Option<[f64; 4]>,
    /// Normalised field.
    pub magnetic_field: Option<[f64; 3]>,
    /// °C.
    pub temperature_c: Option<f64>,
    /// Pa.
    pub pressure_pa: Option<u32>,
    /// Status; from the status byte only the lowest eight bits.
    pub status: Option<StatusWord>,
}

impl Measurement {
    /// Decodes the data of an MTData2 message; unknown items are skipped by their length.
    ///
    /// # Errors
    /// [`MeasurementError`]: nothing of the message is to be used.
    pub fn decode(data: &[u8]) -> Result<Self, MeasurementError> {
        let mut measurement = Self::default();
        for item in Items::new(data).take(ITEMS_MAX) {
            measurement.take(&item.map_err(|_| MeasurementError::Overrun)?)?;
        }
        Ok(measurement)
    }

    fn take(&mut self, item: &Item<'_>) -> Result<(), MeasurementError> {
        let wrong = MeasurementError::Length;
        match item.kind {
            0x0810 => self.temperature_c = Some(single(item)?),
            0x1020 => self.packet_counter = Some(truncating_u16(item.whole(2).ok_or(wrong)?)),
            0x1060 => self.sample_time_fine = Some(item.whole(4).ok_or(wrong)?),
            0x1070 => self.sample_time_coarse = Some(item.whole(4).ok_or(wrong)?),
            0x1010 => self.utc = Some(utc(item).ok_or(wrong)?),
            0x2010 => {
                self.quaternion = Some(unit_quaternion(item)?);
                self.quaternion_frame = item.local_frame;
            }
            0x2020 => {
                let [a, b, c, d, e, f, g, h, i] = vector(item)?;
                self.rotation_matrix = Some([[a, d, g], [b, e, h], [c, f, i]]);
            }
            0x2030 => self.euler_deg = Some(vector(item)?),
            0x3010 => self.pressure_pa = Some(item.whole(4).ok_or(wrong)?),
            0x4010 => self.delta_velocity_mps = Some(vector(item)?),
            0x4020 => self.acceleration_mps2 = Some(vector(item)?),
            0x4030 => self.free_acceleration_mps2 = Some(vector(item)?),
            0x4040 => self.high_rate_acceleration_mps2 = Some(vector(item)?),
            0x8040 => self.high_rate_of_turn_radps = Some(vector(item)?),
            0x8020 => self.rate_of_turn_radps = Some(vector(item)?),
            0x8030 => self.delta_quaternion = Some(unit_quaternion(item)?),
            0xC020 => self.magnetic_field = Some(vector(item)?),
            0xE010 => {
                let byte = item.whole(1).ok_or(wrong)?;
                self.status.get_or_insert(StatusWord(byte));
            }
            0xE020 => self.status = Some(StatusWord(item.whole(4).ok_or(wrong)?)),
            _ => {}
        }
        Ok(())
    }
}

fn vector<const N: usize>(item: &Item<'_>) -> Result<[f64; N], MeasurementError> {
    let numbers = item.numbers::<N>().ok_or(MeasurementError::Length)?;
    if numbers.iter().all(|number| number.is_finite()) {
        Ok(numbers)
    } else {
        Err(MeasurementError::NotFinite)
    }
}

fn utc(item: &Item<'_>) -> Option<UtcTime> {
    let &[n3, n2, n1, n0, y1, y0, month, day, hour, minute, second, flags] = item.data else { return None };
    let nanoseconds = u32::from_be_bytes([n3, n2, n1, n0]);
    Some(UtcTime { nanoseconds, year: u16::from_be_bytes([y1, y0]), month, day, hour, minute, second, flags })
}

fn single(item: &Item<'_>) -> Result<f64, MeasurementError> {
    let [number] = vector::<1>(item)?;
    Ok(number)
}

fn unit_quaternion(item: &Item<'_>) -> Result<[f64; 4], MeasurementError> {
    let quaternion = vector::<4>(item)?;
    let norm = libm::sqrt(quaternion.iter().map(|part| part * part).sum());
    if libm::fabs(norm - 1.0) <= NORM_TOLERANCE { Ok(quaternion) } else { Err(MeasurementError::Norm) }
}
