//! How long a plan takes.

use core::f64::consts::TAU;

use crate::conditions::Conditions;
use crate::item::{Item, Loiter, LoiterEnd};
use crate::leg::{Leg, above_sea_level};
use crate::legs::legs;
use crate::plan::Plan;

/// What turns add to legs, as a factor; the least speed over the ground, of the
/// airspeed; and the time for getting onto a leg, s.
const TURNS: f64 = 1.1;
const SLOWEST_SHARE: f64 = 0.3;
const LEAST_S: f64 = 30.0;
/// A landing where it took off, from over the runway, m.
const PATTERN_M: f64 = 20_000.0;
/// A landing is given up so often before it is not tried again, and each time leads around
/// at least so far, m, beside its leg and back.
const GO_AROUNDS: f64 = 3.0;
const AROUND_M: f64 = 5_000.0;
/// Of the fastest climb and descent: what is flown in the mean.
const RATE_SHARE: f64 = 0.5;

/// How long a plan takes at most, s: each leg against the strongest wind, with turns and
/// loiters, climbs that are not on a leg, and three landings that are given up; at least
/// half a minute. What never ends counts twice.
pub fn longest_s(plan: &Plan, conditions: &Conditions) -> f64 {
    let slowest =
        |airspeed_mps: f64| (airspeed_mps - conditions.wind_mps).max(SLOWEST_SHARE * airspeed_mps);
    let usual_mps = slowest(conditions.airspeed_mps);
    let legs = legs(plan, conditions, &mut Vec::new());
    let leg_s = |leg: &Leg| {
        let speed_mps = leg.ground_mps.unwrap_or_else(|| slowest(leg.airspeed_mps));
        TURNS * leg.length_m / speed_mps + LEAST_S
    };
    let circle_s = |radius_m: f64| TAU * radius_m / usual_mps;
    let usual_circle_s = circle_s(conditions.loiter_radius_m);
    let mut of_item = vec![0.0; plan.items.len() + 1];
    for leg in &legs {
        if let Some(seconds) = of_item.get_mut(leg.item) {
            *seconds = leg_s(leg);
        }
    }
    let level = |item: &Item| above_sea_level(item.altitude()?, plan).ok();
    let mut total_s = LEAST_S;
    let mut at_m = plan.home.map(|home| home.altitude_m);
    for (n, item) in plan.items.iter().enumerate() {
        let number = n + 1;
        let way_s = of_item.get(number).copied().unwrap_or(0.0);
        let to_m = level(item);
        let change_s = to_m.zip(at_m).map_or(0.0, |(to_m, from_m)| {
            let rate_mps = if to_m > from_m {
                conditions.climb_mps
            } else {
                conditions.descent_mps
            };
            (to_m - from_m).abs() / (RATE_SHARE * rate_mps)
        });
        total_s += way_s;
        total_s += match *item {
            Item::Loiter(Loiter { radius_m, end, .. }) => {
                let turn_s = radius_m.map_or(usual_circle_s, circle_s);
                match end {
                    LoiterEnd::Turns(turns) => (turns + 1.0) * turn_s,
                    LoiterEnd::Seconds(seconds) => seconds + turn_s,
                    LoiterEnd::Altitude => 2.0 * turn_s + change_s,
                    LoiterEnd::Never => 2.0 * turn_s,
                }
            }
            // Where it is then is not known, but not farther away than all that was flown.
            Item::Return => {
                let flown: f64 = legs.iter().map(leg_s).sum();
                flown + 2.0 * usual_circle_s
            }
            // Straight ahead, and back from there.
            Item::Takeoff { .. } => 2.0 * change_s + LEAST_S,
            Item::Land { place: None, .. } => {
                let back_m = legs.iter().map(|leg| leg.length_m).sum::<f64>() + PATTERN_M;
                back_m / usual_mps
            }
            Item::Land { .. } => {
                let before = plan.items.get(..n).unwrap_or_default();
                let is_start = |item: &Item| matches!(item, Item::LandStart { .. });
                let begin = before.iter().rposition(is_start).unwrap_or(n);
                let sequence = of_item.get(begin + 1..=number).unwrap_or_default();
                let sequence_s: f64 = sequence.iter().sum();
                GO_AROUNDS * (sequence_s + way_s + AROUND_M / usual_mps)
            }
            Item::Jump { to, times } => {
                let again: f64 = of_item.get(to..=n).unwrap_or_default().iter().sum();
                again * f64::from(times.unwrap_or(1))
            }
            _ => 0.0,
        };
        at_m = to_m.or(at_m);
    }
    total_s
}
