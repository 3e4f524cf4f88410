//! The elevations of an area.

use std::fmt::Write as _;
use std::fs::File;
use std::io::{self, BufReader, Read, Seek};
use std::path::Path;

use fcc_core::flight::terrain::Terrain;
use sha2::{Digest as _, Sha256};

use crate::area::Area;
use crate::error::TerrainError;
use crate::geotiff::{GeoTiff, MASKED};
use crate::hgt::{Hgt, corner};
use crate::lattice::{Grid, Lattice, Overlap, bytes};

/// Elevations of an area, which are kept for as long as they are looked into.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Elevations {
    grids: Vec<Grid>,
    tiles: Vec<String>,
}

/// What a file is by its name.
enum Kind {
    Hgt,
    GeoTiff,
    Packed,
    /// GDAL's mask beside a GeoTIFF.
    Mask,
    Other,
}

fn kind(name: &str) -> Kind {
    let name = name.to_ascii_lowercase();
    let ends = |end: &str| name.ends_with(end);
    if ends(".hgt") {
        Kind::Hgt
    } else if ends(".tif") || ends(".tiff") {
        Kind::GeoTiff
    } else if ends(".hgt.zip") || ends(".hgt.gz") {
        Kind::Packed
    } else if ends(".tif.msk") || ends(".tiff.msk") {
        Kind::Mask
    } else {
        Kind::Other
    }
}

/// Tiles as they are added.
struct Builder {
    area: Area,
    most_bytes: u64,
    left_bytes: u64,
    elevations: Elevations,
}

impl Builder {
    fn new(area: Area, most_bytes: u64) -> Self {
        Self {
            area,
            most_bytes,
            left_bytes: most_bytes,
            elevations: Elevations::default(),
        }
    }

    /// The grid that has the posts of a tile, and which of them.
    fn grid_of(
        &mut self,
        tile: &Lattice,
        shift_deg: f64,
    ) -> Result<Option<(&mut Grid, Overlap)>, TerrainError> {
        let grids = &mut self.elevations.grids;
        let has_it = |grid: &Grid| grid.overlap(tile, shift_deg).is_some();
        if !grids.iter().any(has_it) {
            let lattice = Grid::lattice(tile, shift_deg, &self.area);
            self.left_bytes -= bytes(&lattice, self.left_bytes, self.most_bytes)?;
            grids.push(Grid::unknown(lattice));
        }
        Ok(grids.iter_mut().find_map(|grid| {
            let overlap = grid.overlap(tile, shift_deg)?;
            Some((grid, overlap))
        }))
    }

    fn add(&mut self, name: &str, tile: impl Read + Seek) -> Result<(), TerrainError> {
        let invalid = |message: String| TerrainError::Invalid {
            file: name.to_owned(),
            message,
        };
        match kind(name) {
            Kind::Hgt => {
                let corner = corner(name).ok_or_else(|| {
                    invalid("is not named by its place: name it as N47E008.hgt".to_owned())
                })?;
                let (south_deg, west_deg) = corner;
                let (north_deg, east_deg) = (south_deg + 1.0, west_deg + 1.0);
                let shift_deg = self
                    .area
                    .shift_deg(south_deg, north_deg, west_deg, east_deg);
                let Some(shift_deg) = shift_deg else {
                    return Ok(());
                };
                let read = Hgt::read(corner, tile).map_err(|source| TerrainError::Unreadable {
                    path: name.to_owned(),
                    source,
                })?;
                let tile = read.map_err(invalid)?;
                if let Some((grid, overlap)) = self.grid_of(&tile.lattice, shift_deg)? {
                    for row in overlap.rows.clone() {
                        for column in overlap.columns.clone() {
                            let height_m = tile.height_m(row, column);
                            grid.put(&overlap, row, column, height_m).map_err(invalid)?;
                        }
                    }
                }
            }
            Kind::GeoTiff => {
                let mut tile = GeoTiff::read(tile).map_err(invalid)?;
                let Some(shift_deg) = tile.lattice.shift_deg(&self.area) else {
                    return Ok(());
                };
                if let Some((grid, overlap)) = self.grid_of(&tile.lattice, shift_deg)? {
                    tile.put(&overlap, grid).map_err(invalid)?;
                }
            }
            Kind::Packed => return Err(invalid("is packed: unpack it".to_owned())),
            Kind::Mask => return Err(invalid(MASKED.to_owned())),
            Kind::Other => return Ok(()),
        }
        self.elevations.tiles.push(name.to_owned());
        Ok(())
    }

    /// The finest first.
    fn finish(mut self) -> Elevations {
        let posts = |grid: &Grid| grid.lattice.posts_per_degree.iter().product::<f64>();
        let grids = &mut self.elevations.grids;
        grids.sort_by(|a, b| posts(b).total_cmp(&posts(a)));
        self.elevations
    }
}

impl Elevations {
    /// Reads all tiles of a folder that an area touches, at most so many bytes of heights.
    /// Files that are no tiles by their names are skipped.
    ///
    /// # Errors
    /// When a tile of the area cannot be used, when there is none, or when there are too
    /// many heights.
    pub fn read(folder: &Path, area: &Area, most_bytes: u64) -> Result<Self, TerrainError> {
        let unreadable = |path: &Path| {
            let path = path.display().to_string();
            |source: io::Error| TerrainError::Unreadable { path, source }
        };
        let entries = folder.read_dir().map_err(unreadable(folder))?;
        let names: Result<Vec<_>, _> = entries.map(|entry| Ok(entry?.file_name())).collect();
        let mut names = names.map_err(unreadable(folder))?;
        // Whatever the order of the folder, the same tiles give the same grid.
        names.sort();
        let mut builder = Builder::new(*area, most_bytes);
        for name in names {
            let path = folder.join(&name);
            let name = name.to_string_lossy();
            if matches!(kind(&name), Kind::Other) {
                continue;
            }
            let file = File::open(&path).map_err(unreadable(&path))?;
            builder
                .add(&name, BufReader::new(file))
                .map_err(|error| in_folder(folder, error))?;
        }
        if builder.elevations.grids.is_empty() {
            return Err(TerrainError::Missing {
                folder: folder.display().to_string(),
                example: area.example(),
            });
        }
        Ok(builder.finish())
    }

    /// One tile by its name and content: for tests of the readers.
    ///
    /// # Errors
    /// As [`read`](Self::read); nothing is known if the tile does not touch the area.
    pub fn of_tile(
        name: &str,
        tile: impl Read + Seek,
        area: &Area,
        most_bytes: u64,
    ) -> Result<Self, TerrainError> {
        let mut builder = Builder::new(*area, most_bytes);
        builder.add(name, tile)?;
        Ok(builder.finish())
    }

    /// The names of the tiles that they are from.
    pub fn tiles(&self) -> &[String] {
        &self.tiles
    }

    /// SHA-256 of heights and places, 64 hexadecimal digits: the same elevations have the
    /// same.
    pub fn hash(&self) -> String {
        let mut hash = Sha256::new();
        for grid in &self.grids {
            let Lattice {
                north_deg,
                west_deg,
                posts_per_degree: [per_latitude, per_longitude],
                columns,
                ..
            } = grid.lattice;
            for number in [
                north_deg,
                west_deg,
                per_latitude,
                per_longitude,
                columns as f64,
            ] {
                hash.update(number.to_le_bytes());
            }
            for height_m in &grid.heights_m {
                hash.update(height_m.to_le_bytes());
            }
        }
        let mut digits = String::new();
        for byte in hash.finalize() {
            let _ = write!(digits, "{byte:02x}");
        }
        digits
    }

    /// Something about the terrain.
    pub fn with<T>(&self, of: impl FnOnce(&Terrain<'_>) -> T) -> T {
        let grids: Vec<_> = self.grids.iter().map(Grid::borrowed).collect();
        of(&Terrain { grids: &grids })
    }

    /// For the rest of the program: its memory is not given back.
    pub fn leak(self) -> Terrain<'static> {
        let grids: Vec<_> = self.grids.into_iter().map(Grid::leak).collect();
        Terrain {
            grids: grids.leak(),
        }
    }
}

fn in_folder(folder: &Path, error: TerrainError) -> TerrainError {
    let of = |name: &str| folder.join(name).display().to_string();
    match error {
        TerrainError::Invalid { file, message } => TerrainError::Invalid {
            file: of(&file),
            message,
        },
        TerrainError::Unreadable { path, source } => TerrainError::Unreadable {
            path: of(&path),
            source,
        },
        other => other,
    }
}
