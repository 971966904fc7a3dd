//! The twenty classes of faults, and what each is at each source.

use floorguard_types::random::Pcg32;

/// Kinds of faults (anchors R3).
pub const CLASSES: [&str; 20] = [
    "drop",
    "burst loss",
    "delay",
    "reorder",
    "duplicate",
    "truncate",
    "bit flip",
    "stuck value",
    "NaN or extreme",
    "past stamp",
    "future stamp",
    "clock drift",
    "wrong sender",
    "blinded sector",
    "rate change",
    "link flap",
    "CPU overload",
    "task stall",
    "output stuck",
    "reset mid-mission",
];

/// Where faults happen, as `--fault` names it.
pub const SOURCES: [&str; 12] = [
    "lidar",
    "scanner",
    "imu",
    "traction",
    "steering",
    "encoders",
    "inputs",
    "commands",
    "traction-command",
    "guard",
    "perception",
    "computer",
];

/// The devices that speak; the first three have a clock of their own.
const DEVICES: usize = 7;
/// First of the sources within the computer.
const TASKS: usize = 9;

/// The source is a task of the robot's computer, or all of it.
#[must_use]
pub const fn is_computer(source: usize) -> bool {
    source >= TASKS
}

/// The class can happen at the source. Process data on the bus carry no stamp; only sensors of light can be blinded;
/// tasks can be slow or stand, and the whole computer can lose its power; outputs are stuck where the computer
/// speaks.
#[must_use]
pub fn is_possible(class: usize, source: usize) -> bool {
    let (device, command) = (source < DEVICES, SOURCES[source] == "commands");
    match CLASSES[class] {
        "future stamp" | "clock drift" => source < 3,
        "blinded sector" => source < 2,
        "CPU overload" | "task stall" => is_computer(source),
        "output stuck" => command || SOURCES[source] == "traction-command",
        "reset mid-mission" => device || SOURCES[source] == "computer",
        "stuck value" => device,
        _ => device || command,
    }
}

/// The fault as text, without its times. How bad it is is drawn.
#[must_use]
pub fn draw(class: usize, source: usize, random: &mut Pcg32) -> String {
    let percent = |random: &mut Pcg32, choices: &[u32]| choices[random.below(choices.len() as u32) as usize];
    let millis = percent;
    let kind = match CLASSES[class] {
        "drop" => format!("drop={}%", percent(random, &[2, 5, 20, 50, 100])),
        "burst loss" => format!("burst={}", percent(random, &[2, 5, 20, 100])),
        "delay" => format!("delay={}ms", millis(random, &[5, 20, 80, 250, 800])),
        "reorder" => format!("reorder={}%", percent(random, &[5, 30, 100])),
        "duplicate" => format!("duplicate={}%", percent(random, &[5, 50, 100])),
        "truncate" => format!("truncate={}%", percent(random, &[2, 20, 100])),
        "bit flip" => format!("flip={}%", percent(random, &[1, 10, 50, 100])),
        "stuck value" | "output stuck" => "stuck".to_owned(),
        "NaN or extreme" => format!("extreme={}%", percent(random, &[5, 50, 100])),
        "past stamp" => format!("past={}ms", millis(random, &[5, 50, 300, 2_000])),
        "future stamp" => format!("future={}ms", millis(random, &[1, 5, 50, 300, 2_000])),
        "clock drift" => format!("drift={}%", ["0.01", "1", "10", "-1", "-10"][random.below(5) as usize]),
        "wrong sender" => format!("stranger={}%", percent(random, &[5, 50, 100])),
        "blinded sector" => format!("blind={}deg", percent(random, &[20, 60, 120, 270])),
        "rate change" => format!("rate={}", percent(random, &[2, 3, 10])),
        "link flap" => format!("flap={}ms", millis(random, &[20, 100, 400, 1_000])),
        "CPU overload" => format!("overload={}%", percent(random, &[30, 60, 90])),
        "task stall" => format!("stall={}ms", millis(random, &[50, 200, 500, 950])),
        _ => "reset".to_owned(),
    };
    format!("{}:{kind}", SOURCES[source])
}

/// Any class at any source where it can be.
#[must_use]
pub fn random_fault(random: &mut Pcg32) -> String {
    let pairs: Vec<(usize, usize)> = (0..CLASSES.len())
        .flat_map(|class| (0..SOURCES.len()).map(move |source| (class, source)))
        .filter(|(class, source)| is_possible(*class, *source))
        .collect();
    let (class, source) = pairs[random.below(pairs.len() as u32) as usize];
    draw(class, source, random)
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_sim::FaultSpec;

    #[test]
    fn every_class_occurs_and_every_text_parses() {
        let mut random = Pcg32::new(1, 1);
        for (class, name) in CLASSES.iter().enumerate() {
            assert!((0..SOURCES.len()).any(|source| is_possible(class, source)), "{name}");
            for source in (0..SOURCES.len()).filter(|source| is_possible(class, *source)) {
                for _ in 0..20 {
                    let text = draw(class, source, &mut random);
                    assert!(FaultSpec::parse(&text).is_ok(), "{text}");
                }
            }
        }
    }
}
