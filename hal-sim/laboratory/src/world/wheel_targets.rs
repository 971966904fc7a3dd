//! What the robot asks of its drives, read from the frames on the bus as the judge understands them.

use floorguard_runtime::configuration::CanConfiguration;

/// Front wheel's target: object 60FFh in mm/s behind the controlword.
const ENABLE_OPERATION: u8 = 0x0F;

/// The last target of the front wheel's drive, or of those of all wheels.
pub(super) struct WheelTargets {
    /// Identifiers of the frames; none where a node number is 0.
    ids: [Option<u16>; 4],
    /// The last target of each, m/s.
    pub(super) mps: [f32; 4],
}

impl WheelTargets {
    pub(super) fn of(can: &CanConfiguration) -> Self {
        let id = |node: u8| (node != 0).then(|| 0x200 | u16::from(node));
        let of_wheels = can.wheel_nodes.map(id);
        let ids = if of_wheels[0].is_some() { of_wheels } else { [id(can.drive_node), None, None, None] };
        Self { ids, mps: [0.0; 4] }
    }

    /// The speed that is asked for after a frame, m/s: that of the front wheel, or the mean of all wheels; `None`: another frame.
    pub(super) fn take(&mut self, id: u16, payload: &[u8]) -> Option<f32> {
        let wheel = self.ids.iter().position(|known| *known == Some(id))?;
        let &[control, _, a, b, c, d] = payload else { return None };
        let target_mps = i32::from_le_bytes([a, b, c, d]) as f32 * 1.0e-3;
        self.mps[wheel] = if control == ENABLE_OPERATION { target_mps } else { 0.0 };
        let wheels = self.ids.iter().flatten().count().max(1);
        Some(self.mps.iter().sum::<f32>() / wheels as f32)
    }
}
