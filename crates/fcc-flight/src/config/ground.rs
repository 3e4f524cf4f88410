//! What is known of the ground below a plan without tiles of elevations.

use fcc_core::units::FOOT_M;
use fcc_plan::{Item, Level, Plan, Problem, Usual, unusual};

use super::{BuiltInSection, Config};

/// Where the built-in aircraft can begin, degrees of latitude.
const MOST_LATITUDE_DEG: f64 = 80.0;

impl Config {
    /// The level ground of the built-in aircraft; none of another one, whose ground is not
    /// level.
    fn level_ground(&self, plan: &Plan) -> Option<Level> {
        let built_in = self.built_in.as_ref()?;
        let takes_off = matches!(plan.items.first(), Some(Item::Takeoff { .. }));
        let is_given = built_in.ground_ft != BuiltInSection::default().ground_ft;
        let given = is_given.then_some(Level {
            m: built_in.ground_ft * FOOT_M,
            name: "built-in.ground_ft",
            landing_off_m: Level::LANDING_OFF_M,
        });
        let home = Level::home(plan);
        home.filter(|_| takes_off)
            .or(given)
            .or_else(|| Level::landing(plan))
            .or(home)
    }

    /// Items below the level ground of the built-in aircraft, and where that does not begin.
    pub(super) fn built_in_problems(&self, plan: &Plan) -> Vec<Problem> {
        let ground = self.level_ground(plan);
        let advice = "fly higher; there are valleys with the tiles of terrain.folder only";
        let mut problems = ground.map_or_else(Vec::new, |ground| ground.items_below(plan, advice));
        problems.extend(self.start_problem(plan));
        problems
    }

    fn start_problem(&self, plan: &Plan) -> Option<Problem> {
        self.built_in
            .as_ref()?
            .latitude_deg
            .is_none()
            .then_some(())?;
        let first = plan.items.iter().enumerate().find_map(|(n, item)| {
            let place = item.place()?;
            Some((Some(n + 1), place))
        });
        let home = plan.home.map(|home| (None, home.place));
        let (item, place) = home.or(first)?;
        let message = format!(
            "{:.2}°: the built-in aircraft begins there, and can between -{MOST_LATITUDE_DEG:.0}° \
             and {MOST_LATITUDE_DEG:.0}° only: move it, or give built-in.latitude_deg",
            place.latitude_deg
        );
        (place.latitude_deg.abs() > MOST_LATITUDE_DEG).then_some(match item {
            Some(item) => Problem::of_item(item, "latitude", message),
            None => Problem::of("home: latitude", message),
        })
    }

    /// Items below `autopilot.envelope.floor_ft`, above which nothing of them is flown.
    pub(super) fn floor_problems(&self, plan: &Plan) -> Vec<Problem> {
        let lowest_m = self.autopilot_config().envelope.lowest_altitude_m();
        let floor = lowest_m.map(|m| Level {
            m,
            name: "autopilot.envelope.floor_ft with its margin",
            landing_off_m: f64::INFINITY,
        });
        let advice = "fly higher, or choose a lower floor";
        floor.map_or_else(Vec::new, |floor| floor.items_below(plan, advice))
    }

    /// What is worth a look in a plan that is accepted: places below home and the landing
    /// may be in a valley, or in the ground, which is not known without tiles; and what is
    /// seldom meant.
    pub fn plan_remarks(&self, plan: &Plan) -> Vec<String> {
        // What tiles show to be too low is refused.
        let ground = match self.terrain.folder {
            Some(_) => None,
            None if self.built_in.is_some() => self.level_ground(plan),
            None => Level::lowest_known(plan),
        };
        let advice = "is there a valley? The tiles of terrain.folder tell";
        let below = ground.filter(|_| self.built_in.is_none());
        let mut found = below.map_or_else(Vec::new, |lowest| lowest.items_below(plan, advice));
        let usual = Usual {
            ground: ground.map(|ground| (ground, self.terrain.margin_m)),
            ceiling_m: self.plan.service_ceiling_ft * FOOT_M,
        };
        found.extend(unusual(plan, &self.plan_conditions(), &usual));
        found.iter().map(ToString::to_string).collect()
    }
}
