//! What every scanner of the kind does: it is asked to measure, and measures.

use floorguard_types::profile::Profile;
use floorguard_types::sensing::ScanOf;
use floorguard_types::time::Stamp;

use crate::scan_link::DecodeError;

/// What a scanner reports.
#[derive(Clone, Debug, PartialEq)]
pub enum RangingEvent<'a, P: Profile> {
    /// A scan: beams counter-clockwise as seen from above.
    Scan(&'a ScanOf<P>),
    /// It says that it does not measure.
    StandBy,
    /// It says that it is in trouble: the code of its maker.
    Fault(u16),
    /// It is something else than was configured.
    Unsuitable,
    /// Bytes that make no whole message: nothing of them is used.
    Refused,
    /// A datagram of a bridge that is of no use, and why.
    Datagram(DecodeError),
    /// It did not answer, or stopped sending: it is asked anew.
    Silent,
}

/// Bytes in, scans out; commands between them.
pub trait RangingScanner<P: Profile> {
    /// Takes bytes that arrived at a time: of one that sends datagrams, a whole datagram.
    fn push(&mut self, bytes: &[u8], now: Stamp, event: &mut impl FnMut(RangingEvent<'_, P>));

    /// Time has passed: sends what is due.
    fn poll(&mut self, now: Stamp, send: &mut impl FnMut(&[u8]), event: &mut impl FnMut(RangingEvent<'_, P>));
}
