//! A leg of a plan, and altitudes above sea level.

use crate::item::{Altitude, AltitudeDatum, Item, Place};
use crate::plan::Plan;

/// A leg between two places, with its altitudes above sea level, m.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Leg {
    pub(crate) from: (Place, f64),
    pub(crate) to: (Place, f64),
    pub(crate) length_m: f64,
    pub(crate) course_deg: f64,
    pub(crate) arrival_deg: f64,
    /// The number of the item at its end.
    pub(crate) item: usize,
    /// Whether there is a turn of the path at its end.
    pub(crate) turns: bool,
    /// How near the turn at its end passes the place, m.
    pub(crate) within_m: f64,
    pub(crate) airspeed_mps: f64,
    /// The speed over the ground that is demanded; none: what the airspeed gives.
    pub(crate) ground_mps: Option<f64>,
}

/// The elevation of the plan's runway, m above mean sea level; none without a landing, or
/// where it is not known.
pub fn landing_elevation_m(plan: &Plan) -> Option<f64> {
    let altitude = plan.items.iter().find_map(|item| match item {
        Item::Land {
            place: Some(_),
            altitude,
            ..
        } => Some(*altitude),
        _ => None,
    })?;
    above_sea_level(altitude, plan).ok()
}

pub(crate) fn above_sea_level(altitude: Altitude, plan: &Plan) -> Result<f64, &'static str> {
    match (altitude.above, plan.home) {
        (AltitudeDatum::SeaLevel, _) => Ok(altitude.m),
        (AltitudeDatum::Home, Some(home)) => Ok(home.altitude_m + altitude.m),
        (AltitudeDatum::Home, None) => {
            Err("is above home, and the plan has no home: set it, or give it above sea level")
        }
        (AltitudeDatum::Terrain, _) => Err(
            "is above terrain, and there are no elevations: set terrain.folder in the \
             configuration, or give it above home or sea level",
        ),
    }
}
