//! One flight, in a thread of its own that reads the loop's messages.

use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{SyncSender, sync_channel};
use std::sync::{Arc, OnceLock};
use std::thread::{self, JoinHandle};

use fcc_core::framework::{ControlAuthority, Released};
use fcc_flight::config::Config;
use fcc_flight::flight::{
    Host, Length, Outcome, Pace, Plan, RecordingRequest, assemble_on_phone, fly,
};
use fcc_phone::{Phone, PhoneHandle};
use fcc_runtime::StopHandle;

use crate::commands::{Commander, Commands};
use crate::failure::{Failure, panic_message};
use crate::hints::HintingObserver;
use crate::listener::{Notice, Notifier};
use crate::live::{Live, LiveObserver};
use crate::phone::AppPhone;
use crate::release::{self, Outliving};

/// The nice value that the loop asks for where it is refused `SCHED_FIFO`: that
/// of Android's most urgent threads (`THREAD_PRIORITY_URGENT_AUDIO`).
const NICE: i8 = -19;

/// The stack of the flight's thread: a main thread's, which assembles and flies in
/// the daemon. A Java thread's is too small.
const STACK_BYTES: usize = 8 * 1024 * 1024;

/// A flight that has begun.
pub(crate) struct Flight {
    thread: JoinHandle<()>,
    /// Set before the app is told that it has ended.
    is_over: Arc<AtomicBool>,
    stop: StopRequest,
    commander: Commander,
    phone: PhoneHandle,
}

impl Flight {
    /// Assembles and flies a configuration; returns when its loop runs.
    ///
    /// # Errors
    /// When it does not begin.
    pub(crate) fn begin(
        config: &Config,
        text: &str,
        package: &str,
        live: &Arc<Live>,
        notifier: &Notifier,
    ) -> Result<Self, Failure> {
        let stop = StopRequest::default();
        let (begun, has_begun) = sync_channel(1);
        let phone = AppPhone(Phone::new(package));
        let handle = phone.0.handle();
        let of_flight = Conduct {
            config: config.clone(),
            text: text.to_owned(),
            live: Arc::clone(live),
            notifier: notifier.clone(),
            stop: stop.clone(),
            begun: begun.clone(),
            phone,
        };
        let (live, notifier) = (Arc::clone(live), notifier.clone());
        let is_over = Arc::new(AtomicBool::new(false));
        let ends = Arc::clone(&is_over);
        let thread = thread::Builder::new()
            .name("fcc-flight".to_owned())
            .stack_size(STACK_BYTES)
            .spawn(move || {
                let flown = catch_unwind(AssertUnwindSafe(|| of_flight.conduct()));
                let ended = flown.unwrap_or_else(|payload| Err(panic_message(payload)));
                let why = match &ended {
                    Ok(outcome) => outcome.ending.clone(),
                    Err(why) => why.clone(),
                };
                live.end(ended.as_ref().ok(), &why);
                ends.store(true, Ordering::SeqCst);
                // If the flight had begun, nobody waits for that any more.
                if begun.try_send(Err(why.clone())).is_err() {
                    notifier.tell(Notice::Ended(why));
                }
            })
            .map_err(|error| Failure::Flight(format!("no thread for the flight: {error}")))?;
        match has_begun.recv() {
            Ok(Ok(commander)) => Ok(Self {
                thread,
                is_over,
                stop,
                commander,
                phone: handle,
            }),
            Ok(Err(why)) => {
                let _ = thread.join();
                Err(Failure::Flight(why))
            }
            Err(error) => Err(Failure::Flight(error.to_string())),
        }
    }

    /// Whether it has ended by itself.
    pub(crate) fn is_over(&self) -> bool {
        self.is_over.load(Ordering::SeqCst)
    }

    /// Its end for commands.
    pub(crate) fn commander(&self) -> Commander {
        self.commander.clone()
    }

    /// The phone's sensors, for the app.
    pub(crate) fn phone(&self) -> &PhoneHandle {
        &self.phone
    }

    /// Ends it, and waits until it has ended.
    pub(crate) fn stop(self) {
        self.stop.request();
        // Its panics are caught.
        let _ = self.thread.join();
    }
}

/// A stop that may be requested before there is a loop to stop.
#[derive(Clone, Default)]
struct StopRequest {
    requested: Arc<AtomicBool>,
    handle: Arc<OnceLock<StopHandle>>,
}

impl StopRequest {
    fn request(&self) {
        self.requested.store(true, Ordering::SeqCst);
        self.follow();
    }

    fn attach(&self, handle: &StopHandle) {
        // There is one loop only.
        let _ = self.handle.set(handle.clone());
        self.follow();
    }

    fn follow(&self) {
        if let (true, Some(handle)) = (self.requested.load(Ordering::SeqCst), self.handle.get()) {
            handle.stop();
        }
    }
}

/// Where the commands of a flight that has begun go, or why it has not.
type Begun = SyncSender<Result<Commander, String>>;

/// What the flight's thread needs.
struct Conduct {
    config: Config,
    text: String,
    live: Arc<Live>,
    notifier: Notifier,
    stop: StopRequest,
    begun: Begun,
    phone: AppPhone,
}

impl Conduct {
    /// Assembles the flight, and flies it to its end.
    fn conduct(mut self) -> Result<Outcome, String> {
        release::begin_flight();
        let config = &self.config;
        let assembly = assemble_on_phone(config, &mut self.phone);
        let mut assembly = assembly.map_err(|error| error.to_string())?;
        assembly.loop_config.realtime.nice = Some(NICE);
        let recording = RecordingRequest::of(config, Some(self.text));
        let (commander, commands) = Commands::new(assembly.autopilot.config());
        let observer = LiveObserver::new(
            &self.live,
            &self.notifier,
            self.phone.0.handle(),
            config.tick.period(),
        )
        .map_err(|error| error.to_string())?;
        let plan = Plan {
            pace: Pace::RealTime,
            length: Length::Open,
        };
        let mut observers = assembly.observers(config, plan.pace, recording);
        observers.push(Box::new(commands));
        observers.push(Box::new(observer));
        // After the one whose beginning is that of the state.
        observers.push(Box::new(HintingObserver::new(&self.live)));
        let mut host = App {
            stop: self.stop,
            begun: self.begun,
            commander,
            config,
            outliving: None,
        };
        fly(assembly, &config.tick, plan, observers, &mut host).map_err(|error| error.to_string())
    }
}

/// The app as the host of a flight.
struct App<'a> {
    stop: StopRequest,
    begun: Begun,
    commander: Commander,
    config: &'a Config,
    /// None of a plant that nobody can hold.
    outliving: Option<Outliving>,
}

impl Host for App<'_> {
    fn prepare(&mut self, authority: Option<&Arc<dyn ControlAuthority>>) -> io::Result<()> {
        let folder = &self.config.recording.folder;
        self.outliving = authority
            .map(|authority| Outliving::new(authority, self.config, folder))
            .transpose()?;
        Ok(())
    }

    fn attach(&mut self, stop: &StopHandle) -> io::Result<()> {
        self.stop.attach(stop);
        Ok(())
    }

    fn started(&mut self) {
        let _ = self.begun.try_send(Ok(self.commander.clone()));
    }

    fn poll(&mut self, report: &mut dyn FnMut(String)) {
        if let Some(outliving) = &mut self.outliving {
            outliving.poll(report);
        }
    }

    fn continue_release(&mut self) -> &'static str {
        match &self.outliving {
            Some(outliving) if outliving.hand_over() => {
                "; a second process continues for two minutes"
            }
            _ => "",
        }
    }

    fn end(&mut self, released: Released) {
        if let Some(outliving) = &mut self.outliving {
            outliving.end(released);
        }
    }
}
