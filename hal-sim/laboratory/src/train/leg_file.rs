//! Reads labelled scans: `source,scan,n_legs,x:y;x:y,ranges…`, with a first line that names the geometry.
//!
//! A file whose ranges, geometry and labels do not belong together is refused: its figures would be those of a misunderstanding.

use std::path::Path;

use floorguard_types::capacities::SCAN_BEAMS_MAX;
use floorguard_types::geometry::Point2;
use floorguard_types::sensing::{BeamReturn, Scan};

use super::leg_scans::LabelledScan;
use floorguard_host::outcome::BadInput;
use floorguard_robot::picture_files::read_text;

/// Scanners turn by 0.02° to 6° from beam to beam, radians: anything else is no radians.
const STEP_RAD: std::ops::RangeInclusive<f32> = 3.0e-4..=0.105;
/// A whole turn and a beam, radians.
const FIELD_MAX_RAD: f32 = core::f32::consts::TAU + 0.105;
/// A labelled leg has a return this near, metres: labels are middles of what was measured.
const RETURN_NEAR_M: f32 = 0.3;
/// Share of the labelled legs that must have one.
const RETURNS_MIN: f32 = 0.5;

/// The first line.
struct Geometry {
    first_angle_rad: f32,
    step_rad: f32,
    range_max_m: f32,
    /// Ranges a scan, where it says so.
    beams: Option<usize>,
}

impl Geometry {
    fn parse(header: &str) -> Result<Self, String> {
        let named = |name: &str| {
            let value = header.split_whitespace().find_map(|word| word.strip_prefix(name)?.strip_prefix('='));
            value.and_then(|value| value.trim_end_matches([';', ',']).parse::<f32>().ok())
        };
        let (Some(first_angle_rad), Some(step_rad)) = (named("angle_min"), named("angle_increment")) else {
            return Err("expected the scanner's `angle_min=` and `angle_increment=`, radians; begin the file with a line such as `# angle_min=-2.356 angle_increment=0.00614 n=768 range_max=11`".to_owned());
        };
        if !STEP_RAD.contains(&step_rad.abs()) {
            let (least, most) = (STEP_RAD.start(), STEP_RAD.end());
            return Err(format!(
                "`angle_increment={step_rad}`: a scanner turns by {least} to {most} radians from beam to beam; write radians, not degrees"
            ));
        }
        if first_angle_rad.is_nan() || first_angle_rad.abs() > core::f32::consts::TAU {
            return Err(format!(
                "`angle_min={first_angle_rad}`: at most 6.28 on either side; write radians, not degrees"
            ));
        }
        let range_max_m = named("range_max").unwrap_or(f32::INFINITY);
        if range_max_m.is_nan() || range_max_m <= 0.0 {
            return Err(format!("`range_max={range_max_m}`: write the longest range in metres"));
        }
        let beams = named("n").filter(|count| *count >= 1.0).map(|count| count as usize);
        Ok(Self { first_angle_rad, step_rad, range_max_m, beams })
    }

    /// All scans of a file are of one scanner.
    fn expect(&mut self, ranges: usize) -> Result<(), String> {
        let beams = *self.beams.get_or_insert(ranges);
        if ranges == 0 {
            return Err("no ranges behind the legs; rows are `source,scan,n_legs,legs,ranges…`".to_owned());
        }
        if ranges != beams {
            return Err(format!(
                "{ranges} ranges, and the scanner of this file has {beams} beams (first line or first scan); put the columns back, or, if these are scans of another scanner, write its `n=`, `angle_min=` and `angle_increment=` into the first line"
            ));
        }
        if ranges > SCAN_BEAMS_MAX {
            return Err(format!(
                "{ranges} ranges; at most {SCAN_BEAMS_MAX} are known; keep every second column, and double `angle_increment`"
            ));
        }
        let field_rad = self.step_rad.abs() * ranges as f32;
        if field_rad > FIELD_MAX_RAD {
            return Err(format!(
                "{ranges} ranges at `angle_increment={}` are {field_rad:.1} radians, more than a whole turn; correct the first line",
                self.step_rad
            ));
        }
        Ok(())
    }

    /// Clockwise scans are turned round.
    fn scan(&self, mut beams: Vec<BeamReturn>) -> Scan {
        let mut scan =
            Scan { first_angle_rad: self.first_angle_rad, step_rad: self.step_rad, ..Scan::default() };
        if self.step_rad < 0.0 {
            beams.reverse();
            scan.first_angle_rad += self.step_rad * beams.len().saturating_sub(1) as f32;
            scan.step_rad = -self.step_rad;
        }
        // As many as were expected: they always fit.
        let _ = scan.beams.extend_from_slice(&beams);
        scan
    }
}

/// Reads a file.
///
/// # Errors
/// The file cannot be read, has another form, or its ranges, geometry and labels do not belong together.
pub fn read_leg_scans(path: &Path) -> anyhow::Result<Vec<LabelledScan>> {
    let text = read_text(path)?;
    let mut lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
    let bad = |line: usize, problem: &str| BadInput(format!("{}, line {line}: {problem}", path.display()));
    let (_, header) = lines.next().ok_or_else(|| bad(1, "the file is empty"))?;
    let mut geometry = Geometry::parse(header).map_err(|problem| bad(1, &problem))?;
    let mut scans = Vec::new();
    for (index, line) in lines {
        scans.push(read_scan(line, &mut geometry).map_err(|problem| bad(index + 1, &problem))?);
    }
    check_labels(&scans).map_err(|problem| BadInput(format!("{}: {problem}", path.display())))?;
    Ok(scans)
}

fn read_scan(line: &str, geometry: &mut Geometry) -> Result<LabelledScan, String> {
    let mut cells = line.split(',');
    let source = cells.next().unwrap_or_default().to_owned();
    let _ = cells.next();
    let form = "rows are `source,scan,n_legs,legs,ranges…`, separated by commas, legs as `x:y;x:y` in metres";
    let count = cells.next().and_then(|cell| cell.trim().parse::<usize>().ok());
    let count = count.ok_or_else(|| format!("the third cell is no number of legs; {form}"))?;
    let legs = cells.next().unwrap_or_default();
    let legs = parse_legs(legs).ok_or_else(|| format!("`{legs}` are no legs; {form}"))?;
    if legs.len() != count {
        return Err(format!("{} legs, and the third cell says {count}", legs.len()));
    }
    let beams: Vec<BeamReturn> =
        cells.map(|cell| parse_beam(cell.trim(), geometry.range_max_m)).collect::<Result<_, _>>()?;
    geometry.expect(beams.len())?;
    Ok(LabelledScan { source, scan: geometry.scan(beams), legs })
}

fn parse_legs(text: &str) -> Option<Vec<Point2>> {
    let parts = text.split(';').filter(|part| !part.trim().is_empty());
    let number = |cell: &str| cell.trim().parse::<f32>().ok().filter(|number| number.is_finite());
    parts
        .map(|part| {
            let (x, y) = part.split_once(':')?;
            Some(Point2::new(number(x)?, number(y)?))
        })
        .collect()
}

/// Strictly between its own minimum and the largest range; anything else is unknown, and so is an empty cell.
fn parse_beam(cell: &str, range_max_m: f32) -> Result<BeamReturn, String> {
    let range_m: f32 = match cell {
        "" => 0.0,
        _ => cell.parse().map_err(|_| format!("`{cell}` is no range in metres"))?,
    };
    let is_hit = range_m > 0.02 && range_m < range_max_m.min(60.0);
    Ok(if is_hit { BeamReturn::Hit((range_m * 1_000.0).round() as u16) } else { BeamReturn::Unknown })
}

/// Labels without anything measured beside them are of other scans: no detector could find them.
fn check_labels(scans: &[LabelledScan]) -> Result<(), String> {
    let (mut legs, mut with_returns) = (0_u32, 0_u32);
    let mut nearest_m: Vec<f32> = Vec::new();
    for labelled in scans {
        let hits: Vec<Point2> = hits(&labelled.scan).collect();
        for leg in &labelled.legs {
            let near_m = hits.iter().map(|hit| hit.distance(*leg)).fold(f32::INFINITY, f32::min);
            legs += 1;
            with_returns += u32::from(near_m <= RETURN_NEAR_M);
            nearest_m.push(near_m);
        }
    }
    if legs == 0 || with_returns as f32 >= RETURNS_MIN * legs as f32 {
        return Ok(());
    }
    nearest_m.sort_by(f32::total_cmp);
    let median_m = nearest_m.get(nearest_m.len() / 2).copied().unwrap_or(f32::INFINITY);
    let where_from = if median_m.is_finite() {
        format!("the nearest return is {median_m:.2} m away in the median")
    } else {
        "most of their scans have no return at all".to_owned()
    };
    Err(format!(
        "{with_returns} of {legs} labelled legs have a return within {RETURN_NEAR_M} m, and {where_from}: ranges, legs and the \
         angles of the first line do not belong together; ranges and legs are metres in the scanner's frame, angles radians"
    ))
}

fn hits(scan: &Scan) -> impl Iterator<Item = Point2> + '_ {
    scan.beams.iter().enumerate().filter_map(|(index, beam)| match beam {
        BeamReturn::Hit(range_mm) => {
            let (sin, cos) = (scan.first_angle_rad + index as f32 * scan.step_rad).sin_cos();
            let range_m = f32::from(*range_mm) * 1.0e-3;
            Some(Point2::new(range_m * cos, range_m * sin))
        }
        _ => None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Nine beams over a right angle; a leg straight ahead at 2 m.
    const GOOD: &str =
        "# angle_min=-0.8 angle_increment=0.1 n=9 range_max=11\na,0,1,2.0:0.0,5,5,5,5,5,5,5,5,2.0\n";

    fn read(text: &str) -> Result<Vec<LabelledScan>, String> {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), text).unwrap();
        read_leg_scans(file.path()).map_err(|error| error.to_string())
    }

    #[test]
    fn contradictory_file_is_refused() {
        let scans = read(GOOD).unwrap();
        assert_eq!((scans.len(), scans[0].scan.beams.len()), (1, 9));
        // A clockwise scanner: the same picture from the other end.
        let clockwise = "# angle_min=0.0 angle_increment=-0.1\na,0,1,2.0:0.0,2.0,5,5,5,5,5,5,5,5\n";
        assert_eq!(read(clockwise).unwrap()[0].scan.beams, scans[0].scan.beams);
        assert!(read(&GOOD.replace(" n=9", "")).is_ok());
        for (from, to, reported) in [
            (",5,5,2.0", ",5,2.0", "8 ranges, and the scanner of this file has 9 beams"),
            ("2.0\n", "2.0\nb,1,0,,5,5\n", "line 3: 2 ranges"),
            (",5,5,5,5,5,5,5,5,2.0", "", "no ranges"),
            ("0.1 ", "0.0 ", "radians"),
            ("0.1 ", "0.35 ", "not degrees"),
            ("0.1 ", "nan ", "radians"),
            ("-0.8", "-135", "not degrees"),
            ("-0.8", "inf", "not degrees"),
            ("angle_min=-0.8 ", "", "expected the scanner's"),
            ("range_max=11", "range_max=0", "longest range"),
            ("2.0:0.0", "2.0:4.0", "0 of 1 labelled legs"),
            ("2.0:0.0", "nan:0.0", "are no legs"),
            ("2.0:0.0", "2.0:0.0;1:1", "2 legs, and the third cell says 1"),
            (",5,5,5,5,5,5,5,5,2.0", ",0,0,0,0,0,0,0,0,0", "no return at all"),
            (",2.0\n", ",2000\n", "do not belong together"),
            (",2.0\n", ",two\n", "`two` is no range"),
            ("a,0,1,", "a;0;1;", "separated by commas"),
        ] {
            assert!(GOOD.contains(from), "{from}");
            let refused = read(&GOOD.replacen(from, to, 1)).expect_err(to);
            assert!(refused.contains(reported), "{from} -> {to}: {refused}");
        }
        let turn = format!("# angle_min=-3.1 angle_increment=0.1\na,0,0,{}\n", ",5".repeat(100));
        assert!(read(&turn).unwrap_err().contains("more than a whole turn"));
    }
}
