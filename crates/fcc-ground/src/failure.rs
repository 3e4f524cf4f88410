//! Answers that are errors: a status and a text that says what, where and what to do.

use axum::Json;
use axum::body::Bytes;
use axum::extract::{FromRequest, FromRequestParts, Query, Request};
use axum::http::StatusCode;
use axum::http::request::Parts;
use axum::response::{IntoResponse, Response};
use serde::de::DeserializeOwned;
use serde_json::{Value, json};
use tokio::sync::Semaphore;

/// Threads for what waits for a disk or a daemon.
pub(crate) const THREADS: usize = 16;

/// Why a request is not answered as asked.
#[derive(Debug)]
pub(crate) struct Failure {
    status: StatusCode,
    body: Value,
}

impl Failure {
    #[expect(clippy::needless_pass_by_value, reason = "`map_err` gives values")]
    pub(crate) fn new(status: StatusCode, what: impl ToString) -> Self {
        Self {
            status,
            body: json!({ "error": what.to_string() }),
        }
    }

    pub(crate) fn bad(what: impl ToString) -> Self {
        Self::new(StatusCode::BAD_REQUEST, what)
    }

    pub(crate) fn missing(what: impl ToString) -> Self {
        Self::new(StatusCode::NOT_FOUND, what)
    }

    pub(crate) fn internal(what: impl ToString) -> Self {
        Self::new(StatusCode::INTERNAL_SERVER_ERROR, what)
    }

    /// What the aircraft, or the station for it, does not carry out.
    #[expect(clippy::needless_pass_by_value, reason = "`map_err` gives values")]
    pub(crate) fn refused(why: impl ToString) -> Self {
        Self::with(StatusCode::CONFLICT, json!({ "refused": why.to_string() }))
    }

    pub(crate) const fn with(status: StatusCode, body: Value) -> Self {
        Self { status, body }
    }

    /// Why, in words.
    pub(crate) fn words(&self) -> &str {
        let words = self.body.get("refused").or_else(|| self.body.get("error"));
        words.and_then(Value::as_str).unwrap_or_default()
    }
}

impl IntoResponse for Failure {
    fn into_response(self) -> Response {
        (self.status, Json(self.body)).into_response()
    }
}

/// Runs what may take long, or waits for a disk, beside the server's threads.
pub(crate) async fn aside<T: Send + 'static>(
    work: impl FnOnce() -> Result<T, Failure> + Send + 'static,
) -> Result<T, Failure> {
    let done = tokio::task::spawn_blocking(work).await;
    done.unwrap_or_else(|error| Err(Failure::internal(format!("the station failed: {error}"))))
}

/// What everybody may ask runs in so many threads; the others are left for commands and
/// edits.
const READERS: usize = THREADS / 2;
static READING: Semaphore = Semaphore::const_new(READERS);

/// As [`aside`], in turn, for what changes nothing.
pub(crate) async fn reading<T: Send + 'static>(
    work: impl FnOnce() -> Result<T, Failure> + Send + 'static,
) -> Result<T, Failure> {
    let place = READING.acquire().await.map_err(Failure::internal)?;
    aside(move || {
        // Also when the one who asked has left.
        let _place = place;
        work()
    })
    .await
}

/// The body of a request, from JSON.
#[derive(Debug)]
pub(crate) struct Sent<T>(pub(crate) T);

impl<T: DeserializeOwned, S: Send + Sync> FromRequest<S> for Sent<T> {
    type Rejection = Failure;

    async fn from_request(request: Request, state: &S) -> Result<Self, Failure> {
        let bytes = Bytes::from_request(request, state).await;
        let bytes =
            bytes.map_err(|error| Failure::bad(format!("the body is not read: {error}")))?;
        let read = serde_json::from_slice(&bytes);
        read.map(Self)
            .map_err(|error| Failure::bad(format!("the body is not as expected: {error}")))
    }
}

/// What a request gives behind `?`.
#[derive(Debug)]
pub(crate) struct Given<T>(pub(crate) T);

impl<T: DeserializeOwned, S: Send + Sync> FromRequestParts<S> for Given<T> {
    type Rejection = Failure;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, Failure> {
        let read = Query::from_request_parts(parts, state).await;
        let Query(given) = read.map_err(|error| Failure::bad(error.body_text()))?;
        Ok(Self(given))
    }
}
