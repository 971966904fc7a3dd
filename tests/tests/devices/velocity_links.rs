//! Links of velocities that die: what was asked for before ends at its deadline, and the base is sent a stop at once.

use std::cell::RefCell;
use std::rc::Rc;

use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use floorguard_drivers::velocity_link::AcceptanceRules;
use floorguard_guard::{Action, Decision};
use floorguard_host::executor::{TaskSet, advance_virtual, next_timer_us, use_virtual_clock};
use floorguard_laboratory::world::Plan;
use floorguard_robot::assembly::new_shared;
use floorguard_runtime::clock;
use floorguard_runtime::io::{FramePort, PortFrame};
use floorguard_runtime::shared::Shared;
use floorguard_runtime::tasks::{VelocityRules, velocity_base, velocity_input};
use floorguard_sim::wire::{SentVelocity, TakenVelocity};
use floorguard_types::geometry::Twist2;
use floorguard_types::time::Stamp;

const BEGIN_US: u64 = 1_000_000;

/// A frame that the robot sent, and when, microseconds.
type Sent = Rc<RefCell<Vec<(u64, TakenVelocity)>>>;

/// A link that gives one frame, if it has one, and from then on fails at once; what is sent still arrives.
struct DeadLink {
    frame: Option<Vec<u8>>,
    sent: Sent,
}

impl FramePort for DeadLink {
    type Error = &'static str;

    async fn receive(&mut self, buffer: &mut [u8]) -> Result<PortFrame, Self::Error> {
        let frame = self.frame.take().ok_or("it is dead")?;
        buffer[..frame.len()].copy_from_slice(&frame);
        Ok(PortFrame { length: frame.len(), arrival: clock::now(), peer: 1 })
    }

    fn follow(&mut self) {}

    async fn send(&mut self, frame: &[u8]) -> Result<(), Self::Error> {
        let request = TakenVelocity::read(frame);
        self.sent.borrow_mut().extend(request.map(|request| (clock::now().as_micros(), request)));
        Ok(())
    }
}

fn shared() -> Box<Shared<NoopRawMutex>> {
    use_virtual_clock(BEGIN_US);
    let plan = Plan::named("corridor", 1, 1).unwrap();
    new_shared(&plan.robot, Stamp::from_micros(BEGIN_US)).unwrap()
}

/// Lets the tasks run until a moment.
fn run_until(tasks: &mut TaskSet<'_>, end_us: u64) {
    for _ in 0..10_000 {
        tasks.poll_until_quiet().unwrap();
        match next_timer_us().filter(|at_us| *at_us <= end_us) {
            Some(at_us) => advance_virtual(at_us),
            None => break,
        }
    }
    advance_virtual(end_us);
    tasks.poll_until_quiet().unwrap();
}

#[test]
fn request_ends_at_its_deadline_on_dead_link() {
    let shared = shared();
    let request = SentVelocity {
        sender: 7,
        sequence: 1,
        sent_ms: 0,
        deadline_ms: 150,
        linear_mps: 0.5,
        angular_radps: 0.0,
    };
    let port = DeadLink { frame: Some(request.encode()), sent: Sent::default() };
    let acceptance = AcceptanceRules { sender: None, deadline_max_us: 200_000 };
    let mut tasks = TaskSet::new();
    tasks.spawn(velocity_input(&*shared, port, VelocityRules { acceptance, period_ms: 20 }));
    let wanted_mps = |at: Option<(Stamp, Twist2)>| at.map(|(_, wanted)| wanted.linear_mps);
    run_until(&mut tasks, BEGIN_US + 140_000);
    assert_eq!(wanted_mps(shared.wanted.get()), Some(0.5));
    run_until(&mut tasks, BEGIN_US + 160_000);
    assert_eq!(wanted_mps(shared.wanted.get()), Some(0.0));
}

#[test]
fn base_is_stopped_when_its_link_dies() {
    let shared = shared();
    let stops = shared.decide(|guard| guard.tick(clock::now()));
    let drives = Decision {
        permitted: Twist2 { linear_mps: 0.5, angular_radps: 0.0 },
        action: Action::None,
        torque_off: false,
        ..stops
    };
    shared.decision.publish(drives);
    let sent = Sent::default();
    let mut tasks = TaskSet::new();
    tasks.spawn(velocity_base(&*shared, DeadLink { frame: None, sent: sent.clone() }, 0.8));
    run_until(&mut tasks, BEGIN_US + 100_000);
    let sent = sent.borrow();
    let first = sent.first().expect("a request although nothing is received");
    assert!(first.0 <= BEGIN_US + 20_000, "{first:?}");
    assert!(sent.iter().all(|(_, request)| request.stop != 0), "{sent:?}");
    assert!(sent.len() >= 4, "requests go on: {sent:?}");
}
