//! Tracks whose values bear names: a table with a heading, in any order of columns, or JSON objects.
//!
//! The names are those of OpenTraj's common table (Amirian et al. 2020, `frame_id`, `agent_id`, `pos_x`, `pos_y`, `timestamp`)
//! and the usual ones beside them.

use anyhow::{Context, bail, ensure};
use serde_json::Value;

use super::tracks::{Row, checked};

const SECONDS: &[&str] = &["time_s", "timestamp", "time", "t"];
const FRAMES: &[&str] = &["frame_id", "frame", "f"];
const PEOPLE: &[&str] = &["agent_id", "track_id", "person_id", "ped_id", "id", "person", "p"];
const X: &[&str] = &["pos_x", "x_m", "x"];
const Y: &[&str] = &["pos_y", "y_m", "y"];
/// Under these names an object holds a list of others.
const LISTS: &[&str] = &["tracks", "people", "agents", "data", "points", "positions", "trajectory"];
/// Lists within lists: a file, its tracks, their points.
const DEPTH_MAX: usize = 3;

/// Tracks as their names tell them.
pub struct NamedRows {
    /// Each with its seconds or its frame.
    pub rows: Vec<Row>,
    /// The moments are frames, not seconds.
    pub in_frames: bool,
}

/// The first name of `names` that `find` knows.
fn first<T>(names: &[&str], find: impl Fn(&str) -> Option<T>) -> Option<T> {
    names.iter().find_map(|name| find(name))
}

fn separator(heading: &str) -> char {
    [',', ';', '\t'].into_iter().find(|separator| heading.contains(*separator)).unwrap_or(' ')
}

fn fields(line: &str, separator: char) -> Vec<&str> {
    let parts = line.split(separator).map(|field| field.trim().trim_matches('"'));
    parts.filter(|field| separator != ' ' || !field.is_empty()).collect()
}

/// Where a table has its values.
struct Columns {
    separator: char,
    moment: usize,
    in_frames: bool,
    person: usize,
    x: usize,
    y: usize,
}

impl Columns {
    fn of(heading: &str) -> Option<Self> {
        let separator = separator(heading);
        let names: Vec<String> =
            fields(heading, separator).into_iter().map(str::to_ascii_lowercase).collect();
        let column = |wanted: &[&str]| first(wanted, |name| names.iter().position(|own| own == name));
        let seconds = column(SECONDS);
        Some(Self {
            separator,
            moment: seconds.or_else(|| column(FRAMES))?,
            in_frames: seconds.is_none(),
            person: column(PEOPLE)?,
            x: column(X)?,
            y: column(Y)?,
        })
    }

    fn row(&self, line: &str) -> anyhow::Result<Row> {
        let fields = fields(line, self.separator);
        let number = |column: usize| {
            let field =
                fields.get(column).with_context(|| format!("{} columns are too few", fields.len()))?;
            field.parse::<f64>().with_context(|| format!("'{field}' is not a number"))
        };
        checked(number(self.moment)?, number(self.person)?, number(self.x)?, number(self.y)?)
    }
}

/// The line is the heading of a table of tracks.
pub fn is_heading(line: &str) -> bool {
    Columns::of(line).is_some()
}

/// Rows of a table with a heading.
///
/// # Errors
/// A heading without moment, person, x and y; a line that does not fit, by its number.
pub fn table(text: &str) -> anyhow::Result<NamedRows> {
    let mut lines =
        text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty() && !line.starts_with('#'));
    let (_, heading) = lines.next().context("it is empty")?;
    let columns = Columns::of(heading).with_context(|| {
        format!(
            "its heading '{heading}' does not name time_s or frame, id, x_m and y_m (or their other names)"
        )
    })?;
    let row = |(index, line): (usize, &str)| columns.row(line).with_context(|| format!("line {}", index + 1));
    Ok(NamedRows { rows: lines.map(row).collect::<anyhow::Result<_>>()?, in_frames: columns.in_frames })
}

/// Rows of JSON: one object a line, a list of objects, or objects of people with a list of their points.
///
/// # Errors
/// No JSON; an object without moment, person, x and y; seconds in some objects and frames in others.
pub fn json(text: &str) -> anyhow::Result<NamedRows> {
    let mut found = Vec::new();
    for value in serde_json::Deserializer::from_str(text).into_iter::<Value>() {
        collect(&value.context("this is no JSON")?, None, DEPTH_MAX, &mut found)?;
    }
    let in_frames = found.first().is_some_and(|(in_frames, _)| *in_frames);
    ensure!(
        found.iter().all(|(own, _)| *own == in_frames),
        "some of its objects have seconds, others only frames: give all the same"
    );
    Ok(NamedRows { rows: found.into_iter().map(|(_, row)| row).collect(), in_frames })
}

fn number(object: &Value, names: &[&str]) -> Option<f64> {
    first(names, |name| object.get(name).and_then(Value::as_f64))
}

fn collect(
    value: &Value,
    owner: Option<f64>,
    depth: usize,
    found: &mut Vec<(bool, Row)>,
) -> anyhow::Result<()> {
    let person = number(value, PEOPLE).or(owner);
    let list = value.as_array().or_else(|| first(LISTS, |name| value.get(name)?.as_array()));
    if let Some(list) = list {
        ensure!(depth > 0, "its lists are nested more than {DEPTH_MAX} deep");
        return list.iter().try_for_each(|inner| collect(inner, person, depth - 1, found));
    }
    let seconds = number(value, SECONDS);
    let moment = seconds.or_else(|| number(value, FRAMES));
    match (moment, person, number(value, X), number(value, Y)) {
        (Some(moment), Some(person), Some(x_m), Some(y_m)) => {
            found.push((seconds.is_none(), checked(moment, person, x_m, y_m)?));
            Ok(())
        }
        _ => {
            let text = value.to_string();
            let shown: String = text.chars().take(80).collect();
            bail!("'{shown}' has no time_s or frame, id, x_m and y_m (or their other names)")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(rows: &[Row]) -> Vec<(f64, u64, f32, f32)> {
        rows.iter().map(|row| (row.frame, row.id, row.position.x_m, row.position.y_m)).collect()
    }

    #[test]
    fn reads_columns_by_name_in_any_order() {
        let text = "scene_id,agent_id,frame_id,pos_x,pos_y,vel_x,vel_y,label,timestamp\n\
                    zara,3,780,8.5,3.5,1.2,0,pedestrian,31.2\nzara,3,790,9.0,3.5,1.2,0,pedestrian,31.6\n";
        let read = table(text).unwrap();
        assert!(!read.in_frames);
        assert_eq!(of(&read.rows), [(31.2, 3, 8.5, 3.5), (31.6, 3, 9.0, 3.5)]);
        let frames = table("x y frame id\n1 2 10 7\n").unwrap();
        assert!(frames.in_frames);
        assert_eq!(of(&frames.rows), [(10.0, 7, 1.0, 2.0)]);
    }

    #[test]
    fn wrong_table_names_line_and_heading() {
        let error = format!("{:#}", table("t,id,x,y\n0,1,2,3\n0,1,two,3\n").err().unwrap());
        assert!(error.contains("line 3") && error.contains("'two'"), "{error}");
        assert!(table("t,id,x\n0,1,2\n").is_err());
        assert!(!is_heading("0,1,2,3") && is_heading("time_s,id,x_m,y_m"));
    }

    #[test]
    fn reads_json_of_each_shape() {
        let expected = [(0.0, 4, 1.0, 2.0), (0.5, 4, 1.5, 2.0)];
        for text in [
            r#"[{"t": 0, "id": 4, "x": 1, "y": 2}, {"t": 0.5, "id": 4, "x": 1.5, "y": 2}]"#,
            "{\"timestamp\": 0, \"agent_id\": 4, \"pos_x\": 1, \"pos_y\": 2}\n\
             {\"timestamp\": 0.5, \"agent_id\": 4, \"pos_x\": 1.5, \"pos_y\": 2}\n",
            r#"{"tracks": [{"id": 4, "points": [{"t": 0, "x": 1, "y": 2}, {"t": 0.5, "x": 1.5, "y": 2}]}]}"#,
        ] {
            assert_eq!(of(&json(text).unwrap().rows), expected, "{text}");
        }
    }

    #[test]
    fn refuses_json_without_tracks() {
        assert!(json("[1, 2]").is_err() && json("{\"t\": 0}").is_err() && json("[").is_err());
        assert!(json("[[[[[]]]]]").is_err());
        let mixed = r#"[{"t": 0, "id": 4, "x": 1, "y": 2}, {"frame": 5, "id": 4, "x": 1.5, "y": 2}]"#;
        assert!(json(mixed).is_err());
    }
}
