//! A person as discs on the floor, for judges: near the floor, where a safety scanner looks, and as a whole.

use floorguard_types::geometry::Point2;

use super::{Person, PersonKind};

/// A disc: middle in the world frame, radius in metres.
pub type Disc = (Point2, f32);

/// What crosses the scan plane of a safety scanner (about 0.15 m): feet, wheels, a suitcase.
#[must_use]
pub fn ground_discs(person: &Person) -> Vec<Disc> {
    let disc = |ahead_m, left_m, radius_m| (person.beside(ahead_m, left_m), radius_m);
    match person.kind {
        PersonKind::Wheelchair => vec![
            disc(0.35, 0.1, 0.07),
            disc(0.35, -0.1, 0.07),
            disc(-0.3, 0.29, 0.03),
            disc(-0.1, 0.29, 0.03),
            disc(0.1, 0.29, 0.03),
            disc(-0.3, -0.29, 0.03),
            disc(-0.1, -0.29, 0.03),
            disc(0.1, -0.29, 0.03),
        ],
        PersonKind::Crouching => vec![disc(0.1, 0.1, 0.09), disc(0.1, -0.1, 0.09)],
        PersonKind::Lying => {
            vec![disc(0.0, 0.0, 0.2), disc(0.25, 0.0, 0.22), disc(0.45, 0.0, 0.2), disc(0.72, 0.0, 0.1)]
        }
        kind => {
            let radius_m = 0.065 * kind.height_m() / 1.75 * person.build.breadth;
            let mut discs: Vec<Disc> = person.feet().map(|foot| (foot, radius_m)).to_vec();
            if kind == PersonKind::Luggage {
                discs.push(disc(-0.55, 0.1, 0.17));
            }
            discs
        }
    }
}

/// Everything of the person at any height.
#[must_use]
pub fn body_discs(person: &Person) -> Vec<Disc> {
    let disc = |ahead_m, left_m, radius_m| (person.beside(ahead_m, left_m), radius_m);
    let mut discs = ground_discs(person);
    discs.push((person.position, person.radius_m()));
    match person.kind {
        PersonKind::Trolley => discs.extend([0.45, 0.75, 1.05].map(|ahead_m| disc(ahead_m, 0.0, 0.29))),
        PersonKind::Luggage => discs.push(disc(-0.55, 0.1, 0.25)),
        PersonKind::Lying => discs.extend([-0.8, -0.55, -0.3].map(|ahead_m| disc(ahead_m, 0.0, 0.18))),
        PersonKind::Reaching => discs.extend([0.45, 0.6, 0.75].map(|ahead_m| disc(ahead_m, 0.18, 0.08))),
        PersonKind::Wheelchair => discs.extend([disc(0.25, 0.0, 0.3), disc(-0.2, 0.0, 0.35)]),
        _ => {}
    }
    discs
}
