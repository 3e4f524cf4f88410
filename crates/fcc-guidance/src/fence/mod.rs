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

/// Where the aircraft may fly: inside all zones to stay inside of that have one group, of
/// at least one group if there is any, and outside all others (MAVLink, `common.xml`,
/// "Inclusion Group").
///
/// ```
/// use fcc_guidance::fence::{Fence, Shape, Zone};
/// use fcc_guidance::path::LocalPlane;
/// use nalgebra::Vector2;
///
/// // Inside a circle of 2 km, but not over the 300 m around its centre.
/// let (latitude, longitude) = (0.8, 0.1);
/// let plane = LocalPlane::at(latitude, longitude);
/// let zones = [(2_000.0, true), (300.0, false)]
///     .map(|(radius_m, inclusion)| Zone {
///         plane,
///         shape: Shape::Circle { radius_m },
///         inclusion,
///         group: 0,
///     });
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
    /// Where groups of zones to stay inside of overlap, it is inside of the one that leaves
    /// the most room; a way from one to the other is not seen in it.
    pub fn clearance_m(
        &self,
        latitude_rad: f64,
        longitude_rad: f64,
        offset_m: Vector2<f64>,
    ) -> f64 {
        let depth_m = |zone: &Zone<'_>| zone.depth_m(latitude_rad, longitude_rad, offset_m);
        let (mut included_m, mut excluded_m): (Option<f64>, _) = (None, f64::INFINITY);
        for (n, zone) in self.zones.iter().enumerate() {
            let is_of_group = |other: &&Zone<'_>| other.inclusion && other.group == zone.group;
            if !zone.inclusion {
                excluded_m = excluded_m.min(-depth_m(zone));
            } else if self.zones.iter().position(|other| is_of_group(&other)) == Some(n) {
                let group = self.zones.iter().filter(is_of_group).map(depth_m);
                let group_m = group.fold(f64::INFINITY, f64::min);
                included_m = Some(included_m.map_or(group_m, |most_m| most_m.max(group_m)));
            }
        }
        included_m.unwrap_or(f64::INFINITY).min(excluded_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::LocalPlane;

    /// Circles of 3 km around places, m north: (north, group).
    fn clearance_m(circles: &[(f64, u16)], north_m: f64) -> f64 {
        let zones: [Zone<'_>; 3] = core::array::from_fn(|n| {
            let (centre_m, group) = circles[n.min(circles.len() - 1)];
            Zone {
                plane: LocalPlane::at(0.8 + centre_m / 6_378_000.0, 0.1),
                shape: Shape::Circle { radius_m: 3_000.0 },
                inclusion: true,
                group,
            }
        });
        let fence = Fence {
            zones: &zones,
            ..Fence::default()
        };
        fence.clearance_m(0.8, 0.1, Vector2::new(north_m, 0.0))
    }

    /// MAVLink: inside all zones of a group, and of at least one group.
    #[test]
    fn a_group_is_kept_as_a_whole_and_one_of_the_groups_is_enough() {
        let near = |found_m: f64, expected_m: f64| (found_m - expected_m).abs() < 25.0;
        let one = [(0.0, 0), (4_000.0, 0)];
        assert!(near(clearance_m(&one, 2_000.0), 1_000.0));
        assert!(near(clearance_m(&one, 0.0), -1_000.0));
        let two = [(0.0, 0), (4_000.0, 1)];
        assert!(near(clearance_m(&two, 0.0), 3_000.0));
        assert!(near(clearance_m(&two, 4_000.0), 3_000.0));
        assert!(near(clearance_m(&two, 8_000.0), -1_000.0));
        let mixed = [(0.0, 7), (4_000.0, 1), (2_000.0, 7)];
        assert!(near(clearance_m(&mixed, -500.0), 500.0));
        assert!(near(clearance_m(&mixed, 6_500.0), 500.0));
    }
}
