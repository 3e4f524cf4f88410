//! A report as one page that needs nothing but itself.

use std::path::Path;
use std::{fs, io};

use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::durations::NamedPercentiles;
use super::plot::{Figure, PlotError, figures};
use super::{Report, Timing};
use fcc_telemetry::{FlightScore, LegScore};

const STYLE: &str = include_str!("page.css");
/// Lets plots be zoomed; without it, the page is the same, and still.
const SCRIPT: &str = include_str!("page.js");

impl Report {
    /// The page: HTML with everything in it, plots as SVG; nothing is fetched
    /// when it is opened.
    ///
    /// # Errors
    /// When a plot cannot be drawn.
    pub fn to_html(&self) -> Result<String, PlotError> {
        let figures = figures(self)?;
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
                    @if !figures.flight.is_empty() {
                        h2 { "Flight" }
                        @for figure in &figures.flight { (figure_markup(figure)) }
                        @if let Some(flight) = &self.flight { (flight_table(flight)) }
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

    /// Each plot as a file of its own, for papers: its name, which ends in
    /// `.svg`, and what is in it.
    ///
    /// # Errors
    /// When a plot cannot be drawn.
    pub fn to_svgs(&self) -> Result<Vec<(String, String)>, PlotError> {
        let named = |figure: Figure| {
            let name = figure.title.to_lowercase().replace(' ', "-");
            (format!("{name}.svg"), figure.svg)
        };
        Ok(figures(self)?.into_all().map(named).collect())
    }

    /// Writes each plot into a file of its own, in a folder that is made if it
    /// is missing.
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

    fn title(&self) -> String {
        let origin = &self.origin;
        let of = if origin.aircraft.is_empty() {
            "Flight".to_owned()
        } else {
            format!("Flight of {}", origin.aircraft)
        };
        if origin.started.is_empty() {
            of
        } else {
            format!("{of}, {}", self.started())
        }
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

    fn events_table(&self) -> Markup {
        html! {
            div.wide { table.events {
                thead { tr { th { "No." } th { "Time, s" } th { "Tick" } th.words { "Event" } } }
                tbody {
                    @for event in &self.events {
                        tr {
                            td { (event.number) }
                            td { (format!("{:.3}", event.time_s)) }
                            td { (event.tick) }
                            td.words { (event.text) }
                        }
                    }
                }
            } }
        }
    }
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
                        th.words {}
                        @for column in &columns {
                            th { (column.rate_hz) " Hz " (column.timer) }
                        }
                    }
                }
                tbody {
                    @for (name, cells) in crate::table::timing_rows(&columns) {
                        tr { td.words { (name) } @for cell in cells { td { (cell) } } }
                    }
                }
            } }
            figcaption { "The thesis' table (6.1 to 6.3), and below it what it did not measure." }
        }
    }
}

fn flight_table(flight: &FlightScore) -> Markup {
    let rows = flight
        .legs
        .iter()
        .enumerate()
        .map(|(number, leg)| ((number + 1).to_string(), leg))
        .chain(flight.worst.iter().map(|worst| ("worst".to_owned(), worst)));
    html! {
        figure {
            h3 { "Legs of the timed pattern" }
            div.wide {
                table {
                    thead {
                        tr {
                            @for name in crate::table::LEG_COLUMNS { th { (name) } }
                        }
                    }
                    tbody { @for (name, leg) in rows { (leg_row(name, leg)) } }
                }
            }
            figcaption {
                "By what was measured: time until the heading stays within 2° and the altitude \
                 within 10 ft of the set point, how far each goes past it, and the root mean \
                 square of what is left; largest errors of a whole leg."
            }
        }
    }
}

fn leg_row(name: String, leg: &LegScore) -> Markup {
    html! {
        tr.worst[name == "worst"] {
            @for cell in crate::table::leg_cells(name, leg) { td { (cell) } }
        }
    }
}

fn percentiles_table(title: &str, rows: &[NamedPercentiles]) -> Markup {
    html! {
        @if !rows.is_empty() {
            div.wide { table {
                thead {
                    tr {
                        th.words { (title) }
                        @for name in ["p50", "p90", "p99", "p99.9", "max"] { th { (name) } }
                    }
                }
                tbody {
                    @for row in rows {
                        tr { td.words { (row.name) } @for cell in row.figures() { td { (cell) } } }
                    }
                }
            } }
        }
    }
}
