//! A report as one HTML page without other files.

use std::io;
use std::path::Path;

use comfy_table::Table;
use fcc_record::{create_folder, unless_left, write_output};
use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::plot::{Detail, Figure, Figures, figures};
use super::report::{Report, RunReport};
use super::reported::Addition;
use super::table::{markup, table, timing_columns};
use super::terms::capitalized;
use super::text::percentiles_table;

pub(crate) const STYLE: &str = include_str!("page.css");
/// Zooms the plots; without it the page is the same, but static.
const SCRIPT: &str = include_str!("page.js");

impl<A: Addition> Report<A> {
    /// The page: HTML with all plots as SVG; a browser loads nothing else.
    pub fn to_html(&self) -> String {
        let figures = self.figures(Detail::WhenZoomed);
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
                        @if !self.values.is_empty() { (markup(&self.values_table(), &[0])) }
                        @for (title, caption, table) in self.addition.tables() {
                            (table_figure(title, caption, &table, &[]))
                        }
                    }
                    @if let Some(timing) = &self.timing {
                        h2 { "Timing" }
                        (table_figure(
                            "Period and lateness",
                            "The thesis' table (6.1 to 6.3), and below it what it did not measure.",
                            &timing_columns(&timing.columns()),
                            &[0],
                        ))
                        @for figure in &figures.timing { (figure_markup(figure)) }
                        @if !self.stages.is_empty() {
                            (markup(&percentiles_table("Stage", &self.stages), &[0]))
                        }
                        @if self.has_ages() {
                            (markup(&percentiles_table("Age of", &self.sensor_ages), &[0]))
                        }
                    }
                    @if !self.events.is_empty() {
                        h2 { "Events" }
                        (markup(&self.events_table(), &[3]))
                    }
                    script { (PreEscaped(SCRIPT)) }
                }
            }
        };
        page.into_string()
    }

    /// Each plot as an SVG file: its name, which ends in `.svg`, and its
    /// content.
    pub fn to_svgs(&self) -> Vec<(String, String)> {
        let Figures {
            timeline,
            values,
            timing,
        } = self.figures(Detail::None);
        let named = |figure: Figure| {
            let name = figure.title.to_lowercase().replace([' ', '\''], "-");
            (format!("{name}.svg"), figure.svg)
        };
        let figures = timeline.into_iter().chain(values).chain(timing);
        figures.map(named).collect()
    }

    fn figures(&self, detail: Detail) -> Figures {
        let mut figures = figures(&self.run, detail);
        if !figures.values.is_empty() {
            figures.values.extend(self.addition.figures(&self.run));
        }
        figures
    }

    /// Writes the page into a file, which must be none of the `others`: the
    /// recording, and what else was made of it.
    ///
    /// # Errors
    /// What could not be written.
    pub fn write_page<P: AsRef<Path>>(&self, path: &Path, others: &[P]) -> Result<(), String> {
        let page = self.to_html();
        unless_left(write_output(path, others, page.as_bytes()))
            .map_err(|error| format!("{}: cannot be written: {error}", path.display()))
    }

    /// Writes each plot into a file in a folder, which is created if it is
    /// missing; none may be the recording itself. Returns the number of plots.
    ///
    /// # Errors
    /// What could not be written.
    pub fn write_svgs(&self, folder: &Path, recording: &Path) -> Result<usize, String> {
        let refused =
            |error: io::Error| format!("{}: cannot be written: {error}", folder.display());
        create_folder(folder).map_err(refused)?;
        let plots = self.to_svgs();
        for (name, svg) in &plots {
            write_output(&folder.join(name), &[recording], svg.as_bytes()).map_err(refused)?;
        }
        Ok(plots.len())
    }
}

impl RunReport {
    fn title(&self) -> String {
        let origin = &self.origin;
        let mut title = capitalized(self.terms.run);
        if !origin.plant.is_empty() {
            title = format!("{title} of {}", origin.plant);
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

    fn events_table(&self) -> Table {
        let mut table = table(&["No.", "Time, s", "Tick", "Event"]);
        for event in &self.events {
            let time_s = format!("{:.3}", event.time_s);
            let (number, tick) = (event.number.to_string(), event.tick.to_string());
            table.add_row([number, time_s, tick, event.text.clone()]);
        }
        table
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

fn table_figure(title: &str, caption: &str, table: &Table, text_columns: &[usize]) -> Markup {
    html! {
        figure {
            h3 { (title) }
            (markup(table, text_columns))
            figcaption { (caption) }
        }
    }
}
