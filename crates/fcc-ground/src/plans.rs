//! Flight plans: their hash, limits and check.

use fcc_core::flight::terrain::Terrain;
use fcc_flight::config::Config;
use fcc_plan::{
    AltitudeDatum, Format, Item, Loiter, LoiterEnd, Place, Plan, Problem, Speed, limits,
};
use serde_json::{Value, json};

/// Between points of a height profile, m, and how many at most.
const STEP_M: f64 = 50.0;
const MOST_POINTS: f64 = 2_000.0;
/// A longer leg is drawn with points between, for it is no straight line on a map.
const DRAWN_LEG_M: f64 = 20_000.0;

/// A plan's hash as in the record of each tick: its first 64 bits.
pub(crate) fn hash_text(plan: &Plan) -> String {
    format!("{:016x}", plan.hash().first_64_bits())
}

/// Whether it has no more parts than a file may have.
pub(crate) fn within_limits(plan: &Plan) -> Result<(), String> {
    let corners = plan.fence.polygons.iter().map(|side| side.corners.len());
    for (what, count, most) in [
        ("items", plan.items.len(), limits::ITEMS),
        ("polygons", plan.fence.polygons.len(), limits::FENCES),
        ("circles", plan.fence.circles.len(), limits::FENCES),
        ("corners of the fence", corners.sum(), limits::FENCE_CORNERS),
        ("rally points", plan.rally.len(), limits::RALLY_POINTS),
        ("obstacles", plan.obstacles.len(), limits::OBSTACLES),
    ] {
        if count > most {
            return Err(format!("{count} {what}: give at most {most}"));
        }
    }
    Ok(())
}

/// The plan as it is flown, with every problem: of its numbers, and of this aircraft.
pub(crate) fn checked(plan: &Plan, config: &Config) -> Result<Plan, Vec<Problem>> {
    within_limits(plan).map_err(|what| vec![Problem::of("", what)])?;
    let text = fcc_plan::write(plan, Format::QgcPlan)?;
    let read = fcc_plan::read(&text)?;
    if read.hash() != plan.hash() {
        let what = "the file that is written of it is another plan: export it, and import that";
        return Err(vec![Problem::of("", what)]);
    }
    config.checked_plan(&read)
}

/// The answer to a check: problems, remarks, way and ground below it.
pub(crate) fn check_answer(plan: &Plan, config: &Config) -> Value {
    let (flown, problems) = match checked(plan, config) {
        Ok(flown) => (flown, Vec::new()),
        Err(problems) => (plan.clone(), problems),
    };
    let remarks = if problems.is_empty() {
        config.plan_remarks(&flown)
    } else {
        Vec::new()
    };
    let problems = problems.iter().map(|problem| {
        json!({
            "item": problem.item,
            "field": problem.field,
            "message": problem.message,
            "level": "error",
        })
    });
    let remarks = remarks.iter().map(|remark| {
        let (item, message) = item_of(remark);
        json!({ "item": item, "field": "", "message": message, "level": "remark" })
    });
    let way = Way::of(plan, &flown, config);
    let ground = config.with_ground(plan, |terrain| terrain.map(|terrain| way.ground(terrain)));
    json!({
        "problems": problems.chain(remarks).collect::<Vec<_>>(),
        "distance_m": way.distance_m,
        "duration_s": way.duration_s,
        "path": way.path,
        "items": way.items,
        "terrain": ground.ok().flatten(),
        "hash": hash_text(&flown),
    })
}

/// The number of the item that a remark begins with.
fn item_of(remark: &str) -> (Option<usize>, &str) {
    let parts = remark
        .strip_prefix("item ")
        .and_then(|rest| rest.split_once(": "));
    match parts.and_then(|(number, rest)| Some((number.parse().ok()?, rest))) {
        Some((number, rest)) => (Some(number), rest),
        None => (None, remark),
    }
}

/// The way of a plan from place to place, without its turns and jumps, in calm air.
struct Way {
    distance_m: f64,
    duration_s: f64,
    /// Latitude, longitude, altitude above mean sea level.
    path: Vec<(f64, f64, f64)>,
    /// Of each item: the way to there and its altitude.
    items: Vec<Value>,
    places: Vec<Place>,
}

impl Way {
    fn of(plan: &Plan, flown: &Plan, config: &Config) -> Self {
        let conditions = config.plan_conditions();
        let home_m = plan.home.map_or(0.0, |home| home.altitude_m);
        let mut way = Self {
            distance_m: 0.0,
            duration_s: 0.0,
            path: Vec::new(),
            items: Vec::new(),
            places: Vec::new(),
        };
        let mut at = plan.home.map(|home| (home.place, home.altitude_m));
        if let Some((place, altitude_m)) = at {
            way.begin(place, altitude_m);
        }
        let mut mps = plan.cruise_mps.unwrap_or(conditions.airspeed_mps);
        for item in &flown.items {
            let altitude_m = item.altitude().map(|altitude| match altitude.above {
                AltitudeDatum::SeaLevel => altitude.m,
                AltitudeDatum::Home | AltitudeDatum::Terrain => home_m + altitude.m,
            });
            let altitude_m = altitude_m.or(at.map(|(_, m)| m)).unwrap_or(home_m);
            match item {
                Item::ChangeSpeed {
                    speed: Some(Speed::AirspeedMps(new) | Speed::GroundSpeedMps(new)),
                    ..
                } => mps = *new,
                Item::Loiter(loiter) => {
                    let radius_m = loiter.radius_m.unwrap_or(conditions.loiter_radius_m);
                    way.duration_s += loiter_s(loiter, radius_m, mps);
                }
                Item::Delay { seconds } => way.duration_s += seconds,
                _ => {}
            }
            let place = match item {
                Item::Return => plan.home.map(|home| home.place),
                Item::LandStart { .. } => None,
                item => item.place(),
            };
            if let Some(place) = place {
                match at {
                    Some(from) => way.leg(from, (place, altitude_m), mps.max(1.0)),
                    None => way.begin(place, altitude_m),
                }
                at = Some((place, altitude_m));
            }
            way.items.push(json!({
                "distance_m": way.distance_m,
                "altitude_m": altitude_m,
            }));
        }
        way
    }

    fn begin(&mut self, place: Place, altitude_m: f64) {
        self.path
            .push((place.latitude_deg, place.longitude_deg, altitude_m));
        self.places.push(place);
    }

    fn leg(&mut self, from: (Place, f64), to: (Place, f64), mps: f64) {
        let (length_m, course_deg, _) = from.0.to(to.0);
        let parts = (length_m / DRAWN_LEG_M).ceil().clamp(1.0, 100.0) as u32;
        for part in 1..parts {
            let share = f64::from(part) / f64::from(parts);
            let place = from.0.ahead(course_deg, share * length_m);
            let altitude_m = from.1 + share * (to.1 - from.1);
            self.path
                .push((place.latitude_deg, place.longitude_deg, altitude_m));
        }
        self.begin(to.0, to.1);
        self.distance_m += length_m;
        self.duration_s += length_m / mps;
    }

    /// The ground below: the way to there, and the elevation, if it is known.
    fn ground(&self, terrain: &Terrain<'_>) -> Vec<(f64, Option<f64>)> {
        let (mut ground, mut along_m) = (Vec::new(), 0.0);
        let step_m = STEP_M.max(self.distance_m / MOST_POINTS);
        for (from, to) in self.places.iter().zip(self.places.iter().skip(1)) {
            let (length_m, course_deg, _) = from.to(*to);
            let steps = (length_m / step_m).ceil().clamp(1.0, MOST_POINTS) as u32;
            for step in 0..=steps {
                let at_m = length_m * f64::from(step) / f64::from(steps);
                let place = from.ahead(course_deg, at_m);
                let (latitude, longitude) = (place.latitude_deg, place.longitude_deg);
                let found = terrain.elevation_m(latitude.to_radians(), longitude.to_radians());
                ground.push((along_m + at_m, found));
            }
            along_m += length_m;
        }
        ground
    }
}

/// How long a loiter takes on its circle; one without an end is not counted.
fn loiter_s(loiter: &Loiter, radius_m: f64, mps: f64) -> f64 {
    match loiter.end {
        LoiterEnd::Turns(turns) => turns * std::f64::consts::TAU * radius_m.abs() / mps.max(1.0),
        LoiterEnd::Seconds(seconds) => seconds,
        LoiterEnd::Never | LoiterEnd::Altitude => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A degree of latitude at 45° is 111,132 m on WGS-84.
    #[test]
    fn the_way_of_a_plan_is_measured() {
        let text = "QGC WPL 110\n0 1 0 16 0 0 0 0 44.5 8 120 1\n1 0 2 178 0 50 -1 0 0 0 0 1\n\
                    2 0 3 16 0 0 0 0 45.5 8 300 1\n";
        let plan = fcc_plan::read(text).unwrap();
        let config = Config::default();
        let answer = check_answer(&plan, &config);
        let distance_m = answer["distance_m"].as_f64().unwrap();
        assert!((distance_m - 111_132.0).abs() < 10.0, "{distance_m}");
        let duration_s = answer["duration_s"].as_f64().unwrap();
        assert!((duration_s - 111_132.0 / 50.0).abs() < 1.0, "{duration_s}");
        assert_eq!(answer["items"][1]["altitude_m"], 420.0);
        let path = answer["path"].as_array().unwrap();
        assert_eq!(path[0], json!([44.5, 8.0, 120.0]));
        assert_eq!(path[path.len() - 1], json!([45.5, 8.0, 420.0]));
        assert_eq!(answer["terrain"], Value::Null);
        assert_eq!(answer["hash"].as_str().unwrap().len(), 16);
    }

    #[test]
    fn a_remark_names_its_item() {
        assert_eq!(item_of("item 3: is high"), (Some(3), "is high"));
        assert_eq!(item_of("the plan is long"), (None, "the plan is long"));
    }
}
