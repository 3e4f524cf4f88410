//! The plan of a multicopter: in its configuration in metres from home, and from the files of
//! ground stations.

use std::path::Path;

use fcc_core::flight::earth::metres_per_radian;
use fcc_multicopter::{Item, Waypoint};
use fcc_plan::{Altitude, AltitudeDatum, Place};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// An item of the plan, from home.
#[derive(Clone, Copy, PartialEq, Debug, Deserialize, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum PlanItem {
    /// Rise.
    TakeOff {
        /// Above home.
        height_m: f64,
    },
    /// Fly to a place.
    Waypoint {
        /// North of home.
        north_m: f64,
        /// East of home.
        east_m: f64,
        /// Above home.
        height_m: f64,
        /// Of the nose; none: where it flies to.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        heading_deg: Option<f64>,
        /// Whether it stops there.
        #[serde(default)]
        stops: bool,
    },
    /// Hold the place.
    Hover {
        /// How long.
        seconds: f64,
    },
    /// Circle around a place to the right of the nose.
    Circle {
        /// To the left if negative.
        radius_m: f64,
        /// How often.
        turns: f64,
    },
    /// Fly home, and land there.
    Return,
    /// Land.
    Land,
}

/// What is flown without a plan: a round of 50 s that shows each kind of item.
pub(super) fn tour() -> Vec<PlanItem> {
    let to = |north_m, east_m, height_m| PlanItem::Waypoint {
        north_m,
        east_m,
        height_m,
        heading_deg: None,
        stops: false,
    };
    vec![
        PlanItem::TakeOff { height_m: 8.0 },
        to(20.0, 0.0, 10.0),
        to(20.0, 20.0, 12.0),
        to(0.0, 20.0, 10.0),
        PlanItem::Hover { seconds: 3.0 },
        PlanItem::Circle {
            radius_m: 6.0,
            turns: 1.0,
        },
        PlanItem::Return,
    ]
}

impl PlanItem {
    pub(super) fn to_core(self) -> Item {
        match self {
            Self::TakeOff { height_m } => Item::TakeOff(height_m),
            Self::Waypoint {
                north_m,
                east_m,
                height_m,
                heading_deg,
                stops,
            } => Item::Waypoint(Waypoint {
                place_m: Vector3::new(north_m, east_m, -height_m),
                heading_rad: heading_deg.map(f64::to_radians),
                stops,
            }),
            Self::Hover { seconds } => Item::Hover(seconds),
            Self::Circle { radius_m, turns } => Item::Circle { radius_m, turns },
            Self::Return => Item::Return,
            Self::Land => Item::Land,
        }
    }

    /// What of a plan cannot be flown, by its number.
    pub(super) fn check(plan: &[Self]) -> Result<(), String> {
        for (index, item) in plan.iter().enumerate() {
            let is_first = index == 0;
            let is_last = index + 1 == plan.len();
            let wrong = match item {
                Self::TakeOff { .. } if !is_first => "a take-off is the first item",
                _ if is_first && !matches!(item, Self::TakeOff { .. }) => {
                    "a plan begins with a take-off"
                }
                Self::Return | Self::Land if !is_last => "a return or a landing is the last item",
                _ if is_last && !matches!(item, Self::Return | Self::Land) => {
                    "a plan ends with a return or a landing"
                }
                Self::TakeOff { height_m } if !(1.0..=120.0).contains(height_m) => {
                    "the height must be 1 to 120 m"
                }
                Self::Waypoint {
                    north_m,
                    east_m,
                    height_m,
                    ..
                } if !(1.0..=120.0).contains(height_m)
                    || !(0.0..=5_000.0).contains(&north_m.hypot(*east_m)) =>
                {
                    "the height must be 1 to 120 m, and the distance from home at most 5000 m"
                }
                Self::Circle { radius_m, turns }
                    if !(1.0..=500.0).contains(&radius_m.abs())
                        || !(0.0..=100.0).contains(turns) =>
                {
                    "the radius must be 1 to 500 m, and the turns at most 100"
                }
                Self::Hover { seconds } if !(0.0..=3_600.0).contains(seconds) => {
                    "the time must be 0 to 3600 s"
                }
                _ => continue,
            };
            return Err(format!("item {} of the plan: {wrong}", index + 1));
        }
        if plan.is_empty() {
            return Err("the plan has no items".to_owned());
        }
        Ok(())
    }
}

/// The plan in a file of a ground station, and home: that of the file, or its first place.
pub(super) fn of_file(file: &Path) -> Result<(Place, Vec<PlanItem>), String> {
    let plan = fcc_plan::read_file(file).map_err(|error| error.to_string())?;
    let place_of = |item: &fcc_plan::Item| match *item {
        fcc_plan::Item::Waypoint { place, .. } => Some(place),
        fcc_plan::Item::Takeoff { place, .. } | fcc_plan::Item::Land { place, .. } => place,
        _ => None,
    };
    let home = plan.home.map(|home| (home.place, Some(home.altitude_m)));
    let (home, home_m) = home
        .or_else(|| {
            plan.items
                .iter()
                .find_map(place_of)
                .map(|place| (place, None))
        })
        .ok_or_else(|| format!("{}: the plan has no place", file.display()))?;
    let (north, east) = metres_per_radian(home.latitude_deg.to_radians(), 0.0);
    let from_home = |place: Place| {
        let east_deg = place.longitude_deg - home.longitude_deg;
        (
            north * (place.latitude_deg - home.latitude_deg).to_radians(),
            east * (east_deg - 360.0 * (east_deg / 360.0).round()).to_radians(),
        )
    };
    let height = |altitude: Altitude| match altitude.above {
        AltitudeDatum::Home => Ok(altitude.m),
        AltitudeDatum::SeaLevel => home_m
            .map(|home_m| altitude.m - home_m)
            .ok_or("an altitude above sea level needs a home with one"),
        AltitudeDatum::Terrain => Err("a height above the terrain cannot be flown"),
    };
    let to = |place: Place, height_m: f64, stops: bool| {
        let (north_m, east_m) = from_home(place);
        PlanItem::Waypoint {
            north_m,
            east_m,
            height_m,
            heading_deg: None,
            stops,
        }
    };
    let mut items = Vec::new();
    let mut last_m = 0.0;
    for (index, item) in plan.items.iter().enumerate() {
        let refused = |why: &str| {
            let name = item.name();
            format!("{}: item {} ({name}): {why}", file.display(), index + 1)
        };
        match *item {
            fcc_plan::Item::Takeoff { altitude, .. } => {
                last_m = height(altitude).map_err(refused)?;
                items.push(PlanItem::TakeOff { height_m: last_m });
            }
            fcc_plan::Item::Waypoint {
                place, altitude, ..
            } => {
                last_m = height(altitude).map_err(refused)?;
                items.push(to(place, last_m, false));
            }
            fcc_plan::Item::Delay { seconds } => items.push(PlanItem::Hover { seconds }),
            fcc_plan::Item::Return => items.push(PlanItem::Return),
            fcc_plan::Item::Land { place, .. } => {
                items.extend(place.map(|place| to(place, last_m, true)));
                items.push(PlanItem::Land);
            }
            // The shutter is a camera's.
            fcc_plan::Item::Camera { .. } => {}
            _ => return Err(refused("a multicopter does not fly it")),
        }
    }
    PlanItem::check(&items).map_err(|wrong| format!("{}: {wrong}", file.display()))?;
    Ok((home, items))
}
