//! The vehicles that this program flies beside the aeroplane, one line each.

use std::path::Path;
use std::time::Instant;

use fcc_core::framework::MessageOf;

#[cfg(feature = "live")]
use fcc_fixed_wing::Autopilot;
use fcc_flight::config::{Config, ConfigError};
use fcc_flight::flight::FlyError;
#[cfg(feature = "live")]
use fcc_flight::flight::Pace;
use fcc_flight::vehicle::{Vehicle, Wishes, fly_vehicle, parse, replay_vehicle, vehicle_in};
#[cfg(feature = "live")]
use fcc_live::{WatchError, WatcherOf};
use fcc_multicopter::Multicopter;
use fcc_record::Recording;
use fcc_replay::{Chain, Comparison, Identity};
use fcc_report::Reported;
use fcc_runtime::SpawnError;
#[cfg(feature = "live")]
use fcc_telemetry::Instance;

use super::failure::{Failure, not_opened};
#[cfg(feature = "live")]
use super::live_vehicles::{self, LiveKind, Shown};
use super::{fly, replay, report};
use crate::cli::{FlyArgs, ReplayArgs, ReportArgs};
use crate::exit::Exit;
use crate::observers::{Announcer, Service, StatusLine};
use crate::process::Process;

/// All of them.
const KINDS: &[Kind] = &[Kind::of::<Multicopter>()];

/// The name of the vehicle whose configurations have no key `vehicle`.
const AEROPLANE: &str = "aeroplane";

#[cfg(not(feature = "live"))]
trait Shown: Vehicle + Reported<Addition = ()> {}
#[cfg(not(feature = "live"))]
impl<V: Vehicle + Reported<Addition = ()>> Shown for V {}

/// A vehicle, and what the commands do with it.
pub(super) struct Kind {
    name: &'static str,
    pub(super) fly: fn(&FlyArgs) -> Result<Exit, Failure>,
    pub(super) replay: fn(&ReplayArgs) -> Result<Exit, Failure>,
    pub(super) report: fn(&ReportArgs) -> Result<Exit, Failure>,
    #[cfg(feature = "live")]
    live: LiveKind,
    /// Describes a valid configuration.
    pub(super) check: fn(&str, &str) -> Result<String, ConfigError>,
}

impl Kind {
    const fn of<V: Shown>() -> Self {
        Self {
            name: V::NAME,
            fly: fly_it::<V>,
            replay: replay_it::<V>,
            report: report_it::<V>,
            #[cfg(feature = "live")]
            live: LiveKind::of::<V>(),
            check: |text, file| {
                let config = parse::<V>(text, file)?;
                Ok(V::check(&config).unwrap_or_default())
            },
        }
    }

    fn named(name: &str) -> Option<&'static Self> {
        KINDS.iter().find(|kind| kind.name == name)
    }

    /// The vehicle of a configuration's text; none for an aeroplane, and for a name that no
    /// vehicle has: the aeroplane's reader says what is wrong with it.
    pub(super) fn of_text(text: &str) -> Option<&'static Self> {
        Self::named(&vehicle_in(text)?)
    }

    /// The vehicle of a recording.
    pub(super) fn of_recording(file: &Path) -> Option<&'static Self> {
        Self::named(&Recording::open(file).ok()?.about().plant)
    }

    /// The live telemetry of a vehicle, else the aeroplane's.
    #[cfg(feature = "live")]
    pub(super) fn live(name: Option<&str>) -> &'static LiveKind {
        const AEROPLANE: &LiveKind = &LiveKind::of::<Autopilot>();
        name.and_then(Self::named)
            .map_or(AEROPLANE, |kind| &kind.live)
    }

    /// That of what is published under a name. The aeroplane's watcher says what else is wrong.
    #[cfg(feature = "live")]
    pub(super) fn published(instance: &Instance) -> &'static LiveKind {
        match WatcherOf::<Autopilot>::open(instance) {
            Err(WatchError::AnotherPlant { plant, .. }) => Self::live(Some(&plant)),
            _ => Self::live(None),
        }
    }

    /// The vehicle of a command line, or of the configuration that it names.
    pub(super) fn of_flight(args: &FlyArgs) -> Result<Option<&'static Self>, Failure> {
        let Some(name) = &args.vehicle else {
            let text = args.config.as_deref().map(Config::read_text);
            return Ok(text
                .and_then(Result::ok)
                .and_then(|text| Self::of_text(&text)));
        };
        let kind = Self::named(name);
        if kind.is_none() && name != AEROPLANE {
            let names: Vec<_> = KINDS.iter().map(|kind| kind.name).collect();
            let names = names.join(", ");
            let message = format_args!("there is no vehicle {name:?}: choose {AEROPLANE}, {names}");
            return Err(Failure::of(Exit::Usage, message));
        }
        Ok(kind)
    }
}

fn fly_it<V: Shown>(args: &FlyArgs) -> Result<Exit, Failure> {
    let (mut config, as_given) = match &args.config {
        None => (V::Config::default(), None),
        Some(path) => {
            let file = path.display().to_string();
            let text = Config::read_text(path).map_err(|wrong| Failure::of(Exit::Usage, wrong))?;
            (parse::<V>(&text, &file)?, Some(text))
        }
    };
    let wishes = Wishes {
        seed: args.seed,
        gusts: args.gusts,
        plan: args.plan.as_deref(),
        recordings: args.recording.recordings.as_deref(),
        not_recorded: args.recording.no_recording,
        instance: args.instance.as_ref(),
    };
    V::apply(&mut config, &wishes).map_err(|wrong| Failure::of(Exit::Usage, wrong))?;
    let mut observers: Vec<Box<dyn fcc_flight::flight::Observer<V>>> =
        vec![Box::new(Announcer::default())];
    let pace = fly::pace(args);
    #[cfg(feature = "live")]
    if pace == Pace::RealTime {
        observers.extend(live_vehicles::publisher::<V>(&config));
    }
    if !args.quiet {
        observers.push(Box::new(StatusLine::new(
            V::describe,
            V::switch_position,
            true,
        )));
    }
    observers.push(Box::new(Service::from_environment()));
    let aeroplane = Config::default();
    let outcome = fly_vehicle::<V>(
        &config,
        as_given,
        (pace, args.seconds),
        observers,
        &mut Process::new(&aeroplane),
    )
    .map_err(|error| {
        let exit = match error {
            FlyError::Spawn(SpawnError::Realtime(_)) => Exit::RealtimeDenied,
            _ => Exit::Failure,
        };
        Failure::of(exit, error)
    })?;
    Ok(fly::report(
        &outcome,
        &fcc_report::FlownPlan::default(),
        args.json,
    ))
}

fn replay_it<V: Vehicle>(args: &ReplayArgs) -> Result<Exit, Failure> {
    if args.config.is_some() || args.airframe || args.navigation {
        return Err(Failure::usage(format_args!(
            "--config, --airframe and --navigation are of aeroplanes: this is the recording of a {}",
            V::NAME
        )));
    }
    let chain = Chain::open::<V>(&args.files).map_err(not_opened)?;
    let mut replay =
        replay_vehicle::<V>(&chain).map_err(|error| Failure::of(Exit::NotReplayed, error))?;
    let comparison = Comparison::Identity(Identity::of::<V>());
    let began = Instant::now();
    let outcome = replay::compare(&chain, &mut replay, comparison, args, began);
    Ok(outcome.map_err(Failure::new)?.print(args.json))
}

fn report_it<V: Reported<Addition = ()>>(args: &ReportArgs) -> Result<Exit, Failure> {
    let recording = Recording::open_as::<MessageOf<V>>(&args.file)?;
    report::print::<V>(args, &recording, ())
}
