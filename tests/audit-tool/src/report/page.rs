//! The page for people: verdicts first, then each piece of evidence, in one file without scripts or links outwards.

use std::fmt::Write as _;

use serde_json::Value;

use super::table::{Table, anchor, code, escape, grouped, link, source, verdict};
use super::{claims, goals, instructions, loops, manual, stack, states};
use crate::facts::facts;
use crate::forbidden::hosted_only;
use crate::mutants::Record;
use crate::records::since::{CodeToday, Since};
use crate::report::evidence::Evidence;
use crate::trace::{Place, Requirement, Trace};

/// Sections: anchor, heading.
const SECTIONS: [(&str, &str); 15] = [
    ("claims", "Claims"),
    ("not-claimed", "What is not claimed"),
    ("requirements", "Requirements, both ways"),
    ("hazards", "Hazards and causes"),
    ("states", "States, transitions and causes of the guard"),
    ("reaction", "Reaction time by chain"),
    ("assumptions", "What the machine must provide"),
    ("instructions", "Instructions and determinism"),
    ("goals", "Aims of the long campaigns"),
    ("campaigns", "Campaigns that were run"),
    ("mutants", "Mutants"),
    ("stack", "Stack and functions"),
    ("hosted", "What is in no image"),
    ("dependencies", "Crates of the safety image"),
    ("loops", "Loops and their bounds"),
];

/// The page.
pub fn html(evidence: &Evidence) -> String {
    let mut page = String::from(HEAD);
    let good = evidence.holds();
    let _ = write!(
        page,
        "<h1>{}: the evidence</h1><p class=big>{}</p>",
        escape(&facts().project),
        verdict(good, if good { "every claim holds" } else { "a claim fails" })
    );
    page.push_str(INTRODUCTION);
    page.push_str(&missing(&evidence.records.missing));
    page.push_str("<nav>");
    for (anchor, heading) in SECTIONS {
        let _ = write!(page, "<a href='#{anchor}'>{heading}</a> ");
    }
    page.push_str("</nav>");
    let bodies = [
        claims::section(&evidence.claims),
        manual::chapter(&evidence.records.manual, manual::NOT_CLAIMED),
        requirements(&evidence.trace),
        hazards(&evidence.trace),
        states::section(&evidence.states, &evidence.explored, &evidence.causes),
        manual::chapter(&evidence.records.manual, manual::REACTION),
        manual::chapter(&evidence.records.manual, manual::ASSUMPTIONS),
        instructions::section(evidence.records.firmware.as_ref(), evidence.records.worst.as_ref()),
        goals::section(evidence.records.campaigns.as_ref(), &evidence.today),
        campaigns(evidence.records.campaigns.as_ref(), &evidence.today),
        mutants(&evidence.mutants, &evidence.today.code),
        stack::section(evidence.image.as_ref(), &evidence.roots),
        hosted(),
        dependencies(evidence),
        loops::section(&evidence.sites),
    ];
    for ((anchor, heading), body) in SECTIONS.iter().zip(bodies) {
        let _ = write!(page, "<h2 id={anchor}>{heading}</h2>{body}");
    }
    page
}

/// The records that could not be read, before everything else: their sections are empty or short.
fn missing(files: &[String]) -> String {
    let reported = files.iter().map(|why| {
        format!("<p>{} {}</p>", verdict(false, "cannot be read, and is missing below:"), escape(why))
    });
    reported.collect()
}

fn requirements(trace: &Trace) -> String {
    let mut table =
        Table::new(&["requirement", "code", "tests and their last result", "hazards", "clauses considered"]);
    for line in &trace.requirements {
        let tests: Vec<String> = line
            .tests
            .iter()
            .map(|test| {
                let result = match test.passed {
                    Some(true) => verdict(true, "passed"),
                    Some(false) => verdict(false, "failed"),
                    None => verdict(false, "did not run"),
                };
                format!("{result} {} {}", escape(&test.name), place(&test.place))
            })
            .collect();
        let links = line.hazards.iter().map(|id| link(id));
        table.row(&[
            format!("{}<br>{}", anchor(&line.id), escape(&line.text)),
            line.code.iter().map(place).collect::<Vec<_>>().join("<br>"),
            tests.join("<br>"),
            links.collect::<Vec<_>>().join("<br>"),
            escape(&line.serves),
        ]);
    }
    let back = backwards(&trace.requirements);
    format!(
        "<p>The clauses are orientation and no claim of conformity.</p>{}<h3>From code back to requirements</h3>{back}",
        table.finish()
    )
}

/// Each file with the requirements that it carries or tests.
fn backwards(requirements: &[Requirement]) -> String {
    let mut files = std::collections::BTreeMap::<&str, std::collections::BTreeSet<&str>>::new();
    for line in requirements {
        let tests = line.tests.iter().map(|test| &test.place);
        for place in line.code.iter().chain(tests) {
            files.entry(&place.file).or_default().insert(&line.id);
        }
    }
    let mut table = Table::new(&["file", "requirements"]);
    for (file, ids) in files {
        let links = ids.iter().map(|id| link(id)).collect::<Vec<_>>();
        table.row(&[code(file), links.join(" ")]);
    }
    table.finish()
}

fn place(place: &Place) -> String {
    source(&place.file, place.line)
}

fn hazards(trace: &Trace) -> String {
    let mut table = Table::new(&["hazard", "causes of the guard that answer it", "requirements"]);
    for hazard in &trace.hazards {
        let links = hazard.requirements.iter().map(|id| link(id)).collect::<Vec<_>>();
        table.row(&[
            format!("{}<br>{}", anchor(&hazard.id), escape(&hazard.text)),
            hazard.causes.iter().map(|cause| code(cause)).collect::<Vec<_>>().join(" "),
            links.join(" "),
        ]);
    }
    table.finish()
}

fn campaigns(records: Option<&Value>, today: &CodeToday) -> String {
    let mut table = Table::new(&["campaign", "trials", "findings", "counted", "code since", "repeat with"]);
    let listed = records.and_then(Value::as_array);
    let absent = listed.is_none().then(|| verdict(false, "No record of any campaign could be read."));
    for record in listed.into_iter().flatten() {
        let text = |name: &str| escape(record[name].as_str().unwrap_or(""));
        let number = |name: &str| record[name].as_u64().map_or_else(|| String::from("?"), grouped);
        let counts = record["counts"].as_object().into_iter().flatten();
        let counts: Vec<String> = counts
            .map(|(name, count)| {
                format!(
                    "{} {}",
                    escape(name),
                    count.as_u64().map_or_else(|| escape(&count.to_string()), grouped)
                )
            })
            .collect();
        table.row(&[
            format!("<b>{}</b><br>{}", text("name"), text("what")),
            number("trials"),
            number("findings"),
            counts.join("<br>"),
            Since::of_campaign(record, today).words().to_owned(),
            format!("<code>{}</code>", text("command")),
        ]);
    }
    format!(
        "<p>Long runs, recorded in <code>docs/evidence/campaigns.json</code> when they were made; a short slice of each \
         runs with every <code>cargo xtask test</code>. This audit does not repeat them. <i>Code since</i> compares \
         the fingerprint of core and drivers that a record keeps with today's, {}, and where the whole robot ran that of \
         runtime and simulator, too, {}; records from before fingerprints were kept do not tell.</p>{}{}",
        code(&today.code),
        code(&today.whole),
        absent.unwrap_or_default(),
        table.finish()
    )
}

fn mutants(records: &[Record], code_today: &str) -> String {
    let mut parts = Table::new(&[
        "part",
        "viable",
        "caught",
        "not tried",
        "caught or explained",
        "wanted",
        "core and drivers since",
        "repeat with",
    ]);
    let mut table = Table::new(&["place", "source", "what no test notices", "why nobody can"]);
    for record in records {
        let good = record.percent() >= record.wanted_percent;
        parts.row(&[
            escape(&record.name),
            record.viable.to_string(),
            record.caught.to_string(),
            record.untried.to_string(),
            verdict(good, &format!("{:.1} %", record.percent())),
            format!("{:.0} %", record.wanted_percent),
            Since::of(Some(&record.code), code_today).words().to_owned(),
            code(&record.command),
        ]);
        for survivor in &record.survivors {
            table.row(&[
                source(&survivor.file, survivor.line),
                code(&survivor.source),
                escape(&survivor.mutation),
                escape(&survivor.reason),
            ]);
        }
    }
    format!(
        "<p>The code is mutated in one place at a time, as cargo-mutants lists it; the tests of the package must fail. What no \
         test notices is listed: with the reason where nobody could notice it, and with nothing where a test is missing. Those \
         count against the share, and so does what was not tried.</p>{}{}",
        parts.finish(),
        table.finish()
    )
}

fn hosted() -> String {
    let mut table = Table::new(&["package, modules", "why it is in no image"]);
    for entry in &facts().hosted_only {
        table.row(&[code(&hosted_only::shown(entry)), escape(&entry.reason)]);
    }
    format!(
        "<p>Part of the audited crates, judged from its sources like all of it, but on a Linux computer only. The claim \
         <b>hosted-only-apart</b> holds them off the images.</p>{}",
        table.finish()
    )
}

fn dependencies(evidence: &Evidence) -> String {
    let mut table = Table::new(&["crate", "licence", "reason"]);
    for found in &evidence.dependencies {
        table.row(&[code(&found.name), escape(&found.licence), escape(&found.reason)]);
    }
    table.finish()
}

const INTRODUCTION: &str = "<p>Made by <code>cargo xtask audit</code> from the sources, the linked Cortex-M7 image and \
the tests of this tree. Each claim is checked afresh; one that fails names a file and a line. What was measured by longer \
runs is recorded in the tree and says so. The whole safety manual is <a href='../../docs/safety-manual.md'>\
docs/safety-manual.md</a>. Names of files lead to the sources \
beside this page's <code>target</code> folder.</p>";

const HEAD: &str = "<!doctype html><html lang=en><meta charset=utf-8><meta name=viewport content='width=device-width'>\
<title>floorguard audit</title><style>body{font:15px/1.5 system-ui,sans-serif;margin:2em auto;max-width:80em;\
padding:0 1em;color:#222}table{border-collapse:collapse;width:100%;margin:.7em 0}td,th{border:1px solid #ccc;\
padding:.3em .5em;text-align:left;vertical-align:top}th{background:#f3f3f3}code{font-size:.88em}\
.wide{overflow-x:auto}.big{font-size:1.4em}.good{background:#dff2df;padding:0 .3em}.bad{background:#f9d6d6;\
padding:0 .3em}.aside{background:#eee;padding:0 .3em}nav a{margin-right:1em}td code{overflow-wrap:anywhere}td:first-child code{overflow-wrap:normal}\
summary{cursor:pointer;padding:.15em 0}thead th{position:sticky;top:0}svg{max-width:100%;height:auto}</style>";

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::Hazard;

    #[test]
    fn documents_and_records_cannot_break_the_page() {
        let bad = "<i>'";
        let line =
            Requirement { id: bad.to_owned(), hazards: vec![bad.to_owned()], ..Requirement::default() };
        let hazard = Hazard {
            id: bad.to_owned(),
            text: String::new(),
            causes: vec![],
            requirements: vec![bad.to_owned()],
            line: 1,
        };
        let trace = Trace { requirements: vec![line], hazards: vec![hazard] };
        let record = serde_json::json!([{"name": bad, "counts": {bad: bad}, "what": bad, "command": bad}]);
        let html = [
            requirements(&trace),
            hazards(&trace),
            campaigns(Some(&record), &CodeToday { code: bad.to_owned(), whole: bad.to_owned() }),
        ]
        .concat();
        assert!(!html.contains(bad) && !html.contains("<i>&#39;"), "{html}");
        assert_eq!(html.matches("id='&lt;i&gt;&#39;'").count(), 2, "{html}");
    }

    #[test]
    fn unreadable_record_is_named_first() {
        assert_eq!(missing(&[]), "");
        let html = missing(&["docs/a.json: <broken>".to_owned()]);
        assert!(html.contains("docs/a.json: &lt;broken&gt;") && html.contains("class=bad"), "{html}");
        assert!(campaigns(None, &CodeToday::default()).contains("No record of any campaign could be read"));
        assert!(!campaigns(Some(&serde_json::json!([])), &CodeToday::default()).contains("could be read"));
    }
}
