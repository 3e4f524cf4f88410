//! Distances and directions on WGS-84 by geodesics (Karney, "Algorithms for
//! geodesics", 2013), for what is not computed in a tick.

use std::sync::LazyLock;

use fcc_guidance::path::LocalPlane;
use geographiclib_rs::{DirectGeodesic as _, Geodesic, InverseGeodesic as _};

use crate::item::Place;

static WGS84: LazyLock<Geodesic> = LazyLock::new(Geodesic::wgs84);

impl Place {
    /// The distance to another place, m, and the course there and at arrival, degrees
    /// clockwise from north in -180 to 180.
    ///
    /// ```
    /// use fcc_plan::Place;
    ///
    /// // Wellington to Salamanca, which are almost opposite on the earth
    /// // (GeographicLib's documentation of its Python package: 19,959,679 m).
    /// let wellington = Place { latitude_deg: -41.32, longitude_deg: 174.81 };
    /// let salamanca = Place { latitude_deg: 40.96, longitude_deg: -5.50 };
    /// let (distance_m, course_deg, _) = wellington.to(salamanca);
    /// assert_eq!(distance_m.round(), 19_959_679.0);
    /// assert!((course_deg - 161.067_669_986_160_07).abs() < 1e-9);
    /// ```
    pub fn to(self, other: Self) -> (f64, f64, f64) {
        let (distance_m, course_deg, arrival_deg, _) = WGS84.inverse(
            self.latitude_deg,
            self.longitude_deg,
            other.latitude_deg,
            other.longitude_deg,
        );
        (distance_m, course_deg, arrival_deg)
    }

    /// The place at a distance in m along the geodesic of a course in degrees.
    #[must_use]
    pub fn ahead(self, course_deg: f64, distance_m: f64) -> Self {
        let (latitude_deg, longitude_deg) = WGS84.direct(
            self.latitude_deg,
            self.longitude_deg,
            course_deg,
            distance_m,
        );
        Self {
            latitude_deg,
            longitude_deg,
        }
    }

    pub(crate) const fn radians(self) -> (f64, f64) {
        (
            self.latitude_deg.to_radians(),
            self.longitude_deg.to_radians(),
        )
    }

    /// The plane around it.
    pub(crate) fn plane(self) -> LocalPlane {
        let (latitude, longitude) = self.radians();
        LocalPlane::at(latitude, longitude)
    }
}
