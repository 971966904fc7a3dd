//! Our detector on a recording that it never learnt from, through the command's own evaluation.

use floorguard_laboratory::evaluate;
use floorguard_tests::data::recording;

#[test]
fn walking_people_of_a_real_hall_are_claimed() {
    let folder = "vlp16_clouds/fabu_hall_people_A_reencoded";
    let (Some(capture), Some(key)) =
        (recording(&format!("{folder}.pcap.gz")), recording(&format!("{folder}.pseudo_tracks.csv")))
    else {
        return;
    };
    let report = evaluate::clusters(&capture, &key).expect("readable");
    println!("{report:?}");
    assert!(report.frames == 130 && report.key_people > 300, "{report:?}");
    assert!(report.recall >= 0.90, "recall {}", report.recall);
    // What stands in that hall besides the three is not keyed: one object of a person's shape never moves.
    assert!(report.other_claims_per_frame <= 2.0, "{} others a frame", report.other_claims_per_frame);
}
