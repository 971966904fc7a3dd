//! A classic CAN frame (book, CAN frames: Frame).

use embedded_can::{ExtendedId, Frame, Id, StandardId};

/// Data or remote frame with 11 or 29 bits of identifier.
///
/// ```
/// use floorguard_drivers::can::CanFrame;
///
/// let frame = CanFrame::standard(0x185, &[0x37, 0x02, 0x2E, 0xFB, 0xFF, 0xFF]);
/// assert_eq!(frame.standard_id(), Some(0x185));
/// assert_eq!(frame.payload()[..2], [0x37, 0x02]);
/// // 29 bits at most.
/// assert!(CanFrame::extended(0x2000_0000, &[]).is_none());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CanFrame {
    id: Id,
    remote: bool,
    length: u8,
    data: [u8; 8],
}

impl CanFrame {
    /// A data frame with an 11-bit identifier, of which higher bits are cut; at most eight bytes are taken.
    #[must_use]
    pub fn standard(id: u16, payload: &[u8]) -> Self {
        // 0x7FF is the largest standard identifier: the mask makes the fallback unreachable.
        let id = StandardId::new(id & 0x7FF).unwrap_or(StandardId::MAX);
        Self::filled(Id::Standard(id), false, payload)
    }

    fn filled(id: Id, remote: bool, payload: &[u8]) -> Self {
        let mut data = [0; 8];
        let mut length = 0_u8;
        for (cell, byte) in data.iter_mut().zip(payload) {
            *cell = *byte;
            length = length.saturating_add(1);
        }
        Self { id, remote, length, data }
    }

    /// The 11-bit identifier of a data frame; `None` for anything else.
    #[must_use]
    pub fn standard_id(&self) -> Option<u16> {
        match self.id {
            Id::Standard(id) if !self.remote => Some(id.as_raw()),
            _ => None,
        }
    }

    /// The 29-bit identifier of a data frame; `None` for anything else.
    #[must_use]
    pub fn extended_id(&self) -> Option<u32> {
        match self.id {
            Id::Extended(id) if !self.remote => Some(id.as_raw()),
            _ => None,
        }
    }

    /// The data bytes in use.
    #[must_use]
    pub fn payload(&self) -> &[u8] {
        self.data.get(..usize::from(self.length)).unwrap_or_default()
    }
}

impl Frame for CanFrame {
    fn new(id: impl Into<Id>, data: &[u8]) -> Option<Self> {
        (data.len() <= 8).then(|| Self::filled(id.into(), false, data))
    }

    fn new_remote(id: impl Into<Id>, dlc: usize) -> Option<Self> {
        let length = u8::try_from(dlc).ok().filter(|length| *length <= 8)?;
        Some(Self { length, ..Self::filled(id.into(), true, &[]) })
    }

    fn is_extended(&self) -> bool {
        matches!(self.id, Id::Extended(_))
    }

    fn is_remote_frame(&self) -> bool {
        self.remote
    }

    fn id(&self) -> Id {
        self.id
    }

    fn dlc(&self) -> usize {
        usize::from(self.length)
    }

    fn data(&self) -> &[u8] {
        if self.remote { &[] } else { self.payload() }
    }
}

impl CanFrame {
    /// A data frame with a 29-bit identifier; `None` when it has more bits or the data more than eight bytes.
    #[must_use]
    pub fn extended(id: u32, payload: &[u8]) -> Option<Self> {
        Self::new(ExtendedId::new(id)?, payload)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keeps_what_the_ecosystem_expects_of_a_frame() {
        let id = StandardId::new(0x201).unwrap();
        let frame = CanFrame::new(id, &[0x0F, 0, 0x10]).unwrap();
        assert_eq!(frame, CanFrame::standard(0x201, &[0x0F, 0, 0x10]));
        assert_eq!((frame.id(), frame.dlc(), frame.data()), (Id::Standard(id), 3, &[0x0F, 0, 0x10][..]));
        assert!(frame.is_standard() && frame.is_data_frame());
        assert_eq!(CanFrame::new(id, &[0; 9]), None);
        assert_eq!(CanFrame::new_remote(id, 9), None);
        let remote = CanFrame::new_remote(id, 8).unwrap();
        assert_eq!((remote.dlc(), remote.data().len(), remote.standard_id()), (8, 0, None));
    }

    #[test]
    fn extended_identifiers_are_never_taken_for_standard_ones() {
        let frame = CanFrame::extended(0x201, &[1]).unwrap();
        assert!(frame.is_extended() && frame.standard_id().is_none());
        assert_eq!((frame.extended_id(), CanFrame::standard(1, &[]).extended_id()), (Some(0x201), None));
        assert_eq!(CanFrame::extended(0x2000_0000, &[]), None);
        assert_eq!(CanFrame::standard(0xFA01, &[]).standard_id(), Some(0x201), "higher bits are cut");
    }
}
