//! What is printed about a recording whose robot was allowed then and would be refused today.

/// Says why `run` would refuse the robot of a recording, which is read all the same.
pub fn say_findings(findings: Option<&str>) {
    if let Some(findings) = findings {
        say!("note: `run` refuses this robot today; its recording is read all the same:\n{findings}");
    }
}
