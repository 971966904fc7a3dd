//! The explanation as one page that needs nothing else.

use std::fmt::Write as _;

use super::gather::Snapshot;
use super::picture::picture;
use super::summary::{CauseLine, Incident};
use crate::report::style::{self, escaped, tiles};

/// The page.
#[must_use]
pub fn page(incident: &Incident, snapshots: &[Snapshot]) -> String {
    let title = match &incident.decided_by {
        Some(_) if incident.action.contains("stop") || incident.action.contains("torque") => {
            "Why the robot stopped"
        }
        Some(_) => "Why the robot was slow",
        None => "What the robot did",
    };
    let mut html = style::head(title);
    let _ = write!(
        html,
        "<p class=legend>{}, {:.3} s of the robot's clock, floorguard {}</p>",
        escaped(&incident.file),
        incident.at_s,
        env!("CARGO_PKG_VERSION")
    );
    decided(&mut html, incident);
    html.push_str("<h2>The moment from above</h2>");
    let _ = write!(
        html,
        "<div class=map>{}</div><p class=legend>The robot in blue, its front is up; dashed: its path of the ten seconds before. \
         Red area: protective field. Yellow area: warning field. Dots: what the safety scanner saw. Circles with numbers: people, \
         with the way that they came. The red ring: what held the robot.</p>",
        picture(snapshots, incident.holder.as_ref())
    );
    if let Some(otherwise) = &incident.otherwise {
        let _ = write!(
            html,
            "<h2>What would have happened otherwise</h2><p>{}</p>",
            escaped(&otherwise.sentence)
        );
    }
    sources(&mut html, incident);
    causes(&mut html, incident);
    before(&mut html, incident);
    let _ = write!(html, "<h2>How this page was made</h2><p>{}</p>", escaped(&incident.repetition));
    html + "</main></html>\n"
}

fn decided(html: &mut String, incident: &Incident) {
    html.push_str(&tiles([
        (incident.state.clone(), "state shown", ""),
        (incident.action.clone(), "what the guard did", ""),
        (format!("{:.2} m/s", incident.speed_mps), "speed at the moment", ""),
        (
            incident
                .holder
                .as_ref()
                .map_or_else(|| "–".to_owned(), |holder| format!("{:.2} m", holder.distance_m)),
            "to what held it",
            "",
        ),
    ]));
    let Some(cause) = &incident.decided_by else {
        html.push_str("<p>Nothing held or limited the robot at this moment.</p>");
        return;
    };
    let _ = write!(html, "<p class=cut><b>{}</b>", escaped(&cause.text));
    if let Some(holder) = &incident.holder {
        let _ = write!(html, "<br>It was {}.", escaped(&holder.words()));
    }
    let _ = write!(
        html,
        "<br>{}</p><p>The rule, {}: {}</p>",
        escaped(cause.remedy),
        cause.requirement,
        escaped(cause.rule)
    );
    if let Some(first) = &incident.first {
        let _ = write!(
            html,
            "<p>The stop began at {:.3} s with another cause: {} ({}).</p>",
            first.since_s,
            escaped(&first.text),
            first.requirement
        );
    }
}

fn sources(html: &mut String, incident: &Incident) {
    html.push_str(
        "<h2>What each sensor saw</h2><div class=wide tabindex=0 role=region aria-label=\"What each sensor saw\"><table><tr><th>source<th>health<th class=num>age<th class=why>saw</tr>",
    );
    for source in &incident.sources {
        let age = source.age_ms.map_or_else(|| "never".to_owned(), |age| format!("{age} ms"));
        let _ = write!(
            html,
            "<tr><td>{}<td>{}<td class=num>{age}<td class=why>{}</tr>",
            escaped(source.name),
            escaped(&source.health),
            escaped(&source.saw)
        );
    }
    html.push_str("</table></div>");
}

fn causes(html: &mut String, incident: &Incident) {
    if incident.others.is_empty() {
        return;
    }
    html.push_str(
        "<h2>What else held at the same time</h2><div class=wide tabindex=0 role=region aria-label=\"What else held at the same time\"><table><tr><th class=num>since<th class=why>cause<th>rule<th class=why>remedy</tr>",
    );
    for CauseLine { text, requirement, remedy, since_s, .. } in &incident.others {
        let _ = write!(
            html,
            "<tr><td class=num>{since_s:.3} s<td class=why>{}<td>{requirement}<td class=why>{}</tr>",
            escaped(text),
            escaped(remedy)
        );
    }
    html.push_str("</table></div>");
}

fn before(html: &mut String, incident: &Incident) {
    html.push_str(
        "<h2>The ten seconds before</h2><div class=wide tabindex=0 role=region aria-label=\"The ten seconds before\"><table><tr><th class=num>time<th>state<th class=num>m/s<th \
         class=num>permitted<th class=num>at most<th class=num>nearest person<th class=why>held or limited by</tr>",
    );
    for row in &incident.before {
        let person = row.person_m.map_or_else(|| "–".to_owned(), |metres| format!("{metres:.1} m"));
        let limit =
            if row.limit_mps.is_finite() { format!("{:.2}", row.limit_mps) } else { "–".to_owned() };
        let _ = write!(
            html,
            "<tr><td class=num>{:.3} s<td>{}<td class=num>{:.2}<td class=num>{:.2}<td class=num>{limit}<td class=num>{person}<td class=why>{}</tr>",
            row.at_s,
            escaped(&row.state),
            row.speed_mps + 0.0,
            row.permitted_mps + 0.0,
            escaped(&row.held_by)
        );
    }
    html.push_str("</table></div>");
}
