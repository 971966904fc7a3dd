//! What makes a cluster a person: features, their scaling, a support-vector machine. Source: book, People.

mod eigenvalues;
mod features;
mod scaling;
mod svm;

pub use eigenvalues::eigenvalues3;
pub use features::{FEATURES, FeatureBuilder, Features, ScatterPass};
pub use scaling::{ScaledFeatures, Scaling};
pub use svm::{Platt, SvmModel, Verdict};
