//! The floor before the robot: where it lies, what stands on it, where it is dirty.
//!
//! Depth image → lattice → plane → gate → curvature → objects; colour image → blocks → novelty → dirt.
//! Source: book, Floor and dirt.

mod classes;
mod cloud;
mod confirmation;
mod curvature;
mod depth_noise;
pub mod dirt;
mod gate;
mod lanes;
mod lattice;
mod model;
mod normal_equations;
mod objects;
mod plane;
mod refine;
mod root;
mod search;

pub use classes::PixelClass;
pub use cloud::floor_of_points;
pub use confirmation::{ConfirmedObject, ObjectMemory, ObjectMemoryOf};
pub use curvature::Curvature;
pub use depth_noise::DepthNoise;
pub use gate::{FitFault, FitLimits};
pub use model::{
    FloorEstimate, FloorFault, FloorModel, FloorModelOf, FloorParameters, FloorSource, KNOWN_MAX_US,
    REUSE_MAX_US,
};
pub use objects::{FloorObject, FloorObjects, FloorObjectsOf, ImageTooWide, ObjectFinder, ObjectFinderOf};
pub use plane::{Plane, cross, dot, unit};
pub use refine::FitQuality;
pub use search::Expectation;
