//! People where nobody expects them.

use super::draft::{Draft, piece};
use super::things::strew;
use crate::people::PersonKind;
use crate::scenario::PersonFile;
use crate::scene::{FurnitureFile, FurnitureKind};

/// People who do not move: beside the way, on it, and beside the robot.
pub(super) fn standing(draft: &mut Draft<'_>) {
    let path = if draft.chance(0.5) {
        draft.winding()
    } else {
        draft.straight();
        vec![[8.0, 0.0]]
    };
    for _ in 0..draft.count(1, 4) {
        let kind = draft.pick(&PersonKind::ALL);
        let at_m = [draft.between(2.6, path[0][0] + 1.5), draft.between(-1.1, 1.1)];
        draft.person(kind, at_m);
    }
    if draft.chance(0.4) {
        // Beside the rear; wheelchairs and trolleys need more room.
        let kind = draft.pick(&[PersonKind::Adult, PersonKind::Child, PersonKind::Crouching]);
        let at_m = [draft.between(-0.7, 0.2), draft.sign() * draft.between(0.72, 0.95)];
        draft.person(kind, at_m);
    }
}

/// Shelves along the way with gaps, and people who walk out of them as the robot comes.
pub(super) fn step_out(draft: &mut Draft<'_>) {
    draft.straight();
    let speed_mps = draft.scenario.route.speed_mps;
    for side in [1.0, -1.0] {
        let mut from_m = draft.between(-1.0, 1.5);
        let y_m = side * draft.between(1.0, 1.5);
        for _ in 0..3 {
            let length_m = draft.between(1.0, 3.0);
            let at_m = [from_m + length_m / 2.0, y_m];
            let shelf = piece(FurnitureKind::Shelf, at_m);
            draft.furniture(FurnitureFile { size_m: [length_m, 0.5], height_m: 1.9, ..shelf });
            from_m += length_m;
            let gap_m = draft.between(0.8, 1.2);
            if draft.chance(0.6) {
                let x_m = from_m + gap_m / 2.0;
                walk_out(draft, [x_m, y_m + side * 0.8], (x_m / speed_mps, -side));
            }
            from_m += gap_m;
        }
    }
}

/// Somebody who is on the way about when the robot is; `passes_s` after the robot has started.
fn walk_out(draft: &mut Draft<'_>, at_m: [f32; 2], (passes_s, towards): (f32, f32)) {
    let kinds = [
        PersonKind::Adult,
        PersonKind::Adult,
        PersonKind::Child,
        PersonKind::Trolley,
        PersonKind::Wheelchair,
    ];
    let (kind, speed_mps) = (draft.pick(&kinds), draft.between(0.5, 2.0));
    // It takes the robot two to three seconds to become ready and to gain speed.
    let starts_s = (passes_s + draft.between(-1.5, 2.5)).max(0.0);
    let goal_m = [at_m[0] + draft.between(-0.6, 0.6), at_m[1] + towards * draft.between(1.2, 5.0)];
    draft.scenario.person.push(PersonFile {
        kind,
        at_m,
        speed_mps,
        starts_s,
        goals_m: vec![goal_m, goal_m],
        sees_robot: false,
        ..PersonFile::default()
    });
}

/// The random encounters of old, with objects between.
pub(super) fn crossing(draft: &mut Draft<'_>) {
    draft.straight();
    draft.scenario.random_encounter = true;
    let count = draft.count(0, 3);
    strew(draft, &[[12.0, 0.0]], count);
}
