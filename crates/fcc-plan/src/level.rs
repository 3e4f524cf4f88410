//! Items that lie below the ground, where no tiles of elevations are given, or below
//! another altitude that is kept.

use crate::item::Item;
use crate::leg::{above_sea_level, landing_elevation_m};
use crate::plan::{Plan, limits};
use crate::problem::Problem;

/// An altitude below which no item is to be.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Level {
    /// Above mean sea level, m.
    pub m: f64,
    /// What it is, in messages.
    pub name: &'static str,
    /// A landing may be so far below it, m.
    pub landing_off_m: f64,
}

impl Level {
    /// A landing may be so far below what is taken for the ground, m: with an altimeter
    /// that is farther off, a take-off is not begun.
    pub const LANDING_OFF_M: f64 = 20.0;

    /// The elevation of a plan's home, if it has one.
    pub fn home(plan: &Plan) -> Option<Self> {
        plan.home.map(|home| Self {
            m: home.altitude_m,
            name: "the elevation of home",
            landing_off_m: Self::LANDING_OFF_M,
        })
    }

    /// The elevation of a plan's landing, if it has one.
    pub fn landing(plan: &Plan) -> Option<Self> {
        landing_elevation_m(plan).map(|m| Self {
            m,
            name: "the elevation of the landing",
            landing_off_m: Self::LANDING_OFF_M,
        })
    }

    /// The lower one of both.
    pub fn lowest_known(plan: &Plan) -> Option<Self> {
        let known = [Self::home(plan), Self::landing(plan)];
        let known = known.into_iter().flatten();
        known.min_by(|one, other| one.m.total_cmp(&other.m))
    }

    /// Items that are below it, each with what to do.
    pub fn items_below(&self, plan: &Plan, advice: &str) -> Vec<Problem> {
        let of_item = |(n, item): (usize, &Item)| {
            let altitude_m = above_sea_level(item.altitude()?, plan).ok()?;
            let below_m = self.m - altitude_m;
            let permitted_m = match item {
                Item::Land { .. } => self.landing_off_m,
                _ => 0.0,
            };
            (below_m > permitted_m).then(|| {
                let message = format!(
                    "{altitude_m:.0} m above mean sea level is {below_m:.0} m below {}, {:.0} m: \
                     {advice}",
                    self.name, self.m
                );
                Problem::of_item(n + 1, "altitude", message)
            })
        };
        let found = plan.items.iter().enumerate().filter_map(of_item);
        found.take(limits::PROBLEMS).collect()
    }
}
