//! What the sensors do not see, and whether the file accepts it by name.
//!
//! `accept_unseen` in `[guard]` lists gaps as `floorguard check` prints them: "rear-left below 0.68 m", "ahead hanging 0.92 to
//! 1.40 m"; with " at 0.25 m/s" behind it the speed up to which the body may go there all the same. Without a speed it is that of a
//! contact. A region cannot be accepted without heights: it would hide a sensor that looks elsewhere.

use floorguard_guard::{Eye, Gap, GuardConfig, Region, SensorCoverage, Unseen, UnseenLimits};

use super::camera::CameraConfiguration;
use super::reader::Reader;

/// Heights that are written are rounded, metres.
const SAME_HEIGHT_M: f32 = 0.011;
/// Beside the two heights of a gap, that of a body that ends higher than anybody says, metres.
const NO_END_M: f32 = 10.0;

/// An entry of `accept_unseen`.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Accepted {
    region: Region,
    unseen: Unseen,
    speed_mps: Option<f32>,
}

/// A gap, how fast the body may go there, and from which speed on it is one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoverageGap {
    /// What nobody sees.
    pub gap: Gap,
    /// How fast the body may go into it, m/s; none: nobody has accepted it.
    pub speed_mps: Option<f32>,
}

/// What a gap is called.
#[must_use]
pub fn gap_name(gap: &Gap) -> String {
    let region = gap.region.name();
    match gap.unseen {
        Unseen::Below(height_m) => format!("{region} below {height_m:.2} m"),
        Unseen::Moving(height_m) => format!("{region} moving below {height_m:.2} m"),
        Unseen::Hanging([from_m, to_m]) => format!("{region} hanging {from_m:.2} to {to_m:.2} m"),
    }
}

fn parsed(text: &str) -> Option<Accepted> {
    let (what, speed_mps) = match text.split_once(" at ") {
        Some((what, speed)) => (what, Some(speed.strip_suffix(" m/s")?.trim().parse::<f32>().ok()?)),
        None => (text, None),
    };
    if speed_mps.is_some_and(|mps| !(0.01..=2.0).contains(&mps)) {
        return None;
    }
    let (name, rest) = what.trim().split_once(' ').unwrap_or((what.trim(), ""));
    let region = Region::ALL.into_iter().find(|region| region.name() == name)?;
    let words: Vec<&str> = rest.split_whitespace().collect();
    let number = |word: &str| word.parse::<f32>().ok().filter(|metres| (0.0..=3.0).contains(metres));
    let unseen = match words[..] {
        ["below", height, "m"] => Unseen::Below(number(height)?),
        ["moving", "below", height, "m"] => Unseen::Moving(number(height)?),
        ["hanging", from, "to", to, "m"] => Unseen::Hanging([number(from)?, number(to)?]),
        _ => return None,
    };
    Some(Accepted { region, unseen, speed_mps })
}

impl Accepted {
    fn covers(&self, gap: &Gap) -> bool {
        self.region == gap.region
            && match (self.unseen, gap.unseen) {
                (Unseen::Below(accepted_m), Unseen::Below(height_m))
                | (Unseen::Moving(accepted_m), Unseen::Moving(height_m)) => {
                    accepted_m + SAME_HEIGHT_M >= height_m
                }
                (Unseen::Hanging([from_m, to_m]), Unseen::Hanging([lowest_m, highest_m])) => {
                    from_m <= lowest_m + SAME_HEIGHT_M && to_m + SAME_HEIGHT_M >= highest_m
                }
                _ => false,
            }
    }
}

/// Every gap of a robot at the speeds that it may drive.
#[must_use]
pub fn gaps_of(config: &GuardConfig, camera: Option<&CameraConfiguration>, reverse_mps: f32) -> Vec<Gap> {
    let eyes: Vec<Eye> = camera.map(eye_of).into_iter().collect();
    let coverage = SensorCoverage::of(config, &eyes);
    let speed_of = |region| if region == Region::Rear { reverse_mps } else { config.drive.speed_mps };
    let goes = |region: &Region| *region != Region::Rear || reverse_mps > 0.0;
    let regions = Region::ALL.into_iter().filter(goes);
    regions.flat_map(|region| coverage.gaps(region, speed_of(region))).flatten().collect()
}

/// The floor camera as the coverage knows it.
fn eye_of(camera: &CameraConfiguration) -> Eye {
    let ([fx, fy], [cx, cy]) = (camera.camera.focal_px(), camera.camera.centre_px());
    let (width, height) = camera.size;
    // The narrower side counts for both.
    let half =
        |centre: f32, pixels: usize, focal: f32| centre.min(pixels as f32 - 1.0 - centre).max(0.0) / focal;
    Eye::Camera { mounting: camera.mounting.transform(), half: [half(cx, width, fx), half(cy, height, fy)] }
}

/// Compares the gaps of a robot with those that the file accepts; gives the speeds of all regions.
pub(super) fn check_coverage(
    section: Option<&Reader<'_>>,
    top: &Reader<'_>,
    (config, camera, reverse_mps): (&GuardConfig, Option<&CameraConfiguration>, f32),
) -> (UnseenLimits, Vec<CoverageGap>) {
    let bumper_mps = section.map_or(UnseenLimits::NONE.bumper_mps, |section| {
        section.number_or("contact_speed_mps", 0.02..=0.3, UnseenLimits::NONE.bumper_mps)
    });
    let mut limits = UnseenLimits { bumper_mps, ..UnseenLimits::NONE };
    let texts = section.and_then(|section| section.texts("accept_unseen", "\"rear-left below 0.15 m\""));
    let (texts, span) = texts.unwrap_or_else(|| (Vec::new(), top.span().clone()));
    let mut accepted = Vec::new();
    for text in texts {
        match parsed(text) {
            Some(entry) => accepted.push(entry),
            None => top.refuse(
                &span,
                format!("[guard]: `accept_unseen`: \"{text}\" names no gap"),
                "write it as `floorguard check` does: \"rear-left below 0.15 m\", \"ahead hanging 0.92 to 1.40 m\", and \" at 0.2 m/s\" behind it for another speed than that of a contact",
            ),
        }
    }
    let mut rows = Vec::new();
    for gap in gaps_of(config, camera, reverse_mps) {
        let entry = accepted.iter().find(|entry| entry.covers(&gap));
        let speed_mps = entry.map(|entry| entry.speed_mps.unwrap_or(bumper_mps));
        match speed_mps {
            Some(mps) => {
                let index = Region::ALL.iter().position(|region| *region == gap.region);
                if let Some(toward_mps) = index.and_then(|index| limits.toward_mps.get_mut(index)) {
                    *toward_mps = toward_mps.min(mps);
                }
            }
            None => top.refuse(
                &span,
                format!("no sensor sees \"{}\"", gap_name(&gap)),
                "add or turn a sensor; or put that into `accept_unseen` of [guard]: then the body goes there at the speed of a \
                 contact",
            ),
        }
        rows.push(CoverageGap { gap, speed_mps });
    }
    (limits, rows)
}

/// The least height from which on everything upright is seen in a region; none: from the floor on.
#[must_use]
pub fn seen_from_m(gaps: &[CoverageGap], region: Region) -> f32 {
    let of_region = gaps.iter().filter(|row| row.gap.region == region);
    let heights = of_region.map(|row| match row.gap.unseen {
        Unseen::Below(height_m) => height_m.min(NO_END_M),
        Unseen::Moving(_) | Unseen::Hanging(_) => 0.0,
    });
    heights.fold(0.0, f32::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_are_accepted_by_the_names_that_are_printed() {
        for region in Region::ALL {
            for unseen in [Unseen::Below(0.15), Unseen::Moving(0.15), Unseen::Hanging([0.92, 1.4])] {
                let gap = Gap { region, unseen };
                let entry = parsed(&gap_name(&gap)).unwrap();
                assert!(entry.covers(&gap) && entry.speed_mps.is_none(), "{}", gap_name(&gap));
                let faster = parsed(&format!("{} at 0.25 m/s", gap_name(&gap))).unwrap();
                assert!(faster.covers(&gap) && faster.speed_mps == Some(0.25));
                assert_eq!(parsed(region.name()), None, "a region as a whole would hide too much");
            }
        }
        let gap = |unseen| Gap { region: Region::Rear, unseen };
        let accepts = |text: &str, unseen| parsed(text).unwrap().covers(&gap(unseen));
        assert!(!accepts("rear below 0.12 m", Unseen::Below(0.15)), "lower");
        assert!(!accepts("rear-left below 0.5 m", Unseen::Below(0.15)), "elsewhere");
        assert!(!accepts("rear hanging 0.95 to 1.40 m", Unseen::Hanging([0.92, 1.4])), "less of it");
        assert!(!accepts("rear below 1.4 m", Unseen::Hanging([0.92, 1.4])), "another kind");
        for bad in ["", "behind", "rear below", "rear below 15 cm", "rear at", "rear at 9 m/s", "rear at 0.1"]
        {
            assert_eq!(parsed(bad), None, "{bad}");
        }
    }

    /// What the refused file is told.
    fn refused(changes: &[(&str, &str)]) -> String {
        let mut text = crate::EXAMPLE.to_owned();
        for (from, to) in changes {
            assert!(text.contains(from), "{from}");
            text = text.replacen(from, to, 1);
        }
        crate::parse("robot.toml", &text).map_or_else(|refused| refused.to_string(), |_| String::new())
    }

    #[test]
    fn fg_req_062_a_sector_of_ten_degrees_and_a_scanner_that_looks_backwards_are_refused() {
        assert_eq!(refused(&[]), "");
        let scanner = "z_m = 0.15, roll_deg = 0.0, pitch_deg = 0.0, yaw_deg = 0.0 }";
        let narrow = format!("{scanner}\nsector_first_deg = -10.0\nsector_last_deg = 10.0");
        let turned = scanner.replace("yaw_deg = 0.0", "yaw_deg = 180.0");
        let high = ("x_m = 0.50, y_m = 0.0, z_m = 0.80", "x_m = 0.50, y_m = 0.0, z_m = 1.60");
        for (change, gap) in [
            ((scanner, narrow.as_str()), "\"ahead-left"),
            ((scanner, turned.as_str()), "\"ahead"),
            (high, "\"ahead"),
        ] {
            let told = refused(&[change]);
            assert!(told.contains("no sensor sees") && told.contains(gap), "{change:?}: {told}");
        }
    }

    #[test]
    fn fg_req_062_every_hole_of_the_example_must_be_accepted_by_its_name() {
        let rows = crate::parse("robot.toml", crate::EXAMPLE).unwrap().coverage;
        assert!(rows.len() > 8 && rows.iter().all(|row| row.speed_mps.is_some()), "{rows:?}");
        for entry in [
            "  \"ahead below 0.10 m at 1.0 m/s\",\n",
            "  \"rear below 0.31 m\",\n",
            "  \"rear-left hanging 0.11 to 1.40 m at 0.4 m/s\",\n",
        ] {
            let told = refused(&[(entry, "")]);
            let region = entry.trim_matches([' ', '"', ',', '\n']).split(' ').next().unwrap();
            assert!(told.contains(&format!("no sensor sees \"{region}")), "{entry}: {told}");
        }
        assert!(refused(&[("\"rear below 0.31 m\",", "\"behind\",")]).contains("names no gap"));
        // Less of it is not enough.
        assert!(
            refused(&[("ahead below 0.10 m", "ahead below 0.05 m")]).contains("no sensor sees \"ahead below")
        );
    }

    #[test]
    fn fg_req_029_accepted_holes_limit_the_speed_into_them() {
        let robot = crate::parse("robot.toml", crate::EXAMPLE).unwrap().robot;
        assert_eq!(robot.unseen.toward_mps, [1.0, 0.1, 0.8, 0.8, 0.4, 0.4]);
        assert_eq!(robot.guard().unseen, robot.unseen);
    }
}
