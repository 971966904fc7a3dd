//! The simulated rig at the other end of both wires.

use floorguard_drivers::can::CanFrame;
use floorguard_drivers::scan_motor::ScanMotorConfiguration;
use floorguard_drivers::scip::DeviceConfiguration;
use floorguard_host::outcome::{BadInput, WrongUsage};
use floorguard_mapping::sliding_window::{
    LidarMount, Mirror, MirrorMark, NO_SOURCE, PanoramaGeometry, PersonBox, PersonBoxes, PictureSize,
};
use floorguard_sim::actuated::{LidarModel, MIRROR, ROOMS, Rig, RigEvent, RigFault, Room};
use floorguard_sim::can::CanFrame as SimulatedFrame;
use floorguard_types::geometry::Pose2;
use floorguard_types::time::Stamp;

use super::arguments::{FaultArgument, LidarArgument, WindowArguments};
use floorguard_robot::actuated::{Session, WindowMap};

const STEP_US: u64 = 2_000;
/// From picture to picture.
const PICTURE_US: u64 = 200_000;
/// Columns and rows of the dewarped picture.
const STRIP: [u16; 2] = [900, 180];

/// The dewarped picture, and how directions lie in it.
pub struct Panorama {
    pub geometry: PanoramaGeometry,
    /// Three bytes a pixel, row by row.
    pub pixels: Vec<u8>,
    /// Where the robot stood.
    pub pose: Pose2,
}

/// What the simulation gave.
pub struct Simulated {
    pub map: WindowMap,
    pub session: Session,
    pub panorama: Panorama,
}

/// Plays a room.
///
/// # Errors
/// A room that is not there, or cells that no window has.
pub fn play(arguments: &WindowArguments, name: &str) -> anyhow::Result<Simulated> {
    let (mut rig, mut map, mut session) = set_up(arguments, name)?;
    let mut next_picture_us = PICTURE_US;
    for step in 1..=arguments.seconds * 1_000_000 / STEP_US {
        let now_us = step * STEP_US;
        let mut heard = Vec::new();
        rig.advance_to(now_us, &mut |at_us, event| heard.push((at_us, event)));
        for (at_us, event) in heard {
            let at = Stamp::from_micros(at_us);
            match event {
                RigEvent::Lidar(bytes) => session.hear_lidar(&bytes, at, &mut map),
                RigEvent::Frame(frame) => {
                    let frame = CanFrame::standard(frame.id as u16, frame.payload());
                    session.hear_bus(&frame, at, &mut map);
                }
            }
        }
        let now = Stamp::from_micros(now_us);
        session.enter(now, &mut map);
        if now_us >= next_picture_us && name == "person" {
            next_picture_us += PICTURE_US;
            see_people(&rig, now, &mut map);
        }
        let (mut bytes, mut frames) = (Vec::new(), Vec::new());
        session.stand_at(now, rig.pose());
        session.poll(now, (&mut bytes, &mut frames));
        rig.receive(&bytes);
        for frame in frames {
            let id = frame.standard_id().map_or(0, u32::from);
            rig.receive_can(&SimulatedFrame::new(id, frame.payload()));
        }
    }
    let panorama = panorama(&rig)?;
    Ok(Simulated { map, session, panorama })
}

fn set_up(arguments: &WindowArguments, name: &str) -> anyhow::Result<(Rig, WindowMap, Session)> {
    let rooms = ROOMS.join(", ");
    let room = Room::named(name)
        .ok_or_else(|| WrongUsage(format!("{name}: this room is not there; there are {rooms}")))?;
    let (model, lidar) = match arguments.lidar {
        LidarArgument::Urg => (LidarModel::Urg04lx, DeviceConfiguration::URG_04LX),
        LidarArgument::Ust => (LidarModel::Ust10lx, DeviceConfiguration::UST_10LX),
    };
    let faults = arguments.fault.map(|fault| match fault {
        FaultArgument::MotorStalled => RigFault::MotorStalled { from_us: 10_000_000 },
        FaultArgument::AnglesLost => RigFault::AnglesLost { every: 6 },
        FaultArgument::DamagedCheck => RigFault::DamagedCheck { every: 3 },
    });
    let rig = Rig::new(room, model, (faults.into_iter().collect(), arguments.seed));
    let mut motor = ScanMotorConfiguration::PUBLISHED;
    if name == "person" {
        // Two sweeps within two seconds, where the person walks.
        (motor.left_rad, motor.right_rad, motor.speed_radps) = (0.65, -0.65, 1.0);
    }
    let mount = LidarMount {
        range_max_mm: u16::try_from(lidar.farthest_mm.min(7_000)).unwrap_or(u16::MAX),
        ..LidarMount::PUBLISHED
    };
    let map = WindowMap::new(&arguments.setup(mount))?;
    Ok((rig, map, Session::new(lidar, motor)))
}

fn see_people(rig: &Rig, now: Stamp, map: &mut WindowMap) {
    let boxes: Vec<PersonBox> = rig
        .people(&MIRROR)
        .iter()
        .map(|one| PersonBox {
            azimuth_min_rad: one.azimuths_rad[0],
            azimuth_max_rad: one.azimuths_rad[1],
            elevation_min_rad: one.elevations_rad[0],
            elevation_max_rad: one.elevations_rad[1],
        })
        .collect();
    map.take_people(&PersonBoxes { stamp: now, base_in_odometry: rig.pose(), boxes: &boxes }, now);
}

/// The ring of the camera becomes a strip by the table of its calibrated mirror.
fn panorama(rig: &Rig) -> Result<Panorama, BadInput> {
    // Marks of known elevation, as a calibration finds them: the upper row is the outer circle.
    let marks = [0.0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1.0]
        .map(|part| MirrorMark { part, elevation_rad: MIRROR.elevation_rad(1.0 - part) });
    let mirror = Mirror::from_marks(&marks)
        .ok_or_else(|| BadInput("the marks of the mirror are in disorder".to_owned()))?;
    let middle = MIRROR.side as f32 / 2.0;
    let geometry = PanoramaGeometry {
        centre_x: middle,
        centre_y: middle,
        inner_radius: MIRROR.radii[0],
        outer_radius: MIRROR.radii[1],
        columns: STRIP[0],
        rows: STRIP[1],
        is_outer_up: true,
        first_azimuth_rad: std::f32::consts::PI,
        is_counter_clockwise: false,
        height_m: MIRROR.height_m,
        mirror,
    };
    // The ring's angle runs with the azimuth, the strip against it: left of the robot is left.
    let ring = rig.picture(&MIRROR);
    let geometry_of_ring =
        PanoramaGeometry { first_azimuth_rad: 0.0, is_counter_clockwise: true, ..geometry };
    let mut table = vec![NO_SOURCE; usize::from(STRIP[0]) * usize::from(STRIP[1])];
    let side = MIRROR.side as u16;
    geometry_of_ring.fill_table(PictureSize { columns: side, rows: side }, &mut table);
    let source = ring.as_raw();
    let columns = usize::from(STRIP[0]);
    let pixels = (0..table.len()).flat_map(|place| {
        let (row, column) = (place / columns, place % columns);
        // Column c of the strip looks to π − 2πc/W; that of the ring to 2πc/W.
        let of_ring = (columns + columns / 2 - column) % columns;
        let from = table[row * columns + of_ring] as usize * 3;
        source.get(from..from + 3).map_or([0; 3], |pixel| [pixel[0], pixel[1], pixel[2]])
    });
    Ok(Panorama { geometry, pixels: pixels.collect(), pose: rig.pose() })
}
