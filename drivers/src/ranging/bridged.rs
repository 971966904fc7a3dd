//! Any scanner behind a bridge: the datagrams of the scan link, as the guard takes them.

use floorguard_types::profile::{Native, Profile};
use floorguard_types::time::Stamp;

use super::contract::{RangingEvent, RangingScanner};
use crate::scan_link::{DecoderOf, ScanShape};

/// One bridge.
///
/// ```
/// use floorguard_drivers::ranging::{Bridged, RangingEvent, RangingScanner};
/// use floorguard_drivers::scan_link::ScanShape;
/// use floorguard_types::time::Stamp;
///
/// let (first_udeg, step_udeg) = (-90_000_000, 500_000);
/// let shape = ScanShape { beams: 361, first_udeg, step_udeg, period_us: 50_000, range_mm: [50, 25_000] };
/// let mut refused = 0;
/// Bridged::new(shape).push(b"no datagram", Stamp::ZERO, &mut |event| {
///     refused += u32::from(matches!(event, RangingEvent::Datagram(_)));
/// });
/// assert_eq!(refused, 1);
/// ```
#[derive(Clone, Debug)]
pub struct BridgedOf<P: Profile> {
    decoder: DecoderOf<P>,
}

/// For the scanners of the target.
pub type Bridged = BridgedOf<Native>;

impl<P: Profile> BridgedOf<P> {
    /// Nothing was heard yet.
    #[must_use]
    pub fn new(shape: ScanShape) -> Self {
        Self { decoder: DecoderOf::new(shape) }
    }

    /// What happened so far.
    #[must_use]
    pub const fn decoder(&self) -> &DecoderOf<P> {
        &self.decoder
    }
}

impl<P: Profile> RangingScanner<P> for BridgedOf<P> {
    fn push(&mut self, bytes: &[u8], now: Stamp, event: &mut impl FnMut(RangingEvent<'_, P>)) {
        match self.decoder.decode(bytes, now) {
            Ok(Some(scan)) => event(RangingEvent::Scan(scan)),
            Ok(None) => {}
            Err(error) => event(RangingEvent::Datagram(error)),
        }
    }

    /// A bridge sends by itself. One that does not is late, and the guard sees that by the age of its newest scan.
    fn poll(&mut self, _: Stamp, _: &mut impl FnMut(&[u8]), _: &mut impl FnMut(RangingEvent<'_, P>)) {}
}
