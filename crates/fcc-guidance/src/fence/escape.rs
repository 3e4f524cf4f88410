//! The circle onto which an aircraft turns to stay inside of a fence.

use libm::{atan, atan2, cos, hypot, sin, tan};
use nalgebra::Vector2;

use super::Fence;
use crate::path::turn::smallest_circle_m;
use crate::path::{length, right_of, unit};
use crate::route::OverGround;
use fcc_core::units::GRAVITY_MPS2;

/// How an aircraft banks.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Bank {
    /// The present bank, rad, positive to the right.
    pub now_rad: f64,
    /// The bank that was commanded last, rad: from there the command changes.
    pub commanded_rad: f64,
    /// That of the turn, rad, positive, below π/2.
    pub turn_rad: f64,
    /// How fast it changes, rad/s, positive.
    pub rate_radps: f64,
    /// From a commanded bank to the aircraft's, s.
    pub lag_s: f64,
}

/// A circle over the ground onto which the aircraft can turn at once, and stay.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Escape {
    /// Its centre from the aircraft, m north and east.
    pub centre_m: Vector2<f64>,
    /// m; the smallest one that the bank allows in this wind.
    pub radius_m: f64,
    /// The way around, from above.
    pub clockwise: bool,
    /// How far it stays inside of the fence, m; negative if it leaves it.
    pub clearance_m: f64,
}

/// Steps in which the change of bank is followed.
const STEPS: u32 = 8;

impl Escape {
    /// The better one of the two circles, to the left and to the right; none if the wind
    /// is not weaker than the airspeed.
    pub fn best(fence: &Fence<'_>, here: &OverGround, bank: &Bank) -> Option<Self> {
        let [left, right] = Self::both(fence, here, bank)?;
        Some(if right.clearance_m >= left.clearance_m {
            right
        } else {
            left
        })
    }

    /// Both circles, to the left and to the right; none as in [`best`](Self::best).
    pub fn both(fence: &Fence<'_>, here: &OverGround, bank: &Bank) -> Option<[Self; 2]> {
        let wind = hypot(here.wind_mps.x, here.wind_mps.y);
        let radius_m = smallest_circle_m(here.true_airspeed_mps, wind, bank.turn_rad)?;
        Some([false, true].map(|clockwise| Self::to(fence, here, bank, radius_m, clockwise)))
    }

    /// To one side: the bank is changed first, from the present one, and the circle
    /// touches the course that is flown then.
    fn to(
        fence: &Fence<'_>,
        here: &OverGround,
        bank: &Bank,
        radius_m: f64,
        clockwise: bool,
    ) -> Self {
        let side = if clockwise { 1.0 } else { -1.0 };
        let (ground, air) = (
            here.ground_velocity_mps,
            here.ground_velocity_mps - here.wind_mps,
        );
        let airspeed_mps = length(air).max(1.0);
        // On the circle, at the present course: less than downwind (path::turn).
        let along_mps = (air.dot(&ground) / length(ground).max(1.0)).max(1.0);
        let acceleration_mps2 = ground.dot(&ground) * airspeed_mps / (along_mps * radius_m);
        let turn_rad = atan(acceleration_mps2 / GRAVITY_MPS2).min(bank.turn_rad);
        // The later of the two: the aircraft rolls towards what was commanded first.
        let now_rad = side * (side * bank.now_rad).min(side * bank.commanded_rad);
        let change_rad = side * turn_rad - now_rad;
        let (mut heading_rad, mut at_m) = (atan2(air.y, air.x), Vector2::zeros());
        let mut fly = |bank_rad: f64, dt_s: f64| {
            heading_rad += GRAVITY_MPS2 * tan(bank_rad) / airspeed_mps * dt_s;
            let through = Vector2::new(cos(heading_rad), sin(heading_rad)) * airspeed_mps;
            at_m += (through + here.wind_mps) * dt_s;
            through + here.wind_mps
        };
        let mut velocity = fly(now_rad, bank.lag_s);
        let step_s = change_rad.abs() / bank.rate_radps / f64::from(STEPS);
        for n in 0..STEPS {
            let share = (f64::from(n) + 0.5) / f64::from(STEPS);
            velocity = fly(now_rad + share * change_rad, step_s);
        }
        let course = unit(velocity).unwrap_or(Vector2::new(1.0, 0.0));
        let centre_m = at_m + right_of(course) * (side * radius_m);
        let from_centre_m = fence.clearance_m(here.latitude_rad, here.longitude_rad, centre_m);
        Self {
            centre_m,
            radius_m,
            clockwise,
            clearance_m: from_centre_m - radius_m,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fence::{Shape, Zone};
    use crate::path::LocalPlane;

    const BANK: Bank = Bank {
        now_rad: 0.0,
        commanded_rad: 0.0,
        turn_rad: 0.432_7,  // atan(0.8 tan 30°)
        rate_radps: 0.2618, // 15 °/s
        lag_s: 0.4,
    };

    /// At the origin of the plane, to the north with 100 kt, in a wind towards there.
    fn flying_north(tailwind_mps: f64) -> OverGround {
        OverGround {
            latitude_rad: 0.8,
            longitude_rad: 0.1,
            true_airspeed_mps: 51.444,
            ground_velocity_mps: Vector2::new(51.444 + tailwind_mps, 0.0),
            wind_mps: Vector2::new(tailwind_mps, 0.0),
            ..OverGround::default()
        }
    }

    /// A fence to the north, far away to the other sides, with a corner of it to the east.
    fn best(here: &OverGround, bank: &Bank, north_m: f64, east_m: f64) -> Escape {
        let corners_m = [
            Vector2::new(-50_000.0, -50_000.0),
            Vector2::new(-50_000.0, east_m),
            Vector2::new(north_m, east_m),
            Vector2::new(north_m, -50_000.0),
        ];
        let zones = [Zone {
            plane: LocalPlane::at(0.8, 0.1),
            shape: Shape::Polygon {
                corners_m: &corners_m,
            },
            inclusion: true,
            group: 0,
        }];
        let fence = Fence {
            zones: &zones,
            ..Fence::default()
        };
        Escape::best(&fence, here, bank).unwrap()
    }

    /// V²/(g tan φ) = 584.3 m at 100 kt, and half of the 1.66 s of banking with the lag
    /// before it: 64 m. Its northernmost point is that far away.
    #[test]
    fn the_circle_is_that_of_the_bank_in_calm_air() {
        let escape = best(&flying_north(0.0), &BANK, 2_000.0, 50_000.0);
        assert!((escape.radius_m - 584.3).abs() < 0.5, "{escape:?}");
        let farthest_m = escape.centre_m.x + escape.radius_m;
        assert!((farthest_m - (584.3 + 64.0)).abs() < 6.0, "{escape:?}");
        assert!((escape.clearance_m - (2_000.0 - farthest_m)).abs() < 0.1);
    }

    /// (V + W)²/(g tan φ) = 841 m in 20 kt.
    #[test]
    fn the_wind_makes_it_wider() {
        let escape = best(&flying_north(10.289), &BANK, 2_000.0, 50_000.0);
        assert!((escape.radius_m - 841.4).abs() < 1.0, "{escape:?}");
    }

    #[test]
    fn it_turns_to_where_there_is_room() {
        let escape = best(&flying_north(0.0), &BANK, 2_000.0, 300.0);
        assert!(!escape.clockwise && escape.clearance_m > 0.0, "{escape:?}");
        // Banked to the right it needs longer to turn left, and is farther then.
        let banked = Bank {
            now_rad: 0.432_7,
            ..BANK
        };
        let later = best(&flying_north(0.0), &banked, 2_000.0, 300.0);
        assert!(later.centre_m.x > escape.centre_m.x + 20.0, "{later:?}");
        assert!(later.centre_m.y > escape.centre_m.y, "{later:?}");
    }

    #[test]
    fn no_circle_stands_in_a_wind_as_strong_as_the_airspeed() {
        let here = flying_north(51.444);
        assert!(Escape::best(&Fence::default(), &here, &BANK).is_none());
    }
}
