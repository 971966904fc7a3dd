//! Training of what the core carries as constant tables: on the host, from simulation and from labelled scans, seeded.

mod adaboost;
mod boosting;
pub mod detector;
mod leg_file;
mod leg_scans;
mod online;
mod online_picture;
mod person_samples;
mod quality;
mod scenes;
mod simulated;
mod simulated_legs;
mod standing_map;
mod table;

pub use adaboost::{adaboost, lean};
pub use boosting::{Boosting, Forest, Sample, boost};
pub use leg_file::read_leg_scans;
pub use leg_scans::{LabelledScan, LegSample, coarser, leg_samples};
pub use online::{OnlinePlace, OnlineReport, OnlineWindow, anchors, learn_place};
pub use online_picture::draw_online;
pub use person_samples::{Samples, is_person, person_samples, stretched};
pub use quality::{Quality, quality};
pub use scenes::{built_in_scenes, random_scenes};
pub use simulated::{LabelledSweep, SceneRun, play};
pub use simulated_legs::simulated_leg_samples;
pub use standing_map::StandingMap;
pub use table::{leg_table, person_table};
