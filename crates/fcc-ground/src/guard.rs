//! Which requests are answered at all: those that this page makes.
//!
//! A browser sends to this server also what other sites make it send. Such a request has
//! another `Origin`, or, after rebinding a name to this address, another `Host`; both are
//! compared exactly. What changes something needs the token, which no other site has.

use std::net::{IpAddr, SocketAddr};
use std::sync::Arc;
use std::time::Duration;

use axum::body::{Body, HttpBody as _, to_bytes};
use axum::extract::{Request, State};
use axum::http::header::{
    ACCEPT, CACHE_CONTROL, CONTENT_SECURITY_POLICY, CONTENT_TYPE, HOST, HeaderName, ORIGIN,
    REFERRER_POLICY, WWW_AUTHENTICATE, X_CONTENT_TYPE_OPTIONS, X_FRAME_OPTIONS,
};
use axum::http::{HeaderMap, HeaderValue, Method, StatusCode};
use axum::middleware::Next;
use axum::response::{IntoResponse as _, Response};

use crate::failure::Failure;
use crate::hosts::Hosts;
use crate::station::Station;

/// The longest body of a request, and the longest of one without the token.
const MOST_BYTES: usize = 8 << 20;
const MOST_BYTES_READ_ONLY: usize = 1 << 20;
/// How long a body may take to arrive.
const ARRIVES_WITHIN: Duration = Duration::from_secs(15);

/// What a page of this server may load and do.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' \
    data: blob:; connect-src 'self'; font-src 'self'; worker-src 'self'; manifest-src 'self'; \
    frame-src 'self'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'";

/// Changes nothing, though its plan is in the body.
const READ_ONLY: [&str; 3] = ["/api/plan/check", "/api/plan/import", "/api/plan/export"];

/// The address at which a connection arrived.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ArrivedAt(pub(crate) SocketAddr);

/// Who has sent a request.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Peer(pub(crate) IpAddr);

impl Peer {
    /// As who sends commands.
    pub(crate) fn sender(self) -> String {
        format!("ground station, page at {}", self.0.to_canonical())
    }
}

/// The only value of a header; an error if there are several.
fn single<'a>(headers: &'a HeaderMap, name: &HeaderName) -> Result<Option<&'a str>, Failure> {
    let mut all = headers.get_all(name).iter();
    let (first, second) = (all.next(), all.next());
    if second.is_some() {
        return Err(Failure::bad(format!("{name}: is given twice")));
    }
    let text = first.map(|value| value.to_str());
    text.transpose()
        .map_err(|_| Failure::bad(format!("{name}: is no text")))
}

/// Whether another site has made the browser send this.
fn is_own(request: &Request, hosts: &Hosts) -> Result<(), Failure> {
    let foreign = |what: String| Failure::new(StatusCode::FORBIDDEN, what);
    let at = request.extensions().get::<ArrivedAt>();
    let at = at
        .ok_or_else(|| Failure::internal("the connection has no address"))?
        .0;
    let headers = request.headers();
    let host = single(headers, &HOST)?.unwrap_or_default();
    let named = request
        .uri()
        .authority()
        .map_or(host, |authority| authority.as_str());
    if named != host || !hosts.permit(host, at) {
        return Err(foreign(format!(
            "{host:?} is no name of this station: open the printed link, or give the name with \
             --host NAME"
        )));
    }
    // Its address has the token, which no other site knows.
    if request.uri().path().starts_with("/foxglove/") {
        return Ok(());
    }
    if let Some(origin) = single(headers, &ORIGIN)?
        && origin.strip_prefix("http://") != Some(host)
    {
        return Err(foreign(format!(
            "a page of {origin:?} may not use this station"
        )));
    }
    let site = HeaderName::from_static("sec-fetch-site");
    let is_api = request.uri().path().starts_with("/api") || request.uri().path() == "/map.pmtiles";
    match single(headers, &site)? {
        None | Some("same-origin" | "none") => Ok(()),
        Some(_) if !is_api => Ok(()),
        Some(_) => Err(foreign("another site may not use this station".to_owned())),
    }
}

/// Reads the body of a request that may have one.
async fn with_body(request: Request, most_bytes: usize) -> Result<Request, Failure> {
    let is_json = single(request.headers(), &CONTENT_TYPE)? == Some("application/json");
    if request.method() != Method::DELETE && !is_json {
        return Err(Failure::new(
            StatusCode::UNSUPPORTED_MEDIA_TYPE,
            "content-type: send application/json",
        ));
    }
    let (parts, body) = request.into_parts();
    let too_large = || {
        let what = format!("the request is larger than {most_bytes} bytes");
        Failure::new(StatusCode::PAYLOAD_TOO_LARGE, what)
    };
    // Before it comes.
    if body.size_hint().lower() > most_bytes as u64 {
        return Err(too_large());
    }
    let read = tokio::time::timeout(ARRIVES_WITHIN, to_bytes(body, most_bytes)).await;
    let seconds = ARRIVES_WITHIN.as_secs();
    let read = read.map_err(|_| {
        let what = format!("the request did not arrive within {seconds} s");
        Failure::new(StatusCode::REQUEST_TIMEOUT, what)
    })?;
    let bytes = read.map_err(|_| too_large())?;
    Ok(Request::from_parts(parts, Body::from(bytes)))
}

async fn checked(station: &Station, request: Request) -> Result<Request, Failure> {
    is_own(&request, &station.hosts)?;
    let method = request.method();
    if method == Method::GET || method == Method::HEAD {
        return Ok(request);
    }
    if method != Method::POST && method != Method::PUT && method != Method::DELETE {
        return Err(Failure::new(
            StatusCode::METHOD_NOT_ALLOWED,
            format!("{method}: is not used here"),
        ));
    }
    if station.token.is_in(request.headers()) {
        return with_body(request, MOST_BYTES).await;
    }
    if READ_ONLY.contains(&request.uri().path()) {
        return with_body(request, MOST_BYTES_READ_ONLY).await;
    }
    Err(Failure::new(
        StatusCode::UNAUTHORIZED,
        "this link permits no changes: open the one that the station has printed",
    ))
}

/// Answers a request of this page, and refuses others.
pub(crate) async fn guard(
    State(station): State<Arc<Station>>,
    request: Request,
    next: Next,
) -> Response {
    let is_api = request.uri().path().starts_with("/api");
    let mut response = match checked(&station, request).await {
        Ok(mut request) => {
            // Nothing here differs by it, and it is long in browsers.
            request.headers_mut().remove(ACCEPT);
            next.run(request).await
        }
        Err(failure) => failure.into_response(),
    };
    let is_unauthorized = response.status() == StatusCode::UNAUTHORIZED;
    let headers = response.headers_mut();
    for (name, value) in [
        (CONTENT_SECURITY_POLICY, POLICY),
        (X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (X_FRAME_OPTIONS, "DENY"),
        (REFERRER_POLICY, "no-referrer"),
        (
            HeaderName::from_static("cross-origin-opener-policy"),
            "same-origin",
        ),
        (
            HeaderName::from_static("cross-origin-resource-policy"),
            "same-origin",
        ),
        (CACHE_CONTROL, if is_api { "no-store" } else { "no-cache" }),
    ] {
        headers
            .entry(name)
            .or_insert(HeaderValue::from_static(value));
    }
    if is_unauthorized {
        headers.insert(WWW_AUTHENTICATE, HeaderValue::from_static("Bearer"));
    }
    response
}
