//! What `floorguard decode` prints and how it ends.

use clap::Parser as _;
use floorguard_app::commands::{Arguments, Command, exit_code};
use floorguard_app::recordings::{DecodeArguments, decode_to};
use floorguard_tests::data::recording;

fn arguments(words: &[&str]) -> Result<DecodeArguments, clap::Error> {
    let parsed = Arguments::try_parse_from(["floorguard", "decode"].iter().chain(words))?;
    match parsed.command {
        Some(Command::Decode(arguments)) => Ok(arguments),
        other => panic!("{other:?}"),
    }
}

/// Standard output and exit code.
fn decode(words: &[&str]) -> (String, u8, String) {
    let arguments = arguments(words).expect("a valid command line");
    let mut out = Vec::new();
    let outcome = decode_to(&arguments, &mut out);
    let (code, message) =
        outcome.map_or_else(|error| (exit_code(&error), error.to_string()), |()| (0, String::new()));
    (String::from_utf8(out).expect("text"), code, message)
}

#[test]
fn every_return_is_a_row() {
    let Some(path) = recording("vlp16_packets/mrpt_gps_600rpm.pcap") else { return };
    let (text, code, _) = decode(&[&path.display().to_string(), "--csv"]);
    assert_eq!(code, 0);
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("time_us,laser,azimuth_cdeg,distance_raw,reflectivity,x_m,y_m,z_m"));
    let rows: Vec<Vec<f64>> =
        lines.map(|line| line.split(',').map(|field| field.parse().expect("a number")).collect()).collect();
    // Of packets.csv, whose integers the packet tests compare one by one.
    assert_eq!(rows.len(), 73_486);
    let [time_us, laser, azimuth_cdeg, raw, _, x_m, y_m, z_m] = rows[0][..] else { panic!("eight columns") };
    // Stamp of the first packet in its key, then 2.304 us from laser to laser.
    assert!(
        (time_us - 1_082_340_595.0 - 2.304 * laser).abs() < 1e-3
            && (11_888.0..11_920.0).contains(&azimuth_cdeg)
    );
    for row in &rows {
        let [_, laser, azimuth_cdeg, raw, reflectivity, x_m, y_m, z_m] = row[..] else { panic!("{row:?}") };
        assert!(laser < 16.0 && azimuth_cdeg < 36_000.0 && raw > 0.0 && reflectivity < 256.0, "{row:?}");
        let elevation_deg = if laser % 2.0 == 0.0 { laser - 15.0 } else { laser };
        let elevation = f64::to_radians(elevation_deg);
        let horizontal_m = raw * 0.002 * elevation.cos();
        assert!((x_m.hypot(y_m) - horizontal_m).abs() < 1e-5, "{row:?}");
        assert!((z_m - raw * 0.002 * elevation.sin() + 0.04191 * elevation.tan()).abs() < 1e-5, "{row:?}");
        // Clockwise from x.
        let off = (-y_m).atan2(x_m).to_degrees().rem_euclid(360.0) - azimuth_cdeg / 100.0;
        assert!(off.abs().min(360.0 - off.abs()) < 0.001, "{row:?}");
    }
    assert!(raw > 0.0 && x_m.hypot(y_m).hypot(z_m) < 3.0);
}

#[test]
fn without_csv_standard_output_stays_empty() {
    let Some(path) = recording("vlp16_packets/gadomski_single_packet.pcap") else { return };
    let path = path.display().to_string();
    assert_eq!(decode(&[&path, "--model", "vlp16"]).0, "");
}

#[test]
fn bad_input_exits_3_wrong_usage_2() {
    let (_, code, message) = decode(&["no/such/file.pcap"]);
    assert!(code == 3 && message.contains("no/such/file.pcap"), "{message}");
    assert_eq!(arguments(&["x.pcap", "--model", "vlp-99"]).expect_err("unknown").exit_code(), 2);
    assert_eq!(arguments(&[]).expect_err("no file").exit_code(), 2);
    let Some(path) = recording("vlp16_packets/NEG_hdl32e_monterey_200pkts.pcap") else { return };
    let path = path.display().to_string();
    let (text, code, message) = decode(&[&path, "--csv", "--model", "vlp16"]);
    assert_eq!((text.as_str(), code), ("", 3));
    for word in ["no VLP-16", "0x21", "553", "1327", "auto"] {
        assert!(message.contains(word), "{word} is not in: {message}");
    }
    assert_eq!(decode(&[&path, "--csv"]).1, 0);
    let Some(path) = recording("vlp16_packets/README.md") else { return };
    let (_, code, message) = decode(&[&path.display().to_string()]);
    assert!(code == 3 && message.contains("is no .pcap"), "{message}");
}

#[test]
fn what_stands_before_a_cut_is_printed() {
    let Some(path) = recording("vlp16_packets/mrpt_gps_600rpm.pcap") else { return };
    let bytes = std::fs::read(path).expect("readable");
    let folder = tempfile::tempdir().expect("a folder");
    let cut = folder.path().join("cut.pcap");
    std::fs::write(&cut, &bytes[..bytes.len() / 2]).expect("writable");
    let (text, code, message) = decode(&[&cut.display().to_string(), "--csv"]);
    assert!(code == 3 && message.contains("is cut off after"), "{message}");
    assert!(text.lines().count() > 30_000);
}
