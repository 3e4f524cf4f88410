//! A report as one HTML page without other files.

use std::path::Path;
use std::{fs, io};

use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::durations::NamedPercentiles;
use super::plot::{Detail, Figure, Figures, PlotError, figures};
use super::reported::Addition;
use super::text::VALUE_COLUMNS;
use super::{Report, RunReport, Timing};

const STYLE: &str = include_str!("page.css");
/// Zooms the plots; without it the page is the same, but static.
const SCRIPT: &str = include_str!("page.js");

impl<A: Addition> Report<A> {
    /// The page: HTML with all plots as SVG; a browser loads nothing else.
    ///
    /// # Errors
    /// When a plot cannot be drawn.
    pub fn to_html(&self) -> Result<String, PlotError> {
        let figures = self.figures(Detail::WhenZoomed)?;
        let title = self.title();
        let page = html! {
            (DOCTYPE)
            html lang="en" {
                head {
                    meta charset="utf-8";
                    meta name="viewport" content="width=device-width, initial-scale=1";
                    title { (title) }
                    style { (PreEscaped(STYLE)) }
                }
                body {
                    h1 { (title) }
                    (self.header_table())
                    @if !self.findings.is_empty() {
                        ul.findings {
                            @for finding in &self.findings { li { (finding) } }
                        }
                    }
                    @for figure in &figures.timeline { (figure_markup(figure)) }
                    @if !figures.values.is_empty() {
                        h2 { (capitalized(self.terms.run)) }
                        @for figure in &figures.values { (figure_markup(figure)) }
                        (self.values_table())
                        (PreEscaped(self.addition.html()))
                    }
                    @if let Some(timing) = &self.timing {
                        h2 { "Timing" }
                        (timing_table(timing))
                        @for figure in &figures.timing { (figure_markup(figure)) }
                        (percentiles_table("Stage", &self.stages))
                        @if self.has_ages() {
                            (percentiles_table("Age of", &self.sensor_ages))
                        }
                    }
                    @if !self.events.is_empty() {
                        h2 { "Events" }
                        (self.events_table())
                    }
                    script { (PreEscaped(SCRIPT)) }
                }
            }
        };
        Ok(page.into_string())
    }

    /// Each plot as an SVG file: its name, which ends in `.svg`, and its
    /// content.
    ///
    /// # Errors
    /// When a plot cannot be drawn.
    pub fn to_svgs(&self) -> Result<Vec<(String, String)>, PlotError> {
        let Figures {
            timeline,
            values,
            timing,
        } = self.figures(Detail::None)?;
        let named = |figure: Figure| {
            let name = figure.title.to_lowercase().replace([' ', '\''], "-");
            (format!("{name}.svg"), figure.svg)
        };
        let figures = timeline.into_iter().chain(values).chain(timing);
        Ok(figures.map(named).collect())
    }

    fn figures(&self, detail: Detail) -> Result<Figures, PlotError> {
        let mut figures = figures(&self.run, detail)?;
        if !figures.values.is_empty() {
            figures.values.extend(self.addition.figures(&self.run)?);
        }
        Ok(figures)
    }

    /// Writes the page into a file, which must not be the recording.
    ///
    /// # Errors
    /// What could not be drawn or written.
    pub fn write_page(&self, path: &Path, recording: &Path) -> Result<(), String> {
        let refused = |why: String| format!("{}: {why}", path.display());
        if let (Ok(page), Ok(recording)) = (fs::canonicalize(path), fs::canonicalize(recording))
            && page == recording
        {
            let why = "is the recording: give the page another name";
            return Err(refused(why.to_owned()));
        }
        let page = self.to_html().map_err(|error| error.to_string())?;
        fs::write(path, page).map_err(|error| refused(format!("cannot be written: {error}")))
    }

    /// Writes each plot into a file in a folder, which is created if it is
    /// missing.
    ///
    /// # Errors
    /// What could not be drawn or written.
    pub fn write_svgs(&self, folder: &Path) -> Result<(), String> {
        let refused =
            |error: io::Error| format!("{}: cannot be written: {error}", folder.display());
        let svgs = self.to_svgs().map_err(|error| error.to_string())?;
        fs::create_dir_all(folder).map_err(refused)?;
        for (name, svg) in svgs {
            fs::write(folder.join(name), svg).map_err(refused)?;
        }
        Ok(())
    }
}

impl RunReport {
    fn title(&self) -> String {
        let origin = &self.origin;
        let mut title = capitalized(self.terms.run);
        if !origin.aircraft.is_empty() {
            title = format!("{title} of {}", origin.aircraft);
        }
        if !origin.started.is_empty() {
            title = format!("{title}, {}", self.started());
        }
        title
    }

    fn header_table(&self) -> Markup {
        html! {
            dl {
                @for (name, value) in self.header() {
                    div { dt { (name) } dd { (value) } }
                }
            }
        }
    }

    fn values_table(&self) -> Markup {
        html! {
            @if !self.values.is_empty() {
                div.wide { table {
                    thead {
                        tr {
                            @for (n, name) in VALUE_COLUMNS.iter().enumerate() {
                                th.text[n == 0] { (name) }
                            }
                        }
                    }
                    tbody {
                        @for value in &self.values {
                            tr {
                                @for (n, cell) in value.cells().iter().enumerate() {
                                    td.text[n == 0] { (cell) }
                                }
                            }
                        }
                    }
                } }
            }
        }
    }

    fn events_table(&self) -> Markup {
        html! {
            div.wide { table.events {
                thead { tr { th { "No." } th { "Time, s" } th { "Tick" } th.text { "Event" } } }
                tbody {
                    @for event in &self.events {
                        tr {
                            td { (event.number) }
                            td { (format!("{:.3}", event.time_s)) }
                            td { (event.tick) }
                            td.text { (event.text) }
                        }
                    }
                }
            } }
        }
    }
}

/// With a capital first letter.
pub(crate) fn capitalized(text: &str) -> String {
    let mut letters = text.chars();
    let first: String = letters
        .next()
        .into_iter()
        .flat_map(char::to_uppercase)
        .collect();
    first + letters.as_str()
}

fn figure_markup(figure: &Figure) -> Markup {
    html! {
        figure {
            h3 { (figure.title) }
            div.plot { (PreEscaped(&figure.svg)) }
            figcaption { (figure.caption) }
        }
    }
}

fn timing_table(timing: &Timing) -> Markup {
    let mut columns = vec![timing.table.clone()];
    columns.extend(timing.thesis.map(|thesis| thesis.timing()));
    html! {
        figure {
            h3 { "Period and lateness" }
            div.wide { table {
                thead {
                    tr {
                        th.text {}
                        @for column in &columns {
                            th { (column.rate_hz) " Hz " (column.timer) }
                        }
                    }
                }
                tbody {
                    @for (name, cells) in crate::table::timing_rows(&columns) {
                        tr { td.text { (name) } @for cell in cells { td { (cell) } } }
                    }
                }
            } }
            figcaption { "The thesis' table (6.1 to 6.3), and below it values that the thesis does not have." }
        }
    }
}

fn percentiles_table(title: &str, rows: &[NamedPercentiles]) -> Markup {
    html! {
        @if !rows.is_empty() {
            div.wide { table {
                thead {
                    tr {
                        th.text { (title) }
                        @for name in ["p50", "p90", "p99", "p99.9", "max"] { th { (name) } }
                    }
                }
                tbody {
                    @for row in rows {
                        tr { td.text { (row.name) } @for cell in row.figures() { td { (cell) } } }
                    }
                }
            } }
        }
    }
}
