//! Whole missions in small rooms: what is claimed, against what is true.

use floorguard_host::executor::StopFlag;
use floorguard_laboratory::mission::{
    Memory, MissionConfig, MissionStorage, RunMonitor, Strategy, TrialResult, run, run_keeping,
    run_strategies_believing,
};
use floorguard_robot::site::{DirtSource, Floor, rooms};
use floorguard_types::random::Pcg32;

#[test]
fn the_guarantee_is_kept_in_a_plain_room() {
    let floor = Floor::new("plain", rooms::plain().expect("a room"), 0.17).expect("a floor");
    let dirt = DirtSource::Cells { count: 25, units: vec![10.0, 15.0, 20.0, 25.0] };
    let mut paths_m = Vec::new();
    for strategy in [Strategy::Guarantee, Strategy::NoReplanning, Strategy::Systematic] {
        for seed in 0..3 {
            let expected = dirt.expected_units(&floor, &mut Pcg32::new(seed, 77)).expect("dirt");
            let config = MissionConfig::published(strategy);
            let begin = std::time::Instant::now();
            let result = run(&floor, &config, &expected, seed).expect("a mission");
            paths_m.push(result.distance_m);
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
    let (guarantee, others) = paths_m.split_at(3);
    let (once, lanes) = others.split_at(3);
    assert!(mean(once) < mean(guarantee) && mean(guarantee) < mean(lanes));
}

/// Power fails again and again until the mission is done: nothing that was cleaned is forgotten, nothing is claimed
/// that is not clean, and the path is hardly longer than in one go.
#[test]
fn power_cuts_cost_no_claims_little_distance() {
    let floor = Floor::new("plain", rooms::plain().expect("a room"), 0.17).expect("a floor");
    let dirt = DirtSource::Cells { count: 25, units: vec![8.0, 15.0] };
    for (strategy, every_s) in [(Strategy::Guarantee, 120.0), (Strategy::Systematic, 500.0)] {
        let expected = dirt.expected_units(&floor, &mut Pcg32::new(5, 77)).expect("dirt");
        let config = MissionConfig::published(strategy);
        let whole = run(&floor, &config, &expected, 5).expect("a mission");
        let mut memory: Option<Memory> = None;
        let mut cuts = 0;
        let result = loop {
            let begin_s = memory.as_ref().map_or(0.0, |memory| memory.time_s);
            let mut newest = None;
            let mut keep = |now: &Memory| {
                if now.time_s > begin_s + every_s {
                    anyhow::bail!("power fails");
                }
                newest = Some(Memory::decode(&now.encode())?);
                Ok(())
            };
            let storage = MissionStorage { from: memory.as_ref(), keep: Some(&mut keep), ended: None };
            match run_keeping(&floor, &config, (&expected, &expected), (5, storage)) {
                Ok(result) => break result,
                Err(_) => cuts += 1,
            }
            assert!(newest.is_some() && cuts < 40, "{}: does not come on", strategy.name());
            memory = newest;
        };
        println!(
            "{}: {cuts} cuts, {:.1} m instead of {:.1} m, covered {:.3} instead of {:.3}, {} of {} claimed, {} falsely",
            strategy.name(),
            result.distance_m,
            whole.distance_m,
            result.covered_share,
            whole.covered_share,
            result.claimed_cells,
            result.dirty_cells,
            result.falsely_claimed_cells
        );
        assert!(cuts >= 2);
        assert!(result.distance_m < 1.35 * whole.distance_m);
        assert!(result.falsely_claimed_cells <= 1);
        if strategy == Strategy::Guarantee {
            assert!(result.is_complete && result.claimed_cells == result.dirty_cells);
        } else {
            assert!(result.covered_share > 0.98);
        }
    }
}

#[test]
fn a_memory_of_another_mission_is_refused() {
    let floor = Floor::new("plain", rooms::plain().expect("a room"), 0.17).expect("a floor");
    let dirt = DirtSource::Cells { count: 3, units: vec![8.0] };
    let expected = dirt.expected_units(&floor, &mut Pcg32::new(5, 77)).expect("dirt");
    let config = MissionConfig::published(Strategy::Guarantee);
    let other = Memory { about: 1, ..Memory::default() };
    let storage = MissionStorage { from: Some(&other), ..MissionStorage::default() };
    assert!(run_keeping(&floor, &config, (&expected, &expected), (5, storage)).is_err());
}

/// Somebody ends a campaign after its third mission: what every strategy has done counts, and nothing half done does.
#[test]
fn finished_missions_count_after_early_end() {
    let floor = Floor::new("plain", rooms::plain().expect("a room"), 0.17).expect("a floor");
    let dirt = DirtSource::Cells { count: 2, units: vec![8.0] };
    let config = MissionConfig::published(Strategy::Guarantee);
    let strategies = [Strategy::Guarantee, Strategy::NoReplanning];
    let (ended, done) = (StopFlag::default(), std::sync::atomic::AtomicU32::new(0));
    let progress = |_: Strategy, _: &TrialResult| {
        if done.fetch_add(1, std::sync::atomic::Ordering::Relaxed) + 1 >= 3 {
            ended.stop();
        }
    };
    let monitor = RunMonitor { progress: &progress, ended: &ended };
    // Trials run side by side; on any number of cores hundreds cannot all have ended by the third mission.
    let columns = run_strategies_believing(&floor, (&strategies, &config, &dirt), None, (300, 1), &monitor)
        .expect("missions");
    let counts: Vec<usize> = columns.iter().map(|column| column.trials.len()).collect();
    assert!(counts[0] == counts[1] && counts[0] < 150, "{counts:?}");
    assert!(columns[0].trials.iter().all(|trial| trial.claimed_cells > 0));
}
