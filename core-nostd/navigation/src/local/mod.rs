//! Velocities for the next moment, by one contract: the published dynamic window, and sampling-based predictive control.

mod arrive;
mod contract;
mod dwa;
mod dwa_config;
mod dwa_critics;
mod dwa_window;
mod mppi;
mod step_field;

pub use arrive::Arrival;
pub use contract::{LocalCommand, LocalPlanner, LocalSituation, LocalVerdict};
pub use dwa::{Dwa, DwaScratch};
pub use dwa_config::DwaConfig;
pub use dwa_critics::{DwaScore, Oscillation};
pub use dwa_window::{SampleAxis, samples, window};
pub use mppi::{MPPI_STEPS, Mppi, MppiConfig, MppiSample, MppiWeights};
pub use step_field::{StepCell, StepField};
