//! Roboteqs by CAN against controllers that nobody here wrote a decoder for: the simulated ones, which encode by themselves. Who is not shown a
//! watchdog does not drive; who falls silent is stopped by the controller; what is lost on the bus stops the robot.

use floorguard_drivers::can::CanFrame;
use floorguard_drivers::motor_drives::{MotorDrives, MotorDrivesConfiguration, MotorProtocol, WatchdogCheck};
use floorguard_drivers::three_wheel_base::{BaseEvent, StopKind};
use floorguard_drivers::wheel_drives::{SideTargets, WheelCommand};
use floorguard_sim::CanFrame as SimulatedFrame;
use floorguard_sim::motors::{MotorBank, MotorKind, MotorParameters};
use floorguard_types::time::Stamp;

const GO: WheelCommand = WheelCommand::Move(SideTargets { left_mps: 0.4, right_mps: 0.6 });
const STOP: WheelCommand = WheelCommand::Stop(StopKind::TorqueOff);

struct Bench {
    base: MotorDrives,
    bank: MotorBank,
    now_ms: u64,
    rolled_m: [f64; 4],
    /// Frames of these identifiers do not come through.
    dropped: Vec<u16>,
    losses: u32,
    /// The computer does nothing.
    is_frozen: bool,
    /// The fastest wheel ever.
    fastest_mps: f32,
}

impl Bench {
    fn new(watchdog_ms: u32) -> Self {
        let (nodes, metres_per_turn) = ([9, 9, 0, 0], [0.02, -0.02, 0.02, -0.02]);
        let configuration = MotorDrivesConfiguration {
            protocol: MotorProtocol::RoboteqCan,
            nodes,
            metres_per_turn,
            counts_per_turn: 2_000.0,
            ..MotorDrivesConfiguration::default()
        };
        let bank = MotorBank::new(MotorParameters {
            kind: MotorKind::RoboteqCan,
            wheels: 2,
            nodes,
            metres_per_turn,
            counts_per_turn: 2_000.0,
            pole_pairs: 1.0,
            watchdog_ms,
        });
        Self {
            base: MotorDrives::new(configuration),
            bank,
            now_ms: 0,
            rolled_m: [0.0; 4],
            dropped: Vec::new(),
            losses: 0,
            is_frozen: false,
            fastest_mps: 0.0,
        }
    }

    /// What the wheels do is what is demanded; without power they stand.
    fn rims_mps(&self) -> [f32; 4] {
        self.bank.demands_mps().map(|demand| demand.unwrap_or(0.0))
    }

    fn run(&mut self, millis: u64, command: WheelCommand) {
        for _ in 0..millis {
            self.now_ms += 1;
            let (now, rims_mps) = (Stamp::from_micros(self.now_ms * 1_000), self.rims_mps());
            for (rolled_m, rim_mps) in self.rolled_m.iter_mut().zip(rims_mps) {
                *rolled_m += f64::from(rim_mps) * 1.0e-3;
                self.fastest_mps = self.fastest_mps.max(rim_mps.abs());
            }
            let mut out = Vec::new();
            self.bank.tick((self.now_ms * 1_000, 1.0e-3), (rims_mps, self.rolled_m), &mut out);
            if self.is_frozen {
                continue;
            }
            if self.now_ms.is_multiple_of(10) {
                self.base.command(command);
                let (bank, at_us, losses) = (&mut self.bank, self.now_ms * 1_000, &mut self.losses);
                let mut lost = |event| *losses += u32::from(matches!(event, BaseEvent::NodeLost(_)));
                self.base.poll(now, &mut lost, &mut |frame| {
                    let id = frame.standard_id().expect("standard frames");
                    if !self.dropped.contains(&id) {
                        bank.receive(&SimulatedFrame::new(u32::from(id), frame.payload()), at_us, &mut out);
                    }
                });
            }
            for frame in &out {
                let heard = CanFrame::standard(frame.id as u16, frame.payload());
                if !self.dropped.contains(&(frame.id as u16)) {
                    self.base.on_frame(&heard, now, &mut |_| {});
                }
            }
        }
    }
}

fn driving() -> Bench {
    let mut bench = Bench::new(200);
    bench.run(3_000, GO);
    assert_eq!(bench.base.watchdog(), WatchdogCheck::Passed);
    let rims_mps = bench.rims_mps();
    assert!((rims_mps[0] - 0.4).abs() < 1.0e-3 && (rims_mps[1] - 0.6).abs() < 1.0e-3, "{rims_mps:?}");
    bench
}

#[test]
fn fg_req_084_roboteq_without_shown_watchdog_stands() {
    // Off, or longer than is asked for.
    for watchdog_ms in [0, 1_000] {
        let mut bench = Bench::new(watchdog_ms);
        bench.run(4_000, GO);
        assert!(bench.base.is_complete(), "it is heard");
        assert_eq!((bench.base.watchdog(), bench.fastest_mps), (WatchdogCheck::Pending, 0.0));
    }
}

#[test]
fn fg_req_084_silent_computer_stops_roboteq() {
    let mut bench = driving();
    bench.is_frozen = true;
    // 200 ms, and 0.6 m/s by its own ramp of 0.8 m/s².
    bench.run(1_000, GO);
    assert_eq!(bench.rims_mps(), [0.0; 4], "by its own watchdog");
    // The computer wakes: the old speeds do not come back with its first command.
    bench.is_frozen = false;
    bench.fastest_mps = 0.0;
    bench.run(1_000, STOP);
    assert_eq!((bench.fastest_mps, bench.losses), (0.0, 2));
    bench.run(600, WheelCommand::Stop(StopKind::Hold));
    assert_eq!(bench.fastest_mps, 0.0, "released at standstill");
}

#[test]
fn frames_lost_on_the_bus_stop_roboteq() {
    // Its flags do not come: it is lost, and the speeds end.
    let mut bench = driving();
    bench.dropped = vec![0x389];
    bench.run(1_100, GO);
    assert_eq!((bench.losses, bench.rims_mps()), (2, [0.0; 4]));
    // The speeds do not reach it: its watchdog stops it.
    let mut bench = driving();
    bench.dropped = vec![0x209];
    bench.run(1_000, GO);
    assert_eq!(bench.rims_mps(), [0.0; 4]);
    // Nor is it released then with what it was asked before.
    bench.run(500, GO);
    bench.dropped.clear();
    bench.run(3, STOP);
    bench.run(1_000, STOP);
    assert_eq!(bench.rims_mps(), [0.0; 4]);
}

#[test]
fn power_cut_is_a_fault_of_the_drive() {
    let mut bench = driving();
    bench.bank.cut_power();
    bench.run(200, GO);
    assert_eq!(bench.rims_mps(), [0.0; 4]);
    let mut state = None;
    bench.base.on_frame(
        &CanFrame::standard(0x289, &[0; 8]),
        Stamp::from_micros(bench.now_ms * 1_000),
        &mut |event| {
            if let BaseEvent::Drive(heard) = event {
                state = Some(heard.state);
            }
        },
    );
    assert_eq!(state, Some(floorguard_types::sensing::DriveState::Fault(0x0E04)), "undervoltage");
}
