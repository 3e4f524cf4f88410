//! Flight plans: what they contain, the files they are in, and whether an
//! aircraft can fly them.
//!
//! ```text
//! .plan, QGC WPL 110 ─► Plan ─► resolve ─► check, terrain_problems ─► problems
//!                         └───► Steps ─► Route, which a tick flies
//! ```
//!
//! A [`Plan`] is what the file says: degrees, metres and metres per second, in
//! the numbers of the file, so that a plan that is read and written again is the
//! same to the last bit and has the same [hash](Plan::hash). Everything else
//! computes in radians.
//!
//! Nothing here runs in a tick: it allocates, and reads files.

mod check;
mod command;
mod conditions;
mod duration;
mod file;
mod flyable;
mod geodesic;
mod ground;
mod inside;
mod item;
mod leg;
mod legs;
mod level;
mod mavproxy;
pub mod mission;
mod outline;
mod path;
mod plan;
mod problem;
mod qgc_plan;
mod route;
mod runway;
mod unusual;
mod wpl;

pub use check::check;
pub use conditions::Conditions;
pub use duration::longest_s;
pub use file::{FileError, Format, is_plan, read, read_file, write};
pub use ground::{resolve, terrain_problems};
pub use item::{Altitude, AltitudeDatum, Item, Loiter, LoiterEnd, Place, Speed};
pub use leg::landing_elevation_m;
pub use level::Level;
pub use plan::{
    Circle, Fence, Home, Identity, Obstacle, Plan, PlanHash, Polygon, RallyPoint, limits,
};
pub use problem::Problem;
pub use route::Steps;
pub use unusual::{Usual, unusual};
