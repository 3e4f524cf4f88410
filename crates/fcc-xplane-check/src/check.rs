//! Runs the steps.

use std::fs::{self, OpenOptions};
use std::io;
use std::net::{Ipv4Addr, SocketAddr, ToSocketAddrs, UdpSocket};
use std::path::PathBuf;
use std::time::{Duration, Instant};

use fcc_xplane::{DiscoverError, PlantId, XPlaneConfig, discover, plant_at};

use crate::bench::{Bench, Stop};
use crate::link::Link;
use crate::report::{Report, Simulator};
use crate::result::{Outcome, StepResult};
use crate::screen::Screen;
use crate::step::Step;
use crate::steps::{NO_ANSWER, STEPS};
use crate::waits::{FULL, SHORT};

/// Several beacons.
const BEACON_WITHIN: Duration = Duration::from_secs(5);

/// What to check.
#[derive(Clone, Debug)]
pub struct Request {
    /// The program `fccd`.
    pub program: PathBuf,
    /// The text of its configuration.
    pub config: String,
    /// Where X-Plane is, and the engage switch: from that configuration.
    pub x_plane: XPlaneConfig,
    /// A folder for the daemon's files; it is made.
    pub folder: PathBuf,
    /// Files of the report: that they can be written is known before the steps. Their content
    /// is left as it is.
    pub report: Vec<PathBuf>,
    /// The numbers of the steps to do; all if there are none.
    pub only: Vec<u8>,
    /// Nobody is asked: a stand-in does what a person would.
    pub is_unattended: bool,
    /// Shortened waits.
    pub is_short: bool,
    /// The UDP port to receive on, 0 for any that is free.
    pub local_port: u16,
}

/// Why the check could not begin.
#[derive(thiserror::Error, Debug)]
#[non_exhaustive]
pub enum CheckError {
    /// X-Plane was not found.
    #[error(transparent)]
    NotFound(#[from] DiscoverError),
    /// Its host name is unknown.
    #[error("cannot find X-Plane at {host}: {source}; give its IP address")]
    UnknownHost {
        /// The host.
        host: String,
        /// The operating system's error.
        source: io::Error,
    },
    /// Another `fccd` flies it, which the check would disturb.
    #[error("another fccd flies this X-Plane: end it first: {0}")]
    Flown(PlantId),
    /// No socket, or no folder.
    #[error("{what}: {source}")]
    Io {
        /// What failed.
        what: String,
        /// The operating system's error.
        source: io::Error,
    },
}

impl CheckError {
    /// Whether another program uses the simulator or the port.
    pub fn is_taken(&self) -> bool {
        match self {
            Self::Flown(_) => true,
            Self::Io { source, .. } => source.kind() == io::ErrorKind::AddrInUse,
            _ => false,
        }
    }
}

/// Connects to X-Plane, unless it or the daemon's port is in use, and prepares to start the
/// daemon.
pub(crate) fn open<'a>(
    request: Request,
    screen: &'a mut dyn Screen,
    is_flown: &dyn Fn(&PlantId) -> bool,
) -> Result<Bench<'a>, CheckError> {
    let io = |what: String| move |source| CheckError::Io { what, source };
    let address = locate(&request.x_plane)?;
    if let Some(plant) = plant_at(address).filter(|plant| is_flown(plant)) {
        return Err(CheckError::Flown(plant));
    }
    let daemons = request.x_plane.local_port;
    UdpSocket::bind((Ipv4Addr::UNSPECIFIED, daemons)).map_err(io(format!(
        "fccd cannot receive on x-plane.local_port, {daemons}: end the program that has it, or \
         choose another port"
    )))?;
    let port = request.local_port;
    let link = Link::open(address, &request.x_plane, port)
        .map_err(io(format!("cannot receive on UDP port {port}")))?;
    for file in &request.report {
        let opened = OpenOptions::new().append(true).create(true).open(file);
        opened.map_err(io(format!(
            "the report cannot be written: {}",
            file.display()
        )))?;
    }
    fs::create_dir_all(&request.folder)
        .map_err(io(format!("cannot make {}", request.folder.display())))?;
    Ok(Bench::new(
        link,
        (request.program, request.folder),
        screen,
        if request.is_short { SHORT } else { FULL },
        (request.is_unattended, request.config),
    ))
}

/// Does the steps one after another, and returns the results. Waits for the
/// network and for people. `is_flown` tells whether another `fccd` flies this X-Plane.
///
/// # Errors
/// If it could not begin.
pub fn check(
    request: Request,
    screen: &mut dyn Screen,
    is_flown: &dyn Fn(&PlantId) -> bool,
) -> Result<Report, CheckError> {
    let (only, config) = (request.only.clone(), request.config.clone());
    let how = (request.is_short, request.is_unattended);
    let mut bench = open(request, screen, is_flown)?;
    let mut results = Vec::new();
    let mut ends: Option<&str> = None;
    for step in &STEPS {
        if !only.is_empty() && !only.contains(&step.number) {
            continue;
        }
        if let Some(why) = ends {
            results.push(not_done(step, why));
            continue;
        }
        let (result, quit) = carry_out(step, &mut bench);
        let is_silent = result.outcome == Outcome::Failed && bench.link.latest().is_none();
        ends = match (quit, is_silent) {
            (true, _) => Some(ENDED),
            (_, true) => Some("X-Plane does not answer"),
            _ => None,
        };
        results.push(result);
    }
    bench.daemon.stop();
    let simulator = Simulator::seen(&bench.link);
    Ok(Report::new(simulator, results, how, config))
}

/// Why a step is skipped after a person's end.
const ENDED: &str = "the check was ended";

fn not_done(step: &Step, why: &str) -> StepResult {
    StepResult {
        number: step.number,
        title: step.title,
        outcome: Outcome::Skipped,
        why: Some(why.to_owned()),
        advice: None,
        duration_s: 0.0,
        figures: Vec::new(),
        notes: Vec::new(),
        daemon: Vec::new(),
    }
}

/// What to do about a step that could not begin.
const NOT_READY: &str = "The step could not begin. docs/troubleshooting.md says what to do about the \
                         reason; then repeat this step with --only.";

/// Does one step. Returns its result, and whether the check shall end.
fn carry_out(step: &Step, bench: &mut Bench<'_>) -> (StepResult, bool) {
    bench.screen.begin(step.number, step.title, step.action);
    bench.begin(step.number);
    let began = Instant::now();
    let done = (step.run)(bench);
    let figures = bench.figures.clone();
    let quit = matches!(done, Err(Stop::Quit));
    let advice = match done {
        Err(_) if bench.link.latest().is_none() => NO_ANSWER,
        Err(Stop::NotReady(_)) => NOT_READY,
        _ => step.advice,
    };
    bench.is_ending = quit;
    (step.restore)(bench);
    bench.end();
    let outside: Vec<String> = figures
        .iter()
        .filter(|figure| !figure.within)
        .map(|figure| {
            let limit = figure.limit.as_deref().unwrap_or_default();
            format!("{} {} ({limit})", figure.name, figure.text())
        })
        .collect();
    let (outcome, why) = match done {
        Ok(()) if outside.is_empty() => (Outcome::Passed, None),
        Ok(()) => (Outcome::Failed, Some(outside.join("; "))),
        Err(Stop::Failed(why) | Stop::NotReady(why)) => {
            let all = std::iter::once(why).chain(outside);
            (Outcome::Failed, Some(all.collect::<Vec<_>>().join("; ")))
        }
        Err(Stop::Skipped(why)) => (Outcome::Skipped, Some(why)),
        Err(Stop::Quit) => (Outcome::Skipped, Some(ENDED.to_owned())),
    };
    bench.daemon.read();
    let lines = bench.daemon.since(began).iter();
    let result = StepResult {
        number: step.number,
        title: step.title,
        outcome,
        why,
        advice: (outcome == Outcome::Failed).then_some(advice),
        duration_s: began.elapsed().as_secs_f64(),
        figures,
        notes: bench.notes.clone(),
        daemon: lines
            .filter(|line| !line.is_status())
            .map(|line| line.text.trim().to_owned())
            .collect(),
    };
    bench.screen.end(&result);
    (result, quit)
}

fn locate(config: &XPlaneConfig) -> Result<SocketAddr, CheckError> {
    use fcc_xplane::Simulator as At;
    match &config.simulator {
        At::At(address) => Ok(*address),
        At::Beacon => Ok(discover(config.beacon, BEACON_WITHIN)?.address.into()),
        At::Named(host) => {
            let host = host.to_string();
            let found = host.to_socket_addrs().map(Iterator::collect::<Vec<_>>);
            found
                .and_then(|all| {
                    let first = all.iter().find(|address| address.is_ipv4());
                    let first = first.or(all.first()).copied();
                    first.ok_or_else(|| io::Error::other("it has no address"))
                })
                .map_err(|source| CheckError::UnknownHost { host, source })
        }
    }
}
