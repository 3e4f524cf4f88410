//! `fccd order`: orders to a daemon on this machine.

use fcc_telemetry::live::{Commander, FlightOrder, NewSetpoints, OrderError};
use serde::Serialize;

use super::fail;
use crate::cli::{OrderArgs, OrderWhat, SetArgs};
use crate::exit::Exit;
use crate::output;
use fcc_flight::config::{FOOT_M, KNOT_MPS};

#[derive(Serialize)]
struct Told {
    instance: String,
    carried_out: bool,
    /// The tick that carried it out.
    tick: Option<u64>,
    /// Why it was not carried out.
    why: Option<String>,
}

/// Gives an order, and says what became of it.
pub(super) fn order(args: &OrderArgs) -> Exit {
    let order = FlightOrder::from(&args.what);
    if let Err(words) = order.check() {
        output::message(format!("fccd: {words}"));
        return Exit::Usage;
    }
    let told = Commander::open(&args.instance).and_then(|mut daemon| daemon.order(order));
    let exit = match &told {
        Ok(_) => Exit::Success,
        Err(OrderError::Refused(_)) => Exit::Refused,
        Err(_) => Exit::Failure,
    };
    if args.json {
        let told = Told {
            instance: args.instance.to_string(),
            carried_out: told.is_ok(),
            tick: told.as_ref().ok().copied(),
            why: told.err().map(|error| error.to_string()),
        };
        output::json(&told, exit);
    } else {
        match told {
            Ok(tick) => {
                output::result(format!("carried out in tick {tick}"), exit);
            }
            Err(error) => {
                fail(&error.to_string());
            }
        }
    }
    // What was carried out stays so, even if that cannot be printed.
    exit
}

impl From<&OrderWhat> for FlightOrder {
    fn from(what: &OrderWhat) -> Self {
        match what {
            OrderWhat::Engage => Self::Engage,
            OrderWhat::Disengage => Self::Disengage,
            OrderWhat::Stop => Self::Stop,
            OrderWhat::Set(set) => Self::Set(NewSetpoints::from(set)),
        }
    }
}

impl From<&SetArgs> for NewSetpoints {
    fn from(set: &SetArgs) -> Self {
        Self {
            airspeed_mps: set.airspeed_kt.map(|kt| kt * KNOT_MPS),
            heading_rad: set.heading_deg.map(f64::to_radians),
            altitude_m: set.altitude_ft.map(|ft| ft * FOOT_M),
        }
    }
}
