//! Properties over random inputs, and pedestrians at random.

use proptest::prelude::*;

use super::fixtures::{Rig, config, forward};
use crate::*;
use floorguard_types::geometry::{Point2, Twist2};

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn fg_req_006_output_never_exceeds_input(v in -2.0_f32..2.0, w in -3.0_f32..3.0, limit in 0.0_f32..1.5) {
        let wanted = Twist2 { linear_mps: v, angular_radps: w };
        let out = crate::limiter::limited(wanted, limit, &config().drive, (wanted, 0.01));
        prop_assert!(out.linear_mps.abs() <= v.abs() && out.angular_radps.abs() <= w.abs());
        prop_assert!(out.linear_mps.abs() <= limit + 1.0e-6);
        prop_assert!((out.linear_mps * w - out.angular_radps * v).abs() < 1.0e-4, "the curve changed");
    }

    #[test]
    fn fg_req_013_any_missing_source_means_not_moving(bits in 1_u8..128, wanted in 0.05_f32..1.0) {
        let mut rig = Rig::cruising();
        rig.wanted = forward(wanted);
        rig.step();
        // The last bit would be perception, which only limits.
        for source in Source::ALL.into_iter().take(7).filter(|source| bits & (1 << source.index()) != 0) {
            rig.silent.push(source);
        }
        let decision = rig.run_ms(400);
        prop_assert!(decision.permitted == Twist2::ZERO && decision.state != GuardState::Run);
    }

    /// A person who walks straight at the robot with up to 1.6 m/s meets a robot that stands.
    #[test]
    fn fg_req_032_robot_stands_when_a_person_makes_contact(
        walk_mps in 0.0_f32..1.6, distance_m in 3.5_f32..8.0, y_m in -0.35_f32..0.35,
    ) {
        let mut rig = Rig::cruising();
        let mut gap = distance_m;
        for _ in 0..1_500 {
            gap -= (walk_mps + rig.measured.linear_mps) * 0.01;
            let person_x = 0.95 + gap;
            rig.obstacles = [-0.15_f32, 0.0, 0.15].map(|dy| Point2::new(person_x, y_m + dy)).to_vec();
            rig.people = [AdvisedPerson {
                id: 1,
                position: Point2::new(person_x, y_m),
                velocity_mps: Point2::new(-walk_mps, 0.0),
                position_sigma_m: 0.05,
                velocity_sigma_mps: 0.05,
            }].to_vec();
            rig.step();
            if gap <= 0.02 {
                prop_assert!(rig.measured.linear_mps.abs() < 1.0e-3, "moving at contact: {:?}", rig.measured);
                return Ok(());
            }
        }
    }
}
