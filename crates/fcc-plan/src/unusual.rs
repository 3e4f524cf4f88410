//! What is accepted in a plan, and seldom meant.

use fcc_core::units::FOOT_M;
use fcc_guidance::route::LONGEST_LEG_M;

use crate::conditions::Conditions;
use crate::item::{AltitudeDatum, Item, Loiter, LoiterEnd, Place};
use crate::leg::{Leg, above_sea_level};
use crate::legs::legs;
use crate::level::Level;
use crate::plan::{Plan, limits};
use crate::problem::Problem;

/// Latitude and longitude may be exchanged where that makes a leg longer than this, m, so
/// many times as long.
const EXCHANGED_M: f64 = 50_000.0;
const EXCHANGED_TIMES: f64 = 10.0;
/// A difference of altitudes that is no more than rounding, m.
const SAME: f64 = 0.001;

/// What an aircraft usually keeps.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Usual {
    /// The ground, if it is known, and how far above it items are flown, m.
    pub ground: Option<(Level, f64)>,
    /// The highest altitude above mean sea level, m.
    pub ceiling_m: f64,
}

/// Items that are flown low over the ground or above the ceiling, and legs that are longer
/// than an aircraft flies, or are so if latitude and longitude are exchanged; heights above
/// a home at exactly 0 m; jumps and loiters that never end; commands of a camera. Take-off and landing may
/// be low.
pub fn unusual(plan: &Plan, conditions: &Conditions, usual: &Usual) -> Vec<Problem> {
    let altitudes = plan.items.iter().enumerate().filter_map(|(n, item)| {
        let altitude_m = above_sea_level(item.altitude()?, plan).ok()?;
        let message = too_low(item, altitude_m, usual).or_else(|| too_high(altitude_m, usual))?;
        Some(Problem::of_item(n + 1, "altitude", message))
    });
    let legs = legs(plan, conditions, &mut Vec::new());
    let lengths = legs.iter().filter_map(|leg| {
        let message = too_long(leg)?;
        Some(Problem::of_item(leg.item, "leg", message))
    });
    let items = plan.items.iter().enumerate();
    let endless = items.filter_map(|(n, item)| {
        let what = match item {
            // Forward, it leaves out what it passes, and the plan has its end.
            Item::Jump { times: None, to } if *to <= n + 1 => "jump",
            Item::Loiter(Loiter {
                end: LoiterEnd::Never,
                ..
            }) if n + 1 < plan.items.len() => "loiter",
            _ => return None,
        };
        let message = "for ever: what is behind it is flown by a command only (fccd command plan \
                       land, item N), and the plan has no end";
        Some(Problem::of_item(n + 1, what, message))
    });
    let mut found: Vec<_> = home_at_zero(plan)
        .into_iter()
        .chain(camera(plan))
        .chain(altitudes)
        .chain(lengths)
        .chain(endless)
        .collect();
    found.sort_by_key(|problem| problem.item);
    found.truncate(limits::PROBLEMS);
    found
}

/// Ground stations that do not know the elevation of home write 0.
fn home_at_zero(plan: &Plan) -> Option<Problem> {
    let is_zero = plan.home.is_some_and(|home| home.altitude_m == 0.0);
    let is_relative = |item: &Item| {
        item.altitude()
            .is_some_and(|altitude| altitude.above == AltitudeDatum::Home)
    };
    let first = plan.items.iter().position(is_relative)?;
    is_zero.then(|| {
        let message = format!(
            "its elevation is exactly 0 m, and item {} is above home: is it at the sea? \
             Otherwise give its elevation above mean sea level",
            first + 1
        );
        Problem::of("home", message)
    })
}

fn camera(plan: &Plan) -> Option<Problem> {
    let is_one = |item: &Item| matches!(item, Item::Camera { .. });
    let first = plan.items.iter().position(is_one)?;
    let count = plan.items.iter().filter(|item| is_one(item)).count();
    let message = format!("commands of a camera or gimbal ({count}) are not carried out");
    Some(Problem::of_item(first + 1, "command", message))
}

fn too_low(item: &Item, altitude_m: f64, usual: &Usual) -> Option<String> {
    let (ground, margin_m) = usual.ground?;
    let height_m = altitude_m - ground.m;
    let is_flown = !matches!(item, Item::Takeoff { .. } | Item::Land { .. });
    let is_low = height_m >= 0.0 && height_m < margin_m - SAME;
    (is_flown && is_low).then(|| {
        let [height, margin] = apart(height_m, margin_m);
        format!(
            "{height} m above {}, {:.0} m, is lower than terrain.margin_m, {margin} m: fly \
             higher, or choose a smaller margin",
            ground.name, ground.m
        )
    })
}

fn too_high(altitude_m: f64, usual: &Usual) -> Option<String> {
    (altitude_m > usual.ceiling_m + SAME).then(|| {
        let [altitude, ceiling] = apart(altitude_m / FOOT_M, usual.ceiling_m / FOOT_M);
        format!(
            "{altitude_m:.0} m above mean sea level ({altitude} ft) is above \
             plan.service_ceiling_ft, {ceiling} ft: fly lower, or give the ceiling of your aircraft"
        )
    })
}

/// Two numbers that differ by more than [`SAME`], with as few digits as show that.
fn apart(one: f64, other: f64) -> [String; 2] {
    let texts = (0..=3).map(|digits| [one, other].map(|number| format!("{number:.digits$}")));
    let mut texts = texts.skip_while(|[one, other]| one == other);
    texts.next().unwrap_or_default()
}

fn too_long(leg: &Leg) -> Option<String> {
    let km = |m: f64| m / 1e3;
    let exchanged_m = exchanged(leg.to.0).map(|place| leg.from.0.to(place).0);
    let exchanged_m = exchanged_m.filter(|exchanged_m| {
        leg.length_m > EXCHANGED_M && leg.length_m > EXCHANGED_TIMES * exchanged_m
    });
    let hours = leg.length_m / leg.airspeed_mps / 3_600.0;
    let advice = match exchanged_m {
        Some(exchanged_m) => format!(
            "are latitude and longitude exchanged, here or in the place before? Otherwise it \
             would be {}",
            if exchanged_m < 1e3 {
                format!("{exchanged_m:.0} m")
            } else {
                format!("{:.1} km", km(exchanged_m))
            }
        ),
        None if leg.length_m > LONGEST_LEG_M => "check both places".to_owned(),
        None => return None,
    };
    Some(format!(
        "it is {:.0} km long, {hours:.1} h at {:.1} m/s: {advice}",
        km(leg.length_m),
        leg.airspeed_mps
    ))
}

/// With latitude for longitude, if that is a place.
fn exchanged(place: Place) -> Option<Place> {
    (place.longitude_deg.abs() <= 90.0).then_some(Place {
        latitude_deg: place.longitude_deg,
        longitude_deg: place.latitude_deg,
    })
}
