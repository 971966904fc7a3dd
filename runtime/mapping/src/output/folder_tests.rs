use super::*;

fn files(version: &str) -> Vec<OutputFile> {
    let file = |name: &str| OutputFile::new(name, format!("{name} {version}"));
    vec![file(MARKER), file("map.pgm"), file("submaps/0000.pgm")]
}

/// What lies in the folder, if it is one whole version.
fn version(folder: &Path) -> Option<String> {
    let read = |name: &str| fs::read_to_string(folder.join(name)).ok();
    let version = read(MARKER)?.strip_prefix("map.yaml ")?.to_owned();
    let is_whole =
        files(&version).iter().all(|file| read(&file.name).is_some_and(|text| text.as_bytes() == file.bytes));
    is_whole.then_some(version)
}

#[test]
fn former_map_stays_until_the_new_is_whole() {
    let home = tempfile::tempdir().unwrap();
    let place = home.path().join("hall");
    replace_folder(&place, files("1")).unwrap();
    assert_eq!(version(&place).as_deref(), Some("1"));
    // Power fails after every byte of the preparation: the former map is whole, and the next run does not mind.
    let all: usize = files("2").iter().map(|file| file.bytes.len()).sum();
    for cut in 0..=all {
        let beside = home.path().join(".hall.new");
        let (mut left, mut part) = (cut, Vec::new());
        for file in files("2") {
            let bytes = file.bytes[..file.bytes.len().min(left)].to_vec();
            left -= bytes.len();
            part.push(OutputFile { bytes, ..file });
        }
        write_all(&beside, &part).unwrap();
        assert_eq!(version(&place).as_deref(), Some("1"), "cut after {cut} bytes");
        fs::remove_dir_all(&beside).unwrap();
    }
    write_all(&home.path().join(".hall.new"), files("damaged")).unwrap();
    replace_folder(&place, files("2")).unwrap();
    assert_eq!(version(&place).as_deref(), Some("2"));
    assert_eq!(fs::read_dir(home.path()).unwrap().count(), 1, "nothing is left beside it");
}

/// A program that reads while another writes sees one version, never a mixture or nothing.
#[test]
fn readers_never_see_a_mixture() {
    let home = tempfile::tempdir().unwrap();
    let place = home.path().join("hall");
    replace_folder(&place, files("0")).unwrap();
    let reader = place.clone();
    let done = std::sync::Arc::new(std::sync::atomic::AtomicBool::new(false));
    let ended = done.clone();
    let watched = std::thread::spawn(move || {
        let mut absent = 0;
        while !ended.load(std::sync::atomic::Ordering::Relaxed) {
            absent += u32::from(!reader.join(MARKER).is_file());
        }
        absent
    });
    for round in 1..30 {
        replace_folder(&place, files(&round.to_string())).unwrap();
    }
    done.store(true, std::sync::atomic::Ordering::Relaxed);
    assert_eq!(watched.join().unwrap(), 0);
}

#[test]
fn folder_with_other_files_is_refused() {
    let home = tempfile::tempdir().unwrap();
    let place = home.path().join("documents");
    fs::create_dir(&place).unwrap();
    assert!(check_place(&place).is_ok(), "empty");
    fs::write(place.join("letter.txt"), "words").unwrap();
    assert!(matches!(replace_folder(&place, files("1")), Err(ReplaceError::Foreign(_))));
    assert_eq!(fs::read_to_string(place.join("letter.txt")).unwrap(), "words");
    let file = place.join("letter.txt");
    assert!(matches!(replace_folder(&file, files("1")), Err(ReplaceError::NoPlace(_))));
}
