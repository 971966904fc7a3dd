//! What other rings and people tell the guard.

use embassy_futures::select::{Either, select};
use embassy_sync::blocking_mutex::raw::RawMutex;

use crate::clock;
use crate::shared::Shared;

/// Guard ring: what the mission would like. Runs for ever.
pub async fn command_input<M: RawMutex>(shared: &Shared<M>) {
    loop {
        let (stamp, wanted) = shared.wanted.next().await;
        shared.decide(|guard| guard.on_command(wanted, stamp, clock::now()));
    }
}

/// Guard ring: what perception advises. Runs for ever.
pub async fn advice_input<M: RawMutex>(shared: &Shared<M>) {
    loop {
        let advice = shared.advice.next().await;
        shared.decide(|guard| guard.on_advice(&advice, clock::now()));
    }
}

/// Guard ring: the buttons for reset and start. Runs for ever.
pub async fn operator_input<M: RawMutex>(shared: &Shared<M>) {
    loop {
        match select(shared.reset.wait(), shared.start.wait()).await {
            Either::First(()) => {
                shared.drive_reset.signal(());
                shared.decide(|guard| guard.request_reset(clock::now()));
            }
            Either::Second(()) => {
                shared.decide(|guard| guard.request_start(clock::now()));
            }
        }
    }
}
