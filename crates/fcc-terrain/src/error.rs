//! Why there are no elevations.

use std::io;

use thiserror::Error;

/// Why elevations could not be read.
#[derive(Error, Debug)]
#[non_exhaustive]
pub enum TerrainError {
    /// The folder, or a file in it, cannot be read.
    #[error("{path}: cannot be read: {source}")]
    Unreadable {
        /// Which.
        path: String,
        /// Why.
        source: io::Error,
    },
    /// A file is no tile that can be used.
    #[error("{file}: {message}")]
    Invalid {
        /// Which.
        file: String,
        /// What is wrong and what to do.
        message: String,
    },
    /// The area has more posts than the bound on memory permits.
    #[error(
        "the elevations of this area need {needs_mb} MB, and {most_mb} MB are permitted: permit \
         more, use tiles with fewer posts, or fly a smaller plan"
    )]
    TooLarge {
        /// MB that they need.
        needs_mb: u64,
        /// MB that are permitted.
        most_mb: u64,
    },
    /// None of the tiles is of the area.
    #[error("{folder}: has no tile of this area: add {example}, or a GeoTIFF of it")]
    Missing {
        /// The folder.
        folder: String,
        /// The name of a tile that would be.
        example: String,
    },
}
