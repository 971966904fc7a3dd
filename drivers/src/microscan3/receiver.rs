//! From datagrams to scans.

use floorguard_types::number::nearest_f32;
use floorguard_types::profile::{List, Native, Profile, Size};
use floorguard_types::sensing::{BeamReturn, ScanOf};
use floorguard_types::time::Stamp;
use floorguard_types::units::radians;

use super::assembler::{Assembler, AssemblyCounters};
use super::blocks::{BeamStatus, DeviceStatus, Geometry};
use super::configuration::Configuration;
use super::fragment::FragmentError;
use super::message::{Message, MessageError};

/// What the scanner reported.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EventOf<'a, P: Profile> {
    /// A scan. It stays in the receiver until the next one.
    Scan(&'a ScanOf<P>),
    /// The scanner does not measure: no data, neither obstacle nor free.
    StandBy {
        /// Its scan number.
        sequence: u32,
    },
    /// A datagram or message of no use.
    Refused(ScanError),
}

/// The same in the memory of the target.
pub type Event<'a> = EventOf<'a, Native>;

/// Why there is no scan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ScanError {
    /// The datagram is no piece of a message.
    Fragment(FragmentError),
    /// The message is none.
    Message(MessageError),
    /// No angles are sent.
    NoGeometry,
    /// No measured values are sent, or fewer than announced.
    NoMeasurement,
    /// Angles, resolution or distance factor are impossible.
    Geometry,
    /// The blocks of the message disagree, or the scan exceeds the capacity.
    Beams {
        /// Beams measured.
        found: usize,
        /// Beams announced.
        announced: u16,
    },
    /// The scanner reports an error of itself or of its application.
    Device,
}

impl core::fmt::Display for ScanError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Fragment(error) => write!(f, "{error}"),
            Self::Message(error) => write!(f, "{error}"),
            Self::NoGeometry => {
                f.write_str("scanner sends no angles: enable derived values in its data output")
            }
            Self::NoMeasurement => {
                f.write_str("scanner sends no distances: enable measurement data in its output")
            }
            Self::Geometry => f.write_str("scanner sends impossible angles or units"),
            Self::Beams { found, announced } => {
                write!(f, "scanner sends {found} beams and announces {announced}; at most as many fit")
            }
            Self::Device => f.write_str("scanner reports an error; see its display"),
        }
    }
}

impl core::error::Error for ScanError {}

/// What happened; saturating.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Counters {
    /// Datagrams and messages.
    pub assembly: AssemblyCounters,
    /// Scans delivered.
    pub scans: u32,
    /// Messages that gave no scan.
    pub refused: u32,
    /// Scans missing between two.
    pub lost_scans: u32,
    /// Scan numbers that did not grow.
    pub repeated_scans: u32,
}

/// Receives one scanner. About 47 KiB with a capacity of 2,751 beams.
///
/// ```
/// use floorguard_drivers::microscan3::{Configuration, Event, Receiver};
/// use floorguard_types::sensing::BeamReturn::{Free, Hit, Unknown};
/// use floorguard_types::time::Stamp;
///
/// # let hex = |text: &str| -> Vec<u8> {
/// #     let digits: Vec<char> = text.chars().filter(char::is_ascii_hexdigit).collect();
/// #     digits.chunks(2).map(|two| u8::from_str_radix(&two.iter().collect::<String>(), 16).unwrap()).collect()
/// # };
/// // A message of 116 bytes in two datagrams; the second one overtakes the first.
/// let first = hex("4D5333204D440100740000004D0000000000000000000000560100006F9608017096080100000000
///     6712000068120000C44800004E61BC0034001000440018005C0018000000000000000000010EFF0FFFFF0F01");
/// let second = hex("4D5333204D440100740000004D0000003C0000000000000000000300000000000100050028000000
///     000020F466660600250000000000000005000000E8033201D0073C0900000002409CFF052C010731");
/// let mut receiver = Receiver::new(Configuration::default());
/// let mut scans = Vec::new();
/// for datagram in [second, first] {
///     receiver.push(&datagram, Stamp::from_micros(1_000_000), |event| match event {
///         Event::Scan(scan) => scans.push(scan.clone()),
///         other => panic!("{other:?}"),
///     });
/// }
/// // Glare and contamination say nothing, so they are not free.
/// assert_eq!((scans[0].sequence, scans.len()), (4_712, 1));
/// assert_eq!(scans[0].beams, [Hit(1_000), Hit(2_000), Free(5_500), Unknown, Unknown]);
/// assert!(receiver.status().unwrap().runs());
/// ```
#[derive(Clone, Debug)]
pub struct ReceiverOf<P: Profile> {
    configuration: Configuration,
    assembler: Assembler,
    last_scan: Option<u32>,
    status: Option<DeviceStatus>,
    counters: Counters,
    scan: ScanOf<P>,
}

/// A receiver for the scanners of the target.
pub type Receiver = ReceiverOf<Native>;

impl<P: Profile> ReceiverOf<P> {
    /// An empty receiver.
    #[must_use]
    pub fn new(configuration: Configuration) -> Self {
        Self {
            configuration,
            assembler: Assembler::new(),
            last_scan: None,
            status: None,
            counters: Counters::default(),
            scan: ScanOf::default(),
        }
    }

    /// What happened so far.
    #[must_use]
    pub const fn counters(&self) -> Counters {
        Counters { assembly: self.assembler.counters(), ..self.counters }
    }

    /// State of the device in the newest message; `None` where it sends none.
    #[must_use]
    pub const fn status(&self) -> Option<DeviceStatus> {
        self.status
    }

    /// Takes in a UDP payload that arrived at `now`. `event` is called at most once.
    pub fn push(&mut self, datagram: &[u8], now: Stamp, mut event: impl FnMut(EventOf<'_, P>)) {
        let (bytes, began) = match self.assembler.push(datagram, now) {
            Ok(Some(complete)) => complete,
            Ok(None) => return,
            Err(error) => return event(EventOf::Refused(ScanError::Fragment(error))),
        };
        let message = Message::new_checked(bytes).map_err(ScanError::Message);
        let outcome = message.and_then(|message| {
            let sequence = message.scan_number();
            self.status = message.status();
            if let Some(status) = self.status {
                if status.has_device_error() || status.has_application_error() {
                    return Err(ScanError::Device);
                }
                if status.stands_by() || !status.runs() {
                    return Ok((sequence, false));
                }
            }
            fill(&mut self.scan, &message, &self.configuration, began)?;
            Ok((sequence, true))
        });
        match outcome {
            Ok((sequence, true)) => {
                self.counters.scans = self.counters.scans.saturating_add(1);
                self.count_scan(sequence);
                event(EventOf::Scan(&self.scan));
            }
            Ok((sequence, false)) => event(EventOf::StandBy { sequence }),
            Err(error) => {
                self.counters.refused = self.counters.refused.saturating_add(1);
                event(EventOf::Refused(error));
            }
        }
    }

    fn count_scan(&mut self, sequence: u32) {
        match self.last_scan.map(|last| sequence.wrapping_sub(last)) {
            // A step back, or none, or more than an hour: the scanner repeats itself or restarted.
            Some(0) | Some(90_000..) => {
                self.counters.repeated_scans = self.counters.repeated_scans.saturating_add(1);
            }
            Some(step) => {
                self.counters.lost_scans = self.counters.lost_scans.saturating_add(step.saturating_sub(1));
            }
            None => {}
        }
        self.last_scan = Some(sequence);
    }
}

fn fill<P: Profile>(
    scan: &mut ScanOf<P>,
    message: &Message<'_>,
    configuration: &Configuration,
    began: Stamp,
) -> Result<(), ScanError> {
    let geometry = message.geometry().ok_or(ScanError::NoGeometry)?;
    let measured = message.measured().ok_or(ScanError::NoMeasurement)?;
    check(&geometry)?;
    let beams = measured.beams();
    let found = beams.len();
    let error = ScanError::Beams { found, announced: geometry.beams };
    if found != usize::from(geometry.beams) || found > P::Beams::N || found == 0 {
        return Err(error);
    }
    scan.stamp = began.minus_micros(since_middle_us(&geometry).saturating_add(configuration.latency_us));
    scan.sequence = message.scan_number();
    scan.step_rad = radians(geometry.resolution_deg);
    let first_deg = geometry.start_deg - configuration.forward_deg;
    scan.first_angle_rad = radians(first_deg);
    scan.beams.clear();
    for (distance, _, status) in beams {
        // Their number was compared with the capacity.
        scan.beams.push(beam(distance, status, &geometry, configuration)).map_err(|_| error)?;
    }
    if configuration.inverted {
        let steps = nearest_f32(found.saturating_sub(1));
        scan.first_angle_rad = -radians(first_deg + steps * geometry.resolution_deg);
        scan.turn_round();
    }
    Ok(())
}

/// What no device of the family can mean.
fn check(geometry: &Geometry) -> Result<(), ScanError> {
    let span_deg = geometry.resolution_deg * f32::from(geometry.beams);
    let possible = geometry.factor_mm > 0
        && geometry.resolution_deg > 0.01
        && span_deg <= 361.0
        && (-360.0..=360.0).contains(&geometry.start_deg);
    if possible { Ok(()) } else { Err(ScanError::Geometry) }
}

/// From the middle beam to the last one, microseconds; a sweep of the mirror takes no longer than the scan time.
fn since_middle_us(geometry: &Geometry) -> u64 {
    let sweep_us = u64::from(geometry.beams).saturating_mul(u64::from(geometry.beam_period_us));
    let scan_us = u64::from(geometry.scan_time_ms).saturating_mul(1_000);
    sweep_us.min(scan_us) / 2
}

/// One beam: dazzled or dirty says nothing, whatever distance stands beside it.
fn beam(distance: u16, status: BeamStatus, geometry: &Geometry, configuration: &Configuration) -> BeamReturn {
    let range_mm = u32::from(distance).saturating_mul(u32::from(geometry.factor_mm));
    match (status.is_valid(), status.is_infinite()) {
        _ if status.has_glare() || status.is_contaminated() => BeamReturn::Unknown,
        (false, true) => BeamReturn::Free(configuration.free_range_mm),
        (true, false) if distance > 0 => BeamReturn::Hit(u16::try_from(range_mm).unwrap_or(u16::MAX)),
        // Neither measured nor infinite, both at once, or measured at zero.
        _ => BeamReturn::Unknown,
    }
}
