//! Plans that replace the one that is flown: read, checked and made into routes beside
//! the loop.

use std::path::Path;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};

use fcc_fixed_wing::{AutopilotCommand, PlanReplacement};
use fcc_guidance::route::{PreparedRoutes, Route, RouteConfig, RouteSource};
use fcc_plan::{FileError, Format, Identity, Plan, Problem, Steps};
use fcc_record::Document;

use super::Config;

/// Plans that a program can prepare: their routes are never given back, since a tick may
/// follow one of them.
const MOST_PLANS: usize = 1_024;
/// Items, places and corners of all of them: some 30 MB.
const MOST_PARTS: usize = 200_000;
/// The name of a recording's document that is a plan begins so.
const DOCUMENT: &str = "flight-plan-";

/// A plan that is ready to be flown.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct PreparedPlan {
    /// Which it is, and from where it is flown.
    pub replacement: PlanReplacement,
    /// The first digits of its hash, and how many items it has.
    pub which: String,
    /// Itself, as a `.plan`.
    pub content: String,
    /// What is accepted, and worth a look.
    pub remarks: Vec<String>,
}

impl PreparedPlan {
    /// The command that flies it.
    pub const fn command(&self) -> AutopilotCommand {
        AutopilotCommand::ReplacePlan(self.replacement)
    }

    /// Itself, for the recording.
    pub fn document(&self) -> Document {
        Document {
            name: format!("{DOCUMENT}{:016x}.plan", self.replacement.plan_hash),
            text: self.content.clone(),
        }
    }
}

/// A prepared route, and how it is flown.
#[derive(Debug)]
struct Place {
    config: RouteConfig,
    route: Route<'static>,
}

/// The prepared routes of a program, filled from the first place on and never emptied.
#[derive(Debug)]
struct Shelf {
    places: [OnceLock<Place>; MOST_PLANS],
    parts: AtomicUsize,
}

static SHELF: Shelf = Shelf {
    places: [const { OnceLock::new() }; MOST_PLANS],
    parts: AtomicUsize::new(0),
};

impl Shelf {
    fn places(&self) -> impl Iterator<Item = &Place> {
        self.places.iter().map_while(OnceLock::get)
    }

    fn put(&self, plan: &Plan, config: &RouteConfig) -> Result<(), Vec<Problem>> {
        let hash = plan.hash().first_64_bits();
        if self.route(hash, config).is_some() {
            return Ok(());
        }
        let steps = Steps::of(plan, config)?;
        let corners = plan.fence.polygons.iter().map(|side| side.corners.len());
        let parts = plan.items.len() + plan.rally.len() + corners.sum::<usize>();
        let full = || {
            let message = "no more plans can be prepared by this program: start it again";
            Err(vec![Problem::of("", message)])
        };
        if self.parts.fetch_add(parts, Ordering::Relaxed) + parts > MOST_PARTS {
            return full();
        }
        let mut place = Place {
            config: *config,
            route: steps.leak(0),
        };
        for free in &self.places {
            match free.set(place) {
                Ok(()) => return Ok(()),
                Err(back) => place = back,
            }
        }
        full()
    }
}

impl PreparedRoutes for Shelf {
    fn route(&self, hash: u64, config: &RouteConfig) -> Option<Route<'static>> {
        let found = self
            .places()
            .find(|place| place.route.hash == hash && place.config == *config);
        found.map(|place| place.route)
    }
}

/// Where the autopilot finds prepared routes.
pub(super) const fn prepared_routes() -> RouteSource {
    RouteSource::new(&SHELF)
}

/// How many items a prepared plan has, by its hash.
#[cfg(feature = "live")]
pub(crate) fn items_of(hash: u64) -> Option<usize> {
    let found = SHELF.places().find(|place| place.route.hash == hash);
    found.map(|place| place.route.steps.len())
}

impl Config {
    /// Reads and checks a plan that is to replace the one that is flown, from an item on,
    /// uploaded at this time, in s since 1970 (UTC).
    ///
    /// # Errors
    /// All problems, as those of [`load_plan`](Self::load_plan).
    pub fn prepare_plan(
        &self,
        file: &Path,
        item: u16,
        uploaded_s: u64,
    ) -> Result<PreparedPlan, FileError> {
        let invalid = |problems| FileError::Invalid {
            file: file.display().to_string(),
            problems,
        };
        let plan = fcc_plan::read_file(file)?;
        let (plan, mut problems) = match self.checked_plan(&plan) {
            Ok(checked) => (checked, Vec::new()),
            Err(problems) => (plan, problems),
        };
        // That a plan has no items is said.
        if plan.item(usize::from(item)).is_none() && !plan.items.is_empty() {
            let message = format!(
                "{item}: there is no such item: give 1 to {}",
                plan.items.len()
            );
            problems.push(Problem::of("item to begin with", message));
        }
        if !problems.is_empty() {
            return Err(invalid(problems));
        }
        self.prepare(&plan, item, uploaded_s).map_err(invalid)
    }

    /// A plan that was prepared before, from its content.
    ///
    /// # Errors
    /// Its problems, if it is none.
    pub fn prepare_again(
        &self,
        content: &str,
        item: u16,
        uploaded_s: u64,
    ) -> Result<PreparedPlan, Vec<Problem>> {
        self.prepare(&fcc_plan::read(content)?, item, uploaded_s)
    }

    /// Prepares the plan in a recording's document, if it is one.
    pub fn prepare_recorded(&self, document: &Document) {
        if document.name.starts_with(DOCUMENT) {
            // One that is none is missing when it is flown.
            let _ = self.prepare_again(&document.text, 0, 0);
        }
    }

    fn prepare(
        &self,
        plan: &Plan,
        item: u16,
        uploaded_s: u64,
    ) -> Result<PreparedPlan, Vec<Problem>> {
        let content = fcc_plan::write(plan, Format::QgcPlan)?;
        SHELF.put(plan, &self.autopilot_config().route)?;
        let hash = Identity::of(plan, uploaded_s).hash;
        Ok(PreparedPlan {
            replacement: PlanReplacement {
                plan_hash: hash.first_64_bits(),
                plan_uploaded_unix_s: uploaded_s,
                item,
            },
            which: format!("{hash:.12}, {} items", plan.items.len()),
            content,
            remarks: self.plan_remarks(plan),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(north_deg: f64) -> String {
        format!("QGC WPL 110\n0 0 0 16 0 0 0 0 47 8 900 1\n1 0 0 16 0 0 0 0 {north_deg} 8 900 1\n")
    }

    #[test]
    fn a_plan_is_prepared_once_and_found_by_its_hash() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.waypoints");
        std::fs::write(&file, plan(47.25)).unwrap();
        let config = Config::default();
        let first = config.prepare_plan(&file, 1, 5).unwrap();
        let again = config.prepare_plan(&file, 1, 6).unwrap();
        assert_eq!(first.replacement.plan_hash, again.replacement.plan_hash);
        assert_eq!(again.replacement.plan_uploaded_unix_s, 6);
        let hash = first.replacement.plan_hash;
        let prepared = SHELF.places().filter(|place| place.route.hash == hash);
        assert_eq!(prepared.count(), 1);
        #[cfg(feature = "live")]
        assert_eq!((items_of(hash), items_of(hash ^ 1)), (Some(1), None));
        // Another radius of circles is another route.
        let mut other = RouteConfig::default();
        other.loiter_radius_m += 1.0;
        assert!(SHELF.route(hash, &other).is_none());
        let restored = config.prepare_again(&first.content, 1, 5).unwrap();
        assert_eq!(restored, first);
    }
}
