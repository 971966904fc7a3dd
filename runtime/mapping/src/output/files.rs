//! All files of a map.

use super::map_server::{pgm, yaml};
use super::picture::{Picture, draw};
use super::submaps::{INDEX_HEAD, SubMapConfig, SubMaps, index_line};
use crate::grid_map::GridMap;
use crate::mapper::Mapper;
use crate::metrics::write_tum;
use crate::pose_graph::write_g2o;
use crate::se2::Se2;

/// A file to be written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OutputFile {
    /// Its name in the folder; a `/` makes a folder within it.
    pub name: String,
    /// Its content.
    pub bytes: Vec<u8>,
}

impl OutputFile {
    /// A file.
    pub fn new(name: impl Into<String>, bytes: impl Into<Vec<u8>>) -> Self {
        Self { name: name.into(), bytes: bytes.into() }
    }
}

/// The files of a finished mapping: `map.pgm` and `map.yaml`, `trajectory.tum` (the poses given), `graph.g2o` (a vertex for
/// each kept scan, in the frame of the scanner), `picture.png`, and `submaps/`. Each is made when it is asked for: a building's
/// sub-maps together are larger than all that its mapping needs.
pub fn map_files<'a>(
    mapper: &'a Mapper,
    map: &'a GridMap,
    trajectory: &'a [(f64, Se2)],
) -> impl Iterator<Item = OutputFile> + 'a {
    let graph = mapper.graph();
    let path: Vec<Se2> = trajectory.iter().map(|(_, pose)| *pose).collect();
    let maps = SubMaps::new(&mapper.tracker.nodes, &mapper.views, &mapper.poses, SubMapConfig::default());
    let whole = (0..3).map(move |file| match file {
        0 => OutputFile::new("trajectory.tum", write_tum(trajectory)),
        1 => OutputFile::new("graph.g2o", write_g2o(&graph)),
        _ => {
            let picture = Picture { map, path: &path, poses: &graph.poses, edges: &graph.edges };
            OutputFile::new("picture.png", draw(&picture))
        }
    });
    map_server_files(map, "map").into_iter().chain(whole).chain(sub_map_files(maps))
}

/// The sub-maps, and their list at the end.
fn sub_map_files<'a>(mut maps: SubMaps<'a>) -> impl Iterator<Item = OutputFile> + 'a {
    let (mut list, mut number, mut is_listed) = (INDEX_HEAD.to_owned(), 0, false);
    let pairs = std::iter::from_fn(move || {
        if let Some(map) = maps.next() {
            let name = format!("{number:04}");
            number += 1;
            list.push_str(&index_line(&map, &name));
            return Some(map_server_files(&map.map, &format!("submaps/{name}")));
        }
        let was_listed = std::mem::replace(&mut is_listed, true);
        (!was_listed).then(|| vec![OutputFile::new("submaps/index.txt", std::mem::take(&mut list))])
    });
    pairs.flatten()
}

/// The pair of files of a map, `NAME.pgm` and `NAME.yaml`; a `/` in the name makes a folder.
#[must_use]
pub fn map_server_files(map: &GridMap, name: &str) -> Vec<OutputFile> {
    let picture = format!("{}.pgm", name.rsplit('/').next().unwrap_or(name));
    vec![
        OutputFile::new(format!("{name}.pgm"), pgm(map)),
        OutputFile::new(format!("{name}.yaml"), yaml(map, &picture)),
    ]
}
