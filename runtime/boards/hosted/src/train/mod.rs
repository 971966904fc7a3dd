//! Training of what the core carries as constant tables: on the host, from simulation and from labelled scans, seeded.

mod boosting;
mod person_samples;
mod quality;
mod scenes;
mod simulated;
mod table;

pub use boosting::{Boosting, Forest, Sample, boost};
pub use person_samples::{Samples, person_samples, stretched};
pub use quality::{Quality, quality};
pub use scenes::{built_in_scenes, random_scenes};
pub use simulated::{LabelledSweep, SceneRun, play};
pub use table::person_table;
