//! All files of a map.

use super::map_server::{pgm, yaml};
use super::picture::{Picture, draw};
use super::submaps::{SubMapConfig, index_text, sub_maps};
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
/// each kept scan, in the frame of the scanner), `picture.png`, and `submaps/`.
#[must_use]
pub fn map_files(mapper: &Mapper, map: &GridMap, trajectory: &[(f64, Se2)]) -> Vec<OutputFile> {
    let graph = mapper.graph();
    let path: Vec<Se2> = trajectory.iter().map(|(_, pose)| *pose).collect();
    let picture = Picture { map, path: &path, poses: &graph.poses, edges: &graph.edges };
    let mut files = map_server_files(map, "map");
    files.extend([
        OutputFile::new("trajectory.tum", write_tum(trajectory)),
        OutputFile::new("graph.g2o", write_g2o(&graph)),
        OutputFile::new("picture.png", draw(&picture)),
    ]);
    let maps = sub_maps(&mapper.tracker.nodes, &graph.poses, &SubMapConfig::default());
    let names: Vec<String> = (0..maps.len()).map(|index| format!("{index:04}")).collect();
    files.push(OutputFile::new("submaps/index.txt", index_text(&maps, &names)));
    for (map, name) in maps.iter().zip(&names) {
        files.extend(map_server_files(&map.map, &format!("submaps/{name}")));
    }
    files
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
