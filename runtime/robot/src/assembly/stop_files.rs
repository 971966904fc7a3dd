//! The black box on disk: the last ten seconds before each stop, as a table and as the log that the MCU sends.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use anyhow::Context;
use embassy_sync::blocking_mutex::raw::RawMutex;
use floorguard_runtime::black_box_log::{LOG_VERSION, LogMoment, LogRow, encode_row};
use floorguard_runtime::shared::{BoxEntry, Shared, StopRecord};
use floorguard_types::time::Stamp;

/// Writes `stop-0001.csv` and so on: first line the cause, then one line per moment, oldest first; and the same moments
/// as `stop-0001.fgbox` for `floorguard blackbox`. Gives the path of the table.
///
/// # Errors
/// The folder cannot be made or written.
pub fn write_stop_file<M: RawMutex>(
    folder: &Path,
    number: u32,
    (stop, shared): (&StopRecord, &Shared<M>),
) -> anyhow::Result<PathBuf> {
    std::fs::create_dir_all(folder)
        .with_context(|| format!("{}: cannot make this folder", folder.display()))?;
    let mut moments: Vec<(Stamp, BoxEntry)> = Vec::new();
    shared.black_box(|stamp, entry| moments.push((stamp, entry)));
    let log = folder.join(format!("stop-{number:04}.fgbox"));
    std::fs::write(&log, black_box_log(&moments))
        .with_context(|| format!("{}: cannot be written", log.display()))?;
    let path = folder.join(format!("stop-{number:04}.csv"));
    std::fs::write(&path, table(stop, &moments))
        .with_context(|| format!("{}: cannot be written", path.display()))?;
    Ok(path)
}

/// Moments as the MCU sends them.
#[must_use]
pub fn black_box_log(moments: &[(Stamp, BoxEntry)]) -> Vec<u8> {
    let count = u32::try_from(moments.len()).unwrap_or(u32::MAX);
    let begin = [LogRow::Begin(LOG_VERSION, count.into())];
    let rows = moments.iter().map(|(stamp, entry)| LogRow::Moment(LogMoment::new(*stamp, entry)));
    begin.into_iter().chain(rows).chain([LogRow::End(count)]).flat_map(|row| encode_row(&row)).collect()
}

fn table(stop: &StopRecord, moments: &[(Stamp, BoxEntry)]) -> String {
    let mut text = format!("# {:.3} s: {}\n", stop.stamp.as_micros() as f64 * 1.0e-6, stop.cause);
    text.push_str("time_s,state,action,cause,holding,permitted_mps,measured_mps,limit_mps,field_set\n");
    for (stamp, entry) in moments {
        let [cause, holding] = [entry.cause, entry.holding]
            .map(|cause| cause.map(|cause| cause.to_string()).unwrap_or_default());
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{:.3},{:?},{:?},{cause},{holding},{:.3},{:.3},{:.3},{}",
            stamp.as_micros() as f64 * 1.0e-6,
            entry.state,
            entry.action,
            entry.permitted_mps,
            entry.measured_mps,
            entry.limit_mps,
            entry.field_set,
        );
    }
    text
}
