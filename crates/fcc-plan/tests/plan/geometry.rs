//! The plane that a tick uses against geodesics, anywhere on the earth.

use fcc_guidance::path::LocalPlane;
use fcc_plan::Place;
use proptest::prelude::*;

use crate::any_plan::any_place;

/// How far from the geodesic's end the plane puts it, m.
fn error_m(from: Place, course_deg: f64, distance_m: f64) -> f64 {
    let to = from.ahead(course_deg, distance_m);
    let radians = |place: Place| {
        (
            place.latitude_deg.to_radians(),
            place.longitude_deg.to_radians(),
        )
    };
    let (latitude, longitude) = radians(from);
    let (to_latitude, to_longitude) = radians(to);
    let seen = LocalPlane::at(latitude, longitude).position_m(to_latitude, to_longitude);
    let course = course_deg.to_radians();
    (seen.x - distance_m * course.cos()).hypot(seen.y - distance_m * course.sin())
}

proptest! {
    #[test]
    fn the_plane_is_good_to_its_documented_accuracy(
        from in any_place(), course_deg in -180.0..180.0_f64, share in 0.0..1.0_f64,
    ) {
        // At a pole itself all courses are of its longitude.
        prop_assume!(from.latitude_deg.abs() < 89.999_9);
        let near = error_m(from, course_deg, 20_000.0 * share);
        prop_assert!(near < 0.01, "{near} m within 20 km");
        let far = error_m(from, course_deg, 100_000.0 * share);
        prop_assert!(far < 1.0, "{far} m within 100 km");
    }
}
