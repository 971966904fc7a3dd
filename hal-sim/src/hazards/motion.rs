//! Motions that take the body where its sensors do not look.

use super::draft::{Draft, piece};
use super::things::strew;
use crate::scenario::{ManoeuvreFile, MisplacedFile};
use crate::scene::{FurnitureFile, FurnitureKind};

/// Two shelves, a corner, and something that reaches into the way.
pub(super) fn aisle(draft: &mut Draft<'_>) {
    let (width_m, side) = (draft.between(1.0, 1.6), draft.sign());
    let far_m = draft.between(4.0, 6.0);
    // The corner opens to one side: the shelf there ends before it.
    let shelf = |length_m: f32, y_m: f32| FurnitureFile {
        size_m: [length_m, 0.6],
        height_m: 1.8,
        ..piece(FurnitureKind::Shelf, [length_m / 2.0 - 1.0, y_m])
    };
    let near_m = far_m - width_m / 2.0 - 0.2;
    draft.furniture(shelf(near_m + 1.0, side * (width_m / 2.0 + 0.3)));
    draft.furniture(shelf(far_m + width_m / 2.0 + 1.0, -side * (width_m / 2.0 + 0.3)));
    let end_m = [far_m + width_m / 2.0 + 0.3, 0.0];
    draft.furniture(FurnitureFile {
        size_m: [0.6, 3.0],
        height_m: 1.8,
        ..piece(FurnitureKind::Shelf, end_m)
    });
    if draft.chance(0.6) {
        let (deep_m, height_m) = (draft.between(0.05, 0.35), draft.pick(&[0.08, 0.12, 0.3, 0.6, 1.2]));
        let from_m = if draft.chance(0.4) { draft.between(0.2, 0.6) } else { 0.0 };
        let at_m = [draft.between(1.5, far_m), draft.sign() * (width_m / 2.0 - deep_m / 2.0)];
        let length_m = draft.between(0.1, 0.6);
        draft.block(at_m, [length_m, deep_m], [from_m, from_m + height_m]);
    }
    draft.route(&[[far_m, 0.0], [far_m, side * 4.0]]);
}

/// Something a few centimetres beside the rear, and a way that begins with a turn.
pub(super) fn tail(draft: &mut Draft<'_>) {
    let side = draft.sign();
    for _ in 0..draft.count(1, 3) {
        let (gap_m, size_m) =
            (draft.between(0.035, 0.25), [draft.between(0.1, 0.6), draft.between(0.1, 0.6)]);
        let height_m = draft.pick(&[0.05, 0.08, 0.12, 0.3, 0.45, 0.8, 1.5]);
        let from_m = if draft.chance(0.25) { draft.between(0.1, 0.6) } else { 0.0 };
        let at_m = if draft.chance(0.7) {
            [draft.between(-0.6, 0.1), draft.sign() * (0.40 + gap_m + size_m[1] / 2.0)]
        } else {
            [-0.45 - gap_m - size_m[0] / 2.0, draft.between(-0.5, 0.5)]
        };
        draft.block(at_m, size_m, [from_m, from_m + height_m]);
    }
    match draft.count(0, 2) {
        0 => draft.route(&[[0.3, side * 4.0], [3.0, side * 4.0]]),
        1 => draft.route(&[[-4.0, side * 1.5], [-4.0, -side * 2.0]]),
        _ => by_hand(draft, 6),
    }
}

/// Commands one after the other.
fn by_hand(draft: &mut Draft<'_>, count: u32) {
    // The robot has to become ready first.
    draft.scenario.manoeuvre.push(ManoeuvreFile { seconds: 2.0, forward_mps: 0.0, turn_radps: 0.0 });
    for _ in 0..count {
        let (forward_mps, turn_radps) = match draft.count(0, 4) {
            0 => (draft.between(0.3, 1.0), 0.0),
            1 => (draft.between(0.2, 0.7), draft.between(-0.6, 0.6)),
            2 => (0.0, draft.sign() * draft.between(0.2, 0.7)),
            3 => (draft.between(-0.25, -0.1), 0.0),
            _ => (draft.between(-0.25, -0.1), draft.between(-0.4, 0.4)),
        };
        let seconds = draft.between(1.5, 4.0);
        draft.scenario.manoeuvre.push(ManoeuvreFile { seconds, forward_mps, turn_radps });
    }
}

/// Forward, spin and reverse among objects all around.
pub(super) fn manoeuvres(draft: &mut Draft<'_>) {
    by_hand(draft, 7);
    for _ in 0..draft.count(3, 7) {
        let (bearing_rad, far_m) = (draft.between(0.0, core::f32::consts::TAU), draft.between(0.9, 3.0));
        let (sin, cos) = libm::sincosf(bearing_rad);
        let (size_m, height_m) = (
            [draft.between(0.05, 0.8), draft.between(0.05, 0.5)],
            draft.pick(&[0.05, 0.1, 0.2, 0.5, 1.0, 2.0]),
        );
        let from_m = if draft.chance(0.25) { draft.between(0.1, 0.6) } else { 0.0 };
        draft.block([0.25 + far_m * cos, far_m * sin], size_m, [from_m, from_m + height_m]);
    }
}

/// One sensor or both are not where the file says.
pub(super) fn misplaced(draft: &mut Draft<'_>) {
    let mut by = |x_m: f32, z_m: f32, yaw_deg: f32| MisplacedFile {
        x_m: draft.between(-x_m, x_m),
        y_m: draft.between(-x_m, x_m),
        z_m: draft.between(-z_m, z_m),
        yaw_deg: draft.between(-yaw_deg, yaw_deg),
    };
    let (lidar, scanner) = (by(0.1, 0.1, 12.0), by(0.05, 0.05, 12.0));
    let which = draft.count(0, 2);
    draft.scenario.lidar_misplaced = (which != 0).then_some(lidar);
    draft.scenario.scanner_misplaced = (which != 1).then_some(scanner);
    let path = draft.winding();
    let count = draft.count(4, 8);
    strew(draft, &path, count);
}
