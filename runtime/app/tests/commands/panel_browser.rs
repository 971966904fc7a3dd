//! The panel's page in a real browser without a screen: its script runs and shows the robot.

use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};

use crate::seen_support::{Page, browser};

#[test]
fn a_browser_shows_the_driving_robot() {
    let Some(browser) = browser() else {
        println!("skipped: no Chromium is installed");
        return;
    };
    let mut child = Command::new(env!("CARGO_BIN_EXE_floorguard"))
        .args(["simulate", "--scenario", "empty", "--duration", "400", "--panel", "127.0.0.1:0", "--json"])
        .env_remove("FLOORGUARD_PANEL_TOKEN")
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let mut lines = BufReader::new(child.stderr.take().expect("its words")).lines();
    let line = lines.find_map(|line| line.ok().filter(|line| line.contains("http://"))).expect("an address");
    let address = line.trim().trim_start_matches("panel: ");
    // The robot plays in real time: beside other tests it starts late, and may stand for a moment.
    let seen = Page::open(browser, address, (1280, 800)).until(Seen::of, Seen::shows_a_driving_robot);
    let _ = child.kill();
    let _ = child.wait();
    assert!(seen.last().is_some_and(Seen::shows_a_driving_robot), "{seen:?}");
}

/// What one picture of the page shows.
#[derive(Clone, Copy, Debug)]
struct Seen {
    /// The robot's body on the map.
    body_pixels: usize,
    /// The word in the page's head that it drives; a page without connection has grey there.
    driving_pixels: usize,
}

impl Seen {
    fn of(picture: &image::RgbImage) -> Self {
        let count = |colour: [u8; 3], columns: std::ops::Range<u32>| {
            picture
                .enumerate_pixels()
                .filter(|(x, _, pixel)| columns.contains(x) && pixel.0 == colour)
                .count()
        };
        Self {
            body_pixels: count([0x0b, 0x53, 0x94], 0..890),
            driving_pixels: count([0x2e, 0x7d, 0x32], 900..1280),
        }
    }

    fn shows_a_driving_robot(&self) -> bool {
        self.body_pixels > 500 && self.driving_pixels > 300
    }
}
