//! How good a trajectory is.

mod relations;

pub use relations::{Relation, RelationError, RelationScore, read_relations, score_relations};
