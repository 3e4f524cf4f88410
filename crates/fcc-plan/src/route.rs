//! A plan as a tick reads it: [`fcc_guidance::route`].

use fcc_core::flight::terrain::Obstacle;
use fcc_guidance::route::{Destination, FOR_EVER, JUMPS, Route, RouteConfig, Runway, Step, Until};

use crate::item::{Altitude, Item, Loiter, LoiterEnd, Place, Speed};
use crate::leg::above_sea_level;
use crate::outline::Outline;
use crate::plan::{self, Plan, limits};
use crate::problem::Problem;

/// The steps of a plan, to be kept for as long as they are flown.
#[derive(Clone, PartialEq, Debug)]
pub struct Steps {
    steps: Vec<Step>,
    returns: Vec<Destination>,
    fence: Outline,
    obstacles: Vec<Obstacle>,
    airspeed_mps: Option<f64>,
    hash: u64,
}

impl Steps {
    /// Of a plan: step n is item n + 1.
    ///
    /// # Errors
    /// Every item that is not flown, with what to do.
    ///
    /// ```
    /// use fcc_guidance::route::RouteConfig;
    ///
    /// let text = "QGC WPL 110\n\
    ///     0 1 0 16 0 0 0 0 47.4 8.5 430 1\n\
    ///     1 0 3 21 0 0 0 0 47.5 8.6 300 1\n";
    /// let plan = fcc_plan::read(text).unwrap();
    /// let problems = fcc_plan::Steps::of(&plan, &RouteConfig::default()).unwrap_err();
    /// assert!(problems[0].to_string().starts_with("item 1: command: land needs a waypoint"));
    /// ```
    pub fn of(plan: &Plan, config: &RouteConfig) -> Result<Self, Vec<Problem>> {
        let mut problems = Vec::new();
        let mut steps = Vec::new();
        let mut jumps = 0;
        let mut before = None;
        for (n, item) in plan.items.iter().enumerate() {
            let step = step_of(plan, config, item, before, &mut jumps);
            match step {
                Ok(step) => steps.push(step),
                Err((field, message)) => {
                    problems.push(Problem::of_item(n + 1, field, message));
                }
            }
            before = item.place().or(before);
        }
        problems.truncate(limits::PROBLEMS);
        if !problems.is_empty() {
            return Err(problems);
        }
        Ok(Self {
            steps,
            returns: returns(plan, config),
            fence: Outline::of(plan, config.return_height_m),
            obstacles: plan.obstacles.iter().map(obstacle).collect(),
            airspeed_mps: plan.cruise_mps,
            hash: plan.hash().first_64_bits(),
        })
    }

    /// As a route, uploaded at this time, in s since 1970 (UTC), for the rest of the
    /// program: its memory, some 150 bytes an item, is not given back.
    pub fn leak(self, uploaded_unix_s: u64) -> Route<'static> {
        let (fence, fence_return) = self.fence.leak();
        Route {
            steps: self.steps.leak(),
            returns: self.returns.leak(),
            fence,
            fence_return,
            obstacles: self.obstacles.leak(),
            airspeed_mps: self.airspeed_mps,
            hash: self.hash,
            uploaded_unix_s,
        }
    }
}

type Refused = (&'static str, String);

fn step_of(
    plan: &Plan,
    config: &RouteConfig,
    item: &Item,
    before: Option<Place>,
    jumps: &mut u8,
) -> Result<Step, Refused> {
    let level = |altitude: Altitude| {
        above_sea_level(altitude, plan).map_err(|message| ("altitude", message.to_owned()))
    };
    Ok(match *item {
        Item::Waypoint {
            place,
            altitude,
            radius_m,
        } => Step::Waypoint {
            at: place.plane(),
            altitude_m: level(altitude)?,
            within_m: radius_m.unwrap_or(f64::INFINITY),
        },
        Item::Loiter(Loiter {
            place,
            altitude,
            radius_m,
            clockwise,
            end,
            leave_towards_next,
        }) => Step::Loiter {
            at: place.or(before).map(Place::plane),
            altitude_m: level(altitude)?,
            radius_m: radius_m.unwrap_or(config.loiter_radius_m),
            clockwise,
            until: match end {
                LoiterEnd::Never => Until::Never,
                LoiterEnd::Turns(turns) => Until::Turned(core::f64::consts::TAU * turns),
                LoiterEnd::Seconds(seconds) => Until::Elapsed(seconds),
                LoiterEnd::Altitude => Until::AtAltitude,
            },
            leave_towards_next,
        },
        Item::Return => Step::Return,
        Item::Delay { seconds } => Step::Delay(seconds),
        Item::UntilDistance { distance_m } => Step::UntilDistance(distance_m),
        Item::ChangeAltitude { altitude } => Step::Altitude(level(altitude)?),
        Item::ChangeSpeed {
            throttle_percent: Some(_),
            ..
        } => {
            let why = "a throttle is not flown, because the throttle holds the airspeed: give a \
                       speed alone, and -1 for it";
            return Err(("command", why.to_owned()));
        }
        Item::ChangeSpeed { speed, .. } => match speed {
            None => Step::Mark,
            Some(Speed::AirspeedMps(mps)) => Step::Airspeed(mps),
            Some(Speed::GroundSpeedMps(mps)) => Step::GroundSpeed(mps),
        },
        Item::Jump { to, times } => jump(to, times, jumps)?,
        Item::LandStart { .. } => Step::LandStart,
        Item::Camera { .. } => Step::Mark,
        Item::Takeoff {
            place,
            altitude,
            pitch_deg,
        } => Step::Takeoff {
            runway: takeoff_runway(plan, place),
            altitude_m: level(altitude)?,
            pitch_rad: pitch_deg.filter(|deg| *deg > 0.0).map(f64::to_radians),
        },
        Item::Land {
            place: None,
            abort_altitude_m,
            ..
        } => Step::LandBack {
            height_m: abort_height_m(abort_altitude_m, config),
        },
        Item::Land {
            place: Some(place),
            altitude,
            abort_altitude_m,
        } => {
            if before.is_none() {
                let needs = "land needs a waypoint before it: the runway has the direction of \
                             the leg that leads to it";
                return Err(("command", needs.to_owned()));
            }
            let elevation_m = level(altitude)?;
            let abort_m = abort_height_m(abort_altitude_m, config);
            let home_m = plan.home.map_or(elevation_m, |home| home.altitude_m);
            Step::Land {
                at: place.plane(),
                elevation_m,
                abort_altitude_m: abort_m + home_m.max(elevation_m),
            }
        }
    })
}

/// Above home or the runway, to which it climbs when a landing is given up, m.
fn abort_height_m(given_m: Option<f64>, config: &RouteConfig) -> f64 {
    let given_m = given_m.filter(|above_m| *above_m > 0.0);
    given_m.unwrap_or(config.return_height_m)
}

/// The centre line from home to the place of a take-off.
fn takeoff_runway(plan: &Plan, to: Option<Place>) -> Option<Runway> {
    let (home, to) = (plan.home?, to?);
    let at = home.place.plane();
    let way = at.origin_of_m(&to.plane());
    let course = way.try_normalize(1.0)?;
    Some(Runway {
        at,
        course,
        elevation_m: home.altitude_m,
    })
}

fn jump(to: usize, times: Option<u32>, jumps: &mut u8) -> Result<Step, Refused> {
    let problem = |message: String| ("jump", message);
    let index = to.checked_sub(1).and_then(|to| u16::try_from(to).ok());
    let Some(to) = index else {
        return Err(problem(format!("to {to}: there is no such item")));
    };
    let counter = *jumps;
    let times = match times {
        None => FOR_EVER,
        Some(times) => u16::try_from(times).map_or(FOR_EVER - 1, |times| times.min(FOR_EVER - 1)),
    };
    if times != FOR_EVER {
        if usize::from(counter) >= JUMPS {
            return Err(problem(format!(
                "there are more than {JUMPS}: repeat the items"
            )));
        }
        *jumps += 1;
    }
    Ok(Step::Jump { to, times, counter })
}

fn obstacle(obstacle: &plan::Obstacle) -> Obstacle {
    let (latitude_rad, longitude_rad) = obstacle.centre.radians();
    Obstacle {
        latitude_rad,
        longitude_rad,
        radius_m: obstacle.radius_m,
        top_m: obstacle.top_m,
    }
}

/// Home and the rally points, with the altitudes of a return above mean sea level.
fn returns(plan: &Plan, config: &RouteConfig) -> Vec<Destination> {
    let Some(home) = plan.home else {
        return Vec::new();
    };
    let rally = plan.rally.iter().map(|rally| Destination {
        at: rally.place.plane(),
        altitude_m: home.altitude_m + rally.altitude_m,
    });
    let home = Destination {
        at: home.place.plane(),
        altitude_m: home.altitude_m + config.return_height_m,
    };
    std::iter::once(home).chain(rally).collect()
}
