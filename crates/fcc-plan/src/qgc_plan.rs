//! QGroundControl's `.plan`: JSON (QGroundControl developer guide, "Plan File
//! Format"). Files in use have comments, which are read and not kept.
//!
//! What the format has no place for, floor and ceiling of the fence and
//! obstacles, is in an object `fccd` beside the fence, which QGroundControl
//! ignores.

mod landing;
mod node;
mod read;
mod write;

pub(crate) use read::read;
pub(crate) use write::write;
