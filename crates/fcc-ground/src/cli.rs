//! The command line.

use std::net::SocketAddr;
use std::path::PathBuf;

use clap::Parser;

use crate::exit::EXIT_CODES;

/// The ground station: serves a page with map, flight plan, flight and recordings.
#[derive(Parser, Clone, Debug)]
#[allow(
    clippy::struct_excessive_bools,
    reason = "each is a switch of the command line"
)]
#[command(name = "fcc-ground", version, after_help = EXIT_CODES)]
pub struct Cli {
    /// Address and port to listen on; another one than loopback is reachable by everybody
    /// on that network
    #[arg(long, value_name = "ADDRESS:PORT", default_value = "127.0.0.1:8460")]
    pub listen: SocketAddr,
    /// A further name of this machine by which browsers may address it; may be given several
    /// times
    #[arg(long = "host", value_name = "NAME")]
    pub hosts: Vec<String>,
    /// The configuration of a daemon, for its checks, limits and plan; may be given several
    /// times, one for each telemetry.instance
    #[arg(long = "config", value_name = "FILE")]
    pub configs: Vec<PathBuf>,
    /// The folder of recordings [default: that of the first configuration, or recordings]
    #[arg(long, value_name = "DIR")]
    pub recordings: Option<PathBuf>,
    /// The folder of drafts, uploaded plans and the token [default: the folder of the service,
    /// or ~/.local/state/fcc-ground]
    #[arg(long, value_name = "DIR")]
    pub state: Option<PathBuf>,
    /// The program `fccd`, for the doctor's findings
    #[arg(long, value_name = "FILE", default_value = "fccd")]
    pub fccd: PathBuf,
    /// The daemons of the configurations are started again when they are stopped: a plan that
    /// is uploaded in standby is written into their plan.file, and they are stopped
    #[arg(long)]
    pub restarts: bool,
    /// Send the newest records to Foxglove, too: the line with the link says where
    #[arg(long)]
    pub foxglove: bool,
    /// A map in one file, made by `pmtiles`
    #[arg(long, value_name = "FILE.pmtiles")]
    pub map: Option<PathBuf>,
    /// Whose map it is, shown on the map
    #[arg(
        long,
        value_name = "TEXT",
        default_value = "© OpenStreetMap contributors"
    )]
    pub map_attribution: String,
    /// Replace the token: links from before permit no changes any more
    #[arg(long)]
    pub new_token: bool,
    /// Print the status line as JSON
    #[arg(long)]
    pub json: bool,
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
        let cli = Cli::parse_from(["fcc-ground"]);
        assert!(cli.listen.ip().is_loopback());
    }
}
