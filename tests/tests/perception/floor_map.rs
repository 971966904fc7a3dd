//! The map of seen dirt: under lamps that shine back what is spilled is found, and reflections make no spots; on chips and
//! grain it is found though no pixel of it is a stranger.

use floorguard_sim::floor::FloorKind;
use floorguard_tests::dirt::{OFFSETS, pass};
use rayon::prelude::*;

/// One lane of 4 m over each of the two glossiest floors. With a plain median of nine views both have a spot too many.
#[test]
fn reflections_are_no_dirt() {
    [FloorKind::Epoxy, FloorKind::Tiles].into_par_iter().for_each(|floor| {
        let pass = pass(floor, (1, 4.0), 20_261_121_002).expect("judged");
        let (hits, spills) =
            pass.found.iter().fold((0, 0), |sum, (_, hits, all)| (sum.0 + hits, sum.1 + all));
        assert_eq!((hits, spills), (2, 2), "{floor:?}: {:?}", pass.spots);
        assert_eq!(pass.false_spots, 0, "{floor:?}: {:?}", pass.spots);
        // The curve holds the map's own limit.
        let own = OFFSETS.iter().position(|offset| *offset == 0.0).expect("the map's own");
        assert_eq!(pass.trade[own], (hits, pass.false_spots));
        assert!(pass.trade.iter().all(|(found, _)| *found <= spills), "{:?}", pass.trade);
    });
}

/// Lanes of 4 m over terrazzo and wood. On every one lies a spill of the colour of the floor's own chips or grain: by the
/// rarity of pixels alone three of the eight spills are found, by the colour of the place as well seven.
#[test]
fn what_tints_chips_and_grain_is_dirt() {
    let lanes =
        [(FloorKind::Terrazzo, 1), (FloorKind::Terrazzo, 3), (FloorKind::Wood, 1), (FloorKind::Wood, 3)];
    let passes: Vec<_> =
        lanes.into_par_iter().map(|(floor, seed)| pass(floor, (1, 4.0), seed).expect("judged")).collect();
    let found: u32 = passes.iter().flat_map(|pass| pass.found.map(|(_, hits, _)| hits)).sum();
    let invented: u32 = passes.iter().map(|pass| pass.false_spots).sum();
    assert!(found >= 7 && invented == 0, "{found} of 8 found, {invented} invented");
}
