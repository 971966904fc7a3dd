//! Runs simulated or decoded sweeps (`NAME.bin`, with `NAME.truth` if there is one) through the 3-D odometry and prints its
//! errors: `lidar3d FILE.bin…`; with `NAME.odom.csv` and `NAME.imu.csv` beside it, if `SET` has `wheels` or `gyroscope`. A sweep is a count (u32) and as many returns of six floats: x, y, z, share of the sweep's
//! time, elevation in degrees, label.

use std::io::Read as _;
use std::path::Path;

use floorguard_mapping::lidar_odometry::{
    FloorPrior, Gaussian3, MotionAid, OdometryConfig, SweepOutcome, SweepReturn, WheelSpeed,
};
use floorguard_mapping_host::lego_loam::{LegoLoam, LegoLoamConfig, StepSolver};
use floorguard_mapping_host::lidar3d::{Mapper3, Mapper3Config, SpaceCloserConfig, SweepRecord};
use floorguard_mapping_host::metrics::{ErrorStatistics, TimedPose, absolute_errors, associate};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

fn sweeps(path: &Path) -> Vec<Vec<SweepReturn>> {
    let mut bytes = Vec::new();
    std::fs::File::open(path).unwrap().read_to_end(&mut bytes).unwrap();
    let mut rest = bytes.as_slice();
    let mut all = Vec::new();
    while rest.len() >= 4 {
        let count = u32::from_le_bytes(rest[..4].try_into().unwrap()) as usize;
        let body = &rest[4..4 + 24 * count];
        rest = &rest[4 + 24 * count..];
        let sweep = body.chunks_exact(24).map(|cells| {
            let number = |i: usize| f32::from_le_bytes(cells[4 * i..4 * i + 4].try_into().unwrap());
            SweepReturn {
                point_in_sensor: Vector3::new(number(0), number(1), number(2)),
                time_share: number(3),
                ring: ((number(4) + 15.0) / 2.0).round() as u8,
            }
        });
        all.push(sweep.collect());
    }
    all
}

fn truth(path: &Path) -> Vec<TimedPose> {
    let Ok(text) = std::fs::read_to_string(path.with_extension("truth")) else { return Vec::new() };
    text.lines()
        .map(|line| {
            let n: Vec<f64> = line.split_whitespace().map(|word| word.parse().unwrap()).collect();
            let rotation = UnitQuaternion::from_euler_angles(n[10], n[11], n[9]);
            TimedPose { time_s: n[6], place_m: Vector3::new(n[7], n[8], 0.8), rotation }
        })
        .collect()
}

fn cpu_s() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap();
    text.split_whitespace().next().unwrap().parse::<f64>().unwrap() * 1e-9
}

fn settings() -> OdometryConfig {
    let mut config = OdometryConfig::default();
    let text = std::env::var("SET").unwrap_or_default();
    for pair in text.split(',').filter(|p| !p.is_empty()) {
        let (name, value) = pair.split_once('=').unwrap();
        let v: f64 = value.parse().unwrap();
        match name {
            "run" => config.averaging.run = v as u16,
            "least" => config.averaging.run_least = v as u16,
            "length" => config.averaging.length_m = v as f32,
            "bend" => config.averaging.bend_m = v as f32,
            "far" => config.averaging.range_most_m = v as f32,
            "fine" => config.map.fine_m = v as f32,
            "coarse" => config.map.coarse_m = v as f32,
            "most" => config.map.count_most = v as u16,
            "rounds" => config.align.rounds = v as u32,
            "noise" => config.align.noise_m = v as f32,
            "kernel" => config.align.kernel = v as f32,
            "kfirst" => config.align.kernel_first = v as f32,
            "kwide" => config.align.kernel_wide = v as f32,
            "rwide" => config.align.rounds_wide = v as u32,
            "alike" => config.align.alike = v,
            "matched" => config.align.matched_least = v as u32,
            "qa" => config.noise.angular_radps *= v,
            "qv" => config.noise.linear_mps *= v,
            "step" => config.entering.step_m = v,
            "turn" => config.entering.turn_rad = v.to_radians(),
            "standing" => config.entering.standing = v as u32,
            "hand" => config.noise = floorguard_mapping::lidar_odometry::MotionNoise::hand_held(),
            "floor" => config.floor = Some(FloorPrior::default()),
            "wheels" | "gyroscope" | "open" | "lego" | "damped" => {}
            _ => panic!("{name}"),
        }
    }
    config
}

fn main() {
    for name in std::env::args().skip(1) {
        run(Path::new(&name));
    }
}

fn is_set(name: &str) -> bool {
    std::env::var("SET").unwrap_or_default().split(',').any(|pair| pair.starts_with(name))
}

/// Rows of numbers: time, and what was measured then.
fn rows(path: &Path, kind: &str) -> Vec<Vec<f64>> {
    let text = std::fs::read_to_string(path.with_extension(kind)).unwrap_or_default();
    let numbers = |line: &str| line.split_whitespace().map(|word| word.parse().unwrap()).collect();
    text.lines().filter(|line| !line.starts_with('#')).map(numbers).collect()
}

/// The mean of the rows of a time, of these columns.
fn mean(rows: &[Vec<f64>], [start, end]: [f64; 2], columns: &[usize]) -> Option<Vec<f64>> {
    let during: Vec<_> = rows.iter().filter(|row| (start..=end).contains(&row[0])).collect();
    let mean = |column: &usize| during.iter().map(|row| row[*column]).sum::<f64>() / during.len() as f64;
    (!during.is_empty()).then(|| columns.iter().map(mean).collect())
}

fn aid(path: &(Vec<Vec<f64>>, Vec<Vec<f64>>), time: [f64; 2]) -> MotionAid {
    let (odometry, inertial) = path;
    let gaussian = |mean: [f64; 3], deviation: f64| Gaussian3 {
        mean: Vector3::from(mean),
        deviation: Vector3::repeat(deviation),
    };
    let wheels = is_set("wheels").then(|| mean(odometry, time, &[4, 5])).flatten().map(|speed| WheelSpeed {
        linear_mps: gaussian([speed[0], 0.0, 0.0], 0.02 + 0.03 * speed[0].abs()),
        angular_radps: gaussian([0.0, 0.0, speed[1]], 0.05),
    });
    let rate = is_set("gyroscope").then(|| mean(inertial, time, &[1, 2, 3])).flatten();
    MotionAid { wheels, gyroscope: rate.map(|rate| gaussian([rate[0], rate[1], rate[2]], 0.01)) }
}

/// LeGO-LOAM as published, or with its steps solved to their ends.
fn run_lego(path: &Path) {
    let solver = if is_set("damped") { StepSolver::Damped } else { StepSolver::Published };
    let mut loam = LegoLoam::new(LegoLoamConfig { solver, ..LegoLoamConfig::default() });
    let truth = truth(path);
    let (mut cpu, mut result, mut odometry) = (0.0, Vec::new(), Vec::new());
    let all = sweeps(path);
    for (index, sweep) in all.iter().enumerate() {
        let end_s = truth.get(index).map_or(0.1 * (index + 1) as f64, |pose| pose.time_s);
        let began = cpu_s();
        let outcome = loam.push(sweep, end_s);
        cpu += cpu_s() - began;
        for (poses, pose) in [(&mut result, &outcome.pose), (&mut odometry, &outcome.odometry)] {
            let [x, y, z, w] = pose.quaternion();
            let rotation = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
            poses.push(TimedPose { time_s: end_s, place_m: pose.place_m, rotation });
        }
    }
    let cpu = 1e3 * cpu / all.len() as f64;
    print!("{} LeGO-LOAM cpu {cpu:.2} ms keys {}", path.display(), loam.keys());
    conclude(&truth, &result);
    print!("  odometry alone");
    conclude(&truth, &odometry);
}

fn run(path: &Path) {
    if is_set("lego") {
        return run_lego(path);
    }
    let closing = (!is_set("open")).then(SpaceCloserConfig::default);
    let config = Mapper3Config { odometry: settings(), cloud_m: 1.0e4, closing, ..Mapper3Config::default() };
    let mut mapper = Mapper3::new(config);
    let truth = truth(path);
    let aids = (rows(path, "odom.csv"), rows(path, "imu.csv"));
    let period = 0.099_975_168;
    let verbose = std::env::var("VERBOSE").is_ok();
    let (mut cpu, mut worst, mut matched) = (0.0, 0.0_f64, 0.0);
    let all = sweeps(path);
    for (index, sweep) in all.iter().enumerate() {
        let end_s = truth.get(index).map_or(period * (index + 1) as f64, |pose| pose.time_s);
        let returns = sweep.clone();
        let record = SweepRecord { end_s, duration_s: period, returns, reflectivity: Vec::new() };
        let aid = aid(&aids, [end_s - period, end_s]);
        let began = cpu_s();
        let outcome = mapper.push(record, &aid).unwrap().unwrap();
        let took = cpu_s() - began;
        cpu += took;
        worst = worst.max(took);
        matched += f64::from(outcome.matched) / f64::from(outcome.returns.max(1));
        if verbose && (index % 20 == 0 || all.len() < 50 || outcome.times_noise < 400.0) {
            show(index, &outcome, truth.first().zip(truth.get(index)));
        }
    }
    mapper.finish().unwrap();
    let result = mapper.trajectory();
    print!(
        "{} sweeps {} cpu {:.3} ms, worst {:.1} matched {:.2} mapped {} cubes {:?} loops {:?} {:?}",
        path.display(),
        all.len(),
        1e3 * cpu / all.len() as f64,
        1e3 * worst,
        matched / all.len() as f64,
        mapper.counters.mapped,
        mapper.cubes(),
        mapper.closer().map(|closer| closer.believed()),
        mapper.closer().map(|closer| closer.counters()),
    );
    conclude(&truth, &result);
}

/// One sweep; the error is that in the frame of the first pose, cm.
fn show(index: usize, outcome: &SweepOutcome, truth: Option<(&TimedPose, &TimedPose)>) {
    let pose = outcome.state.pose;
    let error = truth.map(|(start, now)| start.rotation * pose.place_m + start.place_m - now.place_m);
    println!(
        "{index} place mm {:.2?} turn mdeg {:.1?} returns {} matched {} misfit {:.2} times {:.0} weak {:.4} held {} \
         error cm {:.1?} v {:.3?} w {:.3?}",
        (pose.place_m * 1e3).as_slice(),
        (pose.rotation_vector() * 57_296.0).as_slice(),
        outcome.returns,
        outcome.matched,
        outcome.misfit,
        outcome.times_noise,
        outcome.weak.deviation_m,
        outcome.weak.is_held_by_prediction,
        (error.unwrap_or_default() * 100.0).as_slice(),
        outcome.state.twist.linear_mps.as_slice(),
        outcome.state.twist.angular_radps.as_slice(),
    );
}

fn conclude(truth: &[TimedPose], result: &[TimedPose]) {
    let (first, end) = (result.first().unwrap(), result.last().unwrap());
    if truth.is_empty() {
        let away = |pose: &TimedPose| 100.0 * (pose.place_m - first.place_m).norm();
        let turned = |pose: &TimedPose| first.rotation.angle_to(&pose.rotation).to_degrees();
        let most = |of: &dyn Fn(&TimedPose) -> f64| result.iter().map(of).fold(0.0, f64::max);
        println!(
            "  drift {:.3} cm {:.4} deg, most {:.3} cm {:.4} deg",
            away(end),
            turned(end),
            most(&away),
            most(&turned)
        );
        return;
    }
    let errors = ErrorStatistics::of(&absolute_errors(&associate(truth, result, 0.01)));
    let there = truth[0].rotation * end.place_m + truth[0].place_m;
    let end_error = (there - truth.last().unwrap().place_m).norm();
    println!(
        "  ATE {:.2} cm most {:.2} end {:.2}",
        100.0 * errors.rmse,
        100.0 * errors.most,
        100.0 * end_error
    );
}
