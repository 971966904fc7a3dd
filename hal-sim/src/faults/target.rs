//! Where a fault sits: a line, one device of the bus, the output to the devices, or the computer itself.

use super::FaultKind;
use crate::robot::RobotParameters;
use crate::wire::{Payload, Stream, WireEvent};

/// What a fault concerns.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum FaultTarget {
    /// Everything on a line.
    Line(Stream),
    /// What one or two devices of the bus send.
    Nodes([u8; 2]),
    /// Everything that the robot's computer sends to the bus.
    Commands,
    /// What it sends to the traction drive as process data.
    TractionCommand,
    /// The tasks that can stop the robot.
    Guard,
    /// The tasks that see and plan.
    Perception,
    /// The whole computer.
    Computer,
}

/// Names and what they stand for; the nodes are those of the default robot.
fn named_targets() -> [(&'static str, FaultTarget); 15] {
    use FaultTarget::{Commands, Computer, Guard, Line, Nodes, Perception, TractionCommand};
    let nodes = RobotParameters::default().nodes;
    [
        ("lidar", Line(Stream::LidarData)),
        ("position", Line(Stream::LidarPosition)),
        ("scanner", Line(Stream::ScannerSerial)),
        ("rear-scanner", Line(Stream::RearScannerSerial)),
        ("imu", Line(Stream::ImuSerial)),
        ("can", Line(Stream::Can)),
        ("traction", Nodes([nodes.traction; 2])),
        ("steering", Nodes([nodes.steering; 2])),
        ("encoders", Nodes([nodes.left_encoder, nodes.right_encoder])),
        ("inputs", Nodes([nodes.gateway; 2])),
        ("commands", Commands),
        ("traction-command", TractionCommand),
        ("guard", Guard),
        ("perception", Perception),
        ("computer", Computer),
    ]
}

impl FaultTarget {
    /// By its name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        named_targets().into_iter().find(|(known, _)| *known == name).map(|(_, target)| target)
    }

    /// All names, for messages.
    #[must_use]
    pub fn names() -> String {
        named_targets().map(|(name, _)| format!("{name}:")).join(", ")
    }

    /// The fault can happen here.
    #[must_use]
    pub const fn can_suffer(self, kind: FaultKind) -> bool {
        match self {
            Self::Guard | Self::Perception => kind.halts_tasks(),
            Self::Computer => kind.halts_tasks() || matches!(kind, FaultKind::Reset),
            Self::Line(Stream::LidarData | Stream::ScannerSerial | Stream::ScannerData) => {
                !kind.halts_tasks()
            }
            _ => !kind.halts_tasks() && !matches!(kind, FaultKind::Blind(_)),
        }
    }

    /// It concerns what the computer sends, not what it hears.
    #[must_use]
    pub const fn is_output(self) -> bool {
        matches!(self, Self::Commands | Self::TractionCommand)
    }

    /// An event in transit is concerned. `output`: the computer sent it.
    #[must_use]
    pub fn concerns(self, event: &WireEvent, output: bool) -> bool {
        let frame_id = match &event.payload {
            Payload::Frame(frame) if !frame.extended => Some(frame.id),
            _ => None,
        };
        match self {
            // A fault of the scanner hits whichever is fitted.
            Self::Line(Stream::ScannerSerial) => {
                !output && matches!(event.stream, Stream::ScannerSerial | Stream::ScannerData)
            }
            Self::Line(stream) => !output && event.stream == stream,
            Self::Nodes(nodes) => {
                !output && frame_id.is_some_and(|id| id >= 0x080 && nodes.contains(&((id & 0x7F) as u8)))
            }
            Self::Commands => output,
            Self::TractionCommand => {
                let traction = u32::from(RobotParameters::default().nodes.traction);
                output && frame_id == Some(0x200 + traction)
            }
            Self::Guard | Self::Perception | Self::Computer => false,
        }
    }
}
