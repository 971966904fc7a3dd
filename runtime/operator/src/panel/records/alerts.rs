//! What happened to the robot, and who has seen it.

use serde::{Deserialize, Serialize};

/// Alerts that are kept.
const ALERTS_MAX: usize = 200;

/// Something that a person should know.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Alert {
    /// Its number; it is given when it is kept.
    pub id: u64,
    /// When, RFC 3339.
    pub at: String,
    /// What, without numbers.
    pub name: String,
    /// What, in full.
    pub text: String,
    /// What helps.
    pub remedy: String,
    /// When a person acknowledged it, RFC 3339.
    pub acknowledged: Option<String>,
}

/// The alerts, the newest first.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Alerts {
    next: u64,
    list: Vec<Alert>,
}

impl Alerts {
    pub(super) fn push(&mut self, alert: Alert) {
        self.next += 1;
        self.list.insert(0, Alert { id: self.next, ..alert });
        self.list.truncate(ALERTS_MAX);
    }

    pub(super) fn acknowledge(&mut self, id: Option<u64>, at: &str) -> bool {
        let open = self.list.iter_mut().filter(|alert| alert.acknowledged.is_none());
        let mut any = false;
        for alert in open.filter(|alert| id.is_none_or(|id| id == alert.id)) {
            alert.acknowledged = Some(at.to_owned());
            any = true;
        }
        any
    }

    /// How many wait to be acknowledged.
    #[must_use]
    pub fn open(&self) -> usize {
        self.list.iter().filter(|alert| alert.acknowledged.is_none()).count()
    }

    /// The newest.
    #[must_use]
    pub fn newest(&self) -> Option<&Alert> {
        self.list.first()
    }
}
