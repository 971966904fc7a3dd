//! What happened to the datagrams of a device.

/// Counts; saturating.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct DatagramCounters {
    /// Datagrams that were of use.
    pub accepted: u32,
    /// Datagrams refused, for any reason.
    pub refused: u32,
    /// Datagrams missing between two accepted ones.
    pub lost: u32,
}

impl DatagramCounters {
    /// Counts one, by what came of it: how many were missing before it, or why it was refused.
    pub fn count<E>(&mut self, outcome: &Result<u16, E>) {
        match outcome {
            Ok(lost) => {
                self.accepted = self.accepted.saturating_add(1);
                self.lost = self.lost.saturating_add(u32::from(*lost));
            }
            Err(_) => self.refused = self.refused.saturating_add(1),
        }
    }
}
