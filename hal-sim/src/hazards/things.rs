//! What stands on the way.

use super::draft::{Draft, piece};
use crate::scene::{DropFile, FurnitureFile, FurnitureKind, Material};

/// Heights of objects on the floor, metres.
const HEIGHTS_M: [f32; 10] = [0.03, 0.05, 0.08, 0.12, 0.2, 0.3, 0.45, 0.6, 1.0, 2.0];

/// Objects beside the legs of a way and on them.
pub(super) fn strew(draft: &mut Draft<'_>, path: &[[f32; 2]], count: u32) {
    for _ in 0..count {
        let leg = draft.random.below(path.len() as u32) as usize;
        let (from, to) = (if leg == 0 { [0.0, 0.0] } else { path[leg - 1] }, path[leg]);
        let (along, aside_m) = (draft.between(0.1, 1.1), draft.between(-1.3, 1.3));
        let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
        let length_m = libm::hypotf(dx, dy).max(0.1);
        let at_m =
            [from[0] + along * dx - aside_m * dy / length_m, from[1] + along * dy + aside_m * dx / length_m];
        let size_m = [draft.between(0.05, 1.0), draft.between(0.05, 0.6)];
        let height_m = draft.pick(&HEIGHTS_M);
        let from_m = if draft.chance(0.25) { draft.between(0.1, 0.7) } else { 0.0 };
        let kind = draft.pick(&[FurnitureKind::Box, FurnitureKind::Box, FurnitureKind::Post]);
        let (yaw_deg, material) = (draft.between(0.0, 180.0), draft.pick(&[Material::Matte, Material::Dark]));
        let height_m = if from_m > 0.0 { from_m + draft.between(0.02, 0.5) } else { height_m };
        draft.furniture(FurnitureFile { size_m, height_m, from_m, yaw_deg, material, ..piece(kind, at_m) });
    }
}

pub(super) fn scatter(draft: &mut Draft<'_>) {
    let path = draft.winding();
    let count = draft.count(4, 10);
    strew(draft, &path, count);
}

/// A board that hangs or stands on legs beside the way.
pub(super) fn overhang(draft: &mut Draft<'_>) {
    draft.straight();
    let z_m = draft.between(0.25, 0.85);
    let (size_m, yaw_deg) = ([draft.between(0.3, 1.0), draft.between(1.0, 2.6)], draft.between(-30.0, 30.0));
    let at_m = [draft.between(2.5, 7.0), draft.between(-0.7, 0.7)];
    if draft.chance(0.3) {
        let table = piece(FurnitureKind::Table, at_m);
        draft.furniture(FurnitureFile { size_m, yaw_deg, height_m: z_m + 0.03, ..table });
        return;
    }
    let height_m = z_m + draft.between(0.02, 0.10);
    draft.furniture(FurnitureFile {
        size_m,
        yaw_deg,
        from_m: z_m,
        height_m,
        ..piece(FurnitureKind::Box, at_m)
    });
}

pub(super) fn low(draft: &mut Draft<'_>) {
    draft.straight();
    for _ in 0..draft.count(1, 2) {
        let at_m = [draft.between(2.5, 7.0), draft.between(-0.5, 0.5)];
        let size_m = [draft.between(0.05, 0.6), draft.between(0.1, 0.8)];
        let (height_m, yaw_deg) =
            (draft.pick(&[0.03, 0.05, 0.08, 0.10, 0.12, 0.14, 0.20]), draft.between(0.0, 90.0));
        let material = draft.pick(&[Material::Matte, Material::Dark]);
        draft.furniture(FurnitureFile {
            size_m,
            height_m,
            yaw_deg,
            material,
            ..piece(FurnitureKind::Box, at_m)
        });
    }
}

pub(super) fn forks(draft: &mut Draft<'_>) {
    draft.straight();
    let at_m = [draft.between(3.0, 7.0), draft.between(-0.9, 0.9)];
    let yaw_deg = draft.pick(&[0.0, 90.0, -90.0, 180.0, 180.0]) + draft.between(-30.0, 30.0);
    let (from_m, length_m) = (draft.between(0.03, 0.25), draft.between(0.9, 1.2));
    let forks = piece(FurnitureKind::Forks, at_m);
    draft.furniture(FurnitureFile {
        size_m: [length_m, 0.6],
        yaw_deg,
        from_m,
        height_m: from_m + 0.06,
        ..forks
    });
}

pub(super) fn glass(draft: &mut Draft<'_>) {
    draft.straight();
    let at_m = [draft.between(3.0, 7.0), draft.between(-0.6, 0.6)];
    let (size_m, height_m) = ([0.02, draft.between(0.8, 3.0)], draft.between(0.8, 2.2));
    let yaw_deg = if draft.chance(0.3) { 0.0 } else { draft.between(-70.0, 70.0) };
    let material = draft.pick(&[Material::Glass, Material::Glass, Material::Mirror]);
    draft.furniture(FurnitureFile { size_m, height_m, yaw_deg, material, ..piece(FurnitureKind::Box, at_m) });
}

pub(super) fn edge(draft: &mut Draft<'_>) {
    let depth_m = draft.between(0.15, 1.2);
    let size_m = [draft.between(0.8, 3.0), draft.between(1.5, 4.0)];
    let (at_m, yaw_deg) = if draft.chance(0.6) {
        ([draft.between(3.0, 6.0) + size_m[0] / 2.0, draft.between(-0.5, 0.5)], draft.between(-20.0, 20.0))
    } else {
        let side = draft.sign();
        ([draft.between(4.0, 6.0), side * (size_m[1] / 2.0 + draft.between(0.2, 0.7))], 0.0)
    };
    draft.scenario.scene.drop.push(DropFile { at_m, size_m, yaw_deg, depth_m });
    draft.straight();
}

pub(super) fn ramp(draft: &mut Draft<'_>) {
    draft.straight();
    let at_m = [draft.between(3.5, 7.0), draft.between(-0.7, 0.7)];
    let size_m = [draft.between(1.0, 2.5), draft.between(0.6, 1.5)];
    let (yaw_deg, height_m) = (draft.pick(&[0.0, 90.0, -90.0, 180.0]), draft.between(0.08, 0.5));
    draft.furniture(FurnitureFile { size_m, height_m, yaw_deg, ..piece(FurnitureKind::Ramp, at_m) });
}

/// Rails across the way and posts on it.
pub(super) fn thin(draft: &mut Draft<'_>) {
    let path = if draft.chance(0.5) {
        draft.winding()
    } else {
        draft.straight();
        vec![[8.0, 0.0]]
    };
    for _ in 0..draft.count(1, 4) {
        let at_m = [draft.between(2.0, path[0][0] + 1.0), draft.between(-0.6, 0.6)];
        let (thick_m, z_m) = (draft.between(0.02, 0.04), draft.between(0.05, 0.86));
        if draft.chance(0.5) {
            let (size_m, yaw_deg) = ([thick_m, draft.between(0.6, 2.5)], draft.between(-40.0, 40.0));
            let rail = piece(FurnitureKind::Box, at_m);
            draft.furniture(FurnitureFile { size_m, yaw_deg, from_m: z_m, height_m: z_m + thick_m, ..rail });
        } else {
            let (height_m, material) =
                (draft.between(0.1, 2.0), draft.pick(&[Material::Matte, Material::Dark]));
            let post = piece(FurnitureKind::Post, at_m);
            draft.furniture(FurnitureFile { size_m: [thick_m; 2], height_m, material, ..post });
        }
    }
}
