//! Any bytes into every decoder: no panic, nothing out of range comes out, and the next right message is understood.
//!
//! `cargo xtask campaign fuzz-…` runs as many messages as one likes. A finding becomes a named test beside its decoder.

use floorguard_configuration::EXAMPLE;
use floorguard_drivers::microscan3::Receiver as SafetyScanner;
use floorguard_tests::campaign::{Random, Slice, report};
use floorguard_tests::fuzz::scanning::{self, ScanningCorpus};
use floorguard_tests::fuzz::{
    Corpus, bridged_datagrams, bridged_samples, bridged_scans, cola_scans, corrupt, decoders, files, links,
    livox_datagrams, messages, motors, ouster_turn, pick, rplidar_turns,
};

/// Runs each trial with its own random numbers and tells how many messages were of use.
fn campaign(trials: u64, trial: impl FnMut(&mut Random) -> u64) {
    campaign_of(trials, 1, trial);
}

/// The same where one trial feeds the decoder several corrupted messages.
fn campaign_of(trials: u64, messages: u64, mut trial: impl FnMut(&mut Random) -> u64) {
    let slice = Slice::from_environment(trials);
    let mut useful = 0;
    for number in slice.trials.clone() {
        let mut random = slice.random(number);
        useful += trial(&mut random);
    }
    let executions = (slice.trials.end - slice.trials.start) * messages;
    report(&[("executions", executions), ("accepted", useful)]);
    assert!(useful > 0 || executions < 100, "every message was refused: the campaign tests nothing");
}

/// One of the messages, corrupted with parts of another one.
fn corrupted(corpus: &[Vec<u8>], longest: usize, random: &mut Random) -> Vec<u8> {
    let mut bytes = pick(corpus, random).clone();
    corrupt(&mut bytes, pick::<Vec<u8>>(corpus, random), longest, random);
    bytes
}

#[test]
fn fuzz_velodyne() {
    let corpus = Corpus::simulated().lidar;
    campaign(8_000, |random| {
        let datagrams: Vec<_> = (0..1 + random.below(3)).map(|_| corrupted(&corpus, 2_048, random)).collect();
        decoders::velodyne(&datagrams)
    });
}

#[test]
fn fuzz_ouster() {
    let (beams, turn) = ouster_turn();
    campaign(2_000, |random| {
        let from = random.below(50) as usize;
        let mut datagrams: Vec<Vec<u8>> = turn[from..from + 4].to_vec();
        for datagram in &mut datagrams {
            if random.seldom(2) {
                corrupt(datagram, pick::<Vec<u8>>(&turn, random), 8_192, random);
            }
        }
        // A wrong number of turn or column may make half a turn look repeated; after that the next packets are taken.
        decoders::ouster(&beams, &datagrams, &turn)
    });
}

#[test]
fn fuzz_lidar_link() {
    let corpus = bridged_datagrams();
    campaign(8_000, |random| {
        let mut datagrams: Vec<Vec<u8>> = (0..3).map(|_| pick::<Vec<u8>>(&corpus, random).clone()).collect();
        corrupt(&mut datagrams[1], pick::<Vec<u8>>(&corpus, random), 4_096, random);
        decoders::lidar_link(&datagrams)
    });
}

#[test]
fn fuzz_scan_link() {
    let corpus = bridged_scans();
    campaign(4_000, |random| {
        // Two scans of two datagrams each; the first datagram of the second one, or both of the first, are damaged.
        let mut datagrams: Vec<Vec<u8>> = corpus[..4].to_vec();
        corrupt(&mut datagrams[2], pick::<Vec<u8>>(&corpus, random), 4_096, random);
        if random.seldom(4) {
            corrupt(&mut datagrams[0], pick::<Vec<u8>>(&corpus, random), 4_096, random);
        }
        links::scan_link(&datagrams, &corpus[6..8])
    });
}

#[test]
fn fuzz_imu_link() {
    let corpus = bridged_samples();
    campaign(4_000, |random| {
        let mut bytes = corpus[..8].concat();
        corrupt(&mut bytes, pick::<Vec<u8>>(&corpus, random), 2_000, random);
        links::imu_link(&bytes, 1 + random.below(200) as usize, &corpus[10..14])
    });
}

#[test]
fn fuzz_livox() {
    let corpus = livox_datagrams();
    let (before, right) = corpus.split_at(24);
    campaign(2_000, |random| {
        // After a turn the decoder gives columns.
        let mut datagrams = before.to_vec();
        for datagram in datagrams.iter_mut().skip(18) {
            if random.seldom(2) {
                corrupt(datagram, pick::<Vec<u8>>(&corpus, random), 2_048, random);
                // Without a checksum the damage gets farther in.
                if random.seldom(2)
                    && let Some(checksum) = datagram.get_mut(24..28)
                {
                    checksum.fill(0);
                }
            }
        }
        decoders::livox(&datagrams, right)
    });
}

#[test]
fn fuzz_cola() {
    let corpus = cola_scans();
    campaign(500, |random| {
        let mut bytes = corpus.concat();
        corrupt(&mut bytes, pick::<Vec<u8>>(&corpus, random), 40_000, random);
        decoders::cola(&bytes, 1 + random.below(3_000) as usize, &corpus[3])
    });
}

#[test]
fn fuzz_rplidar() {
    let corpus = rplidar_turns();
    campaign(1_000, |random| {
        let mut bytes = corpus.concat();
        corrupt(&mut bytes, pick::<Vec<u8>>(&corpus, random), 6_000, random);
        decoders::rplidar(&bytes, 1 + random.below(700) as usize, &corpus.concat())
    });
}

#[test]
fn fuzz_vectornav() {
    let corpus = messages::vectornav_messages();
    campaign(8_000, |random| {
        let mut bytes = corpus.concat();
        corrupt(&mut bytes, pick::<Vec<u8>>(&corpus, random), 2_000, random);
        decoders::vectornav(&bytes, 1 + random.below(200) as usize, &corpus.concat())
    });
}

#[test]
fn fuzz_position() {
    let corpus = Corpus::simulated().position;
    let sentence = b"$GPRMC,220516,A,5133.82,N,00042.24,W,173.8,231.8,130694,004.2,W*70";
    campaign(8_000, |random| {
        let taken = decoders::position(&corrupted(&corpus, 1_024, random));
        let mut text = sentence.to_vec();
        corrupt(&mut text, sentence, 128, random);
        taken + decoders::sentence(&text)
    });
}

#[test]
fn fuzz_s300() {
    let corpus = Corpus::simulated().scanner;
    campaign(3_000, |random| {
        let bytes = corrupted(&corpus, 4_096, random);
        let portion = 1 + random.below(700) as usize;
        // Whether it finds back costs ten times the damage itself: one trial in eight checks it.
        let is_known = random.seldom(8);
        decoders::s300(&bytes, portion, if is_known { &corpus[..2] } else { &[] })
    });
}

#[test]
fn fuzz_slcan() {
    let frames = Corpus::simulated().can;
    let lines: Vec<Vec<u8>> =
        frames.iter().map(|frame| floorguard_sim::can::encode_slcan(frame).into_bytes()).collect();
    campaign(20_000, |random| {
        let mut bytes: Vec<u8> = (0..4).flat_map(|_| pick(&lines, random).clone()).collect();
        corrupt(&mut bytes, pick::<Vec<u8>>(&lines, random), 512, random);
        decoders::slcan(&bytes)
    });
}

#[test]
fn fuzz_base() {
    let frames = Corpus::simulated().can;
    campaign_of(3_000, decoders::BUS_FRAMES, |random| decoders::base(&frames, random));
}

#[test]
fn fuzz_xsens() {
    let corpus = [Corpus::simulated().imu, messages::xsens_messages()].concat();
    campaign(8_000, |random| decoders::xsens(&corrupted(&corpus, 4_096, random)));
}

#[test]
fn fuzz_microscan3() {
    let whole = messages::microscan3_message(40);
    let corpus = [1, 2].map(|identification| messages::microscan3_datagrams(&whole, identification)).concat();
    let right = messages::microscan3_datagrams(&whole, 77);
    let (mut receiver, mut now_us) = (SafetyScanner::new(Default::default()), 1_000_000);
    campaign(4_000, |random| {
        // Either the content is corrupted and then sent whole, or the datagrams are corrupted in transit.
        let mut message = whole.clone();
        if random.seldom(2) {
            corrupt(&mut message, &whole, 2_048, random);
            decoders::microscan3_message(&message);
        }
        let mut sent = messages::microscan3_datagrams(&message, random.below(4) as u32);
        let sent: Vec<_> = sent
            .drain(..)
            .map(|mut datagram| {
                if random.seldom(3) {
                    corrupt(&mut datagram, pick::<Vec<u8>>(&corpus, random), 1_500, random);
                }
                (random.below(20_000), datagram)
            })
            .collect();
        decoders::microscan3(&mut receiver, &mut now_us, &sent, &right)
    });
}

#[test]
fn fuzz_velocity_link() {
    let corpus = messages::velocity_requests();
    campaign(4_000, |random| {
        let frame = |random: &mut Random| {
            let whole = random.seldom(2).then(|| pick::<Vec<u8>>(&corpus, random).clone());
            (random.below(60_000), whole.unwrap_or_else(|| corrupted(&corpus, 300, random)))
        };
        let frames: Vec<_> = (0..1 + random.below(8)).map(|_| frame(random)).collect();
        decoders::velocity_link(&frames)
    });
}

#[test]
fn fuzz_motors() {
    let talks = motors::motor_talks();
    campaign_of(4_000, motors::MOTOR_FRAMES, |random| motors::motors(&talks, random));
}

#[test]
fn fuzz_scip() {
    let corpus = ScanningCorpus::simulated();
    campaign(3_000, |random| {
        let parts = 1 + random.below(3);
        let bytes: Vec<u8> = (0..parts).flat_map(|_| corrupted(&corpus.replies, 4_096, random)).collect();
        // A whole conversation costs as much as some fifty trials.
        scanning::scip(&corpus, &bytes, random.seldom(100))
    });
}

#[test]
fn fuzz_scan_motor() {
    let corpus = ScanningCorpus::simulated();
    campaign_of(3_000, scanning::MOTOR_FRAMES, |random| scanning::scan_motor(&corpus, random));
}

#[test]
fn fuzz_configuration() {
    let (whole, sections) = ([EXAMPLE.as_bytes().to_vec()], files::sections_of(EXAMPLE));
    campaign(1_000, |random| {
        // One section alone is read ten times as fast as the file, and damage to it seldom hits mere words.
        let corpus = if random.seldom(8) { &whole[..] } else { &sections };
        files::configuration(&corrupted(corpus, 64 * 1024, random))
    });
}

#[test]
fn fuzz_recording() {
    let corpus = [messages::recording()];
    campaign(1_000, |random| files::recording(corrupted(&corpus, 1 << 20, random)));
}
