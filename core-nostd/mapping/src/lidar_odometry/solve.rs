//! Rounds of Gauss and Newton: the state that fits a sweep, a prediction, and what else is known.

use floorguard_types::number::nearest_f32_of_f64;

use super::align::{AlignConfig, Match, Round, Sums, SweepInformation, Weakest, measure};
use super::averaging::AveragedReturn;
use super::filter::{FloorPrior, Matrix12, MotionAid, MotionState, Quadratic, Vector12};
use super::sweep_motion::SweepMotion;
use super::voxel_map::{Bucket, VoxelMap};

/// How far away a result is looked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Effort {
    /// Near the prediction.
    Usual,
    /// Where the prediction failed, or nothing is known of the velocity.
    Wide,
}

/// How the kernel narrows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rounds {
    most: u32,
    /// Factor of the kernel in the first round; its root in the second, and so on.
    widening: f32,
}

impl AlignConfig {
    pub(super) fn rounds_of(&self, effort: Effort) -> Rounds {
        match effort {
            Effort::Usual => Rounds { most: self.rounds, widening: self.kernel_first },
            Effort::Wide => Rounds { most: self.rounds_wide, widening: self.kernel_wide },
        }
    }
}

/// What is known besides returns and prediction.
pub(super) struct Knowledge<'a> {
    pub(super) aid: &'a MotionAid,
    pub(super) floor: Option<&'a FloorPrior>,
    pub(super) duration_s: f64,
}

/// A state that fits.
pub(super) struct Found {
    pub(super) state: MotionState,
    pub(super) sums: Sums,
    /// Squared deviations of the pose that the returns alone ask for from the one that was found; infinite if they ask for
    /// none.
    pub(super) tension: f64,
    pub(super) weakest: Weakest,
}

/// No configuration asks for more corrections of a sweep.
const ROUNDS_MAX: u32 = 100;
/// A widening below this is none.
const NARROW: f32 = 1.3;

/// `None` if the sum of all information is not positive.
pub(super) fn solve<S: AsRef<[Bucket]> + AsMut<[Bucket]>>(
    before: &MotionState,
    (returns, matches): (&[AveragedReturn], &mut [Match]),
    map: &VoxelMap<S>,
    (config, rounds, knowledge): (&AlignConfig, Rounds, &Knowledge<'_>),
) -> Option<Found> {
    let information = before.information()?;
    let mut state = *before;
    let mut widening = rounds.widening;
    let mut sums = Sums::none();
    let (mut weakest, mut tension) = (Weakest::of_nothing(), f64::INFINITY);
    for _ in 0..rounds.most.min(ROUNDS_MAX) {
        let motion = SweepMotion::new(&state.pose, &state.twist, knowledge.duration_s);
        let wide = config.kernel * widening;
        let round = Round { config, kernel: wide * wide, motion: &motion };
        let end = state.pose.place_m.map(nearest_f32_of_f64);
        sums = measure((returns, &mut *matches), map, &round, &end);
        let seen =
            (sums.matched >= config.matched_least).then(|| sums.information(&state.pose, config.alike));
        weakest = seen.as_ref().map_or_else(Weakest::of_nothing, |seen| seen.weakest);
        tension = seen.as_ref().and_then(|seen| seen.quadratic.pose_tension()).unwrap_or(f64::INFINITY);
        let step = correct(&mut state, (before, &information), seen, knowledge)?;
        let moved = step.fixed_rows::<3>(3).norm_squared() < config.step_m * config.step_m;
        let turned = step.fixed_rows::<3>(0).norm_squared() < config.turn_rad * config.turn_rad;
        if moved && turned && widening <= 1.0 {
            break;
        }
        widening = libm::sqrtf(widening);
        if widening < NARROW {
            widening = 1.0;
        }
    }
    Some(Found { state, sums, tension, weakest })
}

/// One round.
fn correct(
    state: &mut MotionState,
    (before, information): (&MotionState, &Matrix12),
    seen: Option<SweepInformation>,
    knowledge: &Knowledge<'_>,
) -> Option<Vector12> {
    let mut all = Quadratic::of_prior(information, &state.difference(before));
    all.add_aid(knowledge.aid, &state.twist);
    if let Some(floor) = knowledge.floor {
        all.add_floor(floor, &state.pose);
    }
    if let Some(SweepInformation { quadratic, .. }) = seen {
        all.information += quadratic.information;
        all.gradient += quadratic.gradient;
    }
    let factor = all.information.cholesky()?;
    let step = -factor.solve(&all.gradient);
    *state = state.corrected(&step);
    state.covariance = factor.inverse();
    Some(step)
}
