//! Reports on flights of the built-in aircraft: their content, that their page
//! is valid and needs no other files, and that their CSV equals the recording.

mod command;
mod flown;

use fcc_core::framework::{Reading, RecordOf, Time};
use fcc_fixed_wing::Autopilot;
use fcc_guidance::TimedPatternConfig;
use fcc_report::{FileEnd, FlightAddition, FlightReport, FlightSurvey, Origin};
use fcc_telemetry::FlightMessage;
use flown::Plan;
use html5ever::tendril::TendrilSink as _;
use markup5ever_rcdom::{Handle, NodeData, RcDom};

/// The report on a flight from the messages that `keep` selects.
fn report(plan: Plan, keep: impl Fn(&FlightMessage) -> bool) -> FlightReport {
    let addition = FlightAddition::new(Some(TimedPatternConfig::default()));
    let mut survey = FlightSurvey::new(Origin::default(), addition);
    plan.fly(|message| {
        if keep(message) {
            survey.take(message).unwrap();
        }
    });
    survey.finish(FileEnd::Finished("stop requested".to_owned()))
}

fn all(_: &FlightMessage) -> bool {
    true
}

fn contains(report: &FlightReport, text: &str) -> bool {
    report.findings.iter().any(|finding| finding.contains(text))
}

/// Parses a page; it must be valid and need no other files.
#[track_caller]
fn sound(page: &str) -> RcDom {
    let dom =
        html5ever::parse_document(RcDom::default(), html5ever::ParseOpts::default()).one(page);
    assert!(dom.errors.borrow().is_empty(), "{:?}", dom.errors.borrow());
    let elsewhere = page.replace("http://www.w3.org/2000/svg", "");
    for fetched in [
        "http:",
        "https:",
        "<script src",
        "fetch(",
        "<link",
        "<iframe",
        "src=",
        "url(",
        "@import",
    ] {
        assert!(!elsewhere.contains(fetched), "the page has {fetched}");
    }
    assert!(!page.contains("NaN"), "the page has a number that is none");
    dom
}

/// The texts of all elements of a name directly inside elements of another
/// name.
fn texts(dom: &RcDom, parent: &str, name: &str) -> Vec<String> {
    let mut found = Vec::new();
    gather(&dom.document, parent, name, &mut found);
    found
}

fn gather(node: &Handle, parent: &str, name: &str, found: &mut Vec<String>) {
    for child in node.children.borrow().iter() {
        if is(node, parent) && is(child, name) {
            found.push(text(child));
        }
        gather(child, parent, name, found);
    }
}

fn is(node: &Handle, element: &str) -> bool {
    matches!(&node.data, NodeData::Element { name, .. } if &*name.local == element)
}

fn text(node: &Handle) -> String {
    match &node.data {
        NodeData::Text { contents } => contents.borrow().to_string(),
        _ => node.children.borrow().iter().map(text).collect(),
    }
}

/// 65 s: 2 s of standby and the switch's second reading, 20 s of holding, two
/// whole legs and a part.
#[test]
fn a_flight_is_reported_as_it_was_flown() {
    let report = report(Plan::seconds(65), all);
    assert_eq!(report.continuity.ticks, 2_600);
    assert_eq!(report.continuity.lost, 0);
    assert!((report.duration_s - 64.975).abs() < 1e-9);
    let states: Vec<_> = report
        .states
        .iter()
        .map(|span| (span.state.as_str(), span.from_s))
        .collect();
    assert_eq!(
        states,
        [("standby", 0.0), ("engaged", 2.025), ("stopped", 64.975)]
    );
    let timing = report.timing.as_ref().unwrap();
    assert!((timing.table.period_ms.mean - 25.0).abs() < 1e-9);
    // Table 6.1 of the thesis.
    assert_eq!(timing.thesis.unwrap().max_ms, 32.593);
    assert!(contains(&report, "ran in lockstep"));

    let flight = report.addition.flight.as_ref().unwrap();
    assert_eq!(flight.legs.len(), 2, "the third leg is not whole");
    let worst = flight.worst.unwrap();
    // The design's limits, widened by the sensors' noise.
    assert!(worst.heading_settle_s.unwrap() < 17.5, "{worst:?}");
    assert!(worst.altitude_settle_s.unwrap() < 14.0, "{worst:?}");

    let html = sound(&report.to_html());
    assert_eq!(
        texts(&html, "figure", "h3"),
        [
            "Timeline",
            "Heading",
            "Altitude and pitch",
            "Airspeed and throttle",
            "Bank and surfaces",
            "Ground track",
            "Legs of the timed pattern",
            "Period and lateness",
        ]
    );
    let cells = texts(&html, "tr", "td");
    assert!(!report.events.is_empty());
    for event in &report.events {
        assert!(cells.contains(&event.text), "{event:?}");
    }
}

#[test]
fn a_gap_is_reported_and_visible() {
    let report = report(Plan::seconds(30), |message| match message {
        FlightMessage::Tick(record) => !(401..=439).contains(&record.tick.number),
        FlightMessage::Event(_) => true,
    });
    assert_eq!(report.continuity.lost, 39);
    let timing = &report.timing.as_ref().unwrap().table;
    assert!(
        (timing.period_ms.max - 25.0).abs() < 1e-9,
        "a gap is no period"
    );
    let [gap] = report.continuity.gaps.as_slice() else {
        panic!("{:?}", report.continuity);
    };
    // Tick 1 is at 0 s: 400 is at 9.975 s, 440 at 10.975 s.
    assert!((gap.from_s - 9.975).abs() < 1e-9 && (gap.to_s - 10.975).abs() < 1e-9);
    assert!(contains(
        &report,
        "39 ticks are missing from the file, in 1 gap, the longest of 1.00 s"
    ));
    let page = report.to_html();
    sound(&page);
    assert!(page.contains("records missing"));
}

#[test]
fn a_silent_sensor_is_an_event_and_a_failsafe() {
    let report = report(
        Plan {
            silent_from: Some(1_000),
            ..Plan::seconds(40)
        },
        all,
    );
    assert_eq!(report.failsafes, 1);
    assert!(contains(&report, "It entered failsafe once"));
    let text: Vec<_> = report.events.iter().map(|event| &event.text).collect();
    assert!(
        text.iter().any(|text| text.contains("failsafe")),
        "{text:?}"
    );
    let page = report.to_html();
    sound(&page);
    // No line continues without measurements: ages do.
    assert!(page.contains("Ages of measurements"));
    assert!(report.to_text().contains("Age of"));
}

#[test]
fn standby_alone_has_nothing_desired() {
    let report = report(Plan::seconds(1), all);
    assert!(contains(&report, "never engaged"));
    assert!(report.addition.flight.is_none());
    let page = report.to_html();
    sound(&page);
    assert!(!page.contains(">\ndesired\n<"), "a legend for no line");
}

#[test]
fn a_recording_without_ticks_is_reported() {
    let report =
        FlightSurvey::new(Origin::default(), FlightAddition::default()).finish(FileEnd::Unknown);
    assert!(contains(&report, "no tick"));
    let html = sound(&report.to_html());
    assert!(texts(&html, "body", "figure").is_empty());
    assert!(report.to_text().contains("no tick"));
}

#[test]
fn one_tick_is_a_report_too() {
    let report = report(Plan::seconds(1), |message| match message {
        FlightMessage::Tick(record) => record.tick.number == 7,
        FlightMessage::Event(_) => false,
    });
    assert_eq!(report.continuity.ticks, 1);
    assert!(contains(&report, "begins late, at tick 7: 6 ticks"));
    sound(&report.to_html());
}

/// Each colour of a plot has another for a dark screen.
#[test]
fn a_dark_screen_has_a_colour_for_each_of_the_plots() {
    let report = report(
        Plan {
            silent_from: Some(1_000),
            ..Plan::seconds(40)
        },
        |message| match message {
            FlightMessage::Tick(record) => !(401..=439).contains(&record.tick.number),
            FlightMessage::Event(_) => true,
        },
    );
    let page = report.to_html();
    let (style, plots) = page.split_once("</style>").unwrap();
    let (_, dark) = style.split_once("prefers-color-scheme: dark").unwrap();
    let mut colours = 0;
    for attribute in ["fill", "stroke"] {
        let before = format!(" {attribute}=\"#");
        for (at, _) in plots.match_indices(&before) {
            let value = &plots[at + before.len()..at + before.len() + 6];
            let rule = format!("[{attribute}=\"#{value}\"]");
            assert!(dark.contains(&rule), "{rule}");
            colours += 1;
        }
    }
    assert!(colours > 100, "{colours}");
}

/// Each plot is a file of its own, too.
#[test]
fn plots_are_svg_files() {
    let report = report(Plan::seconds(30), all);
    let svgs = report.to_svgs();
    let names: Vec<&str> = svgs.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(
        names,
        [
            "timeline.svg",
            "heading.svg",
            "altitude-and-pitch.svg",
            "airspeed-and-throttle.svg",
            "bank-and-surfaces.svg",
            "ground-track.svg",
        ]
    );
    for (name, svg) in &svgs {
        assert!(
            svg.starts_with("<svg ") && svg.contains("xmlns=\"http://www.w3.org/2000/svg\""),
            "{name}"
        );
        assert!(svg.trim_end().ends_with("</svg>"), "{name}");
    }
}

/// A spike of one tick in an hour, with 1.8 s per bin of the overview: the
/// lines of a zoomed plot have more points around it, in a page that is still
/// small.
#[test]
fn a_zoomed_plot_of_a_long_flight_shows_finer_lines() {
    let mut record = RecordOf::<Autopilot>::default();
    let mut survey = FlightSurvey::new(Origin::default(), FlightAddition::default());
    for number in 1..=144_000_u64 {
        let at = Time::from_nanos(number as i64 * 25_000_000);
        (record.tick.number, record.tick.dt_s) = (number, 0.025);
        (record.tick.scheduled, record.tick.woke) = (at, at);
        // Noise from a generator by Lehmer (1951).
        let noise = |of: u64| (number * of * 48_271 % 2_147_483_647) as f64 / 2_147_483_647.0;
        let measured = &mut record.measurements;
        measured.altitude_m = Reading::new(1_000.0 + noise(1), at);
        measured.airspeed_mps = Reading::new(50.0 + noise(3), at);
        measured.heading_rad = Reading::new(1.0 + 0.1 * noise(5), at);
        record.estimate.altitude_m = 1_000.0 + noise(7);
        record.estimate.airspeed_mps = 50.0 + noise(11);
        record.estimate.heading_rad = 1.0 + 0.1 * noise(13);
        survey.take(&FlightMessage::Tick(record)).unwrap();
    }
    let report = survey.finish(FileEnd::Unknown);
    let page = report.to_html();
    sound(&page);
    let paths = |class: &str| -> Vec<usize> {
        let begin = format!("<path class=\"{class}\"");
        let pieces = page.split(&begin).skip(1);
        pieces
            .map(|piece| {
                let (path, _) = piece.split_once("/>").unwrap();
                path.matches([' ', '-', 'h', 'l']).count()
            })
            .collect()
    };
    let (overview, detail) = (paths("overview"), paths("detail"));
    assert_eq!(overview.len(), detail.len());
    assert!(overview.len() >= 6, "{overview:?}");
    let finer = overview.iter().zip(&detail);
    let finer = finer.filter(|(overview, detail)| **detail > 4 * **overview);
    assert!(finer.count() >= 6, "{overview:?} {detail:?}");
    assert!(page.len() < 4_500_000, "{}", page.len());
    // What the script fits each axis of values by.
    let count = |part: &str| page.matches(part).count();
    assert_eq!(count("<svg class=\"time curves\""), 9);
    assert_eq!(count("<g class=\"values\" data-kind=\"line\""), 4);
    assert_eq!(count("<g class=\"values\" data-kind=\"together\""), 3);
    let svgs = report.to_svgs();
    let mut files = svgs.iter();
    assert!(
        files.all(|(_, svg)| !svg.contains("detail")),
        "on paper, too"
    );
}
