//! The line table of a linked image: which lines an instruction was made of.

use std::path::Path;

use anyhow::Result;

use crate::{shell, sources};

/// The line table, inlining included.
pub struct Lines {
    loader: addr2line::Loader,
    root: String,
}

impl Lines {
    /// Opens the line table of an image.
    pub fn of(path: &Path) -> Result<Self> {
        let loader =
            addr2line::Loader::new(path).map_err(|error| anyhow::anyhow!("no line table: {error}"))?;
        Ok(Self { loader, root: format!("{}/", shell::root().display()) })
    }

    /// Source places of an instruction, innermost inlined function first.
    pub fn places(&self, address: u64) -> Result<Vec<(String, u32)>> {
        let mut places = Vec::new();
        let mut frames =
            self.loader.find_frames(address).map_err(|error| anyhow::anyhow!("no frames: {error}"))?;
        while let Some(frame) =
            frames.next().map_err(|error| anyhow::anyhow!("broken line table: {error}"))?
        {
            if let Some(location) = frame.location {
                let file = location.file.unwrap_or("?");
                let file = file.strip_prefix(&self.root).unwrap_or(file);
                places.push((file.to_owned(), location.line.unwrap_or(0)));
            }
        }
        Ok(places)
    }

    /// Name of the innermost inlined function, without path and parameters.
    pub fn innermost(&self, address: u64) -> Result<Option<String>> {
        let mut frames =
            self.loader.find_frames(address).map_err(|error| anyhow::anyhow!("no frames: {error}"))?;
        let frame = frames.next().map_err(|error| anyhow::anyhow!("broken line table: {error}"))?;
        let name =
            frame.and_then(|frame| frame.function).and_then(|name| name.raw_name().ok().map(String::from));
        Ok(name.map(|name| name.split('<').next().unwrap_or_default().to_owned()))
    }

    /// As `places`; for an instruction without a line, those of the nearest of `others` that has one.
    pub fn places_near(&self, address: u64, others: impl Iterator<Item = u64>) -> Result<Vec<(String, u32)>> {
        for candidate in std::iter::once(address).chain(others) {
            let places = self.places(candidate)?;
            if places.first().is_some_and(|(_, line)| *line != 0) {
                return Ok(places);
            }
        }
        self.places(address)
    }

    /// The place that a reader should look at: the innermost one in our layers, else the innermost one.
    pub fn place(&self, address: u64) -> Result<(String, u32)> {
        let places = self.places(address)?;
        let own = places.iter().find(|(file, _)| sources::is_own(file)).or(places.first());
        Ok(own.cloned().unwrap_or_default())
    }
}
