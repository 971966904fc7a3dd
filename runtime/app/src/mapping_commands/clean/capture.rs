//! A lidar capture as sweeps with single returns.

use std::path::Path;

use floorguard_drivers::velodyne::{Decoder, Model, ModelChoice, Packet, Returns, ReturnsOf};
use floorguard_mapping_host::clean::{CleanConfig, FAN_RINGS, RawReturn, RawSweep};
use floorguard_recording::capture::{Capture, LIDAR_DATA_PORT, settle_model};
use floorguard_types::time::Stamp;

/// A capture that can be read again and again.
pub struct LidarCapture {
    path: std::path::PathBuf,
    model: Model,
}

/// A sweep ends where the azimuth falls by more than this, hundredths of a degree.
const FALL_CDEG: u16 = 1_000;

impl LidarCapture {
    /// Finds the model of its lidar.
    ///
    /// # Errors
    /// It cannot be read, or holds no lidar.
    pub fn open(path: &Path) -> anyhow::Result<Self> {
        Ok(Self { path: path.to_owned(), model: settle_model(path, ModelChoice::Auto)? })
    }

    /// Calls `each` for every sweep; parts of a sweep at both ends count.
    ///
    /// # Errors
    /// The file is cut off or damaged, or `each` refuses.
    pub fn for_each(&self, each: &mut dyn FnMut(&RawSweep) -> anyhow::Result<()>) -> anyhow::Result<()> {
        let mut decoder = Decoder::new(ModelChoice::Fixed(self.model));
        let returns = Returns::new(self.model);
        let rings = self.model.angles();
        let mut sweep = RawSweep::default();
        let mut last_cdeg = 0_u16;
        for datagram in Capture::open(&self.path)? {
            let datagram = datagram?;
            if datagram.destination_port != LIDAR_DATA_PORT {
                continue;
            }
            let arrival = Stamp::from_micros(datagram.captured_us);
            let Ok((decoded, _)) = decoder.decode(&datagram.payload, arrival) else { continue };
            let Ok(packet) = Packet::new_checked(&datagram.payload) else { continue };
            let packet_s = decoded.stamp.as_micros() as f64 * 1.0e-6;
            let mut cut = Vec::new();
            returns.for_each(&packet, ReturnsOf::DistinctEchoes, |found| {
                if last_cdeg.saturating_sub(found.azimuth_cdeg) > FALL_CDEG && !sweep.returns.is_empty() {
                    cut.push(std::mem::take(&mut sweep));
                }
                last_cdeg = found.azimuth_cdeg;
                let time_s = packet_s + f64::from(found.offset_ns) * 1.0e-9;
                if sweep.returns.is_empty() {
                    sweep.start_s = time_s;
                }
                sweep.returns.push(RawReturn {
                    point_in_sensor: found.point_in_sensor,
                    offset_s: (time_s - sweep.start_s) as f32,
                    ring: rings.as_ref().get(usize::from(found.laser)).map_or(0, |angles| angles.ring),
                });
            });
            cut.iter().try_for_each(&mut *each)?;
        }
        if !sweep.returns.is_empty() {
            each(&sweep)?;
        }
        Ok(())
    }

    /// Values for a lidar of this kind.
    #[must_use]
    pub fn config(&self) -> CleanConfig {
        let angles = self.model.ring_angles();
        let lasers = self.model.lasers();
        CleanConfig::new(std::array::from_fn::<f32, FAN_RINGS, _>(|ring| {
            let of_ring = angles.as_ref().get(ring).filter(|_| ring < lasers);
            of_ring.map_or(f32::NAN, |angles| angles.elevation_deg.to_radians())
        }))
    }

    /// Name of the model.
    #[must_use]
    pub const fn model_name(&self) -> &'static str {
        self.model.name()
    }
}
