//! Whole missions in small rooms: what is claimed, against what is true.

use floorguard_core::random::Pcg32;
use floorguard_hosted::mission::{DirtSource, Floor, MissionConfig, Strategy, rooms, run};

#[test]
fn the_guarantee_is_kept_in_a_plain_room() {
    let floor = Floor::new("plain", rooms::plain().expect("a room"), 0.17).expect("a floor");
    let dirt = DirtSource::Cells { count: 25, units: vec![10.0, 15.0, 20.0, 25.0] };
    let mut ways_m = Vec::new();
    for strategy in [Strategy::Guarantee, Strategy::NoReplanning, Strategy::Systematic] {
        for seed in 0..3 {
            let expected = dirt.expected_units(&floor, &mut Pcg32::new(seed, 77)).expect("dirt");
            let config = MissionConfig::published(strategy);
            let begin = std::time::Instant::now();
            let result = run(&floor, &config, &expected, seed).expect("a mission");
            ways_m.push(result.distance_m);
            // 25 cells with δ = 0.01 each: more than one false claim in a mission is beyond chance.
            assert!(result.falsely_claimed_cells <= 1, "{}", strategy.name());
            if strategy == Strategy::Guarantee {
                assert!(result.is_complete && result.success);
                assert_eq!(result.claimed_cells, result.dirty_cells);
            }
            println!(
                "{} q99 {} all {} max {} {:.1} m {:.0} s replans {} claimed {}/{} false {} truly {}/{} err {:.3} update {:.3} ms plan {:?} bumps {} distrusts {} complete {} took {:.2} s",
                strategy.name(),
                result.quantile99,
                result.quantile99_all,
                result.max_left,
                result.distance_m,
                result.time_s,
                result.replannings,
                result.claimed_cells,
                result.dirty_cells,
                result.falsely_claimed_cells,
                result.truly_clean_claimed_cells,
                result.truly_clean_cells,
                result.mean_error_m,
                1e3 * result.update_s,
                result.planning_s,
                result.bumps,
                result.distrusts,
                result.is_complete,
                begin.elapsed().as_secs_f64()
            );
        }
    }
    let mean = |part: &[f32]| part.iter().sum::<f32>() / part.len() as f32;
    let (guarantee, others) = ways_m.split_at(3);
    let (once, lanes) = others.split_at(3);
    assert!(mean(once) < mean(guarantee) && mean(guarantee) < mean(lanes));
}
