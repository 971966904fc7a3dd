//! What is tried: smooth deviations, from a few random numbers a sample.

use floorguard_types::geometry::Twist2;
use floorguard_types::number::nearest_f32;
use floorguard_types::random::Pcg32;

use super::config::MPPI_STEPS;

/// Steps from knot to knot; between them the deviation goes straight.
const KNOT_STEPS: usize = 6;
const KNOTS: usize = MPPI_STEPS / KNOT_STEPS + 1;

/// Deviations of standard deviation 1 in both velocities: independent at the knots, linear between them.
pub(super) fn deviations(random: &mut Pcg32) -> [Twist2; MPPI_STEPS] {
    let knots: [Twist2; KNOTS] = core::array::from_fn(|_| {
        let (linear_mps, angular_radps) = random.normal_pair();
        Twist2 { linear_mps, angular_radps }
    });
    core::array::from_fn(|step| {
        let (knot, share) = (step / KNOT_STEPS, nearest_f32(step % KNOT_STEPS) / nearest_f32(KNOT_STEPS));
        let at = |knot: usize| knots.get(knot).copied().unwrap_or(Twist2::ZERO);
        let (a, b) = (at(knot), at(knot.saturating_add(1)));
        Twist2 {
            linear_mps: a.linear_mps + share * (b.linear_mps - a.linear_mps),
            angular_radps: a.angular_radps + share * (b.angular_radps - a.angular_radps),
        }
    })
}
