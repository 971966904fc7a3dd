//! The file of a model: a header with version, generation, length and checksum, and the packed content behind it.
//!
//! | bytes | content |
//! |---|---|
//! | 8 | `FLGENV\r\n`: a transfer that treats it as text is found out |
//! | 2 | version of the format |
//! | 8 | generation: how often the model was saved |
//! | 4 | length of the content |
//! | 4 | CRC-32 (ISO-HDLC) of everything above and of the content |
//! | … | the content, packed with zlib |

use std::io::{Read as _, Write as _};

use anyhow::{Context, bail, ensure};
use crc::{CRC_32_ISO_HDLC, Crc};
use floorguard_mapping::environment::{
    Complex, Contest, DirtPerVisit, DirtSeen, Environment, HeatCell, HourBin, Place, PlaceSlice,
    SpectrumParts, WallTime, Week,
};
use floorguard_types::geometry::Point2;

use super::bytes::{Reader, Writer};
use super::calendar::Calendar;
use super::model::{HOURS, Model, PERIODS};
use super::zones::Zone;

/// Version of the format.
pub const FORMAT_VERSION: u16 = 2;
const MAGIC: &[u8; 8] = b"FLGENV\r\n";
const HEADER: usize = 8 + 2 + 8 + 4;
const CHECKSUM: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);
/// Largest content that is unpacked: the largest model is about 120 MB.
const CONTENT_MAX: u64 = 512 * 1_024 * 1_024;

/// The bytes of a model.
///
/// # Errors
/// None in practice: memory.
pub fn encode(model: &Model) -> anyhow::Result<Vec<u8>> {
    let mut packer = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
    packer.write_all(&content(model).0)?;
    let packed = packer.finish()?;
    let mut file = Writer::default();
    file.bytes(MAGIC);
    file.u16(FORMAT_VERSION);
    file.i64(model.generation as i64);
    file.u32(u32::try_from(packed.len()).context("the model is too large for its file")?);
    let checksum = checksum(&file.0, &packed);
    file.u32(checksum);
    file.bytes(&packed);
    Ok(file.0)
}

fn checksum(header: &[u8], packed: &[u8]) -> u32 {
    let mut digest = CHECKSUM.digest();
    digest.update(header);
    digest.update(packed);
    digest.finalize()
}

/// The model of some bytes.
///
/// # Errors
/// What is no model, was made by a newer program, is cut short or damaged.
pub fn decode(bytes: &[u8]) -> anyhow::Result<Model> {
    let mut reader = Reader(bytes);
    if reader.bytes(8).ok() != Some(MAGIC.as_slice()) {
        bail!("this is no environment model of floorguard");
    }
    let version = reader.u16()?;
    ensure!(
        version == FORMAT_VERSION,
        "version {version} of the format; this program reads version {FORMAT_VERSION}"
    );
    let generation = reader.i64()? as u64;
    let length = reader.u32()? as usize;
    let expected = reader.u32()?;
    let packed = reader.0;
    ensure!(
        packed.len() == length,
        "{} bytes of content where {length} were written: cut short or damaged",
        packed.len()
    );
    let header = bytes.get(..HEADER).unwrap_or_default();
    ensure!(checksum(header, packed) == expected, "the checksum is wrong: the file is damaged");
    let mut content = Vec::new();
    flate2::read::ZlibDecoder::new(packed).take(CONTENT_MAX).read_to_end(&mut content)?;
    let mut model = read_content(&mut Reader(&content))?;
    model.generation = generation;
    Ok(model)
}

fn content(model: &Model) -> Writer {
    let mut to = Writer::default();
    to.text(&model.name);
    to.text(model.calendar.name());
    let places = model.core.places.grid();
    let geometry = places.geometry();
    to.u16(geometry.width());
    to.u16(geometry.height());
    to.f32(geometry.origin_in_map().x_m);
    to.f32(geometry.origin_in_map().y_m);
    to.i64(model.core.newest().map_or(i64::MIN, WallTime::as_micros));
    to.f32(model.per_visit.units);
    to.f32(model.per_visit.visits);
    to.u16(model.zones.len().min(usize::from(u16::MAX)) as u16);
    for zone in model.zones.iter().take(usize::from(u16::MAX)) {
        to.text(&zone.name);
        to.u8(u8::from(zone.is_always_dry));
        to.u8(zone.corners.len() as u8);
        for corner in &zone.corners {
            to.f32(corner.x_m);
            to.f32(corner.y_m);
        }
    }
    for cell in model.core.heat.cells().values() {
        to.u32(cell.visits);
        to.u32(cell.dwell_cs);
        to.u32(cell.watched_cs);
    }
    let entries: Vec<_> = model.core.heat.hours().iter().collect();
    to.u32(entries.len() as u32);
    for entry in entries {
        let (cell, hour) = entry.cell_and_hour().unwrap_or_default();
        to.u32(cell as u32);
        to.u8(hour);
        to.u16(entry.visits);
        to.u32(entry.dwell_cs);
    }
    places.values().iter().for_each(|place| write_place(&mut to, place));
    to
}

fn write_place(to: &mut Writer, place: &Place<HOURS, PERIODS>) {
    if *place == Place::EMPTY {
        return to.u8(0);
    }
    to.u8(1);
    for bin in place.week.bins() {
        to.u16(bin.visits);
        to.u32(bin.watched_ds);
    }
    let parts = place.spectrum.parts();
    to.f32(parts.weight);
    to.f32(parts.sum);
    to.i64(parts.span.map_or(i64::MIN, |span| span.0));
    to.i64(parts.span.map_or(i64::MIN, |span| span.1));
    for sums in parts.signal.iter().chain(&parts.sampling) {
        to.f32(sums.re);
        to.f32(sums.im);
    }
    let (losses, weight) = place.contest.parts();
    losses.iter().chain([&weight, &place.spread.0, &place.spread.1]).for_each(|value| to.f32(*value));
    to.u32(place.stays.0);
    to.u32(place.stays.1);
    to.f32(place.dirt.units);
    to.f32(place.dirt.hours);
    to.i64(place.cleaned.map_or(i64::MIN, |(at, _)| at.as_micros()));
    to.f32(place.cleaned.map_or(0.0, |(_, left)| left));
    let slice = place.slice();
    to.i64(slice.number);
    to.u16(slice.visits);
    to.u32(slice.watched_cs);
}

fn read_content(from: &mut Reader) -> anyhow::Result<Model> {
    let (name, calendar) = (from.text()?, Calendar::named(&from.text()?)?);
    let sides = (from.u16()?, from.u16()?);
    let corner = Point2::new(from.f32()?, from.f32()?);
    let newest = Some(from.i64()?).filter(|micros| *micros != i64::MIN).map(WallTime::from_micros);
    let mut model = Model::of_places(&name, calendar, sides, corner)?;
    model.per_visit = DirtPerVisit { units: from.f32()?, visits: from.f32()? };
    for _ in 0..from.u16()? {
        let (name, is_always_dry, count) = (from.text()?, from.u8()? != 0, from.u8()?);
        let corners =
            (0..count).map(|_| Ok(Point2::new(from.f32()?, from.f32()?))).collect::<anyhow::Result<_>>()?;
        model.zones.push(Zone::new(name, corners, is_always_dry)?);
    }
    for cell in model.core.heat.cells_mut().values_mut() {
        *cell = HeatCell { visits: from.u32()?, dwell_cs: from.u32()?, watched_cs: from.u32()? };
    }
    for _ in 0..from.u32()? {
        let (cell, hour, visits, dwell_cs) = (from.u32()?, from.u8()?, from.u16()?, from.u32()?);
        model.core.heat.hours_mut().add(cell as usize, hour, visits, dwell_cs);
    }
    for place in model.core.places.grid_mut().values_mut() {
        if from.u8()? != 0 {
            *place = read_place(from)?;
        }
    }
    ensure!(from.0.is_empty(), "{} bytes too many", from.0.len());
    let Environment { heat, places, .. } = *model.core;
    model.core = Box::new(Environment::new(heat, places, newest));
    Ok(model)
}

fn read_place(from: &mut Reader) -> anyhow::Result<Place<HOURS, PERIODS>> {
    let mut place = Place::EMPTY;
    let mut bins = [HourBin::default(); HOURS];
    for bin in &mut bins {
        *bin = HourBin { visits: from.u16()?, watched_ds: from.u32()? };
    }
    place.week = Week::from_bins(bins);
    let (weight, sum) = (from.f32()?, from.f32()?);
    let (first, last) = (from.i64()?, from.i64()?);
    let mut signal = [Complex::default(); PERIODS];
    let mut sampling = signal;
    for sums in signal.iter_mut().chain(&mut sampling) {
        *sums = Complex { re: from.f32()?, im: from.f32()? };
    }
    let span = (first != i64::MIN).then_some((first, last));
    place.spectrum.restore(SpectrumParts { weight, sum, span, signal, sampling });
    let mut losses = *Contest::EMPTY.parts().0;
    for loss in &mut losses {
        *loss = from.f32()?;
    }
    place.contest = Contest::from_parts(losses, from.f32()?);
    place.spread = (from.f32()?, from.f32()?);
    place.stays = (from.u32()?, from.u32()?);
    place.dirt = DirtSeen { units: from.f32()?, hours: from.f32()? };
    let (cleaned, left) = (from.i64()?, from.f32()?);
    place.cleaned = (cleaned != i64::MIN).then_some((WallTime::from_micros(cleaned), left));
    place.restore_slice(PlaceSlice { number: from.i64()?, visits: from.u16()?, watched_cs: from.u32()? });
    Ok(place)
}
