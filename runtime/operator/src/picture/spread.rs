//! Marks that would cover each other step aside, so that every number can be read.

/// Rings of places that are tried around a mark.
const RINGS: u8 = 6;
/// Places on a ring.
const DIRECTIONS: u8 = 12;

/// Where each mark is drawn: at its own place, or at the nearest free one, `apart_px` from all marks before it. Marks that
/// find no free place stay where they are.
#[must_use]
pub fn spread(places: &[(f32, f32)], apart_px: f32) -> Vec<(f32, f32)> {
    let mut drawn: Vec<(f32, f32)> = Vec::with_capacity(places.len());
    for (x, y) in places {
        let is_free = |at: &(f32, f32)| {
            drawn.iter().all(|(other_x, other_y)| (at.0 - other_x).hypot(at.1 - other_y) >= apart_px * 0.95)
        };
        let around = (1..=RINGS).flat_map(|ring| {
            (0..DIRECTIONS).map(move |direction| {
                let angle = f32::from(direction) * std::f32::consts::TAU / f32::from(DIRECTIONS);
                let radius_px = f32::from(ring) * apart_px;
                (x + radius_px * angle.cos(), y - radius_px * angle.sin())
            })
        });
        let place = std::iter::once((*x, *y)).chain(around).find(is_free);
        drawn.push(place.unwrap_or((*x, *y)));
    }
    drawn
}

#[cfg(test)]
mod tests {
    use super::spread;

    #[test]
    fn coincident_marks_spread_lone_ones_stay() {
        let places = [[(5.0, 5.0); 9].as_slice(), &[(500.0, 5.0)]].concat();
        let drawn = spread(&places, 16.0);
        assert_eq!((drawn[0], drawn[9]), (places[0], places[9]));
        for (index, (x, y)) in drawn.iter().enumerate() {
            let near = drawn.iter().filter(|(a, b)| (a - x).hypot(b - y) < 15.0).count();
            assert_eq!(near, 1, "mark {index} is covered: {drawn:?}");
        }
    }
}
