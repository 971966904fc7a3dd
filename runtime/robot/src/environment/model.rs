//! The environment model of a Linux computer: the core's, with capacity for a large hall, a calendar and named
//! zones.

use anyhow::ensure;
use floorguard_mapping::GridGeometry;
use floorguard_mapping::environment::{
    DirtPerVisit, Environment, HEAT_CELL_M, HeatCell, HourEntry, PLACE_CELL_M, PeopleHeat, Place, Places,
    WallTime,
};
use floorguard_types::geometry::Point2;

use super::calendar::Calendar;
use super::zones::Zone;

/// Bins of the histogram: the hours of a week.
pub const HOURS: usize = 168;
/// Periods of the spectrum: a week, and its parts down to two hours (the larger set of the reference; book,
/// Environment: Spectrum).
pub const PERIODS: usize = 84;
/// Tracks followed at once, and cells remembered of each.
const TRACKS: usize = 128;
const RECENT: usize = 48;
/// Largest side of a map, metres: a large hall.
const SIDE_MAX_M: f32 = 200.0;
/// Entries of the hour table: at least, at most, and for each cell.
const ENTRIES: (usize, usize, usize) = (1 << 12, 1 << 21, 24);

/// The core's model with storage on the heap.
pub type CoreModel =
    Environment<Vec<HeatCell>, Vec<HourEntry>, Vec<Place<HOURS, PERIODS>>, HOURS, PERIODS, TRACKS, RECENT>;

/// A place and what is known of it.
pub struct Model {
    /// Name for answers.
    pub name: String,
    /// The clock on the wall.
    pub calendar: Calendar,
    /// Zones by name; none: the map is divided.
    pub zones: Vec<Zone>,
    /// What a visitor leaves on the floor.
    pub per_visit: DirtPerVisit,
    /// What was learned of people and places.
    pub core: Box<CoreModel>,
    /// How often it was saved.
    pub generation: u64,
}

impl Model {
    /// An empty model over the rectangle between two corners in the map frame, widened to whole places.
    ///
    /// # Errors
    /// A rectangle that is empty or larger than a model can hold.
    pub fn over(name: &str, calendar: Calendar, (low, high): (Point2, Point2)) -> anyhow::Result<Self> {
        let floor = |value_m: f32| (value_m / PLACE_CELL_M).floor();
        let sides = (floor(high.x_m) + 1.0 - floor(low.x_m), floor(high.y_m) + 1.0 - floor(low.y_m));
        let largest = SIDE_MAX_M / PLACE_CELL_M;
        ensure!(
            sides.0 >= 1.0 && sides.1 >= 1.0 && sides.0 <= largest && sides.1 <= largest,
            "a model covers up to {SIDE_MAX_M} m × {SIDE_MAX_M} m, not {:.1} m × {:.1} m",
            high.x_m - low.x_m,
            high.y_m - low.y_m
        );
        let corner = Point2::new(floor(low.x_m) * PLACE_CELL_M, floor(low.y_m) * PLACE_CELL_M);
        Self::of_places(name, calendar, (sides.0 as u16, sides.1 as u16), corner)
    }

    /// An empty model of so many places from a corner on.
    ///
    /// # Errors
    /// Sides or a corner that make no raster.
    pub fn of_places(
        name: &str,
        calendar: Calendar,
        (wide, high): (u16, u16),
        corner: Point2,
    ) -> anyhow::Result<Self> {
        let fine_cells = (PLACE_CELL_M / HEAT_CELL_M).round() as u16;
        let most = (SIDE_MAX_M / PLACE_CELL_M) as u16;
        ensure!(
            (1..=most).contains(&wide) && (1..=most).contains(&high),
            "{wide} × {high} places make no model"
        );
        let raster = |factor: u16, edge_m: f32| {
            GridGeometry::new(wide * factor, high * factor, edge_m, corner)
                .ok_or_else(|| anyhow::anyhow!("the corner {corner:?} makes no raster"))
        };
        let (fine, coarse) = (raster(fine_cells, HEAT_CELL_M)?, raster(1, PLACE_CELL_M)?);
        let entries = (fine.cell_count() * ENTRIES.2).clamp(ENTRIES.0, ENTRIES.1);
        let heat = PeopleHeat::new(
            fine,
            vec![HeatCell::default(); fine.cell_count()],
            vec![HourEntry::NOTHING; entries],
        )?;
        let places = Places::new(coarse, vec![Place::EMPTY; coarse.cell_count()])?;
        let core = Box::new(Environment::new(heat, places, None));
        Ok(Self {
            name: name.to_owned(),
            calendar,
            zones: Vec::new(),
            per_visit: DirtPerVisit::PRIOR,
            core,
            generation: 0,
        })
    }

    /// Learns all that was seen up to a moment: the watching ends there.
    pub fn settle(&mut self, at: WallTime) {
        let offset_s = self.calendar.offset_s(at);
        self.core.places.turn_to(at, offset_s);
        self.core.places.close(offset_s);
    }

    /// The zones by name, or the map in tiles of about eight metres, `A1` in the lower left corner.
    #[must_use]
    pub fn zones_or_tiles(&self) -> Vec<Zone> {
        if self.zones.is_empty() {
            Zone::tiles(self.core.places.grid().geometry())
        } else {
            self.zones.clone()
        }
    }

    /// The places of a zone, by index.
    #[must_use]
    pub fn places_of(&self, zone: &Zone) -> Vec<usize> {
        let geometry = self.core.places.grid().geometry();
        let inside = |index: &usize| zone.contains(geometry.centre(*index));
        let mut all: Vec<usize> = (0..geometry.cell_count()).filter(inside).collect();
        if all.is_empty() {
            // A zone smaller than a place lies in the one around its middle.
            all.extend(geometry.cell_at(zone.middle()));
        }
        all
    }
}
