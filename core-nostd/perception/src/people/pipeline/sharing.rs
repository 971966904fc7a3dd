//! Clusters in which the tracker expects several people.

use super::context::SweepContext;
use super::state::PeoplePipelineOf;
use crate::clusters::{ColumnFrame, SweepFrame, rings_of};
use floorguard_types::profile::Profile;
use floorguard_types::sensing::SweepOf;

impl<P: Profile> PeoplePipelineOf<P> {
    /// Clusters in which the tracker expects several people are shared out among them.
    #[inline(never)]
    pub(super) fn share_out(&mut self, sweep: &SweepOf<P>, context: &SweepContext) {
        self.splits.clear();
        let odom_in_base = context.base_in_odom.inverse();
        for (index, cluster) in self.clusters.iter().enumerate() {
            let expected = self.tracker.expected(sweep.end_stamp);
            self.splits.consider(index, cluster, expected.map(|place| odom_in_base.transform(place)));
        }
        if self.splits.is_empty() {
            return;
        }
        let frames = SweepFrame::new(sweep, &context.sensor_in_base, context.twist);
        for (index, column) in sweep.used_columns().iter().enumerate() {
            let mut frame: Option<ColumnFrame> = None;
            for ring in rings_of(self.clusterer.present_in(index)) {
                let (Some(raw), Some(angle)) = (column.range_raw.get(ring), self.angles.rings.get(ring))
                else {
                    continue;
                };
                let index =
                    self.clusterer.index_of(index, ring).filter(|cluster| self.splits.is_shared(*cluster));
                if let Some((index, cluster)) =
                    index.and_then(|index| Some((index, self.clusters.get(index)?)))
                {
                    let point = frame.get_or_insert_with(|| frames.column(column)).point(*raw, *angle);
                    self.splits.add(index, point, cluster.nearest_m);
                }
            }
        }
    }
}
