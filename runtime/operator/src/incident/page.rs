//! The explanation as one page that needs nothing else.

use std::fmt::Write as _;

use super::gather::Snapshot;
use super::picture::picture;
use super::summary::{CauseLine, Incident};
use crate::report::style::{self, escaped, tiles};

const LEGEND: &str = "The robot in blue, its front is up; dashed: its path of the ten seconds before. Red area: protective \
field. Yellow area: warning field. Dots: what the safety scanner saw. Circles with numbers: people, with the way that they \
came. The red ring: what held the robot.";

/// The page, in the language of the explanation.
#[must_use]
pub fn page(incident: &Incident, snapshots: &[Snapshot]) -> String {
    let language = incident.language;
    let say = |words: &'static str| language.say(words);
    let title = match &incident.decided_by {
        Some(_) if incident.stops => "Why the robot stopped",
        Some(_) => "Why the robot was slow",
        None => "What the robot did",
    };
    let mut html = style::head_in(language, say(title));
    let at = language.fill("{} s of the robot's clock", &[&language.number(incident.at_s, 3)]);
    let version = env!("CARGO_PKG_VERSION");
    let _ = write!(html, "<p class=legend>{}, {at}, floorguard {version}</p>", escaped(&incident.file));
    decided(&mut html, incident);
    let picture = picture(snapshots, incident.holder.as_ref(), language);
    let _ = write!(
        html,
        "<h2>{}</h2><div class=map>{picture}</div><p class=legend>{}</p>",
        say("The moment from above"),
        say(LEGEND)
    );
    if let Some(otherwise) = &incident.otherwise {
        let heading = say("What would have happened otherwise");
        let _ = write!(html, "<h2>{heading}</h2><p>{}</p>", escaped(&otherwise.sentence));
    }
    sources(&mut html, incident);
    causes(&mut html, incident);
    before(&mut html, incident);
    let heading = say("How this page was made");
    let _ = write!(html, "<h2>{heading}</h2><p>{}</p>", escaped(&incident.repetition));
    html + "</main></html>\n"
}

fn decided(html: &mut String, incident: &Incident) {
    let language = incident.language;
    let say = |words: &'static str| language.say(words);
    let holder = incident.holder.as_ref();
    let far = holder.map(|holder| format!("{} m", language.number(holder.distance_m.into(), 2)));
    html.push_str(&tiles([
        (incident.state.clone(), say("state shown"), ""),
        (incident.action.clone(), say("what the guard did"), ""),
        (format!("{} m/s", language.number(incident.speed_mps.into(), 2)), say("speed at the moment"), ""),
        (far.unwrap_or_else(|| "–".to_owned()), say("to what held it"), ""),
    ]));
    let Some(cause) = &incident.decided_by else {
        let _ = write!(html, "<p>{}</p>", say("Nothing held or limited the robot at this moment."));
        return;
    };
    let _ = write!(html, "<p class=cut><b>{}</b>", escaped(&cause.text));
    if let Some(holder) = holder {
        let words = language.fill("It was {}.", &[&escaped(&holder.words_in(language))]);
        let _ = write!(html, "<br>{words}");
    }
    // The requirements are written in English: a screen reader speaks them so.
    let rule = format!("<span lang=en>{}</span>", escaped(cause.rule));
    let rule = language.fill("The rule, {}: {}", &[cause.requirement, &rule]);
    let _ = write!(html, "<br>{}</p><p>{rule}</p>", escaped(&cause.remedy));
    if let Some(first) = &incident.first {
        let since = language.number(first.since_s, 3);
        let words = language.fill(
            "The stop began at {} s with another cause: {} ({}).",
            &[&since, &escaped(&first.text), first.requirement],
        );
        let _ = write!(html, "<p>{words}</p>");
    }
}

/// A table that can be moved sideways on a phone, up to its first row.
fn open_table(html: &mut String, heading: &str, columns: &[(&str, &str)]) {
    let _ = write!(
        html,
        "<h2>{heading}</h2><div class=wide tabindex=0 role=region aria-label=\"{heading}\"><table><tr>"
    );
    for (class, name) in columns {
        let _ = write!(html, "<th class='{class}'>{name}");
    }
    html.push_str("</tr>");
}

fn sources(html: &mut String, incident: &Incident) {
    let language = incident.language;
    let say = |words: &'static str| language.say(words);
    let columns = [("", say("source")), ("", say("health")), ("num", say("age")), ("why", say("saw"))];
    open_table(html, say("What each sensor saw"), &columns);
    for source in &incident.sources {
        let _ = write!(
            html,
            "<tr><td>{}<td>{}<td class=num>{}<td class=why>{}</tr>",
            escaped(language.say(source.name)),
            escaped(&source.health),
            source.age_in(language),
            escaped(&source.saw)
        );
    }
    html.push_str("</table></div>");
}

fn causes(html: &mut String, incident: &Incident) {
    if incident.others.is_empty() {
        return;
    }
    let language = incident.language;
    let say = |words: &'static str| language.say(words);
    let columns = [("num", say("since")), ("why", say("cause")), ("", say("rule")), ("why", say("remedy"))];
    open_table(html, say("What else held at the same time"), &columns);
    for CauseLine { text, requirement, remedy, since_s, .. } in &incident.others {
        let _ = write!(
            html,
            "<tr><td class=num>{} s<td class=why>{}<td>{requirement}<td class=why>{}</tr>",
            language.number(*since_s, 3),
            escaped(text),
            escaped(remedy)
        );
    }
    html.push_str("</table></div>");
}

fn before(html: &mut String, incident: &Incident) {
    let language = incident.language;
    let say = |words: &'static str| language.say(words);
    let number = |value: f32, digits| language.number(f64::from(value) + 0.0, digits);
    let columns = [
        ("num", say("time")),
        ("", say("state")),
        ("num", "m/s"),
        ("num more", say("permitted")),
        ("num more", say("at most")),
        ("num", say("nearest person")),
        ("why", say("held or limited by")),
    ];
    open_table(html, say("The ten seconds before"), &columns);
    for row in &incident.before {
        let person = row.person_m.map_or_else(|| "–".to_owned(), |metres| number(metres, 1) + " m");
        let limit = if row.limit_mps.is_finite() { number(row.limit_mps, 2) } else { "–".to_owned() };
        let _ = write!(
            html,
            "<tr><td class=num>{} s<td>{}<td class=num>{}<td class='num more'>{}<td class='num more'>{limit}<td \
             class=num>{person}<td class=why>{}</tr>",
            language.number(row.at_s, 3),
            escaped(&row.state),
            number(row.speed_mps, 2),
            number(row.permitted_mps, 2),
            escaped(&row.held_by)
        );
    }
    html.push_str("</table></div>");
}
