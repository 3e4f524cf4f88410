//! GeoTIFF (OGC 19-008r4): heights in degrees of WGS-84.

use std::io::{Read, Seek};
use std::ops::Range;

use tiff::decoder::{Decoder, DecodingResult, Limits};
use tiff::tags::Tag;
use tiff::{ColorType, TiffError};

use crate::gdal::Values;
use crate::lattice::{Grid, Lattice, Overlap};

/// The largest part of an image that is unpacked at once, and the largest table in its
/// header, bytes.
const MOST_CHUNK_BYTES: usize = 64 << 20;
const MOST_TABLE_BYTES: usize = 4 << 20;
/// The largest image, in posts of a side.
const MOST_POSTS: u32 = 200_000;
/// The tag of GDAL for what no other one says.
const GDAL_METADATA: u16 = 42_112;
/// What puts an image into degrees of WGS-84 with heights above mean sea level.
const WARP: &str = "convert it by gdalwarp -t_srs EPSG:4326";

/// About a tile whose voids are in a mask.
pub(crate) const MASKED: &str = "has voids in a mask: put them into the heights, by gdalwarp -dstnodata \
                                 -32768";
/// Of an image that is the mask of another one (TIFF 6.0, `NewSubfileType`).
const IS_MASK: u32 = 4;
/// Images in a file, more than heights, overviews and their masks are.
const MOST_IMAGES: usize = 64;

/// A GeoTIFF whose header was read.
pub(crate) struct GeoTiff<R: Read + Seek> {
    pub(crate) lattice: Lattice,
    decoder: Decoder<R>,
    values: Values,
    /// Whether its first row is the southernmost.
    is_south_up: bool,
}

/// Why a compression is not read; none for those that are (TIFF 6.0, GDAL).
fn unread(compression: u16) -> Option<String> {
    let name = match compression {
        1 | 5 | 7 | 8 | 32_773 | 32_946 => return None,
        34_887 => "LERC".to_owned(),
        50_000 => "ZSTD".to_owned(),
        34_925 => "LZMA".to_owned(),
        50_001 => "WebP".to_owned(),
        50_002 | 52_546 => "JPEG XL".to_owned(),
        other => format!("method {other}"),
    };
    Some(format!(
        "is compressed by {name}, which is not read: convert it by gdal_translate -co \
         COMPRESS=DEFLATE"
    ))
}

fn broken(error: &TiffError) -> String {
    format!("is no TIFF that can be read: {error}")
}

/// The keys of the directory whose values are in it.
struct GeoKeys(Vec<u16>);

impl GeoKeys {
    fn value(&self, wanted: u16) -> Option<u16> {
        let mut entries = self.0.chunks_exact(4).skip(1);
        entries.find_map(|entry| match entry {
            [key, 0, _, value] if *key == wanted => Some(*value),
            _ => None,
        })
    }

    /// Whether posts are in the middles of the pixels, and m in the unit of heights.
    fn check(&self) -> Result<(bool, f64), String> {
        const MODEL_TYPE: u16 = 1_024;
        const RASTER_TYPE: u16 = 1_025;
        const GEODETIC_CRS: u16 = 2_048;
        const ANGULAR_UNITS: u16 = 2_054;
        const VERTICAL: u16 = 4_096;
        const VERTICAL_UNITS: u16 = 4_099;
        match self.value(MODEL_TYPE) {
            Some(2) => {}
            Some(1) => return Err(format!("is in metres of a map's projection: {WARP}")),
            _ => return Err(format!("does not say that it is in degrees: {WARP}")),
        }
        match self.value(GEODETIC_CRS) {
            Some(4_326) => {}
            Some(4_979) => {
                return Err(
                    "its heights are above the ellipsoid: convert them to heights above \
                            mean sea level"
                        .to_owned(),
                );
            }
            other => {
                let which = other.map_or("none".to_owned(), |code| format!("EPSG {code}"));
                return Err(format!("its datum is {which}, not WGS-84: {WARP}"));
            }
        }
        if let Some(unit) = self.value(ANGULAR_UNITS).filter(|unit| *unit != 9_102) {
            return Err(format!(
                "its angles are in unit {unit}, not degrees: {WARP}"
            ));
        }
        // Above EGM96, EGM2008, and mean sea level.
        let vertical = self.value(VERTICAL);
        if let Some(datum) = vertical.filter(|datum| ![5_773, 3_855, 5_714].contains(datum)) {
            return Err(format!(
                "its heights are above EPSG {datum}: give heights above mean sea level, EPSG 5773 \
                 or 3855"
            ));
        }
        let unit_m = match self.value(VERTICAL_UNITS) {
            None | Some(9_001) => 1.0,
            Some(9_002) => 0.304_8,
            Some(9_003) => 1_200.0 / 3_937.0,
            Some(unit) => {
                return Err(format!(
                    "its heights are in unit {unit}: give them in m, 9001, or ft, 9002"
                ));
            }
        };
        match self.value(RASTER_TYPE) {
            None | Some(1) => Ok((true, unit_m)),
            Some(2) => Ok((false, unit_m)),
            Some(other) => Err(format!("its raster type is {other}: give 1 or 2")),
        }
    }
}

/// Where the pixels are: the corner of the first, or its middle, and the way to the next column
/// and to the next row, in degrees.
struct Raster {
    west_deg: f64,
    first_deg: f64,
    east_deg: f64,
    north_deg: f64,
}

impl Raster {
    /// By a matrix, which GDAL writes where rows do not go to the south, or by a tie point and
    /// a scale.
    fn of(matrix: &[f64], scale: &[f64], tie: &[f64]) -> Result<Self, String> {
        match (matrix, scale, tie) {
            (&[east_deg, 0.0, _, west_deg, 0.0, north_deg, _, first_deg, ..], ..) => Ok(Self {
                west_deg,
                first_deg,
                east_deg,
                north_deg,
            }),
            (&[_, ..], ..) => Err(format!("is rotated: {WARP}")),
            ([], &[east_deg, south_deg, ..], &[i, j, _, x, y, _]) => Ok(Self {
                west_deg: x - i * east_deg,
                first_deg: y + j * south_deg,
                east_deg,
                north_deg: -south_deg,
            }),
            _ => Err(format!(
                "does not say where it is by one tie point and a scale: {WARP}"
            )),
        }
    }

    /// Whether the first row is the southernmost.
    fn is_south_up(&self) -> bool {
        self.north_deg > 0.0
    }
}

fn lattice((columns, rows): (u32, u32), is_area: bool, raster: &Raster) -> Result<Lattice, String> {
    let (east_deg, north_deg) = (raster.east_deg, raster.north_deg.abs());
    if east_deg < 0.0 {
        return Err(format!("its columns go to the west: {WARP}"));
    }
    let is_good = |deg: f64| deg.is_finite() && (1e-7..=1.0).contains(&deg);
    if !is_good(east_deg) || !is_good(north_deg) {
        return Err(format!(
            "its posts are {east_deg}° and {north_deg}° apart: give 0.0000001 to 1"
        ));
    }
    let middle = if is_area { 0.5 } else { 0.0 };
    let northernmost = if raster.is_south_up() {
        f64::from(rows) - 1.0
    } else {
        0.0
    };
    let lattice = Lattice {
        north_deg: raster.first_deg + (northernmost + middle) * raster.north_deg,
        west_deg: raster.west_deg + middle * east_deg,
        posts_per_degree: [1.0 / north_deg, 1.0 / east_deg],
        rows: rows as usize,
        columns: columns as usize,
    };
    let south_deg = lattice.north_deg - (f64::from(rows) - 1.0) * north_deg;
    let is_on_earth = (-90.5..=90.5).contains(&south_deg)
        && (-90.5..=90.5).contains(&lattice.north_deg)
        && (-360.0..=360.0).contains(&lattice.west_deg)
        && (f64::from(columns) - 1.0) * east_deg <= 360.0;
    if !is_on_earth {
        return Err("its corners are not on the earth: are they in degrees?".to_owned());
    }
    Ok(lattice)
}

/// Whether one of the images behind the first one is a mask.
fn has_mask<R: Read + Seek>(decoder: &mut Decoder<R>) -> Result<bool, TiffError> {
    let mut next = decoder.image_ifd().directory().next();
    for _ in 0..MOST_IMAGES {
        let Some(pointer) = next else { break };
        let image = decoder.read_directory(pointer)?;
        let mut tags = decoder.read_directory_tags(&image);
        let kind = tags.find_tag_unsigned::<u32>(Tag::NewSubfileType)?;
        if kind.is_some_and(|kind| kind & IS_MASK != 0) {
            return Ok(true);
        }
        next = image.next();
    }
    Ok(false)
}

impl<R: Read + Seek> GeoTiff<R> {
    /// Reads the header.
    pub(crate) fn read(from: R) -> Result<Self, String> {
        let mut limits = Limits::default();
        limits.decoding_buffer_size = MOST_CHUNK_BYTES;
        limits.intermediate_buffer_size = MOST_CHUNK_BYTES;
        limits.ifd_value_size = MOST_TABLE_BYTES;
        let opened = Decoder::new(from).map_err(|error| broken(&error))?;
        let mut decoder = opened.with_limits(limits);
        let compression = decoder.find_tag(Tag::Compression);
        let compression = compression.map_err(|error| broken(&error))?;
        let compression = compression.and_then(|value| value.into_u16().ok());
        if let Some(why) = compression.and_then(unread) {
            return Err(why);
        }
        let size = decoder.dimensions().map_err(|error| broken(&error))?;
        if !(2..=MOST_POSTS).contains(&size.0) || !(2..=MOST_POSTS).contains(&size.1) {
            return Err(format!(
                "has {} times {} pixels: give 2 to {MOST_POSTS}",
                size.0, size.1
            ));
        }
        if has_mask(&mut decoder).map_err(|error| broken(&error))? {
            return Err(MASKED.to_owned());
        }
        let color = decoder.colortype().map_err(|error| broken(&error))?;
        if !matches!(color, ColorType::Gray(_)) {
            let many = "has several bands, not one of heights: select it, by gdal_translate -b";
            return Err(many.to_owned());
        }
        let mut tag = |tag: Tag| decoder.find_tag(tag).map_err(|error| broken(&error));
        let mut numbers = |of: Tag| {
            let value = tag(of)?.map(tiff::decoder::ifd::Value::into_f64_vec);
            let numbers = value.transpose().map_err(|error| broken(&error))?;
            Ok::<_, String>(numbers.unwrap_or_default())
        };
        let raster = Raster::of(
            &numbers(Tag::ModelTransformationTag)?,
            &numbers(Tag::ModelPixelScaleTag)?,
            &numbers(Tag::ModelTiepointTag)?,
        )?;
        let keys = tag(Tag::GeoKeyDirectoryTag)?
            .ok_or("has no GeoKeys: it is a TIFF, and no GeoTIFF")?
            .into_u16_vec()
            .map_err(|error| broken(&error))?;
        let (is_area, unit_m) = GeoKeys(keys).check()?;
        let mut text = |of: Tag| {
            let value = tag(of)?.map(tiff::decoder::ifd::Value::into_string);
            value.transpose().map_err(|error| broken(&error))
        };
        let metadata = text(Tag::Unknown(GDAL_METADATA))?.unwrap_or_default();
        let values = Values::of(text(Tag::GdalNodata)?.as_deref(), &metadata, unit_m)?;
        Ok(Self {
            lattice: lattice(size, is_area, &raster)?,
            is_south_up: raster.is_south_up(),
            decoder,
            values,
        })
    }

    /// Puts the heights of an overlap into a grid.
    pub(crate) fn put(&mut self, overlap: &Overlap, grid: &mut Grid) -> Result<(), String> {
        let (width, height) = self.decoder.chunk_dimensions();
        let (width, height) = (width.max(1) as usize, height.max(1) as usize);
        let across = self.lattice.columns.div_ceil(width);
        let chunks =
            |range: &Range<usize>, size: usize| range.start / size..range.end.div_ceil(size);
        if overlap.columns.is_empty() {
            return Ok(());
        }
        let last = self.lattice.rows - 1;
        let is_south_up = self.is_south_up;
        let in_file = |row: usize| if is_south_up { last - row } else { row };
        let rows = &overlap.rows;
        let rows = if is_south_up && !rows.is_empty() {
            in_file(rows.end - 1)..in_file(rows.start) + 1
        } else {
            rows.clone()
        };
        for down in chunks(&rows, height) {
            for right in chunks(&overlap.columns, width) {
                let index = u32::try_from(down * across + right)
                    .map_err(|_| "has too many parts".to_owned())?;
                let heights_m = self.chunk(index)?;
                let (columns, lines) = self.decoder.chunk_data_dimensions(index);
                let (columns, lines) = (columns as usize, lines as usize);
                if heights_m.len() < columns * lines {
                    return Err(format!("part {index} is shorter than it says"));
                }
                let lines = heights_m.chunks_exact(columns.max(1)).take(lines);
                for (row, line) in lines.enumerate() {
                    let row = down * height + row;
                    if !rows.contains(&row) {
                        continue;
                    }
                    let row = in_file(row);
                    for (column, height_m) in line.iter().enumerate() {
                        let column = right * width + column;
                        if overlap.columns.contains(&column) {
                            grid.put(overlap, row, column, *height_m)?;
                        }
                    }
                }
            }
        }
        Ok(())
    }

    /// The heights of a part of the image; not numbers where they are not known.
    fn chunk(&mut self, index: u32) -> Result<Vec<f32>, String> {
        let read = self.decoder.read_chunk(index);
        let read = read.map_err(|error| format!("part {index} cannot be read: {error}"))?;
        Ok(match read {
            DecodingResult::U8(values) => heights_m(values, &self.values),
            DecodingResult::U16(values) => heights_m(values, &self.values),
            DecodingResult::U32(values) => heights_m(values, &self.values),
            DecodingResult::I8(values) => heights_m(values, &self.values),
            DecodingResult::I16(values) => heights_m(values, &self.values),
            DecodingResult::I32(values) => heights_m(values, &self.values),
            DecodingResult::F32(values) => heights_m(values, &self.values),
            DecodingResult::F64(values) => heights_m(values, &self.values),
            _ => {
                return Err("has heights of a type that is not read: give 16 or 32 bits".to_owned());
            }
        })
    }
}

fn heights_m(raw: Vec<impl Into<f64>>, values: &Values) -> Vec<f32> {
    let raw = raw.into_iter().map(Into::into);
    raw.map(|value| values.height_m(value)).collect()
}
