//! Where an aircraft was in this run, in memory that does not grow.

use serde_json::{Value, json};

const MOST_PLACES: usize = 4_096;
const FIRST_SPACING_M: f64 = 10.0;
/// Mean radius of the Earth (IUGG).
const EARTH_M: f64 = 6_371_008.8;

/// Places at least the spacing apart. When there is no room for more, every second one is
/// left out, and the spacing is doubled.
#[derive(Debug)]
pub(super) struct Track {
    /// Latitude and longitude, rad.
    places: Vec<[f64; 2]>,
    spacing_m: f64,
}

impl Default for Track {
    fn default() -> Self {
        Self {
            places: Vec::new(),
            spacing_m: FIRST_SPACING_M,
        }
    }
}

impl Track {
    /// Adds a place, rad. 0, 0 is that of a navigation that does not know it yet.
    pub(super) fn add(&mut self, place: [f64; 2]) {
        if !place.iter().all(|angle| angle.is_finite()) || place == [0.0, 0.0] {
            return;
        }
        let is_near = |last: &[f64; 2]| distance_m(*last, place) < self.spacing_m;
        if self.places.last().is_some_and(is_near) {
            return;
        }
        if self.places.len() == MOST_PLACES {
            let mut number = 0_usize;
            self.places.retain(|_| {
                number += 1;
                number % 2 == 1
            });
            self.spacing_m *= 2.0;
        }
        self.places.push(place);
    }

    /// The message to a page: latitudes and longitudes in degrees, to a tenth of a metre.
    pub(super) fn message(&self) -> Value {
        let degrees = |rad: &f64| (rad.to_degrees() * 1e6).round() / 1e6;
        let places = self
            .places
            .iter()
            .map(|place| place.each_ref().map(degrees));
        json!({ "track": places.collect::<Vec<_>>() })
    }
}

/// Over a flat Earth: places that follow each other are close.
fn distance_m(a: [f64; 2], b: [f64; 2]) -> f64 {
    let east = (b[1] - a[1]) * a[0].cos();
    EARTH_M * (b[0] - a[0]).hypot(east)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flown(minutes_of_arc: u32, steps: u32) -> Track {
        let mut track = Track::default();
        for step in 0..=minutes_of_arc * steps {
            track.add([0.5, f64::from(step) / f64::from(steps) * 2.908_882e-4]);
        }
        track
    }

    /// A minute of arc of a great circle is 1,853.25 m on this sphere; at a latitude of 0.5 rad
    /// its parallel has 1,626.38 m.
    #[test]
    fn places_are_ten_metres_apart() {
        let track = flown(1, 10_000);
        assert!(
            (155..=163).contains(&track.places.len()),
            "{}",
            track.places.len()
        );
    }

    #[test]
    fn a_long_flight_takes_no_more_memory_and_keeps_its_begin() {
        let track = flown(600, 400);
        assert!((2_048..=4_096).contains(&track.places.len()));
        assert_eq!(track.message()["track"][0], json!([28.647_89, 0.0]));
        let apart_m = |two: &[[f64; 2]]| distance_m(two[0], two[1]);
        let longest_m = track.places.windows(2).map(apart_m).fold(0.0, f64::max);
        // 976 km in 4,096 places are 238 m, in half of them 476 m.
        assert!((238.0..=476.0).contains(&longest_m), "{longest_m}");
    }

    #[test]
    fn what_is_not_known_is_no_place() {
        let mut track = Track::default();
        for place in [[0.0, 0.0], [f64::NAN, 0.1], [0.1, f64::INFINITY]] {
            track.add(place);
        }
        assert_eq!(track.message(), json!({ "track": [] }));
    }
}
