//! Cells over many views: what they agree on, what was there at first, what is strange.

use super::*;

const LIMIT: DirtLimit = DirtLimit { score: KeptScore(100), tint: KeptScore(100) };
const FLOOR: FloorTints = FloorTints::AS_GUESSED;

fn seen(scores: &[f32]) -> SeenCell {
    let mut cell = SeenCell::default();
    for (index, score) in scores.iter().enumerate() {
        cell.observe((KeptScore::of(*score), [0; 3]), &FLOOR, (LIMIT, index as u32));
    }
    cell
}

/// Unknown before three views. A reflection that stays for seven of nine makes no dirt, one that stays for five no
/// clean floor either, and the tenth view replaces the first.
#[test]
fn dirt_is_what_views_agree_on() {
    let (dirt, floor) = (30.0, 8.0);
    let state = |scores: &[f32]| seen(scores).state(SeenLayer::Live, LIMIT);
    assert_eq!(seen(&[dirt, dirt]).live(), None);
    assert_eq!(state(&[dirt, dirt, dirt]), CellState::Dirty);
    assert_eq!(state(&[dirt, dirt, floor]), CellState::Unknown);
    assert_eq!(state(&[dirt, floor, floor]), CellState::Clean);
    let mut scores = [floor; 10];
    for (dirty, expected) in
        [(4, CellState::Clean), (5, CellState::Unknown), (7, CellState::Unknown), (8, CellState::Dirty)]
    {
        scores[..dirty].fill(dirt);
        assert_eq!(state(&scores[..9]), expected, "{dirty} of nine");
    }
    assert_eq!(state(&scores), CellState::Unknown);
}

#[test]
fn parts_are_those_of_sorting() {
    let mut random = floorguard_types::random::Pcg32::new(3, 9);
    for count in 3..20_usize {
        let scores: std::vec::Vec<f32> = (0..count).map(|_| random.below(40) as f32).collect();
        let mut newest = scores[count.saturating_sub(WINDOW)..].to_vec();
        newest.sort_by(f32::total_cmp);
        let [agreed, median] = [newest.len() / 9, newest.len() / 2].map(|rank| KeptScore::of(newest[rank]));
        let together = Together { agreed, median, ..Together::default() };
        assert_eq!(seen(&scores).live(), Some(together), "{scores:?}");
    }
}

/// However often a cell was seen, a view replaces the oldest one.
#[test]
fn the_count_of_views_ends_without_a_gap() {
    let mut cell = seen(&[8.0; 9]);
    cell.total = 65_520;
    for view in 0..30_u32 {
        cell.observe((KeptScore(view as u8), [0; 3]), &FLOOR, (LIMIT, view));
        let mut newest = cell.window;
        newest.sort_unstable();
        let oldest = (view as u8).saturating_sub(8);
        assert!(view < 8 || newest.iter().copied().eq(oldest..=view as u8), "{view}: {newest:?}");
    }
    assert_eq!(cell.observations(), 30);
}

/// Cleaning changes the live state and not what was first perceived.
#[test]
fn the_first_perception_stays() {
    let mut cell = seen(&[30.0; 9]);
    (60..72).for_each(|second| cell.observe((KeptScore::of(9.0), [0; 3]), &FLOOR, (LIMIT, second)));
    assert_eq!(cell.state(SeenLayer::First, LIMIT), CellState::Dirty);
    assert_eq!(cell.state(SeenLayer::Live, LIMIT), CellState::Clean);
    (80..92).for_each(|second| cell.observe((KeptScore::of(30.0), [0; 3]), &FLOOR, (LIMIT, second)));
    assert_eq!(cell.state(SeenLayer::Live, LIMIT), CellState::Dirty);
    let since_s = [SeenLayer::First, SeenLayer::Live].map(|layer| cell.dirty_since_s(layer));
    assert_eq!(since_s, [2, 87], "spilled again: eight of nine at the eighth");
}

/// Four distant observations that saw nothing do not keep a closer one from finding dirt; nine
/// observations do.
#[test]
fn a_glance_proves_no_floor_clean() {
    for (glances, expected) in [(4, CellState::Dirty), (9, CellState::Clean)] {
        let mut cell = seen(&std::vec![9.0; glances]);
        (60..72).for_each(|second| cell.observe((KeptScore::of(30.0), [0; 3]), &FLOOR, (LIMIT, second)));
        assert_eq!(cell.state(SeenLayer::First, LIMIT), expected, "{glances}");
    }
}

/// A colour that the floor has nowhere else is dirt though no pixel is rare. On which seven of nine agree, or five, it
/// is none, but clean floor neither; and what was there at first stays known.
#[test]
fn a_strange_colour_is_dirt() {
    let usual = KeptScore::of(8.0);
    for (views, expected) in
        [(4, CellState::Clean), (5, CellState::Unknown), (7, CellState::Unknown), (8, CellState::Dirty)]
    {
        let mut cell = SeenCell::default();
        for view in 0..9_u32 {
            let tint = if view < views { [8, 0, -120] } else { [0, 0, 8] };
            cell.observe((usual, tint), &FLOOR, (LIMIT, view));
        }
        assert_eq!(cell.state(SeenLayer::Live, LIMIT), expected, "{views} of nine");
        (60..70).for_each(|second| cell.observe((usual, [0; 3]), &FLOOR, (LIMIT, second)));
        assert_eq!(cell.state(SeenLayer::First, LIMIT), expected, "{views} of nine");
        assert_eq!(cell.state(SeenLayer::Live, LIMIT), CellState::Clean);
    }
}

/// Where the floor is unknown no colour is strange, however the limits are moved.
#[test]
fn a_limit_that_nothing_exceeds_is_not_moved() {
    let unknown = DirtLimit { score: KeptScore(120), tint: KeptScore(255) };
    assert_eq!(unknown.moved(-1.0), DirtLimit { score: KeptScore(114), ..unknown });
    let saturated = Together { tint: KeptScore(255), ..Together::default() };
    assert!(saturated.excess(unknown.moved(-9.0)) <= 0.0);
}

/// A quarter of the pixels exceeds what is observed.
#[test]
fn an_observation_is_the_upper_quarter() {
    let mut cell = SeenCell::default();
    (0..32_u8).for_each(|pixel| cell.take(f32::from(pixel)));
    assert!((cell.upper_score() - 24.0).abs() < 0.6, "{}", cell.upper_score());
    assert!(cell.close(&FLOOR, (LIMIT, 1)) && !cell.close(&FLOOR, (LIMIT, 1)));
    assert_eq!(cell.observations(), 1);
}
