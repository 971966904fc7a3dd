//! Plans as they are typed.

use super::*;
use clap::Parser as _;

#[derive(clap::Parser)]
struct Line {
    #[command(flatten)]
    simulate: SimulateArguments,
}

#[test]
fn run_repeat_command_is_complete() {
    for more in [
        "",
        " --strategy systematic --lidar pandar-xt16 --scanner microscan3 --imu bridged --camera",
        " --strategy guarantee --robot mine.toml --until-clean",
        " --fault lidar:drop=5% --fault scanner:silent,from=2s --emergency-stop 2..3",
        " --real-io",
    ] {
        let typed = format!("floorguard simulate --scenario crossing --seed 7 --duration 9.5{more}");
        let words = typed.split(' ').skip(1);
        assert_eq!(repeat(&Line::try_parse_from(words).unwrap().simulate), typed);
    }
}

#[test]
fn impossible_plans_are_reported_before_the_run() {
    let refused = |more: &str| {
        let typed = format!("simulate --scenario crossing {more}");
        let arguments = Line::try_parse_from(typed.split(' ')).unwrap().simulate;
        run(&arguments).unwrap_err().to_string()
    };
    let wrong = Line::try_parse_from(["simulate", "--scenario", "crossing", "--duration", "-1"]);
    assert!(wrong.is_err_and(|error| error.to_string().contains("give seconds")));
    // Nothing was recorded: nothing has run.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("never.mcap");
    let record = path.display();
    let tape = refused(&format!("--duration 1 --tape /dev/null/tape --record {record}"));
    assert!(tape.contains("/dev/null/tape: cannot be written"), "{tape}");
    let start = refused(&format!("--duration 1 --learn /dev/null/model --start yesterday --record {record}"));
    assert!(start.contains("/dev/null/model") || start.contains("'yesterday' is not a moment"), "{start}");
    assert!(!path.exists());
}
