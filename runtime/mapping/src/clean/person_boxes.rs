//! What a box around a person in a picture takes, and when. Through whose body rays went, before or after, has walked on: the free
//! space of the place removes the returns one by one, and a box of a metre would take the wall beside for nothing. Who was seen at one
//! place in three pictures stood there. A place of one or two pictures may be wrong, a wall for example behind somebody's shoulder.

use floorguard_mapping::people_removal::{
    Evidence, EvidenceRule, FreeSpace, RemovalBox, RemovalSize, Sighting, VoxelStore,
};
use floorguard_types::geometry::Point3;

use super::box_index::BoxIndex;

/// The trunk and legs of a grown person: within this distance of the place, metres ...
const TRUNK_HALF_M: f32 = 0.15;
/// ... and between these heights above the floor, metres.
const TRUNK_HEIGHTS_M: [f32; 2] = [0.3, 1.4];
/// Evidence is read at points this far apart, metres: the edge of a usual voxel.
const STEP_M: f32 = 0.1;
/// A body was seen through where at least so many of its voxels are free ...
const FREE_MIN: usize = 8;
/// ... and so many for each that is occupied.
const FREE_PER_OCCUPIED: usize = 2;
/// Who stood is in so many pictures at one place ...
const STOOD_PICTURES: u32 = 3;
/// ... that is, within this distance, metres.
const ONE_PLACE_M: f32 = 0.3;
/// What only one or two pictures say holds this long before and after, seconds.
const SHORTLY_S: f64 = 1.0;

/// Boxes of one survey.
#[derive(Clone, Debug)]
pub struct PersonBoxes {
    standing: BoxIndex,
    /// With their times, seconds.
    shortly: Vec<(f64, RemovalBox)>,
}

/// Boxes that hold for one sweep.
#[derive(Clone, Debug)]
pub struct SweepBoxes<'a> {
    standing: &'a BoxIndex,
    shortly: Vec<RemovalBox>,
}

impl PersonBoxes {
    /// Of people in the pictures of a survey and of boxes that are given for all of it. Read it after the first pass of all surveys.
    /// `floor_m` is the height of the floor in the map. Cost: some 200 voxels for each sighting, and each pair of sightings.
    #[must_use]
    pub fn new<S: VoxelStore>(
        sightings: &[Sighting],
        given: &[RemovalBox],
        floor_m: f32,
        space: &FreeSpace<S>,
    ) -> Self {
        let (mut standing, mut shortly) = (given.to_vec(), Vec::new());
        for seen in sightings.iter().filter(|seen| !was_seen_through(space, seen.person_in_map, floor_m)) {
            let around = RemovalBox::around(seen.person_in_map, floor_m, RemovalSize::default());
            if pictures_at(sightings, seen.person_in_map) >= STOOD_PICTURES {
                standing.push(around);
            } else {
                shortly.push((seen.stamp.as_micros() as f64 * 1.0e-6, around));
            }
        }
        Self { standing: BoxIndex::new(&standing), shortly }
    }

    /// What holds for a sweep, by the time of its middle, seconds.
    #[must_use]
    pub fn of_sweep(&self, middle_s: f64) -> SweepBoxes<'_> {
        let near = self.shortly.iter().filter(|(time_s, _)| (time_s - middle_s).abs() <= SHORTLY_S);
        SweepBoxes { standing: &self.standing, shortly: near.map(|(_, each)| *each).collect() }
    }
}

impl SweepBoxes<'_> {
    /// Whether a point of the map leaves it.
    #[inline]
    #[must_use]
    pub fn contains(&self, point: Point3) -> bool {
        self.standing.contains(point) || self.shortly.iter().any(|each| each.contains(point))
    }
}

/// Pictures that show somebody at this place, from wherever.
fn pictures_at(sightings: &[Sighting], place: Point3) -> u32 {
    let is_here = |seen: &&Sighting| {
        let other = seen.person_in_map;
        let [x_m, y_m] = [other.x_m - place.x_m, other.y_m - place.y_m];
        x_m * x_m + y_m * y_m <= ONE_PLACE_M * ONE_PLACE_M
    };
    sightings.iter().filter(is_here).map(|seen| seen.count).fold(0, u32::saturating_add)
}

/// Whether rays went through the volume of a body at this place, before or after it was there.
fn was_seen_through<S: VoxelStore>(space: &FreeSpace<S>, person: Point3, floor_m: f32) -> bool {
    let (rule, mut reader) = (EvidenceRule::default(), space.reader());
    let [low_m, high_m] = TRUNK_HEIGHTS_M;
    let across = (2.0 * TRUNK_HALF_M / STEP_M).round() as i32;
    let up = ((high_m - low_m) / STEP_M).round() as i32;
    let (mut free, mut occupied) = (0, 0);
    for level in 0..=up {
        for row in 0..=across {
            for column in 0..=across {
                let at = |step: i32| STEP_M * step as f32 - TRUNK_HALF_M;
                let z_m = floor_m + low_m + STEP_M * level as f32;
                let point = Point3::new(person.x_m + at(column), person.y_m + at(row), z_m);
                match rule.read(reader.at(point)) {
                    Evidence::Free => free += 1,
                    Evidence::Occupied => occupied += 1,
                    Evidence::Unknown => {}
                }
            }
        }
    }
    free >= FREE_MIN && free >= FREE_PER_OCCUPIED * occupied
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_mapping::people_removal::{Block, FixedVoxels};
    use floorguard_types::geometry::Pose2;
    use floorguard_types::time::Stamp;

    fn seen(count: u32) -> Sighting {
        let person_in_map = Point3::new(1.9, 0.0, 1.0);
        Sighting {
            person_in_map,
            seen_from_in_map: Pose2::default(),
            stamp: Stamp::from_micros(4_000_000),
            count,
        }
    }

    /// A person at 2 m for `stays` of 40 sweeps, before a wall at 4 m.
    fn watched(stays: usize) -> FreeSpace<FixedVoxels<Vec<Block>>> {
        let mut space = FreeSpace::new(0.1, FixedVoxels::new(vec![Block::FREE; 4_096])).expect("voxels");
        for sweep in 0..40 {
            space.begin_sweep();
            for level in 0..12 {
                for column in -3..=3 {
                    let (y_m, z_m) = (0.05 * column as f32, 0.32 + 0.1 * level as f32);
                    let end_m = if sweep < stays { 1.9 } else { 4.0 };
                    space.hit(Point3::new(end_m, y_m, z_m));
                    space.pass(Point3::new(0.0, y_m, z_m), Point3::new(end_m - 0.15, y_m, z_m));
                }
            }
        }
        space
    }

    const BESIDE: Point3 = Point3::new(1.9, 0.3, 0.5);

    #[test]
    fn only_who_stood_gets_a_box() {
        let takes = |stays: usize| {
            PersonBoxes::new(&[seen(3)], &[], 0.0, &watched(stays)).of_sweep(60.0).contains(BESIDE)
        };
        assert!(takes(40), "stood all the time");
        assert!(!takes(5), "walked past");
        assert!(!takes(12), "left");
    }

    #[test]
    fn one_picture_counts_for_its_time() {
        let boxes = PersonBoxes::new(&[seen(1)], &[], 0.0, &watched(40));
        assert_eq!(
            [3.2, 4.9, 5.1].map(|time_s| boxes.of_sweep(time_s).contains(BESIDE)),
            [true, true, false]
        );
        let pair = [seen(1), seen(2)];
        assert!(PersonBoxes::new(&pair, &[], 0.0, &watched(40)).of_sweep(60.0).contains(BESIDE));
    }

    #[test]
    fn given_and_unseen_places_keep_their_boxes() {
        let space = FreeSpace::new(0.1, FixedVoxels::new(vec![Block::FREE; 16])).expect("voxels");
        assert!(PersonBoxes::new(&[seen(3)], &[], 0.0, &space).of_sweep(60.0).contains(BESIDE));
        let given = RemovalBox::around(Point3::new(1.9, 0.0, 1.0), 0.0, RemovalSize::default());
        assert!(PersonBoxes::new(&[], &[given], 0.0, &watched(5)).of_sweep(60.0).contains(BESIDE));
    }
}
