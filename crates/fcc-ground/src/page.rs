//! The page, which is part of the program.

use axum::http::header::{CACHE_CONTROL, CONTENT_TYPE};
use axum::http::{StatusCode, Uri};
use axum::response::{IntoResponse as _, Response};
use rust_embed::RustEmbed;

#[derive(RustEmbed)]
#[folder = "../../web/dist"]
struct Page;

/// A file of the page. Names that have a hash of the content never change theirs.
pub(crate) async fn page(uri: Uri) -> Response {
    let name = match uri.path().trim_start_matches('/') {
        "" => "index.html",
        name => name,
    };
    let Some(file) = Page::get(name) else {
        return (StatusCode::NOT_FOUND, "there is no such page").into_response();
    };
    let kind = file.metadata.mimetype().to_owned();
    let kind = match kind.as_str() {
        "text/html" => "text/html; charset=utf-8".to_owned(),
        _ => kind,
    };
    let kept = if name.starts_with("assets/") {
        "public, max-age=31536000, immutable"
    } else {
        "no-cache"
    };
    (
        [(CONTENT_TYPE, kind), (CACHE_CONTROL, kept.to_owned())],
        file.data,
    )
        .into_response()
}
