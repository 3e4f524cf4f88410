//! A bar that fills while a file is read.

use indicatif::{ProgressBar, ProgressStyle};

/// A bar for so many bytes; nothing where standard error is no terminal.
pub(super) fn bar(bytes: u64, what: &str) -> ProgressBar {
    let bar = ProgressBar::new(bytes).with_message(what.to_owned());
    if let Ok(style) =
        ProgressStyle::with_template("{msg} {wide_bar} {bytes}/{total_bytes} {eta:>4} left")
    {
        bar.set_style(style);
    }
    bar
}
