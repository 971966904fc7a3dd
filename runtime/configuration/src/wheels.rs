//! The kinds of wheels that a base can have.

/// How the robot's wheels move it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Wheels {
    Tricycle,
    Differential,
    Ackermann,
    Omnidirectional,
}

impl Wheels {
    /// As `kind` names them.
    pub const NAMES: [(&'static str, Self); 4] = [
        ("tricycle", Self::Tricycle),
        ("differential", Self::Differential),
        ("ackermann", Self::Ackermann),
        ("omnidirectional", Self::Omnidirectional),
    ];
}
