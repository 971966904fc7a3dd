//! Whichever scanner is configured.

use floorguard_types::profile::{Native, Profile};
use floorguard_types::time::Stamp;

use super::bridged::BridgedOf;
use super::contract::{RangingEvent, RangingScanner};
use super::hokuyo::HokuyoOf;
use super::rplidar::RplidarOf;
use super::sick::ColaOf;

/// One of the makers' protocols.
// One lives for the length of a run.
#[allow(clippy::large_enum_variant)]
#[derive(Clone, Debug)]
pub enum AnyRangingScannerOf<P: Profile> {
    /// Hokuyo, SCIP 2.0.
    Hokuyo(HokuyoOf<P>),
    /// SICK, CoLa A or B.
    Cola(ColaOf<P>),
    /// Slamtec RPLidar.
    Rplidar(RplidarOf<P>),
    /// Any scanner behind a bridge.
    Bridged(BridgedOf<P>),
}

/// For the scanners of the target.
pub type AnyRangingScanner = AnyRangingScannerOf<Native>;

impl<P: Profile> RangingScanner<P> for AnyRangingScannerOf<P> {
    fn push(&mut self, bytes: &[u8], now: Stamp, event: &mut impl FnMut(RangingEvent<'_, P>)) {
        match self {
            Self::Hokuyo(scanner) => scanner.push(bytes, now, event),
            Self::Cola(scanner) => scanner.push(bytes, now, event),
            Self::Rplidar(scanner) => scanner.push(bytes, now, event),
            Self::Bridged(scanner) => scanner.push(bytes, now, event),
        }
    }

    fn poll(
        &mut self,
        now: Stamp,
        send: &mut impl FnMut(&[u8]),
        event: &mut impl FnMut(RangingEvent<'_, P>),
    ) {
        match self {
            Self::Hokuyo(scanner) => scanner.poll(now, send, event),
            Self::Cola(scanner) => scanner.poll(now, send, event),
            Self::Rplidar(scanner) => scanner.poll(now, send, event),
            Self::Bridged(scanner) => scanner.poll(now, send, event),
        }
    }
}
