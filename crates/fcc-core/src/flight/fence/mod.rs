//! Where an aircraft may fly, and how it keeps inside.
//!
//! A [`Fence`] says how far a place is from its limits. A [`Escape`] is the circle onto
//! which the aircraft could turn from its present bank: as long as one of the two, to the
//! left or to the right, lies inside of the fence, the aircraft can stay inside for as
//! long as the wind does not change. The autopilot turns onto it when the last of them
//! is about to leave the fence.

mod escape;
mod zone;

pub use escape::{Bank, Escape};
pub use zone::{Shape, Zone};

use nalgebra::Vector2;

/// Where the aircraft may fly: inside at least one of the zones to stay inside of, if
/// there is any, and outside all others.
///
/// ```
/// use fcc_core::flight::fence::{Fence, Shape, Zone};
/// use fcc_core::flight::path::LocalPlane;
/// use nalgebra::Vector2;
///
/// // Inside a circle of 2 km, but not over the 300 m around its centre.
/// let (latitude, longitude) = (0.8, 0.1);
/// let plane = LocalPlane::at(latitude, longitude);
/// let zones = [(2_000.0, true), (300.0, false)]
///     .map(|(radius_m, inclusion)| Zone { plane, shape: Shape::Circle { radius_m }, inclusion });
/// let fence = Fence { zones: &zones, ..Fence::default() };
/// let clearance_m = |north_m| fence.clearance_m(latitude, longitude, Vector2::new(north_m, 0.0));
/// assert_eq!(clearance_m(1_900.0), 100.0);
/// assert_eq!(clearance_m(400.0), 100.0);
/// assert_eq!(clearance_m(2_500.0), -500.0);
/// ```
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Fence<'a> {
    /// Its zones.
    pub zones: &'a [Zone<'a>],
    /// The lowest altitude above mean sea level, m.
    pub floor_m: Option<f64>,
    /// The highest altitude above mean sea level, m.
    pub ceiling_m: Option<f64>,
}

impl Fence<'_> {
    /// How far a place is inside of the fence, m; negative outside, and infinite without
    /// zones. The place is at an offset, m north and east, from a latitude and longitude
    /// in rad.
    ///
    /// Where zones to stay inside of overlap, it is inside of the one that leaves the
    /// most room; a way from one to the other is not seen in it.
    pub fn clearance_m(
        &self,
        latitude_rad: f64,
        longitude_rad: f64,
        offset_m: Vector2<f64>,
    ) -> f64 {
        let mut included_m: Option<f64> = None;
        let mut excluded_m = f64::INFINITY;
        for zone in self.zones {
            let depth_m = zone.depth_m(latitude_rad, longitude_rad, offset_m);
            if zone.inclusion {
                included_m = Some(included_m.map_or(depth_m, |most_m| most_m.max(depth_m)));
            } else {
                excluded_m = excluded_m.min(-depth_m);
            }
        }
        included_m.unwrap_or(f64::INFINITY).min(excluded_m)
    }
}
