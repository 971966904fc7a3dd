//! Somebody drives the robot by hand: commands of a scenario instead of a route. The guard treats them like any other.

use embassy_sync::blocking_mutex::raw::RawMutex;
use embassy_time::{Duration, Ticker};
use floorguard_runtime::clock;
use floorguard_runtime::shared::Shared;
use floorguard_sim::scenario::ManoeuvreFile;
use floorguard_types::geometry::Twist2;

/// How often the command is renewed, milliseconds: the guard takes one of 200 ms for stale.
const PERIOD_MS: u64 = 50;

/// What is commanded so many seconds after the begin; to stand after the last one.
fn commanded(manoeuvres: &[ManoeuvreFile], mut seconds: f32) -> Twist2 {
    for manoeuvre in manoeuvres {
        if seconds < manoeuvre.seconds {
            return Twist2 { linear_mps: manoeuvre.forward_mps, angular_radps: manoeuvre.turn_radps };
        }
        seconds -= manoeuvre.seconds;
    }
    Twist2::ZERO
}

/// Commands one manoeuvre after the other, for ever.
pub async fn drive_by_hand<M: RawMutex>(shared: &Shared<M>, manoeuvres: Vec<ManoeuvreFile>) {
    let mut ticker = Ticker::every(Duration::from_millis(PERIOD_MS));
    let begin = clock::now();
    loop {
        ticker.next().await;
        let now = clock::now();
        let wanted =
            if shared.is_paused() { Twist2::ZERO } else { commanded(&manoeuvres, now.seconds_since(begin)) };
        shared.wanted.publish((now, wanted));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_after_the_other_and_then_it_stands() {
        let manoeuvre = |seconds, forward_mps, turn_radps| ManoeuvreFile { seconds, forward_mps, turn_radps };
        let list = [manoeuvre(2.0, 0.5, 0.0), manoeuvre(1.0, -0.2, 0.1)];
        assert_eq!(commanded(&list, 1.9).linear_mps, 0.5);
        assert_eq!(commanded(&list, 2.1), Twist2 { linear_mps: -0.2, angular_radps: 0.1 });
        assert_eq!(commanded(&list, 3.1), Twist2::ZERO);
    }
}
