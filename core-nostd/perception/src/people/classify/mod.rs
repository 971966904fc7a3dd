//! What makes a cluster a person: features, their scaling, a support-vector machine. Algorithms A.3 to A.5.

mod eigenvalues;
mod features;
mod scaling;
mod svm;

pub use eigenvalues::eigenvalues3;
pub use features::{FEATURES, FeatureBuilder, Features, ScatterPass};
pub use scaling::{ScaledFeatures, Scaling};
pub use svm::{Platt, SvmModel, Verdict};
