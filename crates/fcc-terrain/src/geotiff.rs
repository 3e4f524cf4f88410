//! GeoTIFF (OGC 19-008r4): heights in degrees of WGS-84.

use std::io::{Read, Seek};
use std::ops::Range;

use tiff::decoder::{Decoder, DecodingResult, Limits};
use tiff::tags::Tag;
use tiff::{ColorType, TiffError};

use crate::lattice::{Grid, Lattice, Overlap};

/// The largest part of an image that is unpacked at once, and the largest table in its
/// header, bytes.
const MOST_CHUNK_BYTES: usize = 64 << 20;
const MOST_TABLE_BYTES: usize = 4 << 20;
/// The largest image, in posts of a side.
const MOST_POSTS: u32 = 200_000;
/// What puts an image into degrees of WGS-84 with heights above mean sea level.
const WARP: &str = "convert it by gdalwarp -t_srs EPSG:4326";

/// A GeoTIFF whose header was read.
pub(crate) struct GeoTiff<R: Read + Seek> {
    pub(crate) lattice: Lattice,
    decoder: Decoder<R>,
    nodata: Option<f64>,
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

    /// Whether posts are in the middles of the pixels.
    fn check(&self) -> Result<bool, String> {
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
        if let Some(unit) = self.value(VERTICAL_UNITS).filter(|unit| *unit != 9_001) {
            return Err(format!(
                "its heights are in unit {unit}: give them in m, 9001"
            ));
        }
        match self.value(RASTER_TYPE) {
            None | Some(1) => Ok(true),
            Some(2) => Ok(false),
            Some(other) => Err(format!("its raster type is {other}: give 1 or 2")),
        }
    }
}

fn lattice(
    (columns, rows): (u32, u32),
    is_area: bool,
    scale: &[f64],
    tie: &[f64],
) -> Result<Lattice, String> {
    let (&[east_deg, north_deg, ..], &[i, j, _, x, y, _]) = (scale, tie) else {
        return Err(format!(
            "does not say where it is by one tie point and a scale: {WARP}"
        ));
    };
    let is_good = |deg: f64| deg.is_finite() && (1e-7..=1.0).contains(&deg);
    if !is_good(east_deg) || !is_good(north_deg) {
        return Err(format!(
            "its posts are {east_deg}° and {north_deg}° apart: give 0.0000001 to 1"
        ));
    }
    let middle = if is_area { 0.5 } else { 0.0 };
    let lattice = Lattice {
        north_deg: y - (middle - j) * north_deg,
        west_deg: x + (middle - i) * east_deg,
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

impl<R: Read + Seek> GeoTiff<R> {
    /// Reads the header.
    pub(crate) fn read(from: R) -> Result<Self, String> {
        let mut limits = Limits::default();
        limits.decoding_buffer_size = MOST_CHUNK_BYTES;
        limits.intermediate_buffer_size = MOST_CHUNK_BYTES;
        limits.ifd_value_size = MOST_TABLE_BYTES;
        let opened = Decoder::new(from).map_err(|error| broken(&error))?;
        let mut decoder = opened.with_limits(limits);
        let size = decoder.dimensions().map_err(|error| broken(&error))?;
        if !(2..=MOST_POSTS).contains(&size.0) || !(2..=MOST_POSTS).contains(&size.1) {
            return Err(format!(
                "has {} times {} pixels: give 2 to {MOST_POSTS}",
                size.0, size.1
            ));
        }
        let color = decoder.colortype().map_err(|error| broken(&error))?;
        if !matches!(color, ColorType::Gray(_)) {
            return Err(format!("has {color:?}, not one band of heights: select it"));
        }
        let mut tag = |tag: Tag| decoder.find_tag(tag).map_err(|error| broken(&error));
        let mut numbers = |of: Tag| {
            let value = tag(of)?.map(tiff::decoder::ifd::Value::into_f64_vec);
            let numbers = value.transpose().map_err(|error| broken(&error))?;
            Ok::<_, String>(numbers.unwrap_or_default())
        };
        if !numbers(Tag::ModelTransformationTag)?.is_empty() {
            return Err(format!("is rotated: {WARP}"));
        }
        let (scale, tie) = (
            numbers(Tag::ModelPixelScaleTag)?,
            numbers(Tag::ModelTiepointTag)?,
        );
        let keys = tag(Tag::GeoKeyDirectoryTag)?
            .ok_or("has no GeoKeys: it is a TIFF, and no GeoTIFF")?
            .into_u16_vec()
            .map_err(|error| broken(&error))?;
        let is_area = GeoKeys(keys).check()?;
        let nodata = tag(Tag::GdalNodata)?
            .map(tiff::decoder::ifd::Value::into_string)
            .transpose()
            .map_err(|error| broken(&error))?;
        let nodata = nodata
            .map(|text| {
                let text = text.trim_matches(['\0', ' ']);
                let number = text.parse();
                number.map_err(|_| format!("its GDAL_NODATA is no number: {text:.20}"))
            })
            .transpose()?;
        Ok(Self {
            lattice: lattice(size, is_area, &scale, &tie)?,
            decoder,
            nodata,
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
        for down in chunks(&overlap.rows, height) {
            for right in chunks(&overlap.columns, width) {
                let index = u32::try_from(down * across + right)
                    .map_err(|_| "has too many parts".to_owned())?;
                let heights_m = self.chunk(index)?;
                let (columns, rows) = self.decoder.chunk_data_dimensions(index);
                let (columns, rows) = (columns as usize, rows as usize);
                if heights_m.len() < columns * rows {
                    return Err(format!("part {index} is shorter than it says"));
                }
                let lines = heights_m.chunks_exact(columns.max(1)).take(rows);
                for (row, line) in lines.enumerate() {
                    let row = down * height + row;
                    for (column, height_m) in line.iter().enumerate() {
                        let column = right * width + column;
                        if overlap.rows.contains(&row) && overlap.columns.contains(&column) {
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
            DecodingResult::U8(values) => heights_m(values, self.nodata),
            DecodingResult::U16(values) => heights_m(values, self.nodata),
            DecodingResult::U32(values) => heights_m(values, self.nodata),
            DecodingResult::I8(values) => heights_m(values, self.nodata),
            DecodingResult::I16(values) => heights_m(values, self.nodata),
            DecodingResult::I32(values) => heights_m(values, self.nodata),
            DecodingResult::F32(values) => heights_m(values, self.nodata),
            DecodingResult::F64(values) => heights_m(values, self.nodata),
            _ => {
                return Err("has heights of a type that is not read: give 16 or 32 bits".to_owned());
            }
        })
    }
}

fn heights_m(values: Vec<impl Into<f64>>, nodata: Option<f64>) -> Vec<f32> {
    let height_m = |value: f64| match nodata {
        // A void of 32 bits is written with more digits than it has.
        Some(nodata) if value == nodata || value as f32 == nodata as f32 => f32::NAN,
        _ => value as f32,
    };
    let values = values.into_iter().map(Into::into);
    values.map(height_m).collect()
}
