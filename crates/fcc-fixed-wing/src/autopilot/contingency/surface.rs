//! What is below and ahead of the aircraft: the ground, and the nearest obstacles.

use nalgebra::Vector2;

use fcc_core::blocks::wrap_pi;
use fcc_core::flight::earth::metres_per_radian;
use fcc_core::flight::terrain::{Obstacle, Terrain};
use fcc_guidance::path::length;
use fcc_guidance::route::OverGround;

/// Obstacles that are looked at in a tick, the nearest ones.
const MOST_NEAR: usize = 16;

/// An obstacle, m from the aircraft.
#[derive(Clone, Copy, Debug)]
struct Near {
    at_m: Vector2<f64>,
    away_m: f64,
    radius_m: f64,
    top_m: f64,
}

/// Ground and obstacles around an aircraft.
pub(super) struct Surface<'a> {
    terrain: &'a Terrain<'a>,
    here: &'a OverGround,
    metres_per_rad: (f64, f64),
    near: [Option<Near>; MOST_NEAR],
}

impl<'a> Surface<'a> {
    /// With the obstacles within a distance, m.
    pub(super) fn around(
        here: &'a OverGround,
        terrain: &'a Terrain<'a>,
        obstacles: &[Obstacle],
        within_m: f64,
    ) -> Self {
        let (per_latitude, per_longitude) = metres_per_radian(here.latitude_rad, 0.0);
        let metres_per_rad = (per_latitude, per_longitude.max(1.0));
        let mut near = [None; MOST_NEAR];
        for obstacle in obstacles {
            let at_m = Vector2::new(
                (obstacle.latitude_rad - here.latitude_rad) * metres_per_rad.0,
                wrap_pi(obstacle.longitude_rad - here.longitude_rad) * metres_per_rad.1,
            );
            let away_m = length(at_m) - obstacle.radius_m;
            if away_m > within_m {
                continue;
            }
            let far_m = |near: &Option<Near>| near.map_or(f64::INFINITY, |near| near.away_m);
            let farthest = near.iter_mut().max_by(|a, b| far_m(a).total_cmp(&far_m(b)));
            if let Some(farthest) = farthest.filter(|farthest| far_m(farthest) > away_m) {
                *farthest = Some(Near {
                    at_m,
                    away_m,
                    radius_m: obstacle.radius_m,
                    top_m: obstacle.top_m,
                });
            }
        }
        Self {
            terrain,
            here,
            metres_per_rad,
            near,
        }
    }

    /// The aircraft.
    pub(super) const fn here(&self) -> &OverGround {
        self.here
    }

    /// The highest of ground and obstacles within a distance of a place at an offset from
    /// the aircraft, m north and east; none where nothing is known.
    pub(super) fn highest_m(&self, offset_m: Vector2<f64>, reach_m: f64) -> Option<f64> {
        let ground_m = self.terrain.highest_m(
            self.here.latitude_rad + offset_m.x / self.metres_per_rad.0,
            self.here.longitude_rad + offset_m.y / self.metres_per_rad.1,
            reach_m,
        );
        let is_met = |near: &&Near| length(near.at_m - offset_m) < near.radius_m + reach_m;
        let tops_m = self.near.iter().flatten().filter(is_met);
        tops_m
            .map(|near| near.top_m)
            .chain(ground_m)
            .reduce(f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 1° of latitude are 111,132 m at 45° (WGS-84, mean of the meridian), and 17 masts on
    /// it: the nearest 16 are seen.
    #[test]
    fn the_nearest_obstacles_are_seen() {
        let here = OverGround {
            latitude_rad: 45.0_f64.to_radians(),
            longitude_rad: 180.0_f64.to_radians(),
            ..OverGround::default()
        };
        let mast = |n: u32| Obstacle {
            latitude_rad: (45.0 + 0.01 * f64::from(18 - n)).to_radians(),
            longitude_rad: -180.0_f64.to_radians(),
            radius_m: 50.0,
            top_m: 100.0 + f64::from(18 - n),
        };
        let masts: std::vec::Vec<_> = (1..18).map(mast).collect();
        let terrain = Terrain::default();
        let surface = Surface::around(&here, &terrain, &masts, 30_000.0);
        let north = |m: f64| surface.highest_m(Vector2::new(m, 0.0), 60.0);
        assert_eq!(north(1_111.3), Some(101.0));
        assert_eq!(north(1_111.3 + 105.0), Some(101.0));
        assert_eq!(north(1_111.3 + 115.0), None);
        assert_eq!(north(16.0 * 1_111.3), Some(116.0));
        assert_eq!(north(17.0 * 1_111.3), None);
        let near = Surface::around(&here, &terrain, &masts, 1_500.0);
        assert_eq!(near.highest_m(Vector2::new(2_222.6, 0.0), 60.0), None);
    }
}
