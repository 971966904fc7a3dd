//! What the command tells a person or a program at its end.

use floorguard_host::words::counted;

use super::arguments::CleanArguments;
use super::result::CleanSummary;

/// Prints it.
///
/// # Errors
/// Standard output takes nothing.
pub fn report(arguments: &CleanArguments, lidar: &str, summary: &CleanSummary) -> anyhow::Result<()> {
    if arguments.json {
        return Ok(tell!("{}", serde_json::to_string(summary)?)?);
    }
    let share = |part: u64| 100.0 * part as f64 / summary.returns.max(1) as f64;
    say!("cleaned: {} ({lidar})", arguments.out.display());
    say!("  {} and {}", counted(summary.sweeps, "sweep"), counted(summary.returns, "return"));
    say!(
        "  removed: {} of what moved ({:.2} %)",
        counted(summary.returns_moved, "return"),
        share(summary.returns_moved)
    );
    if arguments.boxes.is_some() {
        let [used, unused] = [summary.pictures_used, summary.pictures_unused];
        say!("  pictures: {used} used, {unused} without a sweep or a pose at their time");
        say!(
            "  boxes: {} became {}, {} had too few lidar points, {} were unsure, {} beyond 32 in a picture",
            summary.boxes_placed,
            counted(summary.places as u64, "place"),
            summary.boxes_without_points,
            summary.boxes_not_sure,
            summary.boxes_beyond_32
        );
    }
    if arguments.people.is_some() || arguments.boxes.is_some() {
        say!("  and {} in boxes around people", counted(summary.returns_in_boxes, "return"));
    }
    say!(
        "  floor below what was removed: {:.1} m², of which {:.1} m² were seen ({:.0} %)",
        summary.removed_m2,
        summary.filled_m2,
        100.0 * summary.filled_share
    );
    notes(summary);
    say!(
        "  clouds: {} stay, {} were removed",
        counted(summary.points_clean as u64, "point"),
        summary.points_removed
    );
    say!(
        "  took {:.1} + {:.1} ms a sweep, reading included",
        summary.observe_ms_per_sweep,
        summary.judge_ms_per_sweep
    );
    say!("  look at {}", arguments.out.join("view.html").display());
    Ok(())
}

fn notes(summary: &CleanSummary) {
    if summary.sweeps_without_pose > 0 {
        let sweeps = counted(summary.sweeps_without_pose, "sweep");
        say!("  note: {sweeps} have no pose at their time and are in no cloud");
    }
    if summary.sweeps_without_floor > 0 {
        let sweeps = counted(summary.sweeps_without_floor, "sweep");
        say!("  note: no floor in {sweeps}; nothing of them was removed");
    }
    if summary.places_left_out > 0 {
        say!("  note: {} of people were left out: 1,024 are kept", counted(summary.places_left_out, "place"));
    }
}
