//! The area whose elevations are wanted.

/// Metres in a degree of latitude, at least, and in one of longitude at the equator
/// (WGS-84).
const LATITUDE_DEGREE_M: f64 = 110_574.0;
const LONGITUDE_DEGREE_M: f64 = 111_320.0;

/// A rectangle of latitudes and longitudes, in degrees.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Area {
    /// -90 to 90.
    pub south_deg: f64,
    /// -90 to 90, at least `south_deg`.
    pub north_deg: f64,
    /// -540 to 180.
    pub west_deg: f64,
    /// At least `west_deg`, beyond 180 if it is behind the date line.
    pub east_deg: f64,
}

impl Area {
    /// Around places, latitude and longitude in degrees, with a margin in m; none without
    /// a place.
    ///
    /// ```
    /// use fcc_terrain::Area;
    ///
    /// // Across the date line, at the equator: 111.32 km for a degree of longitude.
    /// let area = Area::around([(0.0, 179.0), (0.5, -179.5)], 11_132.0).unwrap();
    /// assert!((area.west_deg - 178.9).abs() < 1e-4 && (area.east_deg - 180.6).abs() < 1e-4);
    /// ```
    pub fn around(places: impl IntoIterator<Item = (f64, f64)>, margin_m: f64) -> Option<Self> {
        let mut places = places.into_iter();
        let (latitude, longitude) = places.next()?;
        let mut area = Self {
            south_deg: latitude,
            north_deg: latitude,
            west_deg: longitude,
            east_deg: longitude,
        };
        for (latitude_deg, longitude_deg) in places {
            let east_deg =
                longitude + (longitude_deg - longitude + 180.0).rem_euclid(360.0) - 180.0;
            area.south_deg = area.south_deg.min(latitude_deg);
            area.north_deg = area.north_deg.max(latitude_deg);
            area.west_deg = area.west_deg.min(east_deg);
            area.east_deg = area.east_deg.max(east_deg);
        }
        let margin_deg = margin_m / LATITUDE_DEGREE_M;
        area.south_deg = (area.south_deg - margin_deg).max(-90.0);
        area.north_deg = (area.north_deg + margin_deg).min(90.0);
        let poleward_deg = area.north_deg.abs().max(area.south_deg.abs());
        let parallel_m = LONGITUDE_DEGREE_M * poleward_deg.to_radians().cos();
        let aside_deg = (margin_m / parallel_m.max(1.0)).min(180.0);
        area.west_deg -= aside_deg;
        area.east_deg += aside_deg;
        Some(area)
    }

    /// By how many degrees longitudes from `west_deg` to `east_deg` are to be shifted to
    /// be in this area, if some of it is there.
    pub(crate) fn shift_deg(
        &self,
        south_deg: f64,
        north_deg: f64,
        west_deg: f64,
        east_deg: f64,
    ) -> Option<f64> {
        if north_deg < self.south_deg || south_deg > self.north_deg {
            return None;
        }
        let turns = [0.0, 360.0, -360.0];
        turns.into_iter().find(|shift_deg| {
            east_deg + shift_deg >= self.west_deg && west_deg + shift_deg <= self.east_deg
        })
    }

    /// The name of SRTM's tile at its middle.
    pub(crate) fn example(&self) -> String {
        let latitude = (0.5 * (self.south_deg + self.north_deg)).floor();
        let longitude = 0.5 * (self.west_deg + self.east_deg);
        let longitude = ((longitude + 180.0).rem_euclid(360.0) - 180.0).floor();
        let (ns, ew) = (
            if latitude < 0.0 { 'S' } else { 'N' },
            if longitude < 0.0 { 'W' } else { 'E' },
        );
        format!(
            "{ns}{:02.0}{ew}{:03.0}.hgt",
            latitude.abs(),
            longitude.abs()
        )
    }
}
