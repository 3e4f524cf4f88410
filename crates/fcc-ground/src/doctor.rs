//! The doctor's findings, by `fccd doctor`.

use std::process::Stdio;
use std::sync::Arc;
use std::time::Duration;

use axum::Json;
use axum::extract::State;
use serde_json::Value;
use tokio::process::Command;
use tokio::sync::Mutex;
use tokio::time::timeout;

use crate::failure::Failure;
use crate::station::Station;

const PATIENCE: Duration = Duration::from_secs(20);
/// One at a time: it reads the whole machine.
static TURN: Mutex<()> = Mutex::const_new(());

/// `GET /api/doctor`.
pub(crate) async fn doctor(State(station): State<Arc<Station>>) -> Result<Json<Value>, Failure> {
    let _turn = TURN.lock().await;
    let program = station.fccd.display();
    let running = Command::new(&station.fccd)
        .args(["doctor", "--json"])
        .stdin(Stdio::null())
        .stderr(Stdio::null())
        .kill_on_drop(true)
        .output();
    let output = timeout(PATIENCE, running).await;
    let output = output.map_err(|_| Failure::internal(format!("{program} doctor does not end")))?;
    let output = output.map_err(|error| station.without_fccd(&error))?;
    let found = serde_json::from_slice(&output.stdout);
    let found: Value = found.map_err(|error| {
        Failure::internal(format!(
            "{program} doctor --json: is not understood: {error}"
        ))
    })?;
    let findings = found.get("findings").cloned();
    Ok(Json(findings.unwrap_or_default()))
}
