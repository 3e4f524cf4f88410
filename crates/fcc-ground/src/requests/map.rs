//! The user's own map, and the ground below.

use std::os::unix::fs::FileExt as _;
use std::sync::{Arc, Mutex, PoisonError};

use axum::Json;
use axum::extract::State;
use axum::http::header::{ACCEPT_RANGES, CONTENT_RANGE, CONTENT_TYPE, RANGE};
use axum::http::{HeaderMap, StatusCode};
use axum::response::{IntoResponse as _, Response};
use fcc_terrain::{Area, Elevations};
use serde::Deserialize;
use serde_json::{Value, json};

use crate::failure::{Failure, Given, reading};
use crate::station::Station;

/// The longest part of a map that is sent at once.
const MOST_BYTES: u64 = 4 << 20;
/// Elevations in a row, at most.
const MOST_CELLS: usize = 256;
/// Degrees of an area, at most.
const MOST_DEGREES: f64 = 4.0;

/// `GET /api/map`.
pub(crate) async fn map(State(station): State<Arc<Station>>) -> Json<Value> {
    let map = station.map.as_ref();
    Json(json!({
        "pmtiles": map.map(|_| "/map.pmtiles"),
        "attribution": map.map(|map| map.attribution.as_str()),
    }))
}

/// `bytes=FIRST-LAST`.
fn range(text: &str, length: u64) -> Option<(u64, u64)> {
    let (first, last) = text.strip_prefix("bytes=")?.split_once('-')?;
    let first: u64 = first.parse().ok()?;
    let last: u64 = match last {
        "" => u64::MAX,
        last => last.parse().ok()?,
    };
    let last = last
        .min(length.checked_sub(1)?)
        .min(first.checked_add(MOST_BYTES - 1)?);
    (first <= last).then_some((first, last))
}

/// `GET /map.pmtiles`, a part of it.
pub(crate) async fn tiles(
    State(station): State<Arc<Station>>,
    headers: HeaderMap,
) -> Result<Response, Failure> {
    reading(move || {
        let map = station.map.as_ref();
        let map =
            map.ok_or_else(|| Failure::missing("no map was given: give it with --map FILE"))?;
        let failed = |error| Failure::internal(format!("{}: {error}", map.path.display()));
        let length = map.file.metadata().map_err(failed)?.len();
        let wanted = headers.get(RANGE).and_then(|range| range.to_str().ok());
        let part = wanted.and_then(|wanted| range(wanted, length));
        let (first, last) = part.ok_or_else(|| {
            let what = format!(
                "range: give a part of bytes 0 to {}",
                length.saturating_sub(1)
            );
            Failure::new(StatusCode::RANGE_NOT_SATISFIABLE, what)
        })?;
        let mut bytes = vec![0; (last - first + 1) as usize];
        map.file.read_exact_at(&mut bytes, first).map_err(failed)?;
        let headers = [
            (CONTENT_TYPE, "application/octet-stream".to_owned()),
            (ACCEPT_RANGES, "bytes".to_owned()),
            (CONTENT_RANGE, format!("bytes {first}-{last}/{length}")),
        ];
        Ok((StatusCode::PARTIAL_CONTENT, headers, bytes).into_response())
    })
    .await
}

/// The area whose elevations are wanted, in degrees.
#[derive(Clone, Copy, Debug, Deserialize)]
pub(crate) struct Wanted {
    south: f64,
    west: f64,
    north: f64,
    east: f64,
    n: usize,
}

/// One at a time: each may take the memory of `terrain.memory_mb`.
static TURN: Mutex<()> = Mutex::new(());

/// `GET /api/terrain`.
pub(crate) async fn terrain(
    State(station): State<Arc<Station>>,
    Given(wanted): Given<Wanted>,
) -> Result<Json<Value>, Failure> {
    let Wanted {
        south,
        west,
        north,
        east,
        n,
    } = wanted;
    let is_area = (-90.0..=90.0).contains(&south) && (-540.0..=180.0).contains(&west);
    let is_small = (0.0..=MOST_DEGREES).contains(&(north - south))
        && (0.0..=MOST_DEGREES).contains(&(east - west));
    if !is_area || north > 90.0 || !is_small || !(1..=MOST_CELLS).contains(&n) {
        return Err(Failure::bad(format!(
            "give south, west, north and east of at most {MOST_DEGREES} degrees, and n of 1 to \
             {MOST_CELLS}"
        )));
    }
    reading(move || {
        let section = &station.configs.of(None).terrain;
        let Some(folder) = &section.folder else {
            return Ok(Json(Value::Null));
        };
        let area = Area {
            south_deg: south,
            north_deg: north,
            west_deg: west,
            east_deg: east,
        };
        let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
        // An area without tiles is unknown.
        let Ok(read) = Elevations::read(folder, &area, (section.memory_mb * 1e6) as u64) else {
            return Ok(Json(Value::Null));
        };
        let elevations = read.with(|terrain| {
            let cells = (0..n * n).map(|cell| {
                let at = |index: usize| (index as f64 + 0.5) / n as f64;
                let latitude = north - at(cell / n) * (north - south);
                let longitude = west + at(cell % n) * (east - west);
                let found = terrain.elevation_m(latitude.to_radians(), longitude.to_radians());
                found.map(|m| (m * 10.0).round() / 10.0)
            });
            cells.collect::<Vec<_>>()
        });
        Ok(Json(json!({ "n": n, "elevations_m": elevations })))
    })
    .await
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_is_within_the_file() {
        assert_eq!(range("bytes=0-99", 1_000), Some((0, 99)));
        assert_eq!(range("bytes=990-2000", 1_000), Some((990, 999)));
        assert_eq!(range("bytes=10-", 1_000), Some((10, 999)));
        assert_eq!(range("bytes=0-", 1 << 40), Some((0, (4 << 20) - 1)));
        for wrong in [
            "",
            "bytes=-5",
            "bytes=5-4",
            "bytes=1000-",
            "bytes=0-1,3-4",
            "items=0-1",
        ] {
            assert_eq!(range(wrong, 1_000), None, "{wrong}");
        }
        assert_eq!(range("bytes=18446744073709551615-", 1_000), None);
        assert_eq!(range("bytes=0-0", 0), None);
    }
}
