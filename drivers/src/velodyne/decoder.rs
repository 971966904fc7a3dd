//! From a datagram to a stamped [`LidarPacket`]: model, clock, losses, plausibility.

use floorguard_types::number::{truncating_u8, truncating_u32};
use floorguard_types::profile::{Native, Profile, Size};
use floorguard_types::sensing::LidarPacketOf;
use floorguard_types::time::Stamp;

use super::clock::HourClock;
use super::closed_sector::{ClosedSector, PacketTurn, SectorWatch};
use super::columns::Columns;
use super::decode_error::DecodeError;
use super::model::{Model, detect_model};
use super::packet::{Packet, PacketError};
use super::rotation::{check_rotation, leave_out_alone, lost_packets};

/// Which model sends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ModelChoice {
    /// From product byte and packet period.
    Auto,
    /// By configuration; packets that contradict it are refused.
    Fixed(Model),
}

/// What happened to the datagrams; saturating.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Counters {
    /// Packets that gave columns.
    pub accepted: u32,
    /// Datagrams refused, for any reason.
    pub refused: u32,
    /// Packets missing between two accepted ones. What a closed sector was taken for before it had shown is taken back.
    pub lost: u32,
    /// Packets repeated or overtaken (also counted as refused).
    pub not_newer: u32,
    /// Blocks left out of accepted packets, because their azimuth is none.
    pub odd_blocks: u32,
    /// Returns nearer than the blind range, taken for the robot itself and entered as unknown.
    pub self_returns: u32,
}

/// Decodes the stream of one lidar.
///
/// ```
/// use floorguard_drivers::velodyne::{Decoder, Model, ModelChoice};
/// use floorguard_types::time::Stamp;
///
/// // Twelve blocks, 0.4° apart. In the second one laser 1 of its first firing sees something 1 m away.
/// let mut bytes = [0; 1_206];
/// for (azimuth_cdeg, block) in (0_u16..).step_by(40).zip(bytes.chunks_exact_mut(100)) {
///     block[..2].copy_from_slice(&[0xFF, 0xEE]);
///     block[2..4].copy_from_slice(&azimuth_cdeg.to_le_bytes());
/// }
/// bytes[107..109].copy_from_slice(&500_u16.to_le_bytes());
/// bytes[1_204..].copy_from_slice(&[0x37, 0x22]);
///
/// let mut decoder = Decoder::new(ModelChoice::Auto);
/// let (packet, lost) = decoder.decode(&bytes, Stamp::from_micros(5_000_000)).unwrap();
/// assert_eq!((decoder.model(), lost, packet.columns.len()), (Some(Model::Vlp16), 0, 24));
/// let column = &packet.columns[2];
/// let range_mm = column.range_raw[8] * u16::from(packet.range_unit_mm);
/// assert_eq!((column.azimuth_cdeg.abs_diff(40) <= 10, range_mm), (true, 1_000));
/// assert!(decoder.decode(b"not a packet", Stamp::from_micros(5_001_327)).is_err());
/// assert_eq!(decoder.counters().refused, 1);
/// ```
#[derive(Clone, Debug)]
pub struct DecoderOf<P: Profile> {
    choice: ModelChoice,
    decided: Option<Decided<P>>,
    blind_range_mm: u16,
    lasers_max: u8,
    /// The newest packet that is one, accepted or not: for the period.
    last: Option<LastPacket>,
    /// Sensor time since the newest *accepted* packet: what was refused in between is missing in the sweep.
    since_accepted_us: Option<u32>,
    clock: HourClock,
    counters: Counters,
    /// Why a block of the newest accepted packet was left out.
    odd_block: Option<PacketError>,
    sectors: SectorWatch,
}

#[derive(Clone, Debug)]
struct Decided<P: Profile> {
    model: Model,
    product_byte: u8,
    columns: Columns<P>,
}

#[derive(Clone, Copy, Debug)]
struct LastPacket {
    stamp_us: u32,
}

/// An hour, microseconds.
const HOUR_US: u32 = 3_600_000_000;
/// A packet that is older than the one before by up to this was repeated or overtaken on the way; by more, the sensor's
/// clock was set (PPS locked or lost), and what it says now holds.
const REORDER_US: u32 = 500_000;

/// For the lidars of the target.
pub type Decoder = DecoderOf<Native>;

impl<P: Profile> DecoderOf<P> {
    /// A decoder for one lidar.
    #[must_use]
    pub fn new(choice: ModelChoice) -> Self {
        Self {
            choice,
            decided: None,
            blind_range_mm: 0,
            lasers_max: truncating_u8(P::Rings::N),
            last: None,
            since_accepted_us: None,
            clock: HourClock::default(),
            counters: Counters::default(),
            odd_block: None,
            sectors: SectorWatch::default(),
        }
    }

    /// The same decoder for a lidar that sees the robot itself up to `blind_range_mm`: nearer returns become *unknown*
    /// in the columns (book, Velodyne: Checks); they are no evidence of free space.
    #[must_use]
    pub fn with_blind_range_mm(self, blind_range_mm: u16) -> Self {
        Self { blind_range_mm, ..self }
    }

    /// The same decoder for stages that take lidars of at most `lasers_max` rings: packets of a larger one are refused.
    #[must_use]
    pub fn with_lasers_max(mut self, lasers_max: u8) -> Self {
        self.set_lasers_max(lasers_max);
        self
    }

    /// Packets of a larger lidar are refused from now on.
    pub fn set_lasers_max(&mut self, lasers_max: u8) {
        self.lasers_max = lasers_max.min(truncating_u8(P::Rings::N));
    }

    /// The model, once it is known.
    #[must_use]
    pub fn model(&self) -> Option<Model> {
        self.decided.as_ref().map(|decided| decided.model)
    }

    /// How often the sensor's clock was set, see [`HourClock`].
    #[must_use]
    pub const fn clock_restarts(&self) -> u32 {
        self.clock.restarts()
    }

    /// What happened so far.
    #[must_use]
    pub const fn counters(&self) -> Counters {
        self.counters
    }

    /// Why a block of the newest packet was left out though the packet was taken: [`PacketError::Azimuth`].
    #[must_use]
    pub const fn odd_block(&self) -> Option<PacketError> {
        self.odd_block
    }

    /// The sector that the lidar leaves out because it is set to a field of view, once it has shown. It stays unknown, and
    /// nothing of it is lost.
    #[must_use]
    pub const fn closed_sector(&self) -> Option<ClosedSector> {
        self.sectors.known()
    }

    /// Decodes one UDP payload that arrived at `arrival`. Gives the columns and how many packets are missing right
    /// before them.
    ///
    /// # Errors
    /// [`DecodeError`]; the datagram is counted and changes nothing else.
    pub fn decode(&mut self, payload: &[u8], arrival: Stamp) -> Result<(LidarPacketOf<P>, u16), DecodeError> {
        let mut packet = LidarPacketOf::EMPTY;
        let lost = self.decode_into(payload, arrival, &mut packet)?;
        Ok((packet, lost))
    }

    /// The same into a packet that is there already: nothing large is moved.
    ///
    /// # Errors
    /// [`DecodeError`]; the datagram is counted, and what stands in `out` has no meaning.
    pub fn decode_into(
        &mut self,
        payload: &[u8],
        arrival: Stamp,
        out: &mut LidarPacketOf<P>,
    ) -> Result<u16, DecodeError> {
        self.odd_block = None;
        let outcome = self.try_decode(payload, arrival, out);
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

    fn try_decode(
        &mut self,
        payload: &[u8],
        arrival: Stamp,
        out: &mut LidarPacketOf<P>,
    ) -> Result<u16, DecodeError> {
        let packet = Packet::new_checked(payload).map_err(DecodeError::Packet)?;
        let step_us = self.step_us(&packet)?;
        let decision = self.decide(&packet, step_us);
        self.last = Some(LastPacket { stamp_us: packet.stamp_us() });
        self.since_accepted_us =
            self.since_accepted_us.zip(step_us).map(|(sum, step)| sum.saturating_add(step));
        decision?;
        let mut turns = packet.turns();
        check_rotation(&packet, &turns)?;
        let Some(Decided { model, columns, .. }) = &self.decided else {
            return Err(DecodeError::ModelUndecided);
        };
        if !columns.is_whole(*model, self.counters.accepted) {
            return Err(DecodeError::Corrupted);
        }
        if self.sectors.known().is_none() {
            leave_out_alone(&mut turns, packet.is_dual());
        }
        let turned = PacketTurn::new(&turns, model.block_ns(), packet.is_dual())
            .ok_or(DecodeError::Rotation { gap_cdeg: 0 })?;
        let turned = self.sectors.timed(turned);
        let packet_us = model.packet_us(packet.is_dual());
        let since_us = self
            .since_accepted_us
            .map(|since_us| since_us.saturating_sub(self.sectors.closed_us(&turned, since_us, packet_us)));
        let lost = lost_packets(since_us, packet_us);
        let no_loss = self.sectors.accept(&turned, lost, self.since_accepted_us);
        // The datagram is sent after its last firing; the sensor's stamp is that of the first (book, Velodyne: Data
        // packet).
        let taken_us = packet_us.saturating_add(turned.skipped_us);
        let first_firing = arrival.minus_micros(u64::from(taken_us));
        let stamp = self.clock.stamp(packet.stamp_us(), first_firing);
        self.since_accepted_us = Some(0);
        self.counters.lost = self.counters.lost.saturating_add(u32::from(lost)).saturating_sub(no_loss);
        let times = (stamp, turned.skipped_us);
        let self_returns = columns.convert((&packet, &turns), (times, self.blind_range_mm), out);
        self.counters.self_returns = self.counters.self_returns.saturating_add(self_returns);
        let odd = truncating_u32(turns.iter().filter(|turn| turn.azimuth_cdeg.is_none()).count());
        self.odd_block = if odd > 0 { packet.odd_blocks().next() } else { None };
        self.counters.odd_blocks = self.counters.odd_blocks.saturating_add(odd);
        Ok(lost)
    }

    /// Microseconds of sensor time since the packet before; `None` for the first and where the clock was set.
    fn step_us(&self, packet: &Packet<'_>) -> Result<Option<u32>, DecodeError> {
        let Some(last) = self.last else { return Ok(None) };
        let stamp_us = packet.stamp_us();
        // Stamps reach a second into the next hour (book, Velodyne: Clock), so both are taken modulo the hour.
        let step_us =
            (u64::from(stamp_us) + 2 * u64::from(HOUR_US) - u64::from(last.stamp_us)) % u64::from(HOUR_US);
        let step_us = u32::try_from(step_us).unwrap_or(0);
        let back_us = HOUR_US.saturating_sub(step_us);
        if step_us == 0 || back_us <= REORDER_US {
            return Err(DecodeError::NotNewer { stamp_us });
        }
        Ok((step_us < HOUR_US / 2).then_some(step_us))
    }

    fn decide(&mut self, packet: &Packet<'_>, step_us: Option<u32>) -> Result<(), DecodeError> {
        let product_byte = packet.product_byte();
        if let (ModelChoice::Auto, Some(decided)) = (self.choice, &self.decided) {
            // Another lidar on the same port must not be read with the angles of the first.
            return if decided.product_byte == product_byte {
                Ok(())
            } else {
                Err(DecodeError::WrongModel { configured: decided.model, product_byte, period_us: step_us })
            };
        }
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
        if model.lasers() > usize::from(self.lasers_max) {
            return Err(DecodeError::TooManyLasers { model, lasers_max: self.lasers_max });
        }
        if self.model() != Some(model) {
            self.decided = Some(Decided {
                model,
                product_byte,
                columns: Columns::new(model, &model.angles_of::<P::Rings>()),
            });
        }
        Ok(())
    }
}
