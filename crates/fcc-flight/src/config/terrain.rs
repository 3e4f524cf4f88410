//! `[terrain]`: the elevations that plans are checked against.

use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

use fcc_core::flight::terrain::Terrain;
use fcc_plan::{Item, Plan, Problem, Steps};
use fcc_terrain::{Area, Elevations};
use serde::{Deserialize, Serialize};

use super::{Config, ConfigError};

/// `[terrain]`.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct TerrainSection {
    /// Tiles of SRTM, or GeoTIFF; none: no terrain.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub folder: Option<PathBuf>,
    /// How far the path of a plan stays above the ground.
    pub margin_m: f64,
    /// How far around the places of a plan elevations are read.
    pub around_km: f64,
    /// The most memory that elevations take.
    pub memory_mb: f64,
    /// The SHA-256 of the elevations that a flight has: fccd writes it into a recording.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sha256: Option<String>,
    /// The elevations that a flight has.
    #[serde(skip)]
    pub(crate) loaded: Option<Terrain<'static>>,
}

impl Default for TerrainSection {
    fn default() -> Self {
        Self {
            folder: None,
            margin_m: 60.0,
            around_km: 20.0,
            memory_mb: 256.0,
            sha256: None,
            loaded: None,
        }
    }
}

/// Elevations that flights of this program have: they are never given back, since a tick
/// may look into them.
static LOADED: Mutex<Vec<(String, Terrain<'static>)>> = Mutex::new(Vec::new());

/// The elevations with a hash, once for all flights.
fn kept(hash: &str, elevations: Elevations) -> Terrain<'static> {
    let mut loaded = LOADED.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((_, terrain)) = loaded.iter().find(|(kept, _)| kept == hash) {
        return *terrain;
    }
    let terrain = elevations.leak();
    loaded.push((hash.to_owned(), terrain));
    terrain
}

/// Home, items and rally points.
fn places(plan: &Plan) -> impl Iterator<Item = (f64, f64)> + '_ {
    let home = plan.home.map(|home| home.place);
    let items = plan.items.iter().filter_map(Item::place);
    let rally = plan.rally.iter().map(|rally| rally.place);
    let all = home.into_iter().chain(items).chain(rally);
    all.map(|place| (place.latitude_deg, place.longitude_deg))
}

impl Config {
    /// Something about the ground around a plan; without a folder of tiles, about none.
    ///
    /// # Errors
    /// The problem, if the elevations cannot be read.
    pub fn with_ground<T>(
        &self,
        plan: &Plan,
        of: impl FnOnce(Option<&Terrain<'_>>) -> T,
    ) -> Result<T, Problem> {
        if let Some(terrain) = &self.terrain.loaded {
            return Ok(of(Some(terrain)));
        }
        match self.elevations(plan)? {
            Some(elevations) => Ok(elevations.with(|terrain| of(Some(terrain)))),
            None => Ok(of(None)),
        }
    }

    fn elevations(&self, plan: &Plan) -> Result<Option<Elevations>, Problem> {
        let section = &self.terrain;
        let area = Area::around(places(plan), section.around_km * 1e3);
        let Some((folder, area)) = section.folder.as_ref().zip(area) else {
            return Ok(None);
        };
        let most_bytes = (section.memory_mb * 1e6) as u64;
        let read = Elevations::read(folder, &area, most_bytes);
        let read = read.map_err(|error| Problem::of("terrain.folder", error.to_string()))?;
        Ok(Some(read))
    }

    /// Reads the elevations around a plan for a flight, or for its replay, which needs the
    /// same ones.
    ///
    /// # Errors
    /// The problem, if they cannot be read, or are others than those that were recorded.
    pub(crate) fn load_terrain(&mut self, plan: &Plan) -> Result<(), Problem> {
        let Some(elevations) = self.elevations(plan)? else {
            return Ok(());
        };
        let hash = elevations.hash();
        if self
            .terrain
            .sha256
            .as_ref()
            .is_some_and(|sha256| *sha256 != hash)
        {
            let message = "the elevations are others than those of terrain.sha256: give the \
                           tiles of that flight, or take the key out";
            return Err(Problem::of("terrain.folder", message));
        }
        self.terrain.loaded = Some(kept(&hash, elevations));
        self.terrain.sha256 = Some(hash);
        Ok(())
    }

    /// A recorded configuration with the elevations of its flight, if it had some; `name`
    /// is its own in messages.
    ///
    /// # Errors
    /// As [`load_terrain`](Self::load_terrain).
    pub(crate) fn with_recorded_terrain(mut self, name: &str) -> Result<Self, ConfigError> {
        let plan = self.plan.plan().cloned();
        let Some(plan) = plan.filter(|_| self.terrain.sha256.is_some()) else {
            return Ok(self);
        };
        match self.load_terrain(&plan) {
            Ok(()) => Ok(self),
            Err(problem) => Err(ConfigError::Invalid {
                file: name.to_owned(),
                problems: vec![super::Problem {
                    line: None,
                    key: Some(problem.field),
                    message: problem.message,
                }],
            }),
        }
    }

    /// A plan as it is flown with this configuration: with altitudes above terrain as
    /// those above mean sea level.
    ///
    /// # Errors
    /// All problems of the plan.
    pub fn checked_plan(&self, plan: &Plan) -> Result<Plan, Vec<Problem>> {
        let checked = self.with_ground(plan, |terrain| {
            let Some(terrain) = terrain else {
                let mut problems = self.problems_in_the_air(plan);
                problems.extend(self.built_in_problems(plan));
                return Ok::<_, Vec<Problem>>((plan.clone(), problems));
            };
            let plan = fcc_plan::resolve(plan, terrain)?;
            let mut problems = self.problems_in_the_air(&plan);
            let (conditions, margin_m) = (self.plan_conditions(), self.terrain.margin_m);
            let ground = fcc_plan::terrain_problems(&plan, &conditions, terrain, margin_m);
            problems.extend(ground);
            Ok((plan, problems))
        });
        let (plan, problems) = checked.map_err(|problem| vec![problem])??;
        if problems.is_empty() {
            Ok(plan)
        } else {
            Err(problems)
        }
    }

    /// All problems of a plan that is flown with this configuration.
    pub fn plan_problems(&self, plan: &Plan) -> Vec<Problem> {
        self.checked_plan(plan).err().unwrap_or_default()
    }

    /// Problems of a plan that are not those of the ground below.
    fn problems_in_the_air(&self, plan: &Plan) -> Vec<Problem> {
        let mut problems = fcc_plan::check(plan, &self.plan_conditions())
            .err()
            .unwrap_or_default();
        let flown = Steps::of(plan, &self.autopilot_config().route).err();
        for problem in flown.unwrap_or_default() {
            if !problems.contains(&problem) {
                problems.push(problem);
            }
        }
        problems.extend(self.floor_problems(plan));
        problems
    }
}
