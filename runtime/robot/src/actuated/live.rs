//! The thread of the window: both wires, the robot's pose, and boxes of people.

use std::io;
use std::net::UdpSocket;
use std::thread;

use embassy_futures::select::{Either3, select3};
use embassy_time::Timer;
use embedded_io_async::{Read as _, Write as _};
use floorguard_configuration::{ActuatedLidarConfiguration, ScipModel};
use floorguard_drivers::can::CanFrame;
use floorguard_drivers::scip::DeviceConfiguration;
use floorguard_host::carriers::{CanLink, ScipWire};
use floorguard_host::executor::{Ring, StopFlag, run_until, take_priority};
use floorguard_mapping::Occupancy;
use floorguard_mapping::sliding_window::{CellPolicy, LidarMount, PassedPerson, PersonBoxes};
use floorguard_perception::people::{Appearance, Detection, PeopleSensor, PeopleView, Surroundings};
use floorguard_runtime::clock;
use floorguard_runtime::io::CanBus;
use floorguard_types::geometry::Pose2;
use floorguard_types::time::Stamp;

use super::boxes::read_boxes;
use super::session::Session;
use super::watch::{WindowReport, WindowWatch};
use super::window_map::{WindowMap, WindowSetup};
use crate::assembly::{HostedShared, PeopleInbox, StopsAtEnd};

/// What is due is looked for this often, milliseconds: SYNC is sent each ten.
const POLL_MS: u64 = 4;
/// A read takes what is there, up to this: a scan of 721 beams has 2.3 kB.
const PORTION_BYTES: usize = 4_096;
/// A datagram of sixteen boxes is shorter.
const DATAGRAM_BYTES: usize = 2_048;
/// From report to report, microseconds.
const REPORT_US: u64 = 1_000_000;
/// What a box of a detector and returns within it say of a person: sure, but not alone.
const LIKENESS: f32 = 0.8;

/// The wires before the thread opens them.
#[derive(Debug)]
pub struct WindowLinks {
    /// Where they are.
    pub configuration: ActuatedLidarConfiguration,
    /// Boxes of people come here; bound already: a port that is taken is an error at the start.
    pub people: Option<UdpSocket>,
}

impl WindowLinks {
    /// Of a configuration.
    ///
    /// # Errors
    /// The port of the boxes is taken or not ours.
    pub fn bind(configuration: &ActuatedLidarConfiguration) -> io::Result<Self> {
        let bind = |local| {
            UdpSocket::bind(local).map_err(|error| {
                io::Error::new(error.kind(), format!("[actuated_lidar] udp:{local}: {error}"))
            })
        };
        let people = configuration.people_source.map(|address| bind(address.local)).transpose()?;
        Ok(Self { configuration: configuration.clone(), people })
    }

    fn setup(&self) -> (DeviceConfiguration, WindowSetup) {
        let own = &self.configuration;
        let lidar = match own.model {
            ScipModel::Urg04lx => DeviceConfiguration::URG_04LX,
            ScipModel::Ust10lx => DeviceConfiguration::UST_10LX,
        };
        let [axis_x_m, axis_y_m, height_m] = own.mounted_m;
        let mount = LidarMount {
            axis_x_m,
            axis_y_m,
            height_m,
            lever_arm_m: own.lever_arm_m,
            tilt_rad: own.tilt_rad,
            range_max_mm: u16::try_from(lidar.farthest_mm.min(7_000)).unwrap_or(u16::MAX),
            ..LidarMount::PUBLISHED
        };
        let (cell_m, threshold_m) = (own.cell_m, own.threshold_m);
        (lidar, WindowSetup { cell_m, policy: CellPolicy::Nearest, threshold_m, mount })
    }
}

/// Runs `beside` while the lidar, if there is one, fills the window on a thread of its own. A window that cannot be made, or a
/// thread that fails, is reported and ends nothing else: no protection hangs on it.
pub fn watch_window<T>(
    links: Option<WindowLinks>,
    (shared, inbox): (&HostedShared, &PeopleInbox),
    watch: &WindowWatch,
    beside: impl FnOnce() -> T,
) -> T {
    let flag = &StopFlag::default();
    thread::scope(|scope| {
        if let Some(links) = links {
            scope.spawn(move || {
                // The display of the start is the rings'.
                let _ = take_priority(Ring::Camera);
                if let Err(error) = run_window(links, (shared, inbox), watch, flag) {
                    say!("  actuated lidar: {error}");
                }
            });
        }
        let _at_end = StopsAtEnd(flag.clone());
        beside()
    })
}

/// Everything that the thread works with.
struct Live<'a> {
    session: Session,
    map: WindowMap,
    people: Option<UdpSocket>,
    shared: &'a HostedShared,
    inbox: &'a PeopleInbox,
    watch: &'a WindowWatch,
    given: u64,
    reported: Stamp,
}

fn run_window(
    links: WindowLinks,
    (shared, inbox): (&HostedShared, &PeopleInbox),
    watch: &WindowWatch,
    flag: &StopFlag,
) -> anyhow::Result<()> {
    let (lidar, setup) = links.setup();
    let WindowLinks { configuration, people } = links;
    if let Some(people) = &people {
        people.set_nonblocking(true)?;
    }
    let mut live = Live {
        session: Session::new(lidar, configuration.motor),
        map: WindowMap::new(&setup)?,
        people,
        shared,
        inbox,
        watch,
        given: 0,
        reported: clock::now(),
    };
    watch.publish(WindowReport::default());
    let turning = &mut live;
    run_until(flag, |tasks| {
        let (wire, no_lidar) = ScipWire::open(&configuration.source);
        let (bus, no_bus) = CanLink::new(&configuration.motor_source);
        for (what, problem) in [("lidar", no_lidar), ("motor", no_bus)] {
            if let Some(error) = problem {
                say!("  actuated lidar: {what}: not there yet ({error}); waiting for it");
            }
        }
        tasks.spawn(turning.play(wire, bus));
        Ok(())
    })?;
    live.report();
    watch.leave(live.map);
    Ok(())
}

impl Live<'_> {
    /// Never ends.
    async fn play(&mut self, mut wire: ScipWire, mut bus: CanLink) {
        let mut portion = vec![0; PORTION_BYTES];
        let (mut bytes, mut frames) = (Vec::new(), Vec::<CanFrame>::new());
        loop {
            let next = select3(wire.read(&mut portion), bus.receive(), Timer::after_millis(POLL_MS));
            let next = next.await;
            let now = clock::now();
            match next {
                Either3::First(Ok(count)) => {
                    self.session.hear_lidar(portion.get(..count).unwrap_or_default(), now, &mut self.map);
                }
                Either3::First(Err(error)) => {
                    self.map.taken.refuse("wire", format!("the lidar's wire: {error}"))
                }
                Either3::Second(Ok(frame)) => self.session.hear_bus(&frame, now, &mut self.map),
                Either3::Second(Err(error)) => {
                    self.map.taken.refuse("wire", format!("the motor's bus: {error}"))
                }
                Either3::Third(()) => {}
            }
            if let Some(pose) = self.shared.pose.get() {
                self.session.stand_at(pose.stamp, pose.pose_in_odometry);
            }
            self.session.enter(now, &mut self.map);
            self.hear_people(now);
            self.give_people(now);
            self.session.poll(now, (&mut bytes, &mut frames));
            self.send((&mut wire, &mut bytes), (&mut bus, &mut frames)).await;
            if self.reported.past_us(now) >= REPORT_US {
                self.reported = now;
                self.report();
            }
        }
    }

    /// What is due goes out; what a lost wire does not take is asked again by the drivers.
    async fn send(
        &mut self,
        (wire, bytes): (&mut ScipWire, &mut Vec<u8>),
        (bus, frames): (&mut CanLink, &mut Vec<CanFrame>),
    ) {
        let mut rest = bytes.as_slice();
        while !rest.is_empty() {
            match wire.write(rest).await {
                Ok(count @ 1..) => rest = rest.get(count..).unwrap_or_default(),
                Ok(_) | Err(_) => break,
            }
        }
        bytes.clear();
        for frame in frames.drain(..) {
            if let Err(error) = bus.send(&frame).await {
                self.map.taken.refuse("wire", format!("the motor's bus: {error}"));
            }
        }
    }

    /// Where the robot stood when a picture was taken; the newest pose is as old as a tick of the drives.
    fn pose(&self) -> Pose2 {
        self.shared.pose.get().map_or(Pose2::default(), |pose| pose.pose_in_odometry)
    }

    fn hear_people(&mut self, now: Stamp) {
        let mut datagram = [0; DATAGRAM_BYTES];
        let Some(Ok(length)) = self.people.as_ref().map(|socket| socket.recv(&mut datagram)) else { return };
        match read_boxes(datagram.get(..length).unwrap_or_default()) {
            Ok(received) => {
                let stamp = Stamp::from_micros(now.as_micros().saturating_sub(received.age_us));
                let base_in_odometry = self.session.pose_at(stamp).unwrap_or_else(|| self.pose());
                self.map.take_people(&PersonBoxes { stamp, base_in_odometry, boxes: &received.boxes }, now);
            }
            Err(why) => self.map.taken.refuse("boxes", why),
        }
    }

    /// Whom the sweep has left goes into the list of people: where its returns lay, and when.
    fn give_people(&mut self, now: Stamp) {
        while let Some(passed) = self.map.next_passed(now) {
            self.inbox.put(view(&passed, self.pose()));
            self.given += 1;
        }
    }

    fn report(&self) {
        let taken = &self.map.taken;
        let (free_m2, occupied_m2) =
            (self.map.area_m2(Occupancy::Free), self.map.area_m2(Occupancy::Occupied));
        self.watch.publish(WindowReport {
            scans: taken.scans,
            surfaces: taken.surfaces,
            people_points: taken.people,
            cells: self.map.window.points().count(),
            free_m2,
            occupied_m2,
            arrows: self.map.arrows().len(),
            people_given: self.given,
            refused: taken.refused.values().map(|one| (one.first.clone(), one.count)).collect(),
            faults: self.session.faults.clone(),
        });
    }
}

/// A view with one person. A camera's boxes with a lidar's ranges are colour and depth: it counts as a depth camera's, and nobody
/// is missed where it looks.
pub(super) fn view(passed: &PassedPerson, robot_in_odometry: Pose2) -> PeopleView {
    let mut view = PeopleView::new(PeopleSensor::DepthCamera);
    view.stamp = passed.stamp;
    let position = passed.position_in_odometry;
    let robot = floorguard_types::geometry::Point2::new(robot_in_odometry.x_m, robot_in_odometry.y_m);
    let detection = Detection {
        position,
        distance_m: robot.distance(position),
        sigma_m: passed.sigma_m,
        likeness: LIKENESS,
        points: passed.returns,
        moving: None,
        surroundings: Surroundings::OPEN,
        appearance: Appearance::UNKNOWN,
    };
    // The first of sixteen places.
    let _ = view.add(detection);
    view
}
