//! Simulated sweeps with the truth beside them.

use floorguard_drivers::velodyne::{Decoder, Model, ModelChoice, SweepBuilder};
use floorguard_sim::people::PersonKind;
use floorguard_sim::robot::RobotParameters;
use floorguard_sim::{Payload, Scenario, Simulation, Stream};
use floorguard_types::geometry::{Point2, Point3, Transform3};
use floorguard_types::sensing::Sweep;
use floorguard_types::time::Stamp;

/// A scene to be played; the robot stands where the scenario says.
#[derive(Clone, Debug)]
pub struct SceneRun {
    /// The scene.
    pub scenario: Scenario,
    /// Seed of the run.
    pub seed: u64,
    /// Every length is multiplied by this, the sensor's height too.
    pub scale: f32,
    /// Height of the lidar before scaling, metres.
    pub sensor_height_m: f32,
    /// When the first sweep is taken, µs: people are on their way then.
    pub starts_us: u64,
}

/// A sweep and where people were when it ended.
pub struct LabelledSweep {
    /// What the lidar saw.
    pub sweep: Box<Sweep>,
    /// Its mounting.
    pub sensor_in_base: Transform3,
    /// Everybody in the robot's frame: number, kind, place.
    pub people: Vec<(u32, PersonKind, Point2)>,
}

/// Microseconds of the world between two polls of the decoder.
const STEP_US: u64 = 5_000;

/// Plays a scene; every `every`-th sweep of `count` taken ones goes to `sink`.
pub fn play(run: &SceneRun, (count, every): (usize, usize), sink: &mut dyn FnMut(LabelledSweep)) {
    let mut parameters = RobotParameters::default();
    parameters.lidar.z_m = run.sensor_height_m;
    let mount = parameters.lidar;
    let Ok(mut simulation) = Simulation::with_robot(&run.scenario, run.seed, parameters) else { return };
    let mut decoder = Decoder::new(ModelChoice::Fixed(Model::Vlp16));
    let mut builder = SweepBuilder::new(18_000);
    let mut building = Box::new(Sweep::EMPTY);
    let mut complete: Option<Box<Sweep>> = None;
    let (mut seen, mut taken, mut now_us) = (0, 0, 0);
    simulation.advance_to(run.starts_us, &mut |_| {});
    now_us += run.starts_us;
    while taken < count {
        now_us += STEP_US;
        simulation.advance_to(now_us, &mut |event| {
            let (Stream::LidarData, Payload::Bytes(bytes)) = (event.stream, &event.payload) else { return };
            if let Ok((packet, lost)) = decoder.decode(bytes, Stamp::from_micros(event.at_us)) {
                builder.add(&packet, lost, &mut building, |sweep| complete = Some(Box::new(sweep.clone())));
            }
        });
        let Some(mut sweep) = complete.take() else { continue };
        seen += 1;
        // The first sweep began in the middle of a revolution.
        if seen < 2 || !(seen - 2usize).is_multiple_of(every) {
            continue;
        }
        taken += 1;
        scale_ranges(&mut sweep, run.scale);
        let truth = simulation.truth();
        let into_base = truth.robot.inverse();
        let people = truth.people.iter().map(|person| {
            let place = into_base.transform(person.position);
            (person.id, person.kind, Point2::new(place.x_m * run.scale, place.y_m * run.scale))
        });
        let at = Point3::new(mount.x_m * run.scale, mount.y_m * run.scale, mount.z_m * run.scale);
        let sensor_in_base = Transform3 { translation: at, ..Transform3::IDENTITY };
        sink(LabelledSweep { sweep, sensor_in_base, people: people.collect() });
    }
}

fn scale_ranges(sweep: &mut Sweep, scale: f32) {
    for raw in sweep.columns.iter_mut().flat_map(|column| &mut column.range_raw) {
        *raw = (f32::from(*raw) * scale).min(f32::from(u16::MAX)) as u16;
    }
}
