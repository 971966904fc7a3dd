//! The blocks of a message (book, microScan3: Blocks).

use floorguard_types::number::nearest_f32;

/// Beams of the finest resolution.
const BEAMS_MAX: usize = 2_751;
/// Counts of a degree: 2²².
const PER_DEGREE: f32 = 4_194_304.0;
/// Cut-off paths in the intrusion block.
const PATHS: usize = 24;

/// Where beams look and what a count is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Geometry {
    /// Millimetres of a count.
    pub factor_mm: u16,
    /// Beams of a scan.
    pub beams: u16,
    /// From scan to scan, milliseconds.
    pub scan_time_ms: u16,
    /// Of the first beam, degrees in the device's polar frame.
    pub start_deg: f32,
    /// From beam to beam, degrees.
    pub resolution_deg: f32,
    /// From beam to beam, microseconds.
    pub beam_period_us: u32,
}

impl Geometry {
    pub(super) fn new_checked(block: &[u8]) -> Option<Self> {
        let &[f0, f1, b0, b1, t0, t1, _, _, s0, s1, s2, s3, r0, r1, r2, r3, p0, p1, p2, p3] =
            block.first_chunk::<20>()?;
        let degrees = |bytes| nearest_f32(i32::from_le_bytes(bytes)) / PER_DEGREE;
        Some(Self {
            factor_mm: u16::from_le_bytes([f0, f1]),
            beams: u16::from_le_bytes([b0, b1]),
            scan_time_ms: u16::from_le_bytes([t0, t1]),
            start_deg: degrees([s0, s1, s2, s3]),
            resolution_deg: degrees([r0, r1, r2, r3]),
            beam_period_us: u32::from_le_bytes([p0, p1, p2, p3]),
        })
    }
}

/// Flags of a beam.
///
/// ```
/// use floorguard_drivers::microscan3::BeamStatus;
///
/// let blinded = BeamStatus(0b101);
/// assert!(blinded.is_valid() && blinded.has_glare() && !blinded.is_infinite());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BeamStatus(pub u8);

impl BeamStatus {
    /// The distance was measured.
    #[must_use]
    pub const fn is_valid(self) -> bool {
        self.0 & 1 != 0
    }

    /// Nothing came back.
    #[must_use]
    pub const fn is_infinite(self) -> bool {
        self.0 & 2 != 0
    }

    /// Dazzled.
    #[must_use]
    pub const fn has_glare(self) -> bool {
        self.0 & 4 != 0
    }

    /// A reflector.
    #[must_use]
    pub const fn is_reflector(self) -> bool {
        self.0 & 8 != 0
    }

    /// The window is too dirty here.
    #[must_use]
    pub const fn is_contaminated(self) -> bool {
        self.0 & 16 != 0
    }

    /// The window is getting dirty here.
    #[must_use]
    pub const fn warns_of_contamination(self) -> bool {
        self.0 & 32 != 0
    }
}

/// The beams of a scan, in the order of the wire.
#[derive(Clone, Copy, Debug)]
pub struct Measured<'a> {
    beams: &'a [u8],
}

impl<'a> Measured<'a> {
    pub(super) fn new_checked(block: &'a [u8]) -> Option<Self> {
        let (count, rest) = block.split_first_chunk::<4>()?;
        let count = usize::try_from(u32::from_le_bytes(*count)).ok().filter(|count| *count <= BEAMS_MAX)?;
        // At most 2,751 times four.
        Some(Self { beams: rest.get(..count.saturating_mul(4))? })
    }

    /// Distance in counts of [`Geometry::factor_mm`], signal strength, flags.
    pub fn beams(&self) -> impl ExactSizeIterator<Item = (u16, u8, BeamStatus)> + Clone + use<'a> {
        self.beams.chunks_exact(4).map(|beam| match *beam {
            [low, high, strength, status] => (u16::from_le_bytes([low, high]), strength, BeamStatus(status)),
            _ => (0, 0, BeamStatus(0)),
        })
    }
}

/// General state of the device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DeviceStatus {
    bytes: [u8; 16],
}

impl DeviceStatus {
    pub(super) fn new_checked(block: &[u8]) -> Option<Self> {
        block.first_chunk::<16>().map(|bytes| Self { bytes: *bytes })
    }

    const fn state(self, bit: u8) -> bool {
        self.bytes[0] >> bit & 1 != 0
    }

    /// It measures and watches its fields.
    #[must_use]
    pub const fn runs(self) -> bool {
        self.state(0)
    }

    /// It waits.
    #[must_use]
    pub const fn stands_by(self) -> bool {
        self.state(1)
    }

    /// The window is getting dirty.
    #[must_use]
    pub const fn warns_of_contamination(self) -> bool {
        self.state(2)
    }

    /// The window is too dirty.
    #[must_use]
    pub const fn is_contaminated(self) -> bool {
        self.state(3)
    }

    /// The reference contour has moved.
    #[must_use]
    pub const fn contour_moved(self) -> bool {
        self.state(4)
    }

    /// Somebody covers the window.
    #[must_use]
    pub const fn is_manipulated(self) -> bool {
        self.state(5)
    }

    /// Safe cut-off paths, bit 0 the first of twenty; set: on, nothing is in the field.
    #[must_use]
    pub const fn safe_paths(self) -> u32 {
        let [_, a, b, c, ..] = self.bytes;
        u32::from_le_bytes([a, b, c, 0])
    }

    /// Cut-off paths that are not safe, as [`Self::safe_paths`].
    #[must_use]
    pub const fn other_paths(self) -> u32 {
        let [_, _, _, _, a, b, c, ..] = self.bytes;
        u32::from_le_bytes([a, b, c, 0])
    }

    /// Cut-off paths that wait for a reset.
    #[must_use]
    pub const fn reset_required(self) -> u32 {
        let [_, _, _, _, _, _, _, a, b, c, ..] = self.bytes;
        u32::from_le_bytes([a, b, c, 0])
    }

    /// Current monitoring case of tables 1 to 4.
    #[must_use]
    pub const fn monitoring_cases(self) -> [u8; 4] {
        let [_, _, _, _, _, _, _, _, _, _, a, b, c, d, ..] = self.bytes;
        [a, b, c, d]
    }

    /// The application around the device is wrong (wiring, inputs).
    #[must_use]
    pub const fn has_application_error(self) -> bool {
        self.bytes[15] & 1 != 0
    }

    /// The device itself is broken.
    #[must_use]
    pub const fn has_device_error(self) -> bool {
        self.bytes[15] & 2 != 0
    }
}

/// Which beams see something in the field of each cut-off path.
#[derive(Clone, Copy, Debug)]
pub struct Intrusion<'a> {
    block: &'a [u8],
}

impl<'a> Intrusion<'a> {
    pub(super) const fn new(block: &'a [u8]) -> Self {
        Self { block }
    }

    /// The bit fields of the paths, first path first, bit 0 of byte 0 the first beam. Ends early where the block does.
    pub fn paths(&self) -> impl Iterator<Item = &'a [u8]> + use<'a> {
        let mut rest = self.block;
        (0..PATHS).map_while(move |_| {
            let (bits, after) = first_path(rest)?;
            rest = after;
            Some(bits)
        })
    }
}

/// The bit field that begins here, and what follows it. A function of its own: written into the 24 rounds of a loop, its
/// comparisons keep rustc 1.95 (LLVM 22, constraint elimination) busy for more than a quarter of an hour.
#[inline(never)]
fn first_path(rest: &[u8]) -> Option<(&[u8], &[u8])> {
    let (size, after) = rest.split_first_chunk::<4>()?;
    after.split_at_checked(usize::try_from(u32::from_le_bytes(*size)).ok()?)
}
