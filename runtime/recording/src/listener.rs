//! Who hears the messages of a recording while they are made: live connections to viewers.

use super::schemas::Schema;
use super::times::Times;

/// One message on its way: the same bytes that a recording holds.
#[derive(Clone, Copy)]
pub struct LiveMessage<'a> {
    /// Where it belongs.
    pub topic: &'static str,
    /// Its type; one topic has one type.
    pub schema: &'static Schema,
    /// When it was recorded and made, on the robot's clock.
    pub times: Times,
    /// The message as plain CDR.
    pub data: &'a [u8],
}

/// Takes every message of a run. It is called on the telemetry thread and must not wait: what does not fit it drops and counts.
pub trait MessageListener: Send {
    /// A message of the run.
    fn message(&mut self, message: &LiveMessage<'_>);
}
