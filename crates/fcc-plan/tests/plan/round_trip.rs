//! What was written is read as the same plan, to the last bit.

use fcc_plan::{Format, Plan, read, write};
use proptest::prelude::*;

use crate::any_plan::any_plan;

/// The plan without what `QGC WPL 110` has no place for.
fn for_text(plan: Plan) -> Plan {
    let mut plan = plan;
    plan.cruise_mps = None;
    plan.fence.floor_m = None;
    plan.fence.ceiling_m = None;
    plan.obstacles.clear();
    plan
}

proptest! {
    #[test]
    fn by_a_plan_of_qgroundcontrol(plan in any_plan()) {
        let text = write(&plan, Format::QgcPlan).unwrap();
        let again = read(&text).unwrap();
        prop_assert_eq!(&again, &plan);
        prop_assert_eq!(again.hash(), plan.hash());
    }

    #[test]
    fn by_a_text(plan in any_plan()) {
        let plan = for_text(plan);
        let text = write(&plan, Format::QgcWpl).unwrap();
        let again = read(&text).unwrap();
        prop_assert_eq!(&again, &plan);
        prop_assert_eq!(again.hash(), plan.hash());
    }

    #[test]
    fn another_plan_has_another_hash(plan in any_plan(), other in any_plan()) {
        prop_assume!(plan != other);
        prop_assert_ne!(plan.hash(), other.hash());
    }

    #[test]
    fn any_text_is_read_or_refused(text in "(QGC WPL 110\n)?(\\PC|[0-9 \t\n.-])*") {
        let _ = read(&text);
    }
}

/// Hashes are in recordings: they never change. By `printf` and `sha256sum`, of
/// the text that the documentation of the hash states.
#[test]
fn the_hash_is_that_of_the_stated_text() {
    let text = "QGC WPL 110\n0 1 0 16 0 0 0 0 47.5 8.5 430 1\n1 0 3 16 0 50 0 0 47.6 8.6 300 1\n";
    let plan = read(text).unwrap();
    assert_eq!(
        plan.hash().to_string(),
        "62aedd326a971e7d4a8baf2b3e7ae666153f5f90ffa5913e0cdf158ddd4fd1df"
    );
}
