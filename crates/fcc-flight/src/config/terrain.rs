//! `[terrain]`: the elevations that plans are checked against.

use std::path::PathBuf;

use fcc_core::flight::terrain::Terrain;
use fcc_plan::{Item, Plan, Problem, Steps};
use fcc_terrain::{Area, Elevations};
use serde::{Deserialize, Serialize};

use super::Config;

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
}

impl Default for TerrainSection {
    fn default() -> Self {
        Self {
            folder: None,
            margin_m: 60.0,
            around_km: 20.0,
            memory_mb: 256.0,
        }
    }
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
        let section = &self.terrain;
        let area = Area::around(places(plan), section.around_km * 1e3);
        let Some((folder, area)) = section.folder.as_ref().zip(area) else {
            return Ok(of(None));
        };
        let most_bytes = (section.memory_mb * 1e6) as u64;
        let elevations = Elevations::read(folder, &area, most_bytes)
            .map_err(|error| Problem::of("terrain.folder", error.to_string()))?;
        Ok(elevations.with(|terrain| of(Some(terrain))))
    }

    /// A plan as it is flown with this configuration: with altitudes above terrain as
    /// those above mean sea level.
    ///
    /// # Errors
    /// All problems of the plan.
    pub fn checked_plan(&self, plan: &Plan) -> Result<Plan, Vec<Problem>> {
        let checked = self.with_ground(plan, |terrain| {
            let Some(terrain) = terrain else {
                let problems = self.problems_in_the_air(plan);
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
        problems.extend(self.runway_problems(plan));
        problems
    }
}
