//! Maps without people: a hall recorded by a real lidar, judged by an independent key, and who left between two surveys.

use std::path::Path;

use floorguard_app::mapping_commands::{CleanArguments, clean_map};
use floorguard_tests::data::recording;
use floorguard_tests::removal::{Revisited, Twice, octomap, ours};

/// Points of a PLY file of ours.
fn cloud(path: &Path) -> Vec<[f32; 3]> {
    let bytes = std::fs::read(path).expect("the command writes its clouds");
    let end = b"end_header\n";
    let header = bytes.windows(end.len()).position(|window| window == end).expect("a header") + end.len();
    let number = |octets: &[u8]| f32::from_le_bytes(octets.try_into().expect("four octets"));
    bytes[header..].chunks_exact(12).map(|row| [0, 4, 8].map(|at| number(&row[at..at + 4]))).collect()
}

/// Boxes of the key around walking people: least and largest x, y, z, lidar frame.
fn key() -> Option<Vec<[f32; 6]>> {
    let folder = "vlp16_clouds/fabu_hall_people_A_reencoded";
    let rows = |name: &str| -> Option<Vec<Vec<f32>>> {
        let text = std::fs::read_to_string(recording(&format!("{folder}.{name}"))?).expect("a key is text");
        let row = |line: &str| line.split(',').map(|cell| cell.parse().unwrap_or(f32::NAN)).collect();
        Some(text.lines().skip(1).map(row).collect())
    };
    let clusters = rows("fg_clusters.csv")?;
    let of_people = rows("pseudo_tracks.csv")?.into_iter().filter(|row| row[2] < 4.0).filter_map(|row| {
        let cluster = clusters.iter().find(|cluster| cluster[0] == row[0] && cluster[1] == row[5])?;
        cluster.get(6..12)?.try_into().ok()
    });
    Some(of_people.collect())
}

fn is_in(boxes: &[[f32; 6]], point: [f32; 3], grown_m: f32) -> bool {
    let inside = |each: &[f32; 6]| {
        (0..3).all(|axis| (each[axis] - grown_m..=each[axis + 3] + grown_m).contains(&point[axis]))
    };
    boxes.iter().any(inside)
}

/// Boxes out of order, of another picture, and a mounting that is no rotation: each is named, and the former map stays as it was.
fn refused_boxes_lose_nothing(arguments: &CleanArguments, folder: &Path) {
    let camera = |side: &str| {
        format!(
            "{{\"width\": 640, \"height\": 480, \"focal_px\": [320, 320], \"centre_px\": [320, 240], \"camera_from_lidar\": \
             [[0, {side}, 0, 0], [0, 0, -1, 0], [1, 0, 0, 0], [0, 0, 0, 1]]}}"
        )
    };
    let boxes = |time_s: f64, right: u32| {
        format!("time_s,left,top,right,bottom\n0.5,1,2,30,40\n{time_s},1,2,{right},40\n")
    };
    let before = std::fs::read(arguments.out.join("clean.ply")).expect("the first map");
    for (boxes, camera, reported) in [
        (boxes(0.3, 30), camera("-1"), "out of order"),
        (boxes(0.6, 1_900), camera("-1"), "another size"),
        (boxes(0.6, 30), camera("-2"), "no rotation"),
    ] {
        let files = [("boxes.csv", boxes), ("camera.json", camera)].map(|(name, text)| {
            let path = folder.join(name);
            std::fs::write(&path, text).expect("written");
            Some(path)
        });
        let [boxes, camera] = files;
        let refused = clean_map(&CleanArguments { boxes, camera, ..arguments.clone() }).expect_err(reported);
        assert!(refused.to_string().contains(reported), "{reported}: {refused:#}");
        assert_eq!(
            std::fs::read(arguments.out.join("clean.ply")).expect("still there"),
            before,
            "{reported}"
        );
    }
}

#[test]
fn walkers_leave_the_recorded_hall() {
    let capture = recording("vlp16_clouds/fabu_hall_people_A_reencoded.pcap.gz");
    let (Some(capture), Some(people)) = (capture, key()) else { return };
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().join("clean");
    let arguments =
        CleanArguments { files: vec![capture], out: out.clone(), cube_m: 0.02, ..CleanArguments::default() };
    clean_map(&arguments).expect("the hall is cleaned");
    refused_boxes_lose_nothing(&arguments, folder.path());
    let (clean, removed) = (cloud(&out.join("clean.ply")), cloud(&out.join("removed.ply")));
    assert!(people.len() > 250 && clean.len() > 20_000, "{} boxes, {} points", people.len(), clean.len());
    let among =
        |points: &[[f32; 3]], grown_m| points.iter().filter(|point| is_in(&people, **point, grown_m)).count();
    let (left, gone) = (among(&clean, 0.0), among(&removed, 0.0));
    // Of what is removed, nearly all was a person: the key's boxes end at returns, bodies do not.
    let stray = removed.len() - among(&removed, 0.3);
    println!(
        "{left} points stay among the people, {gone} are gone; {stray} of {} removed elsewhere",
        removed.len()
    );
    assert!(left as f64 <= 0.1 * (left + gone) as f64, "{left} of {}", left + gone);
    assert!(stray as f64 <= 0.1 * clean.len() as f64, "{stray} of {}", clean.len());
}

#[test]
fn who_left_between_surveys_is_removed() {
    let surveys = Twice::left_between();
    let outcome = ours(&surveys).expect("rendered, not read");
    let score = outcome.score;
    assert!(score.people_kept + score.people_removed > 3_000, "{score:?}");
    assert!(score.dynamic_accuracy() >= 0.98, "{score:?}");
    assert!(score.static_accuracy() >= 0.995, "{score:?}");
    let reference = octomap(&surveys).expect("rendered, not read").score;
    assert!(score.harmonic_mean() > reference.harmonic_mean(), "{score:?} {reference:?}");
}

#[test]
fn tour_of_revisits_ends_without_people() {
    let (rounds, clouds) = Revisited::short().run();
    let [survey, .., last] = &rounds[..] else { panic!("{rounds:?}") };
    println!("{rounds:?}");
    assert!(survey.seen > 0 && last.stops > 0 && rounds.len() <= 4, "{rounds:?}");
    // Legs swing while a person stands, so that parts of each square are seen in the survey already; what boxes left of the
    // person there (arms, edges) goes once the tour's rays have passed through the place.
    assert!(last.areas.removed_m2 > 0.2 && last.areas.filled_share() >= 0.95, "{last:?}");
    assert!(last.seen == 0 && last.score.people_kept * 2 < survey.score.people_kept, "{rounds:?}");
    assert!(last.score.dynamic_accuracy() >= 0.98 && last.score.static_accuracy() >= 0.98, "{last:?}");
    assert!(!clouds.filled.is_empty());
}
