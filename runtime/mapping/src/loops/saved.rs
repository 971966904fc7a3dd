//! The search for loops as bytes. Stretches and their fields are made again from the scans.

use super::closer::{LoopCloser, LoopStatistics};
use super::config::LoopConfig;
use super::stretch::Stretch;
use crate::front_end::Node;
use crate::refine::ScanView;
use crate::saved::{Reading, Saving};

impl LoopCloser {
    pub(crate) fn save(&self, to: &mut Saving<'_>) {
        to.count(self.stretches.len());
        for stretch in &self.stretches {
            to.count(stretch.first);
            to.count(stretch.end);
        }
        to.count(self.links.len());
        self.links.iter().flatten().for_each(|stretch| to.count(*stretch));
        to.count(self.next_node);
        let LoopStatistics { searched, unlike, at_rim, ambiguous, contradicted, accepted } = self.statistics;
        [searched, unlike, at_rim, ambiguous, contradicted, accepted]
            .into_iter()
            .for_each(|value| to.count(value));
    }

    pub(crate) fn read(
        from: &mut Reading<'_>,
        scans: (&[Node], &[ScanView]),
        config: LoopConfig,
    ) -> Option<Self> {
        let (nodes, _) = scans;
        let mut closer = Self::new(config);
        closer.stretches = from.all(|from| {
            let (first, end) = (from.count()?, from.count()?);
            (first < end && end <= nodes.len()).then(|| Stretch::new(scans, first..end, &config))
        })?;
        closer.links = from.all(|from| Some([from.count()?, from.count()?]))?;
        closer.next_node = from.count()?;
        closer.statistics = LoopStatistics {
            searched: from.count()?,
            unlike: from.count()?,
            at_rim: from.count()?,
            ambiguous: from.count()?,
            contradicted: from.count()?,
            accepted: from.count()?,
        };
        Some(closer)
    }
}
