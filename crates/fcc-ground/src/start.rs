//! Starts the station, prints its link, and ends it.

use std::env;
use std::fs;
use std::io::{self, ErrorKind, IsTerminal as _, Write as _};
use std::net::{Ipv4Addr, SocketAddr};
use std::path::PathBuf;

use clap::Parser as _;
use fcc_flight::config::ConfigError;
use fcc_mavlink::Identity;
use fcc_telemetry::StationLink;
use nix::ifaddrs::getifaddrs;
use qrcode::QrCode;
use qrcode::render::unicode::Dense1x2;
use serde_json::json;
use tokio::net::TcpListener;
use tokio::runtime::Runtime;
use tokio::signal::unix::{SignalKind, signal};
use tokio::task::JoinHandle;

use crate::cli::{Cli, MavlinkIdentity};
use crate::daemon_config::DaemonConfigs;
use crate::exit::Exit;
use crate::failure::THREADS;
use crate::hosts::Hosts;
use crate::map_file::MapFile;
use crate::mavlink;
use crate::requests::router;
use crate::server;
use crate::station;
use crate::token::Token;

/// Why the station does not start.
#[derive(thiserror::Error, Debug)]
#[non_exhaustive]
pub enum StartError {
    /// A configuration is wrong.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// The map cannot be used.
    #[error("--map {0}")]
    Map(String),
    /// MAVLink cannot be spoken as asked.
    #[error("{0}")]
    Mavlink(String),
    /// No folder was given, and none is known.
    #[error("--state DIR: give a folder for drafts: neither STATE_DIRECTORY nor HOME is set")]
    NoState,
    /// The folder of drafts cannot be used.
    #[error("{path}: cannot be used: {source}")]
    State {
        /// The folder.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// Another program uses the port.
    #[error("{0} is used by another program: end it, or give another address with --listen")]
    Taken(SocketAddr),
    /// The address cannot be used.
    #[error("--listen {address}: {source}")]
    Listen {
        /// The address.
        address: SocketAddr,
        /// The system's error.
        source: io::Error,
    },
    /// The system does not give what is needed.
    #[error("{0}")]
    System(String),
}

impl StartError {
    const fn exit(&self) -> Exit {
        match self {
            Self::Config(_) | Self::Map(_) | Self::Mavlink(_) | Self::NoState => Exit::Usage,
            Self::Taken(_) => Exit::Taken,
            Self::State { .. } | Self::Listen { .. } | Self::System(_) => Exit::Failure,
        }
    }
}

/// A station that serves.
#[derive(Debug)]
pub struct Running {
    /// Where it listens.
    pub address: SocketAddr,
    /// What permits changes.
    pub token: Token,
    recordings: PathBuf,
    state: PathBuf,
    foxglove: bool,
    serving: JoinHandle<()>,
}

impl Running {
    /// The link that permits changes.
    pub fn link(&self) -> String {
        format!(
            "http://{}/#token={}",
            reachable(self.address),
            self.token.as_str()
        )
    }

    /// The address for a connection of Foxglove, if it is served.
    fn foxglove(&self) -> Option<String> {
        let (address, token) = (reachable(self.address), self.token.as_str());
        let link = || format!("ws://{address}/foxglove/NAME?token={token}");
        self.foxglove.then(link)
    }

    /// The link for the camera of a phone, if another machine can open it.
    fn picture(&self) -> Option<String> {
        if reachable(self.address).ip().is_loopback() {
            return None;
        }
        let code = QrCode::new(self.link()).ok()?;
        let picture = code.render::<Dense1x2>().build();
        // Black on white, whatever the colours of the terminal.
        let lines = picture
            .lines()
            .map(|line| format!("\x1b[30;107m{line}\x1b[0m"));
        Some(lines.collect::<Vec<_>>().join("\n"))
    }

    /// Ends it.
    pub fn stop(&self) {
        self.serving.abort();
    }
}

/// The address by which a browser finds a station that listens on all of them: the first of
/// a network, or else this machine's own.
fn reachable(address: SocketAddr) -> SocketAddr {
    if !address.ip().is_unspecified() {
        return address;
    }
    let all = getifaddrs().into_iter().flatten();
    let mut v4 = all.filter_map(|one| Some(one.address?.as_sockaddr_in()?.ip()));
    let ip = v4.find(|ip| !ip.is_loopback() && !ip.is_link_local());
    (ip.unwrap_or(Ipv4Addr::LOCALHOST), address.port()).into()
}

fn state_folder(given: Option<PathBuf>) -> Result<PathBuf, StartError> {
    let of = |name: &str| {
        env::var_os(name)
            .filter(|value| !value.is_empty())
            .map(PathBuf::from)
    };
    let by_user = || {
        of("XDG_STATE_HOME")
            .or_else(|| Some(of("HOME")?.join(".local/state")))
            .map(|folder| folder.join("fcc-ground"))
    };
    let found = given.or_else(|| of("STATE_DIRECTORY")).or_else(by_user);
    found.ok_or(StartError::NoState)
}

/// What of the command line is MAVLink's, if it is spoken at all.
fn mavlink_options(cli: &Cli, configs: &DaemonConfigs) -> Option<mavlink::Options> {
    let given = &cli.mavlink;
    let instance = given.instance.clone();
    (!given.links.is_empty()).then(|| mavlink::Options {
        links: given.links.concat(),
        allowed: given.allow.clone(),
        system: given.system,
        identity: match given.identity {
            MavlinkIdentity::Generic => Identity::Generic,
            MavlinkIdentity::Px4 => Identity::Px4,
        },
        key: given.key.clone(),
        instance: instance
            .or_else(|| configs.first().cloned())
            .unwrap_or_default(),
    })
}

/// Starts a station within a runtime of tokio.
///
/// # Errors
/// When a configuration, the map, the folder or the address cannot be used.
pub async fn start(cli: Cli) -> Result<Running, StartError> {
    let configs = DaemonConfigs::load(&cli.configs)?;
    let mavlink = mavlink_options(&cli, &configs);
    let map = cli
        .map
        .as_ref()
        .map(|path| MapFile::open(path, &cli.map_attribution));
    let map = map.transpose().map_err(StartError::Map)?;
    let state = state_folder(cli.state)?;
    let unusable = |source| StartError::State {
        path: state.clone(),
        source,
    };
    fs::create_dir_all(&state).map_err(unusable)?;
    let token = Token::of(&state, cli.new_token).map_err(unusable)?;
    let recordings = cli.recordings.or_else(|| configs.recordings.clone());
    let recordings = recordings.unwrap_or_else(|| "recordings".into());
    let listener = TcpListener::bind(cli.listen).await;
    let listener = listener.map_err(|source| match source.kind() {
        ErrorKind::AddrInUse => StartError::Taken(cli.listen),
        _ => StartError::Listen {
            address: cli.listen,
            source,
        },
    })?;
    let address = listener.local_addr();
    let address = address.map_err(|error| StartError::System(error.to_string()))?;
    let station = station::station(
        token.clone(),
        Hosts::new(&cli.hosts, address.port()),
        (recordings.clone(), state.clone()),
        cli.fccd,
        (cli.restarts, cli.foxglove),
        map,
        configs,
    );
    let station = station.map_err(StartError::System)?;
    if let Some(options) = mavlink {
        mavlink::start(&station, &options).map_err(StartError::Mavlink)?;
    }
    let serving = tokio::spawn(server::serve(listener, router(station)));
    Ok(Running {
        address,
        token,
        recordings,
        state,
        foxglove: cli.foxglove,
        serving,
    })
}

/// Prints where the station is; a reader that has left is no failure.
fn announce(running: &Running, as_json: bool) -> io::Result<()> {
    let link = running.link();
    let line = if as_json {
        json!({
            "software": env!("CARGO_PKG_VERSION"),
            "listen": running.address.to_string(),
            "link": link,
            "recordings": running.recordings,
            "state": running.state,
            "foxglove": running.foxglove(),
        })
        .to_string()
    } else {
        let foxglove = running
            .foxglove()
            .map(|address| format!("\nFoxglove: connect to {address}, NAME being the daemon's"));
        format!(
            "ground station: open {link}{}",
            foxglove.unwrap_or_default()
        )
    };
    let mut out = io::stdout().lock();
    let picture = running.picture().filter(|_| !as_json && out.is_terminal());
    let lines = picture.into_iter().chain([line]).collect::<Vec<_>>();
    let written = writeln!(out, "{}", lines.join("\n")).and_then(|()| out.flush());
    written.or_else(|error| match error.kind() {
        ErrorKind::BrokenPipe => Ok(()),
        _ => Err(error),
    })
}

/// An error: for a reader, and as JSON where that is the result.
fn message(as_json: bool, text: impl std::fmt::Display) {
    // A message that cannot be printed cannot be reported.
    let _ = writeln!(io::stderr(), "fcc-ground: {text}");
    if as_json {
        let _ = writeln!(io::stdout(), "{}", json!({ "error": text.to_string() }));
    }
}

/// The threads of a station: two for the network, others for disks and daemons.
///
/// # Errors
/// When the system gives none.
pub fn runtime() -> io::Result<Runtime> {
    tokio::runtime::Builder::new_multi_thread()
        .worker_threads(2)
        .max_blocking_threads(THREADS)
        .enable_all()
        .build()
}

/// The program: until it is interrupted or terminated.
pub fn run() -> Exit {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => {
            let exit = if error.use_stderr() {
                Exit::Usage
            } else {
                Exit::Success
            };
            // As above.
            let _ = error.print();
            if error.use_stderr() && env::args_os().any(|word| word == "--json") {
                let _ = writeln!(io::stdout(), "{}", json!({ "error": error.to_string() }));
            }
            return exit;
        }
    };
    let runtime = match runtime() {
        Ok(runtime) => runtime,
        Err(error) => {
            message(cli.json, error);
            return Exit::Failure;
        }
    };
    let exit = runtime.block_on(until_ended(cli));
    // What waits for a disk or a daemon does not keep it.
    runtime.shutdown_background();
    exit
}

async fn until_ended(cli: Cli) -> Exit {
    let as_json = cli.json;
    let (Ok(mut interrupted), Ok(mut terminated)) = (
        signal(SignalKind::interrupt()),
        signal(SignalKind::terminate()),
    ) else {
        message(as_json, "signals cannot be received");
        return Exit::Failure;
    };
    let running = match start(cli).await {
        Ok(running) => running,
        Err(error) => {
            message(as_json, &error);
            return error.exit();
        }
    };
    // For the daemons of this user, until the station ends.
    let _published = StationLink::publish(&running.link());
    if let Err(error) = announce(&running, as_json) {
        message(as_json, format!("the link cannot be printed: {error}"));
        return Exit::Failure;
    }
    tokio::select! {
        _ = interrupted.recv() => {}
        _ = terminated.recv() => {}
    }
    running.stop();
    Exit::Success
}
