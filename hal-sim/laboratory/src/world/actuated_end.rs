//! The devices' ends of the wires of a lidar that a motor turns, on the robot of the simulated world.

use std::io::{Read as _, Write as _};
use std::net::{TcpListener, TcpStream, UdpSocket};

use anyhow::Context;
use floorguard_configuration::{
    ActuatedLidarConfiguration, CanAddress, ScipAddress, ScipModel, SerialAddress,
};
use floorguard_drivers::scan_motor::ScanMotorConfiguration;
use floorguard_host::carriers::PseudoTerminal;
use floorguard_robot::actuated::WindowLinks;
use floorguard_sim::actuated::{LidarModel, MIRROR, MountedLidar, Rig, RigEvent};
use floorguard_sim::can::{SlcanDecoder, encode_slcan};
use floorguard_sim::people::Person;
use floorguard_sim::simulation::Simulation;
use floorguard_types::geometry::Point2;

use super::ends::{read_all, write_all};
use crate::plan::Plan;

/// From picture to picture of the panoramic camera, microseconds.
const PICTURE_US: u64 = 200_000;
/// People farther away are not found in it, metres.
const FARTHEST_M: f32 = 6.0;
const BAUD: u32 = 115_200;

/// The lidar's end.
enum LidarEnd {
    Serial(PseudoTerminal),
    Tcp(TcpListener, Option<TcpStream>),
}

/// Lidar, motor and panoramic camera.
pub(super) struct ActuatedEnd {
    rig: Rig,
    lidar: LidarEnd,
    motor: PseudoTerminal,
    decoder: SlcanDecoder,
    people: Option<UdpSocket>,
    next_picture_us: u64,
    /// Messages that a full line refused.
    pub refused: u64,
}

impl ActuatedEnd {
    /// Both ends, if the plan's robot carries such a lidar.
    pub fn open(plan: &Plan) -> anyhow::Result<Option<(Self, WindowLinks)>> {
        let Some(wanted) = &plan.actuated_lidar else { return Ok(None) };
        let terminal = || PseudoTerminal::open().context("no pseudo-terminal");
        let (model, lidar, source) = match wanted.model {
            ScipModel::Urg04lx => {
                let line = terminal()?;
                let source = ScipAddress::Serial(SerialAddress { device: line.device.clone(), baud: BAUD });
                (LidarModel::Urg04lx, LidarEnd::Serial(line), source)
            }
            ScipModel::Ust10lx => {
                let listener = TcpListener::bind("127.0.0.1:0").context("no TCP port on the loopback")?;
                listener.set_nonblocking(true)?;
                let source = ScipAddress::Tcp(listener.local_addr()?);
                (LidarModel::Ust10lx, LidarEnd::Tcp(listener, None), source)
            }
        };
        let motor = terminal()?;
        let published = ScanMotorConfiguration::PUBLISHED;
        let configuration = ActuatedLidarConfiguration {
            source,
            motor_source: CanAddress::Slcan(motor.device.clone()),
            // The gear and encoder of the simulated motor.
            motor: ScanMotorConfiguration {
                counts_per_turn: published.counts_per_turn,
                gear: published.gear,
                ahead_counts: published.ahead_counts,
                ..wanted.motor
            },
            people_source: None,
            ..wanted.clone()
        };
        let (people, robot_people) = match wanted.people_source {
            Some(_) => {
                let robot = UdpSocket::bind("127.0.0.1:0").context("no UDP port on the loopback")?;
                let camera = UdpSocket::bind("127.0.0.1:0")?;
                camera.connect(robot.local_addr()?)?;
                (Some(camera), Some(robot))
            }
            None => (None, None),
        };
        let mounted = MountedLidar { place_m: wanted.mounted_m, node: wanted.motor.node };
        let rig = Rig::carried(plan.scenario.scene.build(), model, (mounted, plan.seed));
        let end = Self {
            rig,
            lidar,
            motor,
            decoder: SlcanDecoder::default(),
            people,
            next_picture_us: PICTURE_US,
            refused: 0,
        };
        Ok(Some((end, WindowLinks { configuration, people: robot_people })))
    }

    /// Plays up to a moment of the world.
    pub fn play(&mut self, simulation: &Simulation, to_us: u64) {
        let pose = simulation.robot().0;
        self.rig.follow(simulation.people(), pose);
        let bytes = self.lidar.receive();
        self.rig.receive(&bytes);
        let (frames, replies) = self.decoder.push(&read_all(&self.motor));
        self.refused += u64::from(!write_all(&self.motor, &replies));
        for frame in &frames {
            self.rig.receive_can(frame);
        }
        let Self { rig, lidar, motor, refused, .. } = self;
        rig.advance_to(to_us, &mut |_, event| {
            let is_sent = match event {
                RigEvent::Lidar(bytes) => lidar.send(&bytes),
                RigEvent::Frame(frame) => write_all(motor, encode_slcan(&frame).as_bytes()),
            };
            *refused += u64::from(!is_sent);
        });
        if to_us >= self.next_picture_us {
            self.next_picture_us = to_us + PICTURE_US;
            self.send_people(simulation);
        }
    }

    /// What a detector would say of the panoramic picture.
    fn send_people(&mut self, simulation: &Simulation) {
        let Some(socket) = &self.people else { return };
        let pose = simulation.robot().0;
        let place = Point2::new(pose.x_m, pose.y_m);
        let truth = simulation.truth();
        let is_seen = |person: &&Person| {
            person.position.distance(place) < FARTHEST_M
                && truth.people.iter().any(|other| other.id == person.id && other.in_sight)
        };
        let near: Vec<Person> = simulation.people().iter().filter(is_seen).cloned().collect();
        let boxes: Vec<[f32; 4]> = MIRROR
            .people(&near, pose)
            .iter()
            .map(|one| {
                [one.azimuths_rad[0], one.azimuths_rad[1], one.elevations_rad[0], one.elevations_rad[1]]
            })
            .collect();
        let datagram = serde_json::json!({ "age_s": 0.0, "boxes": boxes }).to_string();
        self.refused += u64::from(socket.send(datagram.as_bytes()).is_err());
    }
}

impl LidarEnd {
    fn receive(&mut self) -> Vec<u8> {
        match self {
            Self::Serial(line) => read_all(line),
            Self::Tcp(listener, stream) => {
                if let Ok((newest, _)) = listener.accept() {
                    // A connection that blocks would hold up the world.
                    *stream = newest.set_nonblocking(true).is_ok().then_some(newest);
                }
                let mut bytes = vec![0; 4_096];
                let count = stream.as_mut().and_then(|stream| stream.read(&mut bytes).ok()).unwrap_or(0);
                bytes.truncate(count);
                bytes
            }
        }
    }

    fn send(&mut self, bytes: &[u8]) -> bool {
        match self {
            Self::Serial(line) => write_all(line, bytes),
            Self::Tcp(_, stream) => stream
                .as_mut()
                .is_none_or(|stream| stream.write(bytes).is_ok_and(|count| count == bytes.len())),
        }
    }
}
