//! A small seeded slice of the published experiments; the whole is `cargo xtask reproduce cleaning`.

use floorguard_tests::reproduce::{FigureFive, environments, figure_five, figure_six, table_one};

#[test]
fn table_one_guarantee_beats_lanes_in_distance() {
    let table = table_one(2).expect("built-in rooms");
    println!("{}", table.text());
    assert!(table.holds());
    assert!(table.distance_ratio() > 1.5, "{}", table.distance_ratio());
    // Two missions do not rank the others, but driving at random has never cleaned 25 cells.
    assert!(table.columns[3].trials.iter().all(|t| !t.success));
}

#[test]
fn figure_five_at_its_edges() {
    let all = environments().expect("maps");
    let plain = all.first().expect("the plain room is built in");
    let cells = figure_five(plain, &[0.05], &[(5.0, 10.0), (25.0, 30.0)], (1, None)).expect("missions");
    let figure = FigureFive { cells };
    println!("{}", figure.text());
    assert!(figure.holds());
}

#[test]
fn figure_six_compares_the_same_missions() {
    let six = figure_six(4).expect("built-in rooms");
    println!("{}", six.text());
    let test = six.test();
    assert_eq!(test.pairs, 4);
    // Same seed, same dirt, same wheels: only the belief differs, and it must not be worse.
    assert!(test.mean_difference > -0.005, "{test:?}");
    assert!(six.with_dirt.trials.iter().all(|t| t.mean_error_m < 0.1));
}
