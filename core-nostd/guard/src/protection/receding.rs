//! People whom the robot leaves behind: a stop would only keep it near to them (book, Guard: Collision).

use super::advice::AdvisedPerson;
use super::collision::{Body, PERSON_RADIUS_M, POSITION_SIGMAS, STRAIGHT_RADPS};
use floorguard_types::geometry::Twist2;

/// Slower than this the robot drives away from nobody, m/s.
const LEAVING_MPS: f32 = 0.02;
/// Of the angle within which the trailing edge drives away from a person only this share counts: the bearing of the
/// person changes while the robot turns.
const TURNING_SHARE: f32 = 0.5;
/// Who comes nearer to the flank more slowly than this stands beside it, m/s: tracks of people who stand move by some
/// 0.05 m/s.
const BESIDE_MPS: f32 = 0.1;
/// Whose middle is nearer to the flank than this is in contact with it, and not beside, metres: half the depth of a body.
const CONTACT_M: f32 = 0.2;

impl Body {
    /// The robot's own motion leaves a person behind: it cannot bring the body nearer to anywhere that the person may
    /// be, a disc of two standard deviations, and the person does not follow faster than the robot leaves (FG-REQ-034).
    ///
    /// The person is beyond the trailing edge, or stands beside the flank of a robot that drives straight: such a robot
    /// touches nobody who is not beyond its leading edge. The trailing edge of a turning robot swings aside: all of the
    /// disc must be behind it, near to straight behind, the nearer the more the robot turns. More doubt never turns this
    /// from `false` to `true`.
    ///
    /// ```
    /// use floorguard_guard::{AdvisedPerson, Body};
    /// use floorguard_types::geometry::{Point2, Twist2};
    ///
    /// let body = Body { x_m: [-0.5, 1.0], y_m: [-0.4, 0.4] };
    /// let behind = AdvisedPerson { position: Point2::new(-0.7, 0.1), ..AdvisedPerson::default() };
    /// assert!(body.recedes_from(&behind, Twist2 { linear_mps: 0.3, angular_radps: 0.0 }));
    /// assert!(!body.recedes_from(&behind, Twist2 { linear_mps: -0.3, angular_radps: 0.0 }));
    /// ```
    #[must_use]
    pub fn recedes_from(&self, person: &AdvisedPerson, twist: Twist2) -> bool {
        let speed_mps = twist.linear_mps.abs();
        let doubt_m = POSITION_SIGMAS * person.position_sigma_m.max(0.0);
        let offset = self.offset(person.position);
        let behind_m = -offset.x_m * twist.linear_mps.signum();
        if self.is_beside(person, twist) {
            return speed_mps >= LEAVING_MPS;
        }
        if speed_mps < LEAVING_MPS || behind_m <= 0.0 || self.closing_m2ps(person, twist) > 0.0 {
            return false;
        }
        if twist.angular_radps.abs() <= STRAIGHT_RADPS {
            return behind_m + self.x_m[1] - self.x_m[0] > doubt_m;
        }
        let [trailing_m, half_width_m] = self.trailing_edge_m(twist.linear_mps);
        let swings_mps = twist.angular_radps.abs() * trailing_m;
        let leaves_mps = speed_mps - twist.angular_radps.abs() * half_width_m;
        let aside_m = offset.y_m.abs() + doubt_m;
        leaves_mps > 0.0
            && behind_m > doubt_m
            && aside_m * swings_mps <= TURNING_SHARE * leaves_mps * (behind_m - doubt_m)
    }

    /// A person near the body does not limit the speed (FG-REQ-031): the robot drives straight, and all of the disc is beyond its
    /// trailing edge, or the separation grows, also with the person one standard deviation of the velocity faster. For a body that
    /// turns nobody is exempt: its corners come nearer again.
    #[must_use]
    pub fn is_exempt_from_near_limit(&self, person: &AdvisedPerson, twist: Twist2) -> bool {
        let offset = self.offset(person.position);
        let disc_m = PERSON_RADIUS_M + POSITION_SIGMAS * person.position_sigma_m.max(0.0);
        let leaves = twist.linear_mps.abs() >= LEAVING_MPS && twist.angular_radps.abs() <= STRAIGHT_RADPS;
        let is_behind = -offset.x_m * twist.linear_mps.signum() > disc_m;
        let doubt_m2ps = person.velocity_sigma_mps.max(0.0) * offset.norm();
        leaves && (is_behind || self.closing_m2ps(person, twist) + doubt_m2ps < 0.0)
    }

    /// A body that drives straight passes a person beside it: the middle of the person is beside the body wherever in two standard
    /// deviations it is, nothing of the disc around it lies in the way ahead, and the person does not come nearer.
    fn is_beside(&self, person: &AdvisedPerson, twist: Twist2) -> bool {
        let offset = self.offset(person.position);
        let doubt_m = POSITION_SIGMAS * person.position_sigma_m.max(0.0);
        let disc_m = PERSON_RADIUS_M + doubt_m;
        let leading_m = if twist.linear_mps < 0.0 { -self.x_m[0] } else { self.x_m[1] };
        let place_m = person.position.x_m * twist.linear_mps.signum();
        // Of the disc so much before and behind its middle reaches over the line of the flank.
        let in_way_m = libm::sqrtf((disc_m * disc_m - offset.y_m * offset.y_m).max(0.0));
        twist.angular_radps.abs() <= STRAIGHT_RADPS
            && offset.x_m == 0.0
            && offset.y_m.abs() >= CONTACT_M
            && leading_m - place_m > in_way_m.max(doubt_m)
            && self.closing_m2ps(person, twist) < BESIDE_MPS * offset.y_m.abs()
    }

    /// How fast the person comes nearer to the nearest point of the body, as both move, times the gap, m²/s.
    fn closing_m2ps(&self, person: &AdvisedPerson, twist: Twist2) -> f32 {
        let (place, offset) = (person.position, self.offset(person.position));
        let nearest = [place.x_m - offset.x_m, place.y_m - offset.y_m];
        let along_mps = person.velocity_mps.x_m - twist.linear_mps + twist.angular_radps * nearest[1];
        let across_mps = person.velocity_mps.y_m - twist.angular_radps * nearest[0];
        -(offset.x_m * along_mps + offset.y_m * across_mps)
    }

    /// From the axle to the trailing edge along x, and to its farther end along y, metres.
    fn trailing_edge_m(&self, linear_mps: f32) -> [f32; 2] {
        let trailing_m = if linear_mps < 0.0 { self.x_m[1] } else { self.x_m[0] };
        [trailing_m.abs(), self.y_m[0].abs().max(self.y_m[1].abs())]
    }
}
