//! `[scanner]` and `[rear_scanner]`: model, address, mounting, and the sector that the body does not cover.

use core::ops::RangeInclusive;

use floorguard_runtime::configuration::{Mounting, RangingModel, ScannerConfiguration, ScannerModel};
use floorguard_types::units::radians;

use super::actuated_lidar::read_scip_source;
use super::address::{ScannerAddress, SerialAddress};
use super::bridged_scanner::{NO_SHAPE, read_bridged};
use super::devices::{read_datagrams, read_mounting, read_serial};
use super::reader::Reader;

/// Beams of the finest output of the microScan3 family (book, microScan3: Blocks); the guard limits the
/// capacity.
const MICROSCAN3_BEAMS: u16 = 2_751;
/// Bit rates of an S300 with which its scans come before the guard takes it for late (book, SICK S300: Line).
const S300_BAUDS: [u32; 4] = [115_200, 125_000, 250_000, 500_000];
/// Speeds at which a scanner that is no safety device can be accepted, m/s: a touch at the greatest one is what a bumper makes harmless.
const ACCEPTED_MPS: RangeInclusive<f32> = 0.05..=0.5;

/// The scanner that the guard looks through, where it is, and how fast the robot may be where it is no safety device.
pub(super) struct ReadScanner {
    pub(super) scanner: ScannerConfiguration,
    pub(super) address: ScannerAddress,
    pub(super) accepted_mps: Option<f32>,
}

pub(super) fn read_scanner(section: Reader<'_>) -> Option<ReadScanner> {
    let (model, source) = read_scanner_device(&section);
    let accepted_mps = read_accepted(&section, model);
    let (mounting, sector_rad) = read_scanner_place(&section);
    section.finish();
    let scanner = ScannerConfiguration { model: model?, mounting, sector_rad };
    Some(ReadScanner { scanner, address: source?, accepted_mps })
}

/// `accept_uncertified_mps` (FG-REQ-085): without it no robot drives behind a scanner that is no safety device.
fn read_accepted(section: &Reader<'_>, model: Option<ScannerModel>) -> Option<f32> {
    let accepted_mps =
        section.number_or_absent("accept_uncertified_mps", ACCEPTED_MPS, "with a ranging scanner, refused");
    match (model, accepted_mps) {
        (Some(ScannerModel::Ranging(ranging)), None) if section.good_so_far() => section.refuse_to_drive(
            section.span(),
            format!(
                "[scanner]: a {} is no safety device: no output of it is certified, nothing watches its window, and no return is \
                 warranted, not even that of a leg in black",
                ranging.name()
            ),
            "mount a safety scanner, or write accept_uncertified_mps = 0.3: no faster than that is the robot then, and who is met at \
             that speed must not be hurt",
        ),
        (Some(ScannerModel::S300 | ScannerModel::MicroScan3 { .. }), Some(_)) => section.refuse(
            section.span(),
            "[scanner]: `accept_uncertified_mps` is given, and this is a safety scanner",
            "leave `accept_uncertified_mps` out",
        ),
        _ => {}
    }
    accepted_mps
}

/// The second scanner: an S300 on a line of its own.
pub(super) fn read_rear_scanner(section: Reader<'_>) -> Option<(ScannerConfiguration, SerialAddress)> {
    let model = section.choice("model", &[("s300", ScannerModel::S300)]);
    let line = read_s300_line(&section, model);
    let (mounting, sector_rad) = read_scanner_place(&section);
    section.finish();
    Some((ScannerConfiguration { model: model?, mounting, sector_rad }, line?))
}

/// Mounting, and the sector that the body does not cover.
fn read_scanner_place(section: &Reader<'_>) -> (Mounting, [f32; 2]) {
    let mounting = read_mounting(section.section("mounting"));
    if mounting.position.z_m > 0.2 {
        let what = format!(
            "{}: the scan plane is {} m high, allowed is up to 0.2 m",
            section.title(),
            mounting.position.z_m
        );
        let remedy = "mount the scanner lower: feet and children must cross the plane";
        section.refuse_to_drive(section.span(), what, remedy);
    }
    let sector_rad = [
        radians(section.number_or("sector_first_deg", -135.0..=0.0, -135.0)),
        radians(section.number_or("sector_last_deg", 0.0..=135.0, 135.0)),
    ];
    (mounting, sector_rad)
}

/// The model, and what it is connected to: an S300 has a line, a microScan3 sends datagrams and says how many beams.
fn read_scanner_device(section: &Reader<'_>) -> (Option<ScannerModel>, Option<ScannerAddress>) {
    let finest = ScannerModel::MicroScan3 { beams: MICROSCAN3_BEAMS };
    let models = [
        ("s300", ScannerModel::S300),
        ("microscan3", finest),
        ("hokuyo-ust", ScannerModel::Ranging(RangingModel::HokuyoUst)),
        ("hokuyo-urg-04lx", ScannerModel::Ranging(RangingModel::HokuyoUrg04lx)),
        ("sick-tim5xx", ScannerModel::Ranging(RangingModel::SickTim5xx)),
        ("sick-lms1xx", ScannerModel::Ranging(RangingModel::SickLms1xx)),
        ("rplidar-a", ScannerModel::Ranging(RangingModel::RplidarA)),
        ("rplidar-s", ScannerModel::Ranging(RangingModel::RplidarS)),
        ("bridged", ScannerModel::Ranging(RangingModel::Bridged(NO_SHAPE))),
    ];
    let model = section.choice("model", &models);
    if let Some(ScannerModel::Ranging(RangingModel::Bridged(_))) = model {
        let shape = read_bridged(section);
        let source = read_datagrams(section, "udp:127.0.0.1:2370");
        let model = shape.map(|shape| ScannerModel::Ranging(RangingModel::Bridged(shape)));
        return (model, source.map(ScannerAddress::Datagrams));
    }
    let beams =
        section.integer_or("beams", 276..=i64::from(MICROSCAN3_BEAMS), i64::from(MICROSCAN3_BEAMS)) as u16;
    if let Some(ScannerModel::MicroScan3 { .. }) = model {
        let model = ScannerModel::MicroScan3 { beams };
        let source = read_datagrams(section, "udp:0.0.0.0:6060");
        return (Some(model), source.map(ScannerAddress::Datagrams));
    }
    if let Some(ScannerModel::Ranging(ranging)) = model {
        let source = read_scip_source(section);
        return (model, source.map(|source| ScannerAddress::Wire(source, ranging)));
    }
    if let Some(sender) = section.find("sender") {
        section.refuse(
            &sender.span(),
            "[scanner]: `sender` is given, and an S300 is connected by a line of its own",
            "leave `sender` out, or write model = \"microscan3\"",
        );
    }
    if section.find("beams").is_some() {
        section.refuse(
            section.span(),
            "[scanner]: `beams` is given, and an S300 always sends 541",
            "leave `beams` out, or write model = \"microscan3\"",
        );
    }
    let line = read_s300_line(section, model);
    (model, line.map(ScannerAddress::Serial))
}

fn read_s300_line(section: &Reader<'_>, model: Option<ScannerModel>) -> Option<SerialAddress> {
    let line = read_serial(section);
    if let (Some(line), true) = (&line, model.is_some() && section.good_so_far())
        && !S300_BAUDS.contains(&line.baud)
    {
        section.refuse_to_drive(
            &section.find("baud").map_or(section.span().clone(), |value| value.span()),
            format!(
                "{}: `baud` is {}, an S300 has no such rate, or its scans come too late with it",
                section.title(),
                line.baud
            ),
            "write 500000, 250000, 125000 or 115200, as it is set in the scanner",
        );
    }
    line
}

#[cfg(test)]
mod tests {
    use crate::{EXAMPLE, ScannerAddress, parse};
    use floorguard_guard::Source;

    const LINE: &str = "model = \"s300\"\nsource = \"serial:/dev/ttyUSB0\"\nbaud = 500000\n";

    fn with_scanner(keys: &str) -> String {
        assert!(EXAMPLE.contains(LINE));
        EXAMPLE.replace(LINE, keys)
    }

    /// No robot drives behind a scanner that is no safety device, but where its file says how fast.
    #[test]
    fn fg_req_085_ranging_scanners_need_a_stated_speed() {
        let keys = "model = \"hokuyo-ust\"\nsource = \"tcp:192.168.0.10:10940\"\n";
        let refused = parse("robot.toml", &with_scanner(keys)).expect_err("refused").to_string();
        assert!(
            refused.contains("no safety device") && refused.contains("accept_uncertified_mps = 0.3"),
            "{refused}"
        );
        let accepted = with_scanner(&format!("{keys}accept_uncertified_mps = 0.3\n"));
        let read = parse("robot.toml", &accepted).unwrap_or_else(|refused| panic!("{refused}"));
        assert!(matches!(read.carriers.scanner, ScannerAddress::Wire(_, _)));
        let unseen = read.robot.unseen;
        for speed in [unseen.forward_mps, unseen.turning_mps, unseen.spinning_mps, unseen.reverse_mps] {
            assert!(speed <= 0.3, "{speed}");
        }
        let guard = read.robot.guard();
        guard.validate().unwrap();
        assert_eq!((guard.scanner.beams, guard.scanner.step_rad), (1_081, 0.25_f32.to_radians()));
        assert!(
            read.warnings().iter().any(|warning| warning.contains("no safety device")),
            "{:?}",
            read.warnings()
        );
        let own = LINE.to_owned() + "accept_uncertified_mps = 0.3\n";
        let refused = parse("robot.toml", &with_scanner(&own)).expect_err("refused").to_string();
        assert!(refused.contains("this is a safety scanner"), "{refused}");
        let unknown = accepted.replace("hokuyo-ust", "hokuyo-utm");
        let refused = parse("robot.toml", &unknown).expect_err("refused").to_string();
        assert!(refused.contains("did you mean `hokuyo-ust`"), "{refused}");
    }

    /// Scans that come more slowly than a safety scanner's let the robot react later: its fields are as much longer.
    #[test]
    fn fg_req_085_slow_scanners_make_longer_fields() {
        let reach_m = |keys: &str| {
            let read = parse("robot.toml", &with_scanner(keys)).unwrap_or_else(|refused| panic!("{refused}"));
            let fields = read.robot.fields.iter().flat_map(|field| field.protective.iter());
            (fields.map(|point| point.x_m).fold(0.0, f32::max), read.robot.limits.response_s)
        };
        let (safe_m, safe_s) = reach_m(LINE);
        let urg = "model = \"hokuyo-urg-04lx\"\nsource = \"serial:/dev/ttyACM0\"\nbaud = 115200\naccept_uncertified_mps = 0.3\n";
        let (slow_m, slow_s) = reach_m(urg);
        assert!(
            (slow_s - safe_s - 0.24).abs() < 1.0e-6 && slow_m > safe_m + 0.05,
            "{safe_m} m, {slow_m} m, {slow_s} s"
        );
        // Its newest scan is late later, by less than the fields allow for.
        let ages = |keys: &str| {
            let read = parse("robot.toml", &with_scanner(keys)).unwrap_or_else(|refused| panic!("{refused}"));
            let rules = read.robot.guard().rules(Source::Scanner);
            (rules.limit_after_us, rules.stop_after_us)
        };
        assert_eq!((ages(LINE), ages(urg)), ((100_000, Some(200_000)), (220_000, Some(320_000))));
    }
}
