//! The ground track, in bounded memory.

use fcc_core::flight::Position;

/// At this many points, the smallest distance between points is doubled.
const MOST_POINTS: usize = 4_000;
/// Smallest distance between points at first, m.
const FINEST_M: f64 = 0.5;

/// A point of the track.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct TrackPoint {
    /// Since the first tick.
    pub(super) time_s: f64,
    /// From the first position.
    pub(super) north_m: f64,
    /// From the first position.
    pub(super) east_m: f64,
}

/// Places of a line over the ground: latitude and longitude, rad.
pub type GroundLine = Vec<(f64, f64)>;

/// A flight plan on the ground, for the picture of the track.
#[derive(Clone, Debug, Default)]
pub struct PlanLines {
    /// Its legs and the circles of its loiters.
    pub path: Vec<GroundLine>,
    /// Its fence.
    pub fence: Vec<GroundLine>,
}

/// A ground track that is being recorded.
#[derive(Clone, Debug)]
pub(super) struct Track {
    frame: Option<Frame>,
    apart_m: f64,
    places: Vec<TrackPoint>,
    last: Option<TrackPoint>,
}

impl Default for Track {
    fn default() -> Self {
        Self {
            frame: None,
            apart_m: FINEST_M,
            places: Vec::new(),
            last: None,
        }
    }
}

impl Track {
    pub(super) fn push(&mut self, time_s: f64, position: &Position) {
        if !(position.latitude_rad.is_finite() && position.longitude_rad.is_finite()) {
            return;
        }
        let frame = self.frame.get_or_insert_with(|| Frame::at(position));
        let place = frame.place(time_s, position);
        self.last = Some(place);
        if self.is_far(&place) {
            self.places.push(place);
        }
        if self.places.len() >= MOST_POINTS {
            self.apart_m *= 2.0;
            let all = std::mem::take(&mut self.places);
            for place in all {
                if self.is_far(&place) {
                    self.places.push(place);
                }
            }
        }
    }

    fn is_far(&self, place: &TrackPoint) -> bool {
        self.places
            .last()
            .is_none_or(|last| last.distance_m(place) >= self.apart_m)
    }

    /// Adds the last position.
    pub(super) fn finish(&mut self) {
        if self.places.last() != self.last.as_ref() {
            self.places.extend(self.last);
        }
    }

    /// In ascending time.
    pub(super) fn places(&self) -> &[TrackPoint] {
        &self.places
    }

    /// Lines in latitude and longitude, rad, as (east, north) from the first position, m.
    pub(super) fn drawn(&self, lines: &[GroundLine]) -> Vec<Vec<(f64, f64)>> {
        let place = |(latitude_rad, longitude_rad): &(f64, f64)| {
            let position = Position {
                latitude_rad: *latitude_rad,
                longitude_rad: *longitude_rad,
                altitude_m: 0.0,
            };
            let frame = self.frame?;
            let at = frame.place(0.0, &position);
            Some((at.east_m, at.north_m))
        };
        let line = |line: &GroundLine| line.iter().filter_map(place).collect();
        lines.iter().map(line).collect()
    }
}

impl TrackPoint {
    pub(super) fn distance_m(&self, other: &Self) -> f64 {
        (self.north_m - other.north_m).hypot(self.east_m - other.east_m)
    }
}

/// The plane that touches the ellipsoid at a position.
#[derive(Clone, Copy, Debug)]
struct Frame {
    latitude_rad: f64,
    longitude_rad: f64,
    north_m_per_rad: f64,
    east_m_per_rad: f64,
}

/// Semi-major axis and first eccentricity squared of WGS 84.
const SEMI_MAJOR_M: f64 = 6_378_137.0;
const ECCENTRICITY_2: f64 = 6.694_379_990_14e-3;

impl Frame {
    /// With the radii of curvature in the meridian and in the prime vertical.
    fn at(position: &Position) -> Self {
        let (sin, cos) = position.latitude_rad.sin_cos();
        let w2 = 1.0 - ECCENTRICITY_2 * sin * sin;
        let prime_vertical_m = SEMI_MAJOR_M / w2.sqrt();
        Self {
            latitude_rad: position.latitude_rad,
            longitude_rad: position.longitude_rad,
            north_m_per_rad: prime_vertical_m * (1.0 - ECCENTRICITY_2) / w2,
            east_m_per_rad: prime_vertical_m * cos,
        }
    }

    fn place(&self, time_s: f64, position: &Position) -> TrackPoint {
        let turn = std::f64::consts::TAU;
        let east_rad = position.longitude_rad - self.longitude_rad;
        // Across the date line the shorter way.
        let east_rad = (east_rad + turn / 2.0).rem_euclid(turn) - turn / 2.0;
        TrackPoint {
            time_s,
            north_m: (position.latitude_rad - self.latitude_rad) * self.north_m_per_rad,
            east_m: east_rad * self.east_m_per_rad,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(latitude_deg: f64, longitude_deg: f64) -> Position {
        Position {
            latitude_rad: latitude_deg.to_radians(),
            longitude_rad: longitude_deg.to_radians(),
            altitude_m: 0.0,
        }
    }

    /// Lengths of a degree at 45° on WGS 84 (NGA.STND.0036, "Department of
    /// Defense World Geodetic System 1984"; tables give 111 132 m of latitude
    /// and 78 847 m of longitude).
    #[test]
    fn a_hundredth_of_a_degree_is_as_long_as_on_the_ellipsoid() {
        let mut track = Track::default();
        track.push(0.0, &at(45.0, 179.999));
        track.push(1.0, &at(45.01, -179.991));
        track.finish();
        let places = track.places();
        assert!((places[1].north_m - 1_111.32).abs() < 0.2, "{places:?}");
        assert!((places[1].east_m - 788.47).abs() < 0.2, "{places:?}");
    }

    #[test]
    fn a_long_track_is_thinned_and_keeps_its_ends() {
        let mut track = Track::default();
        for n in 0..100_000 {
            track.push(f64::from(n), &at(0.0, f64::from(n) * 1e-5));
        }
        assert!(track.places.len() < MOST_POINTS);
        track.finish();
        let places = track.places();
        assert_eq!(places.first().unwrap().time_s, 0.0);
        assert_eq!(places.last().unwrap().time_s, 99_999.0);
    }
}
