//! Sweeps of the simulator beside the project, which shares nothing with ours: two real floor plans, walkers with labels.

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, ensure};
use floorguard_mapping_host::clean::{RawReturn, RawSweep, Track};
use floorguard_mapping_host::metrics::read_tum;
use floorguard_types::geometry::Point3;

use super::chance::Chance;

/// Height of the simulated sensor above the floor, metres.
const SENSOR_M: f64 = 0.8;
/// Duration of a simulated revolution: 1,808 firings of 55.296 µs.
const SWEEP_S: f64 = 1_808.0 * 55.296e-6;

/// A simulated drive.
pub struct SimulatedDrive {
    sweeps: PathBuf,
    rows: Vec<[f64; 6]>,
    /// True poses of the sensor.
    pub track: Track,
}

/// A sweep with the number of the person that each return came from; 0 for the building.
#[derive(Clone, Debug, Default)]
pub struct LabelledSweep {
    /// As the sensor measured it.
    pub sweep: RawSweep,
    /// Person, from 1; 0 is static.
    pub labels: Vec<u8>,
}

/// Compiles the simulator with the C++ compiler of the machine and lets it drive through a plan, in `folder`.
///
/// # Errors
/// No compiler, or a file that cannot be written.
pub fn simulate(data: &Path, plan: &str, walkers: u8, folder: &Path) -> anyhow::Result<SimulatedDrive> {
    std::fs::create_dir_all(folder)?;
    let program = folder.join("simvlp");
    if !program.exists() {
        let mut compiler = Command::new("c++");
        let status = compiler.arg("-O2").arg(data.join("simvlp.cpp")).arg("-o").arg(&program).status();
        ensure!(status.context("c++, the C++ compiler")?.success(), "the simulator cannot be compiled");
    }
    let base = folder.join(plan);
    for kind in ["grid", "traj"] {
        let mut bytes = Vec::new();
        let packed = data.join(format!("{plan}.{kind}.gz"));
        flate2::read::GzDecoder::new(File::open(&packed)?).read_to_end(&mut bytes)?;
        std::fs::write(folder.join(format!("{plan}.{kind}")), bytes)?;
    }
    let out = folder.join(format!("{plan}_{walkers}"));
    let sweeps = out.with_extension("bin");
    if !sweeps.exists() {
        let mut run = Command::new(&program);
        let status = run.arg(&base).arg(&out).args(["0.015", "2"]).arg(walkers.to_string()).status()?;
        ensure!(status.success(), "the simulator ended with {status}");
    }
    let rows = rows(&std::fs::read_to_string(base.with_extension("traj"))?)?;
    let track = track_of(&rows)?;
    Ok(SimulatedDrive { sweeps, rows, track })
}

/// Time, x, y, yaw, roll, pitch a line.
fn rows(text: &str) -> anyhow::Result<Vec<[f64; 6]>> {
    let mut rows = Vec::new();
    for line in text.lines() {
        let numbers: Vec<f64> = line.split_whitespace().map(str::parse).collect::<Result<_, _>>()?;
        rows.push(numbers.try_into().map_err(|_| anyhow::anyhow!("six numbers a line of the true path"))?);
    }
    Ok(rows)
}

fn track_of(rows: &[[f64; 6]]) -> anyhow::Result<Track> {
    let mut tum = String::new();
    for [time_s, x, y, yaw, roll, pitch] in rows {
        let [qx, qy, qz, qw] = quaternion(*roll, *pitch, *yaw);
        tum += &format!("{time_s} {x} {y} {SENSOR_M} {qx} {qy} {qz} {qw}\n");
    }
    Ok(Track::new(read_tum(&tum)?)?)
}

/// Of turns about fixed axes, x first.
pub fn quaternion(roll: f64, pitch: f64, yaw: f64) -> [f64; 4] {
    let ((sr, cr), (sp, cp), (sy, cy)) =
        ((0.5 * roll).sin_cos(), (0.5 * pitch).sin_cos(), (0.5 * yaw).sin_cos());
    [
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
        cr * cp * cy + sr * sp * sy,
    ]
}

impl SimulatedDrive {
    /// The path with errors as an odometry has them: each pose of every tenth of a second is off by normal errors of these
    /// sizes, in each coordinate and angle, and the path between follows.
    ///
    /// # Errors
    /// None: times ascend.
    pub fn disturbed_track(&self, place_m: f64, angle_rad: f64) -> anyhow::Result<Track> {
        let mut chance = Chance(7);
        let mut error = |size: f64| size * f64::from(chance.normal());
        let mut rows: Vec<[f64; 6]> = self.rows.iter().step_by(20).copied().collect();
        for [_, x, y, yaw, roll, pitch] in &mut rows {
            (*x, *y) = (*x + error(place_m), *y + error(place_m));
            (*yaw, *roll, *pitch) =
                (*yaw + error(angle_rad), *roll + error(angle_rad), *pitch + error(angle_rad));
        }
        track_of(&rows)
    }

    /// Calls `each` for every sweep, in order, at most `most`.
    ///
    /// # Errors
    /// The file of sweeps is damaged.
    pub fn for_each(&self, most: usize, mut each: impl FnMut(&LabelledSweep)) -> anyhow::Result<()> {
        let mut file = BufReader::with_capacity(1 << 20, File::open(&self.sweeps)?);
        let mut sweep = LabelledSweep::default();
        let mut bytes = Vec::new();
        for number in 0..most {
            let mut count = [0; 4];
            if file.read_exact(&mut count).is_err() {
                break;
            }
            bytes.resize(u32::from_le_bytes(count) as usize * 24, 0);
            file.read_exact(&mut bytes)?;
            sweep.enter(number, &bytes);
            each(&sweep);
        }
        Ok(())
    }
}

impl LabelledSweep {
    /// Rows of x, y, z, share of the revolution, elevation in degrees, person.
    fn enter(&mut self, number: usize, bytes: &[u8]) {
        self.sweep.start_s = number as f64 * SWEEP_S;
        self.sweep.returns.clear();
        self.labels.clear();
        for row in bytes.chunks_exact(24) {
            let value = |index: usize| {
                let octets = row.get(4 * index..4 * index + 4).and_then(|octets| octets.try_into().ok());
                octets.map_or(f32::NAN, f32::from_le_bytes)
            };
            self.sweep.returns.push(RawReturn {
                point_in_sensor: Point3::new(value(0), value(1), value(2)),
                offset_s: value(3) * SWEEP_S as f32,
                ring: ((value(4) + 15.0) / 2.0).round() as u8,
            });
            self.labels.push(value(5) as u8);
        }
    }
}
