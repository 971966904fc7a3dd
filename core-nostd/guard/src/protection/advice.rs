//! What perception tells the guard. It can only tighten (FG-REQ-030).

use heapless::Vec;

use floorguard_types::geometry::Point2;
use floorguard_types::time::Stamp;

/// People in one advice: the nearest first; whom perception leaves out must be farther away than all of these.
pub const ADVISED_PEOPLE_MAX: usize = 32;

/// A tracked person, in the robot frame at [`Advice::stamp`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AdvisedPerson {
    /// Identity of the track.
    pub id: u32,
    /// Where, metres.
    pub position: Point2,
    /// Velocity over ground along the robot's axes, m/s.
    pub velocity_mps: Point2,
    /// Standard deviation of the position, metres (largest axis).
    pub position_sigma_m: f32,
    /// Standard deviation of the velocity, m/s.
    pub velocity_sigma_mps: f32,
}

impl AdvisedPerson {
    /// Every number is finite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        let numbers = [
            self.position.x_m,
            self.position.y_m,
            self.velocity_mps.x_m,
            self.velocity_mps.y_m,
            self.position_sigma_m,
            self.velocity_sigma_mps,
        ];
        numbers.iter().all(|number| number.is_finite())
    }
}

/// One message of the perception ring.
///
/// ```
/// use floorguard_guard::Advice;
///
/// // Advice can only tighten: none of it permits anything.
/// let advice = Advice { speed_limit_mps: Some(0.2), ..Advice::default() };
/// assert!(advice.people.is_empty() && !advice.stop);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Advice {
    /// When the measurement behind it was taken.
    pub stamp: Stamp,
    /// People, nearest first.
    pub people: Vec<AdvisedPerson, ADVISED_PEOPLE_MAX>,
    /// Do not drive faster than this, m/s.
    pub speed_limit_mps: Option<f32>,
    /// Stop.
    pub stop: bool,
}
