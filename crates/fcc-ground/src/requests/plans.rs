//! Flight plans: checked, read from files and written to them.

use std::sync::Arc;

use axum::Json;
use axum::extract::State;
use axum::http::StatusCode;
use axum::http::header::{CONTENT_DISPOSITION, CONTENT_TYPE};
use axum::response::{IntoResponse as _, Response};
use fcc_plan::{Format, Plan, limits};
use fcc_telemetry::Instance;
use serde::Deserialize;
use serde_json::{Value, json};

use crate::failure::{Failure, Sent, reading};
use crate::plans::{check_answer, within_limits};
use crate::station::Station;

/// The body of a check.
#[derive(Debug, Deserialize)]
pub(crate) struct ToCheck {
    plan: Plan,
    instance: Option<Instance>,
}

/// `POST /api/plan/check`.
pub(crate) async fn check(
    State(station): State<Arc<Station>>,
    Sent(asked): Sent<ToCheck>,
) -> Result<Json<Value>, Failure> {
    let answer = reading(move || {
        let config = station.configs.of(asked.instance.as_ref());
        Ok(check_answer(&asked.plan, config))
    });
    Ok(Json(answer.await?))
}

/// The body of an import.
#[derive(Debug, Deserialize)]
pub(crate) struct Imported {
    text: String,
    #[serde(default)]
    name: String,
}

/// `POST /api/plan/import`.
pub(crate) async fn import(Sent(imported): Sent<Imported>) -> Result<Json<Value>, Failure> {
    reading(move || {
        if imported.text.len() as u64 > limits::FILE_BYTES {
            return Err(Failure::bad(format!(
                "{}: is larger than 4 MiB",
                imported.name
            )));
        }
        let plan = fcc_plan::read(&imported.text).map_err(|problems| {
            let error = format!("{}: is no plan that can be flown", imported.name);
            let body = json!({ "error": error, "problems": problems });
            Failure::with(StatusCode::BAD_REQUEST, body)
        })?;
        Ok(Json(json!({ "plan": plan })))
    })
    .await
}

/// The body of an export.
#[derive(Debug, Deserialize)]
pub(crate) struct Exported {
    plan: Plan,
    format: ExportFormat,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "lowercase")]
enum ExportFormat {
    Plan,
    Waypoints,
}

/// `POST /api/plan/export`.
pub(crate) async fn export(Sent(exported): Sent<Exported>) -> Result<Response, Failure> {
    within_limits(&exported.plan).map_err(Failure::bad)?;
    let (format, kind, name) = match exported.format {
        ExportFormat::Plan => (
            Format::QgcPlan,
            "application/json",
            "attachment; filename=\"flight.plan\"",
        ),
        ExportFormat::Waypoints => (
            Format::QgcWpl,
            "text/plain; charset=utf-8",
            "attachment; filename=\"flight.waypoints\"",
        ),
    };
    let text = fcc_plan::write(&exported.plan, format).map_err(|problems| {
        let error = "this format has no place for a part of the plan: choose .plan";
        let body = json!({ "error": error, "problems": problems });
        Failure::with(StatusCode::BAD_REQUEST, body)
    })?;
    Ok(([(CONTENT_TYPE, kind), (CONTENT_DISPOSITION, name)], text).into_response())
}
