//! Tiles that are made.

use std::io::Cursor;

use fcc_terrain::{Area, Elevations, TerrainError};
use tiff::encoder::colortype::{Gray8, Gray16, Gray32Float, GrayI16};
use tiff::encoder::{Compression, TiffEncoder, TiffValue};
use tiff::tags::Tag;

pub(crate) const MOST_BYTES: u64 = 256_000_000;

/// An `.hgt` of 3 seconds of arc: the height of each post by its row from the north and
/// its column from the west.
pub(crate) fn hgt(height_m: impl Fn(usize, usize) -> i16) -> Vec<u8> {
    const SIDE: usize = 1_201;
    let mut bytes = Vec::with_capacity(2 * SIDE * SIDE);
    for row in 0..SIDE {
        for column in 0..SIDE {
            bytes.extend(height_m(row, column).to_be_bytes());
        }
    }
    bytes
}

/// A GeoTIFF of 20 by 10 posts, 0.01° apart, whose first is at 47° north and 8° east, as
/// its keys say; a post is 10 times its row and its column.
#[derive(Clone)]
pub(crate) struct Made {
    pub(crate) keys: Vec<[u16; 4]>,
    pub(crate) tie: Vec<f64>,
    pub(crate) scale: Vec<f64>,
    pub(crate) nodata: Option<&'static str>,
    pub(crate) compression: Compression,
    pub(crate) has_keys: bool,
    /// Columns and rows.
    pub(crate) size: (u32, u32),
    /// Instead of a tie point and a scale.
    pub(crate) matrix: Vec<f64>,
    /// Items of `GDAL_METADATA`.
    pub(crate) metadata: &'static str,
    /// `NewSubfileType` of a second image, if there is one.
    pub(crate) second: Option<u32>,
}

impl Default for Made {
    fn default() -> Self {
        Self {
            // Geographic, pixel is point, WGS-84.
            keys: vec![[1_024, 0, 1, 2], [1_025, 0, 1, 2], [2_048, 0, 1, 4_326]],
            tie: vec![0.0, 0.0, 0.0, 8.0, 47.0, 0.0],
            scale: vec![0.01, 0.01, 0.0],
            nodata: None,
            compression: Compression::Uncompressed,
            has_keys: true,
            size: (COLUMNS, ROWS),
            matrix: Vec::new(),
            metadata: "",
            second: None,
        }
    }
}

/// A matrix of the first two rows, without heights.
pub(crate) fn matrix([a, b, x]: [f64; 3], [c, d, y]: [f64; 3]) -> Vec<f64> {
    let rows = [
        [a, b, 0.0, x],
        [c, d, 0.0, y],
        [0.0; 4],
        [0.0, 0.0, 0.0, 1.0],
    ];
    rows.concat()
}

pub(crate) const COLUMNS: u32 = 20;
pub(crate) const ROWS: u32 = 10;

/// The heights of such a file.
pub(crate) fn heights<T>(of: impl Fn(u32, u32) -> T) -> Vec<T> {
    let posts = (0..ROWS).flat_map(|row| (0..COLUMNS).map(move |column| (row, column)));
    posts.map(|(row, column)| of(row, column)).collect()
}

macro_rules! written {
    ($name:ident, $color:ty, $sample:ty) => {
        pub(crate) fn $name(&self, heights_m: &[$sample]) -> Vec<u8> {
            let mut bytes = Cursor::new(Vec::new());
            let encoder = TiffEncoder::new(&mut bytes).unwrap();
            let mut encoder = encoder.with_compression(self.compression);
            let mut image = encoder
                .new_image::<$color>(self.size.0, self.size.1)
                .unwrap();
            image.rows_per_strip(3).unwrap();
            let mut tag = |tag, value: &dyn Value| value.write(image.encoder(), tag);
            if self.matrix.is_empty() {
                tag(Tag::ModelTiepointTag, &self.tie.as_slice());
                tag(Tag::ModelPixelScaleTag, &self.scale.as_slice());
            } else {
                tag(Tag::ModelTransformationTag, &self.matrix.as_slice());
            }
            if !self.metadata.is_empty() {
                let xml = format!("<GDALMetadata>\n  {}\n</GDALMetadata>\n", self.metadata);
                tag(Tag::Unknown(42_112), &xml.as_str());
            }
            if self.has_keys {
                let header = [1, 1, 0, self.keys.len() as u16];
                let keys = [&[header], self.keys.as_slice()].concat().concat();
                tag(Tag::GeoKeyDirectoryTag, &keys.as_slice());
            }
            if let Some(nodata) = self.nodata {
                tag(Tag::GdalNodata, &nodata);
            }
            image.write_data(heights_m).unwrap();
            if let Some(kind) = self.second {
                let mut second = encoder.new_image::<Gray8>(2, 2).unwrap();
                second
                    .encoder()
                    .write_tag(Tag::NewSubfileType, kind)
                    .unwrap();
                second.write_data(&[255; 4]).unwrap();
            }
            bytes.into_inner()
        }
    };
}

type Encoder<'a, 'w> =
    tiff::encoder::DirectoryEncoder<'a, &'w mut Cursor<Vec<u8>>, tiff::encoder::TiffKindStandard>;

/// What a tag may have.
trait Value {
    fn write(&self, encoder: &mut Encoder<'_, '_>, tag: Tag);
}

impl<T: TiffValue + Copy> Value for T {
    fn write(&self, encoder: &mut Encoder<'_, '_>, tag: Tag) {
        encoder.write_tag(tag, *self).unwrap();
    }
}

impl Made {
    written!(i16, GrayI16, i16);
    written!(u16, Gray16, u16);
    written!(f32, Gray32Float, f32);
}

/// A tile, as far as it is in 46.5° to 47.5° north and 7.5° to 9.5° east.
pub(crate) fn read(name: &str, bytes: &[u8]) -> Result<Elevations, TerrainError> {
    let area = Area {
        south_deg: 46.5,
        north_deg: 47.5,
        west_deg: 7.5,
        east_deg: 9.5,
    };
    Elevations::of_tile(name, Cursor::new(bytes), &area, MOST_BYTES)
}

/// The elevation of a place, in degrees.
pub(crate) fn at(elevations: &Elevations, latitude: f64, longitude: f64) -> Option<f64> {
    elevations.with(|terrain| terrain.elevation_m(latitude.to_radians(), longitude.to_radians()))
}

pub(crate) fn near(found: Option<f64>, expected: f64) -> bool {
    found.is_some_and(|m| (m - expected).abs() < 1e-3)
}
