//! Two experts who look at a track as a whole: this one was a person, that one was none.
//!
//! Source: book, Online learning: Experts. Where ours differ, the comment at the number says so.

/// When an expert speaks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExpertRules {
    /// A person has walked this far, metres.
    pub walked_min_m: f32,
    /// At this mean speed, m/s. Published 0.3 to 1.0; people in halls walk at 1.2 to 1.6.
    pub walking_mps: [f32; 2],
    /// And is this far from where it began at some time, metres. Ours: a standing track that jitters for hours has a long
    /// path.
    pub strayed_min_m: f32,
    /// What stands never strays farther than this, metres.
    pub standing_max_m: f32,
    /// Sum of the variances of its place, m².
    pub variance_max_m2: f32,
    /// For so long, seconds. Published 30 poses, that is 1 to 3 s: people stand as long.
    pub standing_min_s: f32,
    /// A track with the shape of a person beyond this may stand for any time: mean log-odds. Ours.
    pub certain: f32,
}

impl ExpertRules {
    /// The published values (Yan et al. 2017) with the changes that stand at each number.
    pub const DEFAULT: Self = Self {
        walked_min_m: 3.0,
        walking_mps: [0.3, 2.0],
        strayed_min_m: 1.5,
        standing_max_m: 0.2,
        variance_max_m2: 0.02,
        standing_min_s: 10.0,
        certain: 2.5,
    };
}

/// What is known of a track.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct TrackSummary {
    pub seconds: f32,
    pub walked_m: f32,
    pub strayed_m: f32,
    pub variance_m2: f32,
    /// Greatest and mean log-odds of its shapes.
    pub best: f32,
    pub mean: f32,
}

/// What the experts say.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// All its shapes are those of a person.
    Person,
    /// None of its shapes is a person's. The published expert labels only shapes that were classified as a person; then
    /// what was rightly refused is forgotten, and passes for a person later.
    NotAPerson,
    /// Neither expert knows.
    Silent,
}

impl ExpertRules {
    pub(super) fn judge(&self, track: &TrackSummary) -> Verdict {
        let speed = track.walked_m / track.seconds.max(0.1);
        let [slow, fast] = self.walking_mps;
        let walks = track.walked_m >= self.walked_min_m
            && track.strayed_m >= self.strayed_min_m
            && (slow..=fast).contains(&speed);
        // A trolley that nobody ever took for a person walks, too.
        if walks && track.best > 0.0 {
            return Verdict::Person;
        }
        if self.stands(track) && track.mean < self.certain { Verdict::NotAPerson } else { Verdict::Silent }
    }

    fn stands(&self, track: &TrackSummary) -> bool {
        track.seconds >= self.standing_min_s
            && track.strayed_m <= self.standing_max_m
            && track.variance_m2 <= self.variance_max_m2
    }

    /// Whether enough is known to end the wait for a track that stands.
    pub(super) fn is_ripe(&self, track: &TrackSummary) -> bool {
        self.stands(track)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn walkers_standers_and_undecided_tracks() {
        let rules = ExpertRules::DEFAULT;
        let walker = TrackSummary {
            seconds: 5.0,
            walked_m: 6.0,
            strayed_m: 5.0,
            variance_m2: 3.0,
            best: 1.0,
            mean: 0.2,
        };
        let stander =
            TrackSummary { seconds: 12.0, walked_m: 1.0, strayed_m: 0.1, variance_m2: 0.004, ..walker };
        assert_eq!(rules.judge(&walker), Verdict::Person);
        assert_eq!(rules.judge(&stander), Verdict::NotAPerson);
        assert_eq!(rules.judge(&TrackSummary { best: -0.1, ..stander }), Verdict::NotAPerson);
        for silent in [
            TrackSummary { best: -0.5, ..walker },
            TrackSummary { walked_m: 2.0, ..walker },
            TrackSummary { seconds: 40.0, ..walker },
            TrackSummary { seconds: 1.0, ..walker },
            TrackSummary { strayed_m: 0.6, ..walker },
            TrackSummary { seconds: 3.0, ..stander },
            TrackSummary { mean: 3.0, ..stander },
            TrackSummary { variance_m2: 0.05, ..stander },
        ] {
            assert_eq!(rules.judge(&silent), Verdict::Silent, "{silent:?}");
        }
    }
}
