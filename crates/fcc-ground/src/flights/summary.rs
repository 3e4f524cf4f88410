//! What is shown of a recording in a list, and compared.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::UNIX_EPOCH;

use fcc_plan::Place;
use fcc_record::Recording;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::scan::{Events, Found, Scanner, Table, TableReader, utc_s};
use crate::failure::Failure;

/// Points of a thumbnail, at most.
const THUMBNAIL_POINTS: usize = 120;
/// Rows of the curves that are kept, at most.
pub(super) const KEPT_POINTS: usize = 36_000;
/// A summary is made again when this changes.
pub(super) const VERSION: u32 = 3;
/// A step of a track has at least so much; one that is longer than the most is none.
const LEAST_STEP_M: f64 = 15.0;
const MOST_STEP_M: f64 = 2_000.0;
/// The modes in which a path is followed: plan, loiter, go-to, return.
const OVER_GROUND: [u64; 4] = [3, 4, 5, 6];
const ENGAGED: u64 = 1;
const FAILSAFE: u64 = 2;
const GO_AROUND: u64 = 9;

/// A recording in figures.
#[derive(Clone, PartialEq, Debug, Default, Deserialize, Serialize)]
pub(super) struct Summary {
    pub(super) version: u32,
    /// Of the file that it is of.
    pub(super) bytes: u64,
    pub(super) modified_ms: u64,
    pub(super) file: String,
    pub(super) instance: String,
    pub(super) plant: String,
    start_utc_s: f64,
    duration_s: f64,
    /// None: it was not read to its end yet.
    distance_m: Option<f64>,
    whole: bool,
    /// Why it ended.
    ending: String,
    pub(super) being_written: bool,
    faults: u64,
    thumbnail: Vec<[f64; 2]>,
    /// What is compared, by the names in `compare`.
    pub(super) figures: BTreeMap<String, f64>,
}

/// Whether a column is kept: not the times and sources of readings, nor raw ones.
fn is_kept(name: &str) -> bool {
    let ends = ["_taken_ns", "_source"];
    let begins = ["raw_", "gnss_", "magnetic_", "other_", "pilot_"];
    !ends.iter().any(|end| name.ends_with(end))
        && !begins.iter().any(|begin| name.starts_with(begin))
}

/// Name, length and time of a file.
pub(super) fn stamp(path: &Path) -> Option<(String, u64, u64)> {
    let found = path.metadata().ok()?;
    let modified = found.modified().ok()?.duration_since(UNIX_EPOCH).ok()?;
    let file = path.file_name()?.to_str()?.to_owned();
    Some((file, found.len(), modified.as_millis() as u64))
}

/// The mean of squares.
#[derive(Default)]
struct Squares {
    sum: f64,
    count: f64,
}

impl Squares {
    fn take(&mut self, value: f64) {
        self.sum += value * value;
        self.count += 1.0;
    }

    fn rms(&self) -> Option<f64> {
        (self.count > 0.0).then(|| (self.sum / self.count).sqrt())
    }
}

impl Summary {
    pub(super) fn listed(&self) -> Value {
        json!({
            "file": self.file,
            "instance": self.instance,
            "plant": self.plant,
            "start_utc_s": self.start_utc_s,
            "duration_s": self.duration_s,
            "distance_m": self.distance_m,
            "whole": self.whole,
            "ending": self.ending,
            "being_written": self.being_written,
            "faults": self.faults,
            "bytes": self.bytes,
            "thumbnail": self.thumbnail,
        })
    }

    /// Of a file that cannot be read.
    pub(super) fn unread(path: &Path) -> Self {
        let (file, bytes, modified_ms) = stamp(path).unwrap_or_default();
        Self {
            version: VERSION,
            bytes,
            modified_ms,
            file,
            ..Self::default()
        }
    }

    /// What the begin and the end of a file say.
    pub(super) fn begin(path: &Path) -> Result<(Self, Recording), Failure> {
        let recording = Recording::open(path).map_err(Failure::bad)?;
        let about = recording.about();
        let instance = about.parameters.get("telemetry.instance");
        let end = recording.end();
        let summary = Self {
            instance: instance
                .map_or("fccd", |name| name.trim_matches('"'))
                .to_owned(),
            plant: about.plant.clone(),
            start_utc_s: about.started_unix_ns as f64 * 1e-9,
            duration_s: end.map_or(0.0, |end| end.duration_ns as f64 * 1e-9),
            ending: end.map_or_else(String::new, |end| end.ending.clone()),
            whole: recording.is_whole(),
            being_written: recording.is_being_written(),
            ..Self::unread(path)
        };
        Ok((summary, recording))
    }

    /// Whether the whole file was read, and stays as it is.
    pub(super) const fn is_complete(&self) -> bool {
        self.distance_m.is_some() && !self.being_written
    }

    /// The summary, the events, and the curves of a file that is finished; what its begin
    /// says if it does not go on.
    pub(super) fn read(
        path: &Path,
        goes_on: impl Fn() -> bool,
    ) -> Result<(Self, Value, Option<Table>), Failure> {
        let (begin, recording) = Self::begin(path)?;
        let scanner = Scanner::of(&recording)?;
        let mut reading = Reading::new(&scanner);
        let mut events = Events::new(&scanner.columns);
        let columns = scanner.columns.all.iter();
        let names = columns.map(|column| column.name.as_str());
        let names: Vec<&str> = names.filter(|name| is_kept(name)).collect();
        let ticks = recording.end().map(|end| end.ticks as usize);
        let span = ticks.map(|ticks| (2 * ticks).div_ceil(KEPT_POINTS).max(1));
        let table = span.map(|span| TableReader::new(&scanner.columns, &names, span));
        let mut table = table.transpose()?;
        let mut is_read = true;
        scanner.read(&recording, |found| {
            events.take(&found, &scanner.columns);
            if let Found::Row(woke_ns, row) = found {
                reading.take(woke_ns, row);
                if let Some(table) = &mut table {
                    table.take(woke_ns, row);
                }
            }
            is_read = goes_on();
            is_read
        })?;
        if !is_read {
            return Ok((begin, Value::Null, None));
        }
        let summary = Self {
            start_utc_s: utc_s(&recording, reading.first_ns.unwrap_or(0)),
            duration_s: reading.duration_s(),
            distance_m: Some(reading.distance_m),
            faults: reading.failsafes,
            thumbnail: thumbnail(&reading.places),
            figures: reading.figures(),
            ..begin
        };
        let table = table.map(|table| table.finish(&recording));
        Ok((summary, events.listed(), table))
    }
}

/// The value of a column in a row, by its name.
type ValueOf<'a> = Box<dyn Fn(&str, &[u64]) -> f64 + 'a>;

/// What is collected tick by tick.
struct Reading<'a> {
    value: ValueOf<'a>,
    first_ns: Option<i64>,
    last_ns: i64,
    distance_m: f64,
    places: Vec<Place>,
    failsafes: u64,
    go_arounds: f64,
    engaged_s: f64,
    state: u64,
    mode: u64,
    cross_track: Squares,
    airspeed: Squares,
    most: BTreeMap<&'static str, f64>,
    late_ns: Vec<f64>,
    missed: f64,
}

const RADIAN_DEG: f64 = 1_f64.to_degrees();
/// Values whose largest is compared, and what one of the column is in the figure's unit.
const LARGEST: [(&str, &str, f64); 4] = [
    ("highest_altitude_m", "estimated_altitude_m", 1.0),
    ("greatest_airspeed_mps", "estimated_airspeed_mps", 1.0),
    ("greatest_bank_deg", "estimated_roll_rad", RADIAN_DEG),
    ("greatest_load_factor", "estimated_load_factor", 1.0),
];

impl<'a> Reading<'a> {
    fn new(scanner: &'a Scanner) -> Self {
        let columns = &scanner.columns;
        let indices: BTreeMap<&str, usize> = columns
            .all
            .iter()
            .enumerate()
            .map(|(index, column)| (column.name.as_str(), index))
            .collect();
        Self {
            value: Box::new(move |name, row| {
                indices
                    .get(name)
                    .map_or(f64::NAN, |index| columns.value(*index, row))
            }),
            first_ns: None,
            last_ns: 0,
            distance_m: 0.0,
            places: Vec::new(),
            failsafes: 0,
            go_arounds: 0.0,
            engaged_s: 0.0,
            state: 0,
            mode: 0,
            cross_track: Squares::default(),
            airspeed: Squares::default(),
            most: BTreeMap::new(),
            late_ns: Vec::new(),
            missed: 0.0,
        }
    }

    fn duration_s(&self) -> f64 {
        self.first_ns
            .map_or(0.0, |first_ns| (self.last_ns - first_ns) as f64 * 1e-9)
    }

    fn take(&mut self, woke_ns: i64, row: &[u64]) {
        let value = |name: &str| (self.value)(name, row);
        let step_s = self
            .first_ns
            .map_or(0.0, |_| (woke_ns - self.last_ns) as f64 * 1e-9);
        self.first_ns.get_or_insert(woke_ns);
        self.last_ns = woke_ns;
        let (state, mode) = (value("state") as u64, value("desired_guidance_mode") as u64);
        self.failsafes += u64::from(state == FAILSAFE && self.state != FAILSAFE);
        if mode == GO_AROUND && self.mode != GO_AROUND {
            self.go_arounds += 1.0;
        }
        (self.state, self.mode) = (state, mode);
        self.missed += value("missed");
        self.late_ns
            .push((woke_ns as f64 - value("scheduled_ns")).max(0.0));
        if state == ENGAGED {
            self.engaged_s += step_s;
            self.airspeed
                .take(value("estimated_airspeed_mps") - value("desired_airspeed_mps"));
            if OVER_GROUND.contains(&mode) {
                self.cross_track.take(value("desired_cross_track_m"));
            }
        }
        for (name, column, factor) in LARGEST {
            let now = value(column).abs() * factor;
            if now.is_finite() {
                let most = self.most.entry(name).or_insert(now);
                *most = most.max(now);
            }
        }
        let place = Place {
            latitude_deg: value("estimated_latitude_rad").to_degrees(),
            longitude_deg: value("estimated_longitude_rad").to_degrees(),
        };
        self.moved_to(place);
    }

    /// Only longer steps count, so that noise of a standing aircraft does not.
    fn moved_to(&mut self, place: Place) {
        let is_known = place.latitude_deg != 0.0 || place.longitude_deg != 0.0;
        if !is_known || !place.latitude_deg.is_finite() || !place.longitude_deg.is_finite() {
            return;
        }
        let Some(last) = self.places.last() else {
            self.places.push(place);
            return;
        };
        let step_m = flat_m(*last, place);
        if step_m >= LEAST_STEP_M {
            if step_m < MOST_STEP_M {
                self.distance_m += step_m;
            }
            self.places.push(place);
        }
    }

    fn figures(&mut self) -> BTreeMap<String, f64> {
        let p99 = self.late_ns.len() * 99 / 100;
        let late_ns = (!self.late_ns.is_empty()).then(|| {
            let (_, p99, _) = self.late_ns.select_nth_unstable_by(p99, f64::total_cmp);
            *p99
        });
        let own = [
            ("engaged_s", Some(self.engaged_s)),
            ("distance_m", Some(self.distance_m)),
            ("cross_track_rms_m", self.cross_track.rms()),
            ("airspeed_rms_mps", self.airspeed.rms()),
            ("lateness_p99_us", late_ns.map(|ns| ns * 1e-3)),
            ("missed", Some(self.missed)),
            ("failsafes", Some(self.failsafes as f64)),
            ("go_arounds", Some(self.go_arounds)),
        ];
        let own = own
            .into_iter()
            .filter_map(|(name, value)| Some((name, value?)));
        let all = own.chain(self.most.iter().map(|(name, value)| (*name, *value)));
        all.map(|(name, value)| (name.to_owned(), value)).collect()
    }
}

/// The distance of two places that are near each other.
fn flat_m(a: Place, b: Place) -> f64 {
    const DEGREE_M: f64 = 111_195.0;
    let north_m = (b.latitude_deg - a.latitude_deg) * DEGREE_M;
    let east_deg = (b.longitude_deg - a.longitude_deg + 540.0).rem_euclid(360.0) - 180.0;
    let east_m = east_deg * DEGREE_M * a.latitude_deg.to_radians().cos();
    north_m.hypot(east_m)
}

/// The track within a square of 1, x to the east and y to the north.
fn thumbnail(places: &[Place]) -> Vec<[f64; 2]> {
    let Some(origin) = places.first() else {
        return Vec::new();
    };
    let shrink = origin.latitude_deg.to_radians().cos();
    let every = places.len().div_ceil(THUMBNAIL_POINTS).max(1);
    let points: Vec<[f64; 2]> = places
        .iter()
        .step_by(every)
        .map(|place| {
            let east =
                (place.longitude_deg - origin.longitude_deg + 540.0).rem_euclid(360.0) - 180.0;
            [east * shrink, place.latitude_deg]
        })
        .collect();
    let bounds = |axis: fn(&[f64; 2]) -> f64| {
        let values = || points.iter().map(axis);
        let least = values().fold(f64::MAX, f64::min);
        (least, values().fold(f64::MIN, f64::max))
    };
    let (east, north) = (bounds(|[x, _]| *x), bounds(|[_, y]| *y));
    let size = (east.1 - east.0).max(north.1 - north.0).max(1e-9);
    let within = |value: f64, (least, most): (f64, f64)| {
        let at = 0.5 + (value - 0.5 * (least + most)) / size;
        (at * 1e4).round() / 1e4
    };
    let placed = points
        .iter()
        .map(|[x, y]| [within(*x, east), within(*y, north)]);
    placed.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place(latitude_deg: f64, longitude_deg: f64) -> Place {
        Place {
            latitude_deg,
            longitude_deg,
        }
    }

    /// At 60° a degree of longitude is half as long as one of latitude.
    #[test]
    fn a_thumbnail_has_the_shape_of_the_track() {
        let track = [place(60.0, 10.0), place(60.5, 10.0), place(60.5, 10.5)];
        let points = thumbnail(&track);
        assert_eq!(points[0], [0.25, 0.0]);
        assert_eq!(points[1], [0.25, 1.0]);
        assert!((points[2][0] - 0.75).abs() < 1e-3 && points[2][1] == 1.0);
        assert!(thumbnail(&[]).is_empty());
        assert_eq!(thumbnail(&[place(1.0, 2.0)]), [[0.5, 0.5]]);
    }

    #[test]
    fn distances_cross_the_date_line() {
        let across_m = flat_m(place(0.0, 179.99), place(0.0, -179.99));
        assert!((across_m - 0.02 * 111_195.0).abs() < 1.0, "{across_m}");
    }
}
