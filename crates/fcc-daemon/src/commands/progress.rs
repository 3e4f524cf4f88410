//! Progress bars.

use indicatif::{ProgressBar, ProgressStyle};

/// A progress bar for reading `bytes`; hidden if standard error is not a
/// terminal.
pub(super) fn bar(bytes: u64, what: &str) -> ProgressBar {
    let bar = ProgressBar::new(bytes).with_message(what.to_owned());
    if let Ok(style) =
        ProgressStyle::with_template("{msg} {wide_bar} {bytes}/{total_bytes} {eta:>4} left")
    {
        bar.set_style(style);
    }
    bar
}
