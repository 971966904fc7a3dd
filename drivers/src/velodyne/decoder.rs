//! From a datagram to a stamped [`LidarPacket`]: model, clock, losses, plausibility.

use floorguard_core::sensing::LidarPacket;
use floorguard_core::time::Stamp;

use super::clock::HourClock;
use super::columns::Columns;
use super::model::{Model, detect_model};
use super::packet::{Packet, PacketError};

/// Which model sends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ModelChoice {
    /// From product byte and packet period.
    Auto,
    /// By configuration; packets that contradict it are refused.
    Fixed(Model),
}

/// A datagram that gives no columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum DecodeError {
    /// It is no data packet.
    Packet(PacketError),
    /// It comes from another model than configured.
    WrongModel {
        /// As configured.
        configured: Model,
        /// As the packet says.
        product_byte: u8,
        /// Microseconds since the packet before, where that tells.
        period_us: Option<u32>,
    },
    /// Product byte 0x21 without a second packet yet: early VLP-16 or HDL-32E. Happens once after the start.
    ModelUndecided,
    /// A product byte that no supported model has.
    UnknownProduct {
        /// The byte.
        product_byte: u8,
    },
    /// The head does not turn, or turns impossibly fast: azimuths cannot be trusted.
    Rotation {
        /// Turned within one block, hundredths of a degree.
        gap_cdeg: u16,
    },
    /// Not newer than the packet before: repeated or overtaken.
    NotNewer {
        /// Microseconds since the top of the hour.
        stamp_us: u32,
    },
}

impl core::fmt::Display for DecodeError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Packet(error) => write!(f, "{error}"),
            Self::WrongModel { configured, product_byte, period_us } => {
                write!(f, "the lidar is no {}: product byte 0x{product_byte:02X}", configured.name())?;
                if let Some(period_us) = period_us {
                    write!(f, ", {period_us} us between packets (expected {})", configured.packet_us(false))?;
                }
                write!(f, "; set the model to auto or to the one that is mounted")
            }
            Self::ModelUndecided => {
                write!(f, "product byte 0x21 is an HDL-32E or an early VLP-16; one more packet tells")
            }
            Self::UnknownProduct { product_byte } => {
                write!(f, "unknown lidar product byte 0x{product_byte:02X}; set the model by hand")
            }
            Self::Rotation { gap_cdeg } => {
                write!(
                    f,
                    "the lidar turned {gap_cdeg} cdeg within a block; possible are 1 to 100: is the motor running?"
                )
            }
            Self::NotNewer { stamp_us } => {
                write!(f, "lidar packet {stamp_us} us is not newer than the one before")
            }
        }
    }
}

impl core::error::Error for DecodeError {}

/// What happened to the datagrams; saturating.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Counters {
    /// Packets that gave columns.
    pub accepted: u32,
    /// Datagrams refused, for any reason.
    pub refused: u32,
    /// Packets missing between two accepted ones.
    pub lost: u32,
    /// Packets repeated or overtaken (also counted as refused).
    pub not_newer: u32,
}

/// Decodes the stream of one lidar.
#[derive(Clone, Debug)]
pub struct Decoder {
    choice: ModelChoice,
    decided: Option<(Model, Columns)>,
    last: Option<LastPacket>,
    clock: HourClock,
    counters: Counters,
}

#[derive(Clone, Copy, Debug)]
struct LastPacket {
    stamp_us: u32,
    arrival: Stamp,
}

/// At 1,200 rpm a block turns 80 cdeg; the margin is for a head that overshoots (wire-formats 1.5).
const GAP_MAX_CDEG: u16 = 100;
/// A longer silence is a restart, not a number of lost packets.
const LOST_MAX: u32 = 750;
/// An hour, microseconds.
const HOUR_US: u32 = 3_600_000_000;

impl Decoder {
    /// A decoder for one lidar.
    #[must_use]
    pub fn new(choice: ModelChoice) -> Self {
        Self { choice, decided: None, last: None, clock: HourClock::default(), counters: Counters::default() }
    }

    /// The model, once it is known.
    #[must_use]
    pub fn model(&self) -> Option<Model> {
        self.decided.as_ref().map(|(model, _)| *model)
    }

    /// What happened so far.
    #[must_use]
    pub const fn counters(&self) -> Counters {
        self.counters
    }

    /// Decodes one UDP payload that arrived at `arrival`. Gives the columns and how many packets are missing right
    /// before them.
    ///
    /// # Errors
    /// [`DecodeError`]; the datagram is counted and changes nothing else.
    pub fn decode(&mut self, payload: &[u8], arrival: Stamp) -> Result<(LidarPacket, u16), DecodeError> {
        let outcome = self.try_decode(payload, arrival);
        match outcome {
            Ok(_) => self.counters.accepted = self.counters.accepted.saturating_add(1),
            Err(error) => {
                self.counters.refused = self.counters.refused.saturating_add(1);
                if matches!(error, DecodeError::NotNewer { .. }) {
                    self.counters.not_newer = self.counters.not_newer.saturating_add(1);
                }
            }
        }
        outcome
    }

    fn try_decode(&mut self, payload: &[u8], arrival: Stamp) -> Result<(LidarPacket, u16), DecodeError> {
        let packet = Packet::new_checked(payload).map_err(DecodeError::Packet)?;
        let step_us = self.step_us(&packet, arrival)?;
        let decision = self.decide(&packet, step_us);
        self.last = Some(LastPacket { stamp_us: packet.stamp_us(), arrival });
        decision?;
        let gap = packet.gaps().into_iter().find(|gap| !(1..=GAP_MAX_CDEG).contains(gap));
        if let Some(gap_cdeg) = gap.filter(|_| !packet.is_dual()) {
            return Err(DecodeError::Rotation { gap_cdeg });
        }
        let Some((model, columns)) = &self.decided else { return Err(DecodeError::ModelUndecided) };
        let lost = lost_packets(step_us, model.packet_us(packet.is_dual()));
        let stamp = self.clock.stamp(packet.stamp_us(), arrival);
        self.counters.lost = self.counters.lost.saturating_add(u32::from(lost));
        Ok((columns.convert(&packet, stamp), lost))
    }

    /// Microseconds of sensor time since the packet before; `None` for the first and after a long silence.
    fn step_us(&self, packet: &Packet<'_>, arrival: Stamp) -> Result<Option<u32>, DecodeError> {
        let Some(last) = self.last else { return Ok(None) };
        let stamp_us = packet.stamp_us();
        let forwards = stamp_us.wrapping_sub(last.stamp_us);
        let over_the_hour = stamp_us.saturating_add(HOUR_US).wrapping_sub(last.stamp_us);
        let step_us = if stamp_us >= last.stamp_us { forwards } else { over_the_hour };
        // A step backwards looks like almost an hour forwards, which the arrival contradicts.
        let silence_s = arrival.seconds_since(last.arrival);
        if step_us == 0 || (step_us > HOUR_US / 2 && silence_s < 1.0) {
            // A clock that was set back must not silence the lidar: after a second the new time holds.
            return Err(DecodeError::NotNewer { stamp_us });
        }
        Ok(Some(step_us))
    }

    fn decide(&mut self, packet: &Packet<'_>, step_us: Option<u32>) -> Result<(), DecodeError> {
        if self.decided.is_some() && !matches!(self.choice, ModelChoice::Fixed(_)) {
            return Ok(());
        }
        let product_byte = packet.product_byte();
        let detected = step_us.and_then(|period_us| detect_model(product_byte, period_us));
        let named = Model::from_product_byte(product_byte);
        let early_firmware = product_byte == 0x21;
        let model = match self.choice {
            ModelChoice::Auto if early_firmware => detected.ok_or(DecodeError::ModelUndecided)?,
            ModelChoice::Auto => named.ok_or(DecodeError::UnknownProduct { product_byte })?,
            ModelChoice::Fixed(model) => {
                let contradicted = if early_firmware {
                    detected.is_some_and(|other| other != model)
                } else {
                    named != Some(model)
                };
                if contradicted {
                    self.decided = None;
                    return Err(DecodeError::WrongModel {
                        configured: model,
                        product_byte,
                        period_us: step_us,
                    });
                }
                model
            }
        };
        if self.model() != Some(model) {
            self.decided = Some((model, Columns::new(model, &model.angles())));
        }
        Ok(())
    }
}

fn lost_packets(step_us: Option<u32>, period_us: u32) -> u16 {
    let periods = step_us.map_or(1, |step| step.saturating_add(period_us / 2) / period_us.max(1));
    let lost = periods.saturating_sub(1);
    if lost > LOST_MAX { 0 } else { u16::try_from(lost).unwrap_or(0) }
}
