//! Elevation tiles, read before a flight.
//!
//! ```text
//! N47E008.hgt, *.tif ─► Elevations ─► fcc_core::flight::terrain::Terrain
//! ```
//!
//! [`Elevations::read`] takes all tiles of a folder that an [`Area`] touches, and keeps
//! the part of them that is inside it, within a bound on memory. What comes out of it is
//! only looked into: by the check of a plan, and by a tick. What no tile says is not
//! known, and never sea level.
//!
//! | tiles | |
//! |---|---|
//! | SRTM's `.hgt` | 1 or 3 seconds of arc: 3,601 or 1,201 rows of as many posts from the north, 16 bits each, the higher byte first, -32,768 for a void; named by the south-west corner (USGS, "SRTM Collection User Guide", 2015) |
//! | GeoTIFF, `.tif` or `.tiff` | one band of heights above mean sea level, in degrees of WGS-84 (OGC 19-008r4), without rotation; `GDAL_NODATA` for voids, scale, offset and unit of `GDAL_METADATA` |
//!
//! Nothing here runs in a tick: it reads files, and allocates.

mod area;
mod elevations;
mod error;
mod gdal;
mod geotiff;
mod hgt;
mod lattice;

pub use area::Area;
pub use elevations::Elevations;
pub use error::TerrainError;
