//! Three people stand and walk away in a hall, recorded by a real VLP-16: each must be found moving while walking, and
//! nothing else.

use floorguard_laboratory::evaluate::motion;
use floorguard_perception::motion::MotionParameters;
use floorguard_tests::data::recording;

/// What this stage must reach.
const FOUND_MIN: f64 = 0.90;
const FALSE_PER_100_SWEEPS_MAX: f64 = 1.0;
/// The key's own note: track 3 is a split of track 2.
const PEOPLE: [u64; 3] = [0, 1, 2];

#[test]
fn walking_people_are_found_moving_and_nothing_else() {
    let capture = recording("vlp16_clouds/fabu_hall_people_A_reencoded.pcap.gz");
    let key = recording("vlp16_clouds/fabu_hall_people_A_reencoded.pseudo_tracks.csv");
    let (Some(capture), Some(key)) = (capture, key) else { return };
    let report = motion(&capture, &key, MotionParameters::FIXED).expect("both are readable");
    println!("{report:?}");
    for track in report.tracks.iter().filter(|track| PEOPLE.contains(&track.track)) {
        assert!(track.walking_frames > 50, "{track:?}");
        assert!(track.found >= FOUND_MIN, "{track:?}");
    }
    assert!(report.static_objects > 5_000, "the hall is full of objects: {}", report.static_objects);
    assert!(report.false_positives_per_100_sweeps <= FALSE_PER_100_SWEEPS_MAX, "{report:?}");
}
