//! `[plan]`: the flight plan, and how it is flown.

use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use fcc_core::units::{FOOT_M, FOOT_PER_MINUTE_MPS, KNOT_MPS};
use fcc_guidance::path::NpfgConfig;
use fcc_guidance::route::{Route, RouteConfig};
use fcc_plan::{Conditions, FileError, Format, Identity, Item, Place, Problem, Steps};
use serde::{Deserialize, Serialize};

use super::autopilot::RunwaySection;
use super::{AutopilotSection, BuiltInSection, Config, ConfigError, GuidanceSection};

/// The built-in aircraft begins at least so high over the runway of its plan.
const LEAST_ABOVE_GROUND_FT: f64 = 1_000.0;

/// `[plan]`.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct PlanSection {
    /// A `.plan` of QGroundControl, or a `QGC WPL 110`; relative to the folder where the
    /// program is started.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<PathBuf>,
    /// The strongest wind, from any direction, that the plan is checked for.
    pub wind_kt: f64,
    /// Period of the oscillation around the path; none for the law's own.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub period_s: Option<f64>,
    /// The largest bank of a turn over the ground; the envelope may limit it further.
    pub max_bank_deg: f64,
    /// The largest rate at which the bank is commanded.
    pub bank_rate_degps: f64,
    /// The radius of a circle for which the plan gives none.
    pub loiter_radius_m: f64,
    /// The height above home at which the aircraft returns at least.
    pub return_height_ft: f64,
    /// The highest altitude of the aircraft above mean sea level; the plan's above it are
    /// remarked on.
    pub service_ceiling_ft: f64,
    /// The plan itself, as a `.plan`: fccd writes it into a recording.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub content: Option<String>,
    /// When it was uploaded, s since 1970 (UTC): likewise.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub uploaded_unix_s: Option<u64>,
    /// The plan that was read.
    #[serde(skip)]
    loaded: Option<Loaded>,
}

/// A plan that can be flown.
#[derive(Clone, Debug)]
struct Loaded {
    identity: Identity,
    route: Route<'static>,
    plan: fcc_plan::Plan,
}

impl Default for PlanSection {
    fn default() -> Self {
        let route = RouteConfig::default();
        Self {
            file: None,
            wind_kt: 20.0,
            period_s: None,
            max_bank_deg: 30.0,
            bank_rate_degps: 15.0,
            loiter_radius_m: route.loiter_radius_m,
            return_height_ft: 500.0,
            // Handbook of the Cessna 172P (1981), at 2,400 lb.
            service_ceiling_ft: 13_000.0,
            content: None,
            uploaded_unix_s: None,
            loaded: None,
        }
    }
}

impl PlanSection {
    /// How routes are flown.
    pub(super) fn route_config(&self, runway: &RunwaySection) -> RouteConfig {
        RouteConfig {
            law: NpfgConfig {
                period_s: self.period_s.unwrap_or(NpfgConfig::default().period_s),
                ..NpfgConfig::default()
            },
            bank_rad: self.max_bank_deg.to_radians(),
            bank_rate_radps: self.bank_rate_degps.to_radians(),
            loiter_radius_m: self.loiter_radius_m,
            return_height_m: self.return_height_ft * FOOT_M,
            runway: runway.into(),
        }
    }

    /// The plan's route, after it was read.
    pub fn route(&self) -> Option<Route<'static>> {
        self.loaded.as_ref().map(|loaded| loaded.route)
    }

    /// The plan, after it was read.
    pub fn plan(&self) -> Option<&fcc_plan::Plan> {
        self.loaded.as_ref().map(|loaded| &loaded.plan)
    }

    /// Which plan it is, after it was read.
    pub fn identity(&self) -> Option<Identity> {
        self.loaded.as_ref().map(|loaded| loaded.identity)
    }

    /// Reads [`content`](Self::content), which was checked when it was recorded.
    pub(super) fn content_problems(&mut self) -> Vec<super::Problem> {
        let Some(content) = &self.content else {
            return Vec::new();
        };
        let uploaded_s = self.uploaded_unix_s.unwrap_or(0);
        let problems = match fcc_plan::read(content) {
            Ok(plan) => self.take(plan, uploaded_s).err().unwrap_or_default(),
            Err(problems) => problems,
        };
        let of_content = |problem: Problem| super::Problem {
            line: None,
            key: Some("plan.content".to_owned()),
            message: problem.to_string(),
        };
        problems.into_iter().map(of_content).collect()
    }

    fn take(&mut self, plan: fcc_plan::Plan, uploaded_s: u64) -> Result<(), Vec<Problem>> {
        let config = self.route_config(&RunwaySection::default());
        let route = Steps::of(&plan, &config)?.leak(uploaded_s);
        self.loaded = Some(Loaded {
            identity: Identity::of(&plan, uploaded_s),
            route,
            plan,
        });
        Ok(())
    }
}

impl Config {
    /// What a plan is checked for.
    pub fn plan_conditions(&self) -> Conditions {
        let AutopilotSection {
            envelope, runway, ..
        } = &self.autopilot;
        let airspeeds = self.autopilot_config().envelope.allowed_airspeeds();
        let glide_path = runway.glide_path_deg.to_radians().tan();
        Conditions {
            airspeed_mps: self.autopilot.reference_airspeed_kt * KNOT_MPS,
            slowest_mps: *airspeeds.start(),
            fastest_mps: *airspeeds.end(),
            wind_mps: self.plan.wind_kt * KNOT_MPS,
            bank_rad: self
                .plan
                .max_bank_deg
                .min(envelope.max_bank_deg)
                .to_radians(),
            climb_mps: envelope.max_climb_fpm * FOOT_PER_MINUTE_MPS,
            descent_mps: envelope.max_sink_fpm * FOOT_PER_MINUTE_MPS,
            loiter_radius_m: self.plan.loiter_radius_m,
            final_m: runway.decision_height_ft * FOOT_M / glide_path,
            fence_margin_m: self.contingency.watched_margin_m(),
        }
    }

    /// Reads and checks the file of the plan, if one is given, which is uploaded at
    /// this time, in s since 1970 (UTC). The built-in aircraft begins where the plan
    /// does, unless the configuration says where.
    ///
    /// # Errors
    /// All problems, each with its item.
    pub fn load_plan(&mut self, uploaded_s: u64) -> Result<(), FileError> {
        let Some(file) = self.plan.file.clone() else {
            return Ok(());
        };
        let plan = fcc_plan::read_file(&file)?;
        self.use_plan(&plan, &file, uploaded_s)
    }

    /// The configuration with its plan, if it has one; `name` is its own in messages.
    ///
    /// # Errors
    /// As [`load_plan`](Self::load_plan), for the key `plan.file`.
    pub fn with_plan(mut self, name: &str) -> Result<Self, ConfigError> {
        let now = SystemTime::now().duration_since(UNIX_EPOCH);
        let of_key = |message: String| super::Problem {
            line: None,
            key: Some("plan.file".to_owned()),
            message,
        };
        match self.load_plan(now.map_or(0, |since| since.as_secs())) {
            Ok(()) => Ok(self),
            Err(error) => Err(ConfigError::Invalid {
                file: name.to_owned(),
                problems: match error {
                    FileError::Invalid { file, problems } => problems
                        .iter()
                        .map(|problem| of_key(format!("{file}: {problem}")))
                        .collect(),
                    other => vec![of_key(format!(
                        "{other} (a relative path begins in the folder where the program is \
                         started)"
                    ))],
                },
            }),
        }
    }

    fn use_plan(
        &mut self,
        plan: &fcc_plan::Plan,
        file: &Path,
        uploaded_s: u64,
    ) -> Result<(), FileError> {
        let invalid = |problems| FileError::Invalid {
            file: file.display().to_string(),
            problems,
        };
        self.load_terrain(plan)
            .map_err(|problem| invalid(vec![problem]))?;
        let plan = self.checked_plan(plan).map_err(invalid)?;
        let content = fcc_plan::write(&plan, Format::QgcPlan).map_err(invalid)?;
        if self.flies_plan() {
            self.begin_at(&plan);
        }
        self.plan.take(plan, uploaded_s).map_err(invalid)?;
        self.plan.content = Some(content);
        self.plan.uploaded_unix_s = Some(uploaded_s);
        Ok(())
    }

    /// The built-in aircraft begins at the plan's home, or at its first place; on the
    /// runway there, if the plan begins with a take-off. Its ground is as high as the
    /// runway, unless the configuration has another one.
    fn begin_at(&mut self, plan: &fcc_plan::Plan) {
        let first = plan.items.iter().find_map(Item::place);
        let Some(place) = plan.home.map(|home| home.place).or(first) else {
            return;
        };
        if let Some(built_in) = &mut self.built_in {
            built_in.latitude_deg.get_or_insert(place.latitude_deg);
            built_in.longitude_deg.get_or_insert(place.longitude_deg);
            let takes_off = match plan.items.first() {
                Some(Item::Takeoff { place, .. }) => plan.home.zip(Some(*place)),
                _ => None,
            };
            if let Some((home, to)) = takes_off {
                built_in.on_runway = true;
                built_in.ground_ft = home.altitude_m / FOOT_M;
                built_in.altitude_ft = built_in.altitude_ft.max(built_in.ground_ft);
                if let Some(to) = to {
                    let (_, course_deg, _) = home.place.to(to);
                    built_in.heading_deg = course_deg.rem_euclid(360.0);
                }
            } else if let Some(elevation_m) = fcc_plan::landing_elevation_m(plan)
                && built_in.ground_ft == BuiltInSection::default().ground_ft
            {
                built_in.ground_ft = elevation_m / FOOT_M;
                let least_ft = built_in.ground_ft + LEAST_ABOVE_GROUND_FT;
                built_in.altitude_ft = built_in.altitude_ft.max(least_ft);
            }
        }
    }

    /// Flies a plan once engaged.
    pub fn fly_plan(&mut self, file: PathBuf) {
        self.plan.file = Some(file);
        self.guidance = GuidanceSection::Plan;
    }

    /// Flies the plan that a recorded configuration flew, by this one's rules; whether it
    /// flew one.
    ///
    /// # Errors
    /// What this configuration cannot fly.
    pub fn fly_plan_of(&mut self, recorded: &Self) -> Result<bool, Vec<Problem>> {
        let flown = recorded.plan.loaded.as_ref();
        let Some(flown) = flown.filter(|_| recorded.flies_plan()) else {
            return Ok(false);
        };
        self.plan
            .take(flown.plan.clone(), flown.identity.uploaded_s)?;
        self.guidance = GuidanceSection::Plan;
        Ok(true)
    }

    /// Whether a plan is flown once engaged.
    pub const fn flies_plan(&self) -> bool {
        matches!(self.guidance, GuidanceSection::Plan)
    }

    /// How long the plan takes at most, s: each leg against the wind that it is checked
    /// for, with its turns, and the way from where the built-in aircraft begins.
    pub fn plan_length_s(&self) -> Option<f64> {
        let plan = self.plan.plan()?;
        let conditions = self.plan_conditions();
        let begin = self.built_in.as_ref().and_then(|built_in| {
            Some(Place {
                latitude_deg: built_in.latitude_deg?,
                longitude_deg: built_in.longitude_deg?,
            })
        });
        let first = plan.items.iter().find_map(Item::place);
        let way_m = begin.zip(first).map_or(0.0, |(from, to)| from.to(to).0);
        let way_s = way_m / (conditions.airspeed_mps - conditions.wind_mps).max(1.0);
        Some(fcc_plan::longest_s(plan, &conditions) + way_s)
    }
}
