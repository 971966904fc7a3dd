//! The robot in a fleet: what it is there, what it tells, and what it takes of orders.

#[cfg(feature = "fleet")]
mod joined;
mod opening;

#[cfg(feature = "fleet")]
pub use joined::join;
#[cfg(any(test, feature = "laboratory"))]
pub use opening::fleet_broker;
#[cfg(not(feature = "fleet"))]
pub use opening::join;
pub use opening::{CleaningOffer, FleetOpening};
