//! What the floor camera saw of the dirt: the floor as it was first perceived, as it is now, and the spots.

use std::fmt::Write;

use super::cleaning::{Legend, raster};
use floorguard_robot::camera::SeenDirt;

/// Heat of a cell.
const HEAT: [Legend; 4] =
    [("#ffffff", "seen clean"), ("#f6c26b", "dirty"), ("#d9742b", "dirtier"), ("#8f1d0e", "dirtiest")];
/// Spots in the table.
const SHOWN: usize = 12;

/// Both layers and a table, as part of a page.
#[must_use]
pub fn section(seen: &SeenDirt) -> String {
    let shade = |percent: &i8| match percent {
        ..0 => None,
        0 => Some(0),
        1..60 => Some(1),
        60..80 => Some(2),
        _ => Some(3),
    };
    let width = usize::from(seen.geometry.width());
    let picture = |layer: &[i8]| raster(width, &layer.iter().map(shade).collect::<Vec<_>>(), &HEAT);
    let ([first, live], [before_m2, now_m2]) = (&seen.layers, seen.dirty_m2);
    let mut html = format!(
        "<h2>Dirt that the floor camera saw</h2><p>{:.1} m² of floor seen in {} pictures, {} more could not be judged; what \
         was not seen is unknown, not clean. Odometry frame.</p><h3>As first perceived: {before_m2:.2} m² dirty, {} \
         spots</h3>{}<h3>As seen last: {now_m2:.2} m² dirty</h3>{}",
        seen.seen_m2,
        seen.frames.0,
        seen.frames.1,
        seen.spots.spots.len(),
        picture(first),
        picture(live),
    );
    if !seen.spots.spots.is_empty() {
        html.push_str("<table><tr><th>spot at, m<th class=num>area, cm²<th class=num>seen for, s<th class=num>views</tr>");
        for spot in seen.spots.spots.iter().take(SHOWN) {
            let (centre, area_cm2) = (spot.centre_in_map, 1.0e4 * spot.area_m2);
            let _ = write!(
                html,
                "<tr><td>{:.2}, {:.2}<td class=num>{area_cm2:.0}<td class=num>{:.0}<td class=num>{}</tr>",
                centre.x_m, centre.y_m, spot.age_s, spot.observations
            );
        }
        html.push_str("</table>");
    }
    html
}
