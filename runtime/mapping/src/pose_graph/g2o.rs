//! The text format of g2o: `VERTEX_SE2 id x y heading`, `EDGE_SE2 from to x y heading` and the upper triangle of the
//! information (Kümmerle et al. 2011; the format as g2o's own `types/slam2d` writes it).

use std::collections::BTreeMap;
use std::fmt::Write;

use nalgebra::Matrix3;

use super::edge::{Edge, EdgeKind};
use super::graph::Graph;
use crate::se2::Se2;

/// A line that cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: {what}")]
pub struct G2oError {
    /// Number of the line, from 1.
    pub line: usize,
    /// What is wrong.
    pub what: &'static str,
}

/// Reads a graph. Poses come in the order of their numbers; edges from a number to the next are the sequence, all others
/// loops. Poses that only edges name stand at the origin. Other kinds of lines are left out.
///
/// # Errors
/// A line of a known kind is damaged.
pub fn read_g2o(text: &str) -> Result<Graph, G2oError> {
    let mut vertices: BTreeMap<u64, Se2> = BTreeMap::new();
    let mut edges: Vec<([u64; 2], Se2, Matrix3<f64>)> = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let mut words = line.split_whitespace();
        let kind = words.next().unwrap_or_default();
        let ids = match kind {
            "VERTEX_SE2" => 1,
            "EDGE_SE2" => 2,
            _ => continue,
        };
        let damaged = |what| G2oError { line: index + 1, what };
        let mut id =
            || words.next().and_then(|word| word.parse::<u64>().ok()).ok_or(damaged("a number of a pose"));
        let first = id()?;
        let second = if ids == 2 { id()? } else { first };
        let numbers: Option<Vec<f64>> =
            words.map(|word| word.parse().ok().filter(|n: &f64| n.is_finite())).collect();
        let numbers = numbers.ok_or(damaged("a word is no number"))?;
        if ids == 1 {
            let Some([x, y, heading]) = numbers.first_chunk::<3>() else {
                return Err(damaged("it ends too early"));
            };
            vertices.insert(first, Se2::new(*x, *y, *heading));
        } else {
            let Some(&[x, y, heading, xx, xy, xt, yy, yt, tt]) = numbers.first_chunk::<9>() else {
                return Err(damaged("it ends too early"));
            };
            let information = Matrix3::new(xx, xy, xt, xy, yy, yt, xt, yt, tt);
            edges.push(([first, second], Se2::new(x, y, heading), information));
        }
    }
    for ([from, to], _, _) in &edges {
        vertices.entry(*from).or_default();
        vertices.entry(*to).or_default();
    }
    let index: BTreeMap<u64, usize> = vertices.keys().enumerate().map(|(index, id)| (*id, index)).collect();
    let edge = |([from, to], measured, information): ([u64; 2], Se2, Matrix3<f64>)| {
        let kind = if from.abs_diff(to) == 1 { EdgeKind::Sequence } else { EdgeKind::Loop };
        Edge { from: index[&from], to: index[&to], measured, information, kind }
    };
    let edges = edges.into_iter().map(edge).collect();
    Ok(Graph { poses: vertices.into_values().collect(), edges })
}

/// Writes a graph.
#[must_use]
pub fn write_g2o(graph: &Graph) -> String {
    let mut text = String::new();
    for (index, pose) in graph.poses.iter().enumerate() {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "VERTEX_SE2 {index} {} {} {}", pose.x_m, pose.y_m, pose.heading_rad);
    }
    for edge in &graph.edges {
        let (pose, i) = (edge.measured, edge.information);
        let _ = writeln!(
            text,
            "EDGE_SE2 {} {} {} {} {} {} {} {} {} {} {}",
            edge.from,
            edge.to,
            pose.x_m,
            pose.y_m,
            pose.heading_rad,
            i[(0, 0)],
            i[(0, 1)],
            i[(0, 2)],
            i[(1, 1)],
            i[(1, 2)],
            i[(2, 2)]
        );
    }
    text
}
