//! What other rings and people tell the guard.
//!
//! Each task has a form that reports what it takes: a recording keeps it, because the threads of a computer hand it over
//! at other moments in each run.

use embassy_futures::select::{Either, select};
use embassy_sync::blocking_mutex::raw::RawMutex;
use floorguard_guard::Advice;
use floorguard_types::geometry::Twist2;
use floorguard_types::time::Stamp;

use crate::clock;
use crate::shared::Shared;

/// What the guard ring takes from other rings and from people.
#[derive(Clone, Copy, Debug)]
pub enum GuardInput<'a> {
    /// What the mission would like, and when it asked for it.
    Command(Stamp, Twist2),
    /// What perception advises.
    Advice(&'a Advice),
    /// The button for reset.
    Reset,
    /// The button for start.
    Start,
}

/// Guard ring: what the mission would like. Runs for ever.
pub fn command_input<M: RawMutex>(shared: &Shared<M>) -> impl Future<Output = ()> {
    observed_command_input(shared, |_| {})
}

/// The same; `observe` gets each input before the guard does.
pub fn observed_command_input<M: RawMutex>(
    shared: &Shared<M>,
    observe: impl FnMut(GuardInput<'_>),
) -> impl Future<Output = ()> {
    shaped_command_input(shared, |wanted| wanted, observe)
}

/// The same for a base that cannot drive every velocity: the guard judges what `drivable` makes of the requested one (FG-REQ-083).
pub async fn shaped_command_input<M: RawMutex>(
    shared: &Shared<M>,
    drivable: impl Fn(Twist2) -> Twist2,
    mut observe: impl FnMut(GuardInput<'_>),
) {
    loop {
        let (stamp, wanted) = shared.wanted.next().await;
        let wanted = drivable(wanted);
        observe(GuardInput::Command(stamp, wanted));
        shared.decide(|guard| guard.on_command(wanted, stamp, clock::now()));
    }
}

/// Guard ring: what perception advises. Runs for ever.
pub fn advice_input<M: RawMutex>(shared: &Shared<M>) -> impl Future<Output = ()> {
    observed_advice_input(shared, |_| {})
}

/// The same; `observe` gets each input before the guard does.
pub async fn observed_advice_input<M: RawMutex>(shared: &Shared<M>, mut observe: impl FnMut(GuardInput<'_>)) {
    loop {
        let advice = shared.advice.next().await;
        observe(GuardInput::Advice(&advice));
        shared.decide(|guard| guard.on_advice(&advice, clock::now()));
    }
}

/// Guard ring: the buttons for reset and start. Runs for ever.
pub fn operator_input<M: RawMutex>(shared: &Shared<M>) -> impl Future<Output = ()> {
    observed_operator_input(shared, |_| {})
}

/// The same; `observe` gets each input before the guard does.
pub async fn observed_operator_input<M: RawMutex>(
    shared: &Shared<M>,
    mut observe: impl FnMut(GuardInput<'_>),
) {
    loop {
        match select(shared.reset.wait(), shared.start.wait()).await {
            Either::First(()) => {
                observe(GuardInput::Reset);
                shared.drive_reset.signal(());
                shared.decide(|guard| guard.request_reset(clock::now()));
            }
            Either::Second(()) => {
                observe(GuardInput::Start);
                shared.decide(|guard| guard.request_start(clock::now()));
            }
        }
    }
}
