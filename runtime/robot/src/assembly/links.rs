//! Opens what `robot.toml` names. A missing device is reported and waited for; a port in use is not.

use std::io;
use std::net::UdpSocket;
use std::sync::mpsc::{Receiver, channel};

use floorguard_runtime::configuration::RangingModel;
use floorguard_runtime::tape::TapeLine;

use super::latch_file::LatchFile;
use super::tap::{Tap, Tapped};
use crate::assembly::{GuardCarriers, PeopleInbox, ScannerCarrier};
use crate::cleaner::MissionSetup;
use crate::learning::LearningSetup;
use crate::navigator::NavigationSetup;
use floorguard_configuration::{
    CanAddress, Carriers, CommandConfiguration, DatagramAddress, ImuAddress, ScannerAddress, ScipAddress,
    SerialAddress,
};
use floorguard_host::carriers::{BoundFrames, CanLink, Listening, ReconnectingLine, ScipWire, UdpReceiver};
use floorguard_host::executor::Lateness;

/// What the scanner is connected to, before the guard's thread opens it.
#[derive(Debug)]
pub enum ScannerLink {
    /// An S300's line.
    Serial(SerialAddress),
    /// The port of a scanner that sends datagrams, bound already, and its accepted sender.
    Datagrams(UdpSocket, Listening),
    /// The line or the connection of a scanner that must be asked.
    Wire(ScipAddress, RangingModel),
}

/// What the inertial sensor is connected to, before the guard's thread opens it.
#[derive(Debug)]
pub enum ImuLink {
    /// A line.
    Serial(SerialAddress),
    /// The port of a bridge, bound already, and its accepted sender.
    Datagrams(UdpSocket, Listening),
}

/// Where the bytes come from, before the guard's thread opens it.
#[derive(Debug)]
pub struct Links {
    /// The lidar's port, bound already, and its accepted sender: a port that is taken is an error at the
    /// start.
    pub lidar: Option<(UdpSocket, Listening)>,
    /// The safety scanner's line or port.
    pub scanner: ScannerLink,
    /// The second safety scanner's line.
    pub rear_scanner: Option<SerialAddress>,
    /// The inertial sensor's line or port.
    pub imu: Option<ImuLink>,
    /// The CAN bus, if the drives are on one.
    pub can: Option<CanAddress>,
    /// The base that takes velocities, if it is one.
    pub base: Option<BoundFrames>,
    /// Who drives the robot from outside; without it, it drives itself.
    pub command: Option<(BoundFrames, CommandConfiguration)>,
    /// Who listens to all of them.
    pub tap: Option<Tap>,
    /// What the robot cleans; without it, it drives its route.
    pub mission: Option<MissionSetup>,
    /// Where the robot drives; it then neither cleans nor drives its route.
    pub navigation: Option<NavigationSetup>,
    /// What others than the lidar and the scanner see of people.
    pub people: PeopleInbox,
    /// How the robot learns; without it, it does not.
    pub learning: Option<LearningSetup>,
    /// Counts how late the guard ring is.
    pub lateness: Lateness,
    /// Where what is latched outlives the computer; a simulated robot does without.
    pub latches: Option<LatchFile>,
}

/// A device that is not there yet.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Missing {
    /// Which.
    pub source: &'static str,
    /// What the system says.
    pub why: String,
}

/// The carriers of the guard ring.
type Opened = GuardCarriers<
    Tapped<UdpReceiver>,
    Tapped<ReconnectingLine>,
    Tapped<UdpReceiver>,
    Tapped<ScipWire>,
    Tapped<CanLink>,
>;

impl Links {
    /// Of a configuration.
    ///
    /// # Errors
    /// A port is taken or not ours.
    pub fn bind(carriers: &Carriers) -> io::Result<Self> {
        let lidar = carriers.lidar.map(|address| bind_port("lidar", address)).transpose()?;
        let scanner = match &carriers.scanner {
            ScannerAddress::Serial(address) => ScannerLink::Serial(address.clone()),
            ScannerAddress::Datagrams(address) => {
                let (socket, listening) = bind_port("scanner", *address)?;
                ScannerLink::Datagrams(socket, listening)
            }
            ScannerAddress::Wire(address, model) => ScannerLink::Wire(address.clone(), *model),
        };
        let imu = carriers.imu.as_ref().map(|address| match address {
            ImuAddress::Serial(line) => Ok(ImuLink::Serial(line.clone())),
            ImuAddress::Datagrams(address) => {
                bind_port("imu", *address).map(|(socket, listening)| ImuLink::Datagrams(socket, listening))
            }
        });
        let imu = imu.transpose()?;
        Ok(Self {
            lidar,
            scanner,
            rear_scanner: carriers.rear_scanner.clone(),
            imu,
            can: carriers.can.clone(),
            base: carriers.base.as_ref().map(BoundFrames::base).transpose()?,
            command: None,
            tap: None,
            mission: None,
            navigation: None,
            people: PeopleInbox::default(),
            learning: None,
            lateness: Lateness::default(),
            latches: None,
        })
    }

    /// What its ports have to say to people while the robot runs.
    #[must_use]
    pub fn notices(&mut self) -> Receiver<String> {
        let (notices, heard) = channel();
        if let Some((_, listening)) = &mut self.lidar {
            listening.notices = Some(notices.clone());
        }
        if let ScannerLink::Datagrams(_, listening) = &mut self.scanner {
            listening.notices = Some(notices.clone());
        }
        if let Some(ImuLink::Datagrams(_, listening)) = &mut self.imu {
            listening.notices = Some(notices.clone());
        }
        let command = self.command.as_mut().map(|(command, _)| command);
        command.into_iter().chain(&mut self.base).for_each(|link| link.notify(notices.clone()));
        heard
    }

    /// Opens everything on the calling thread; `missing` hears of what is not there yet.
    ///
    /// # Errors
    /// The socket cannot be watched.
    pub(super) fn open(self, missing: &mut dyn FnMut(Missing)) -> io::Result<Opened> {
        let mut note = |source, problem: Option<io::Error>| {
            if let Some(error) = problem {
                missing(Missing { source, why: error.to_string() });
            }
        };
        let tap = self.tap;
        let lidar = self.lidar.map(|(socket, listening)| UdpReceiver::from_socket(socket, listening));
        let lidar = lidar.transpose()?.map(|lidar| Tapped::new(lidar, TapeLine::Lidar, tap.clone()));
        let scanner = match self.scanner {
            ScannerLink::Serial(address) => {
                let (line, problem) = ReconnectingLine::new(address.device, address.baud);
                note("safety scanner", problem);
                ScannerCarrier::Serial(Tapped::new(line, TapeLine::Scanner, tap.clone()))
            }
            ScannerLink::Datagrams(socket, listening) => {
                let socket = UdpReceiver::from_socket(socket, listening)?;
                ScannerCarrier::Datagrams(Tapped::new(socket, TapeLine::Scanner, tap.clone()))
            }
            ScannerLink::Wire(address, model) => {
                let (wire, problem) = match model {
                    RangingModel::RplidarA | RangingModel::RplidarS => ScipWire::open_with_motor(&address),
                    _ => ScipWire::open(&address),
                };
                note("scanner", problem);
                ScannerCarrier::Asked(Tapped::new(wire, TapeLine::Scanner, tap.clone()), model)
            }
        };
        let rear_scanner = self.rear_scanner.map(|address| {
            let (line, problem) = ReconnectingLine::new(address.device, address.baud);
            note("rear safety scanner", problem);
            Tapped::new(line, TapeLine::RearScanner, tap.clone())
        });
        let imu = self.imu.map(|link| match link {
            ImuLink::Serial(address) => {
                let (line, problem) = ReconnectingLine::new(address.device, address.baud);
                note("inertial sensor", problem);
                Ok((ScipWire::Line(line), address.baud))
            }
            ImuLink::Datagrams(socket, listening) => {
                UdpReceiver::from_socket(socket, listening).map(|port| (ScipWire::Datagrams(port), 0))
            }
        });
        let imu = imu.transpose()?;
        let can = self.can.map(|address| {
            let (can, problem) = CanLink::new(&address);
            note("CAN bus", problem);
            Tapped::new(can, TapeLine::Can, tap.clone())
        });
        Ok(GuardCarriers {
            lidar,
            scanner,
            rear_scanner,
            imu: imu.map(|(line, baud)| (Tapped::new(line, TapeLine::Imu, tap.clone()), baud)),
            can,
            tap,
        })
    }
}

impl Links {
    /// With the link of a program that drives the robot from outside.
    ///
    /// # Errors
    /// Its port is taken or not ours.
    pub fn commanded(mut self, command: Option<&CommandConfiguration>) -> io::Result<Self> {
        if let Some(command) = command {
            self.command = Some((BoundFrames::command(command)?, command.clone()));
        }
        Ok(self)
    }
}

/// Binds the port of a device; `section` of the robot's file names it.
fn bind_port(section: &'static str, address: DatagramAddress) -> io::Result<(UdpSocket, Listening)> {
    let DatagramAddress { local, sender } = address;
    let socket = UdpSocket::bind(local).map_err(|error| {
        let remedy = format!("end the other program that listens there, or correct [{section}] source");
        io::Error::new(error.kind(), format!("[{section}] udp:{local}: {error}; {remedy}"))
    })?;
    Ok((socket, Listening { section, only: sender, ..Listening::default() }))
}
