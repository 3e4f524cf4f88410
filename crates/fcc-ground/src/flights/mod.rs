//! Recordings: what was flown, as tables, curves and files of other programs.

mod compare;
mod export;
mod scan;
pub(crate) mod summaries;
mod summary;

use std::collections::BTreeSet;
use std::convert::Infallible;
use std::fs::{self, File};
use std::path::PathBuf;
use std::sync::Arc;

use axum::Json;
use axum::body::{Body, Bytes};
use axum::extract::{Path, State};
use axum::http::StatusCode;
use axum::http::header::{
    CONTENT_DISPOSITION, CONTENT_SECURITY_POLICY, CONTENT_TYPE, X_FRAME_OPTIONS,
};
use axum::response::{IntoResponse as _, Response};
use fcc_flight::config::Config;
use fcc_flight::replay::{recorded_pattern, recorded_plan};
use fcc_plan::Item;
use fcc_record::Recording;
use fcc_report::{FlightAddition, FlightSurvey, PlanLines};
use fcc_telemetry::FlightMessage;
use fcc_telemetry::file_lock::is_locked;
use serde::Deserialize;
use serde_json::{Value, json};
use tokio::sync::OwnedSemaphorePermit;

use crate::daemon_config;
use crate::failure::{Failure, Given, aside, reading};
use crate::plans::hash_text;
use crate::station::Station;
use export::PART_BYTES;
use scan::MOST_VALUES;

/// Of a report: what it may do where it is shown. It has its styles and scripts in itself,
/// and texts of a recording; it gets nothing of this page.
const REPORT_POLICY: &str = "sandbox allow-scripts; default-src 'none'; style-src \
    'unsafe-inline'; script-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action \
    'none'; frame-ancestors 'self'";

/// The path of a recording by its name, which is no path.
fn path_of(station: &Station, file: &str) -> Result<PathBuf, Failure> {
    let missing = || Failure::missing(format!("there is no recording {file:?}"));
    let is_name = file.strip_suffix(".mcap").is_some()
        && !file.starts_with('.')
        && file.len() <= 200
        && !file.contains(['/', '\\', '\0']);
    if !is_name {
        return Err(missing());
    }
    let path = station.recordings.join(file);
    // A link may lead anywhere.
    let found = fs::symlink_metadata(&path).map_err(|_| missing())?;
    found.is_file().then_some(path).ok_or_else(missing)
}

fn open(station: &Station, file: &str) -> Result<Recording, Failure> {
    Recording::open(path_of(station, file)?).map_err(Failure::bad)
}

/// `GET /api/flights`.
pub(crate) async fn list(State(station): State<Arc<Station>>) -> Result<Json<Value>, Failure> {
    reading(move || Ok(Json(station.flights.list(&station.recordings)?))).await
}

/// What is wanted of a recording.
#[derive(Debug, Deserialize)]
pub(crate) struct DataWanted {
    #[serde(default)]
    columns: String,
    points: Option<usize>,
}

/// Sends bytes in parts, and gives the place back after the last one.
fn sent_in(place: OwnedSemaphorePermit, bytes: Vec<u8>) -> Body {
    let bytes = Bytes::from(bytes);
    let parts = (0..bytes.len()).step_by(PART_BYTES).map(move |from| {
        let _ = &place;
        let to = bytes.len().min(from + PART_BYTES);
        Ok::<_, Infallible>(bytes.slice(from..to))
    });
    Body::from_stream(futures_util::stream::iter(parts))
}

/// `GET /api/flights/{file}/data`.
pub(crate) async fn data(
    State(station): State<Arc<Station>>,
    Path(file): Path<String>,
    Given(wanted): Given<DataWanted>,
) -> Result<Response, Failure> {
    let place = station.sending_place()?;
    let bytes = reading(move || {
        let path = path_of(&station, &file)?;
        let names = wanted.columns.split(',').filter(|name| !name.is_empty());
        let names: Vec<&str> = names.collect();
        let mut known = BTreeSet::new();
        if let Some(again) = names.iter().find(|name| !known.insert(**name)) {
            return Err(Failure::bad(format!("{again:?}: is wanted twice")));
        }
        let table = match wanted.points {
            Some(points) => {
                let points = points.clamp(2, MOST_VALUES / (names.len() + 1));
                station.flights.table(&path, &names, points)?
            }
            None => scan::table(&open(&station, &file)?, &names)?,
        };
        Ok(table.to_bytes())
    })
    .await?;
    let kind = [(CONTENT_TYPE, "application/octet-stream")];
    Ok((kind, sent_in(place, bytes)).into_response())
}

/// `GET /api/flights/{file}/events`.
pub(crate) async fn events(
    State(station): State<Arc<Station>>,
    Path(file): Path<String>,
) -> Result<Json<Value>, Failure> {
    reading(move || Ok(Json(station.flights.events(&path_of(&station, &file)?)?))).await
}

/// `GET /api/flights/{file}/plan`.
pub(crate) async fn plan(
    State(station): State<Arc<Station>>,
    Path(file): Path<String>,
) -> Result<Json<Value>, Failure> {
    reading(move || {
        let recording = open(&station, &file)?;
        let about = recording.about();
        let Some((_, plan)) = recorded_plan(about) else {
            return Ok(Json(Value::Null));
        };
        let uploaded = about.parameters.get("plan.uploaded_unix_s");
        // Those that replaced it, in their order.
        let replaced = about.documents.iter().filter_map(|document| {
            let is_plan = document.name.starts_with("flight-plan-");
            let plan = is_plan.then(|| fcc_plan::read(&document.text).ok())??;
            Some(json!({ "hash": hash_text(&plan), "plan": plan }))
        });
        Ok(Json(json!({
            "hash": hash_text(&plan),
            "uploaded_utc_s": uploaded.and_then(|text| text.parse::<u64>().ok()),
            "replaced_by": replaced.collect::<Vec<_>>(),
            "plan": plan,
        })))
    })
    .await
}

/// `GET /api/flights/{file}/aircraft`: its limits by the configuration that was flown.
pub(crate) async fn aircraft(
    State(station): State<Arc<Station>>,
    Path(file): Path<String>,
) -> Result<Json<Value>, Failure> {
    reading(move || {
        let recording = open(&station, &file)?;
        let flown = Some(&recording.about().config).filter(|text| !text.is_empty());
        let config = flown.map(|text| Config::parse_without_aircraft(text, &file));
        let known = config.and_then(Result::ok);
        Ok(Json(known.as_ref().map(daemon_config::aircraft).into()))
    })
    .await
}

/// `GET /api/flights/{file}/report`.
pub(crate) async fn report(
    State(station): State<Arc<Station>>,
    Path(file): Path<String>,
) -> Result<Response, Failure> {
    let page = reading(move || {
        let path = path_of(&station, &file)?;
        let recording = Recording::open_as::<FlightMessage>(path).map_err(Failure::bad)?;
        let about = recording.about();
        let plan = recorded_plan(about).map(|(which, plan)| (which, lines(&plan)));
        let addition = FlightAddition::new(recorded_pattern(about)).with_plan(plan);
        let report = FlightSurvey::read(&recording, addition, None, |_| {});
        Ok(report.map_err(Failure::internal)?.to_html())
    })
    .await?;
    let headers = [
        (CONTENT_TYPE, "text/html; charset=utf-8"),
        (CONTENT_SECURITY_POLICY, REPORT_POLICY),
        (X_FRAME_OPTIONS, "SAMEORIGIN"),
    ];
    Ok((headers, page).into_response())
}

/// A plan on the ground: its legs, and the corners of its fence.
fn lines(plan: &fcc_plan::Plan) -> PlanLines {
    let at = |place: &fcc_plan::Place| {
        (
            place.latitude_deg.to_radians(),
            place.longitude_deg.to_radians(),
        )
    };
    let home = plan.home.map(|home| home.place);
    let legs = home
        .into_iter()
        .chain(plan.items.iter().filter_map(Item::place));
    let fence = plan.fence.polygons.iter().map(|polygon| {
        let closed = polygon.corners.iter().chain(polygon.corners.first());
        closed.map(at).collect()
    });
    PlanLines {
        path: vec![legs.map(|place| at(&place)).collect()],
        fence: fence.collect(),
    }
}

/// In which format a recording is wanted.
#[derive(Debug, Deserialize)]
pub(crate) struct DownloadWanted {
    format: export::Format,
}

/// `GET /api/flights/{file}/download`.
pub(crate) async fn download(
    State(station): State<Arc<Station>>,
    Path(file): Path<String>,
    Given(wanted): Given<DownloadWanted>,
) -> Result<Response, Failure> {
    let (format, name) = (wanted.format, file.clone());
    let place = station.sending_place()?;
    let recording = reading(move || open(&station, &file)).await?;
    let stem = name.strip_suffix(".mcap").unwrap_or_default();
    // Of a name of fccd; others have no quotation marks either.
    let stem: String = stem
        .chars()
        .filter(|c| c.is_ascii_alphanumeric() || "._-".contains(*c))
        .collect();
    let end = format.end();
    let headers = [
        (CONTENT_TYPE, format.content_type().to_owned()),
        (
            CONTENT_DISPOSITION,
            format!("attachment; filename=\"{stem}.{end}\""),
        ),
    ];
    Ok((
        headers,
        Body::from_stream(export::stream(recording, format, place)),
    )
        .into_response())
}

/// `GET /api/flights/{a}/compare/{b}`.
pub(crate) async fn compare(
    State(station): State<Arc<Station>>,
    Path((a, b)): Path<(String, String)>,
) -> Result<Json<Value>, Failure> {
    reading(move || {
        let summary = |file: &str| station.flights.summary(&path_of(&station, file)?);
        Ok(Json(compare::differences(&summary(&a)?, &summary(&b)?)))
    })
    .await
}

/// `DELETE /api/flights/{file}`.
pub(crate) async fn delete(
    State(station): State<Arc<Station>>,
    Path(file): Path<String>,
) -> Result<StatusCode, Failure> {
    aside(move || {
        let path = path_of(&station, &file)?;
        let failed = |error| Failure::internal(format!("{file}: {error}"));
        // Also before its description is complete.
        let is_written = is_locked(&File::open(&path).map_err(failed)?);
        if is_written {
            return Err(Failure::refused(
                "it is being recorded: end the flight first",
            ));
        }
        fs::remove_file(&path).map_err(failed)?;
        station.flights.forget(&file);
        Ok(StatusCode::NO_CONTENT)
    })
    .await
}
