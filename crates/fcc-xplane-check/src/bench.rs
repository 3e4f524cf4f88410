//! What a step works with: the link, the daemon, the person or the cues, waits,
//! and the figures that it measures.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use crate::configuration::{self, Guidance};
use crate::daemon::Daemon;
use crate::figure::{Figure, Limit};
use crate::link::{Link, Sample};
use crate::screen::{Answer, Screen};
use crate::waits::Waits;
use crate::watched::Watched;

/// How long each turn receives.
const TURN: Duration = Duration::from_millis(10);
/// The interval of live lines.
const LIVE_EVERY: Duration = Duration::from_millis(250);
/// A cue takes a frame, and a reply the next.
const AFTER_A_CUE: Duration = Duration::from_millis(100);
/// How long a person may take to do something.
const BY_A_PERSON: Duration = Duration::from_secs(300);
/// How long a stand-in may take that takes a cue for it.
const BY_A_CUE: Duration = Duration::from_secs(15);
/// How long the daemon may take from its start until it is ready: connecting,
/// and settling of its filters.
const READY_WITHIN: Duration = Duration::from_secs(20);
/// The switch has to be off for half a second before an on counts.
const OFF_FOR: Duration = Duration::from_millis(700);
/// How long engaging and releasing may take.
pub(crate) const ENGAGES_WITHIN: Duration = Duration::from_secs(3);

/// Why a step ended before its end.
#[derive(Debug)]
pub(crate) enum Stop {
    Failed(String),
    /// What the step needs first was not there: its own advice would not help.
    NotReady(String),
    Skipped(String),
    Quit,
}

/// How a step ended; figures out of their limits are failures too.
pub(crate) type Done = Result<(), Stop>;

pub(crate) fn failed<T>(why: impl Into<String>) -> Result<T, Stop> {
    Err(Stop::Failed(why.into()))
}

fn did_not_happen(what: &str, within: Duration) -> String {
    format!(
        "did not happen within {:.0} s: {what}",
        within.as_secs_f64()
    )
}

/// What a step works with.
pub(crate) struct Bench<'a> {
    pub(crate) link: Link,
    pub(crate) daemon: Daemon,
    pub(crate) screen: &'a mut dyn Screen,
    pub(crate) waits: Waits,
    pub(crate) is_unattended: bool,
    /// The user's configuration.
    pub(crate) config: String,
    pub(crate) figures: Vec<Figure>,
    pub(crate) notes: Vec<String>,
    pub(crate) step: u8,
    /// The check was ended: nobody is asked any more.
    pub(crate) is_ending: bool,
    shown: Instant,
}

impl<'a> Bench<'a> {
    pub(crate) fn new(
        link: Link,
        (program, folder): (PathBuf, PathBuf),
        screen: &'a mut dyn Screen,
        waits: Waits,
        (is_unattended, config): (bool, String),
    ) -> Self {
        Self {
            link,
            daemon: Daemon::new(program, folder),
            screen,
            waits,
            is_unattended,
            config,
            figures: Vec::new(),
            notes: Vec::new(),
            step: 0,
            is_ending: false,
            shown: Instant::now(),
        }
    }

    /// A step begins.
    pub(crate) fn begin(&mut self, step: u8) {
        self.step = step;
        self.figures.clear();
        self.notes.clear();
        self.cue("begin");
        // What is known is of after the last step.
        self.link.poll(AFTER_A_CUE);
    }

    /// A step has ended.
    pub(crate) fn end(&mut self) {
        self.cue("end");
    }

    /// Tells a stand-in where the check is.
    fn cue(&self, action: &str) {
        if self.is_unattended {
            let path = format!("fccd/check/step/{:02}/{action}", self.step);
            self.link.command(&path);
        }
    }

    /// Records a number.
    pub(crate) fn measure(&mut self, name: &str, value: f64, unit: &'static str, limit: Limit) {
        self.figures.push(Figure::new(name, value, unit, limit));
    }

    /// Records how many replies showed an override since a moment: none may.
    pub(crate) fn measure_overridden(&mut self, name: &str, since: Instant) {
        let overridden = self.link.since(since).filter(|s| s.is_overridden());
        let count = overridden.count() as f64;
        self.measure(name, count, "", Limit::AtMost(0.0));
    }

    /// Records something noticed.
    pub(crate) fn note(&mut self, text: impl Into<String>) {
        self.notes.push(text.into());
    }

    /// A value now.
    pub(crate) fn number(&self, what: Watched) -> f64 {
        self.link.number(what)
    }

    /// Whether the daemon holds the controls.
    pub(crate) fn is_held(&self) -> bool {
        self.link.latest().is_some_and(Sample::is_held)
    }

    /// Whether either override is set.
    pub(crate) fn is_overridden(&self) -> bool {
        self.link.latest().is_some_and(Sample::is_overridden)
    }

    /// Whether the daemon has printed one of these texts since a time.
    pub(crate) fn has_said(&self, since: Instant, texts: &[&str]) -> bool {
        let lines = self.daemon.since(since);
        lines
            .iter()
            .any(|line| texts.iter().any(|text| line.text.contains(text)))
    }

    /// Receives for a moment.
    fn turn(&mut self, what: &str) -> Done {
        self.link.poll(TURN);
        self.daemon.read();
        if self.shown.elapsed() >= LIVE_EVERY {
            self.shown = Instant::now();
            let seen = self.seen();
            self.screen.live(&format!("{what}: {seen}"));
        }
        if self.screen.is_stopped() {
            return Err(Stop::Quit);
        }
        Ok(())
    }

    /// What is seen now, in a line.
    fn seen(&self) -> String {
        let Some(now) = self.link.latest() else {
            return "nothing arrives".to_owned();
        };
        if self.link.is_silent_for(Duration::from_millis(500)) {
            return format!("silent for {:.1} s", now.at.elapsed().as_secs_f64());
        }
        let set = |what| if now.number(what) >= 0.5 { "on" } else { "off" };
        format!(
            "bank {:.0}°, pitch {:.0}°, {:.0} kt, {:.0} ft, override {} {}, switch {}",
            now.number(Watched::Roll),
            now.number(Watched::Pitch),
            now.number(Watched::Airspeed),
            now.number(Watched::GaugeAltitude),
            set(Watched::OverrideJoystick),
            set(Watched::OverrideThrottles),
            set(Watched::EngageSwitch),
        )
    }

    /// Receives for this long.
    pub(crate) fn wait(&mut self, what: &str, duration: Duration) -> Done {
        let until = Instant::now() + duration;
        while Instant::now() < until {
            self.turn(what)?;
        }
        Ok(())
    }

    /// Waits until something holds; returns whether it did within the limit.
    pub(crate) fn until(
        &mut self,
        what: &str,
        limit: Duration,
        mut holds: impl FnMut(&Self) -> bool,
    ) -> Result<bool, Stop> {
        let until = Instant::now() + limit;
        while !holds(self) {
            if Instant::now() >= until {
                return Ok(false);
            }
            self.turn(what)?;
        }
        Ok(true)
    }

    /// As `until`; a failure with this text if it does not hold in time.
    pub(crate) fn expect(
        &mut self,
        what: &str,
        limit: Duration,
        holds: impl FnMut(&Self) -> bool,
    ) -> Done {
        if self.until(what, limit, holds)? {
            return Ok(());
        }
        failed(did_not_happen(what, limit))
    }

    /// Has a person do something, or a stand-in by a cue, and waits until it is
    /// seen.
    pub(crate) fn have_done(
        &mut self,
        cue: &str,
        instruction: &str,
        what: &str,
        mut holds: impl FnMut(&Self) -> bool,
    ) -> Done {
        if self.is_ending {
            return Err(Stop::Quit);
        }
        let limit = if self.is_unattended {
            self.cue(cue);
            BY_A_CUE
        } else {
            self.screen.instruct(instruction, false);
            BY_A_PERSON
        };
        let until = Instant::now() + limit;
        while !holds(self) {
            self.turn(what)?;
            if !self.is_unattended {
                match self.screen.answer() {
                    Some(Answer::Skip) => return Err(Stop::Skipped("left out".to_owned())),
                    Some(Answer::Quit) => return Err(Stop::Quit),
                    Some(Answer::Done) | None => {}
                }
            }
            if Instant::now() >= until {
                return failed(did_not_happen(what, limit));
            }
        }
        Ok(())
    }

    /// Has a person do something that cannot be seen from here, and waits until
    /// the person says so; a stand-in does it at once.
    pub(crate) fn have_confirmed(&mut self, cue: &str, instruction: &str) -> Done {
        if self.is_unattended {
            self.cue(cue);
            return Ok(());
        }
        if self.is_ending {
            return Err(Stop::Quit);
        }
        self.screen.instruct(instruction, true);
        let until = Instant::now() + BY_A_PERSON;
        while Instant::now() < until {
            self.turn("waiting for Enter")?;
            match self.screen.answer() {
                Some(Answer::Done) => return Ok(()),
                Some(Answer::Skip) => break,
                Some(Answer::Quit) => return Err(Stop::Quit),
                None => {}
            }
        }
        Err(Stop::Skipped("left out".to_owned()))
    }

    /// Starts the daemon for this guidance, unless it runs with it already.
    pub(crate) fn start(&mut self, guidance: Guidance) -> Done {
        if self.daemon.read() && self.daemon.guidance() == Some(guidance) {
            return Ok(());
        }
        self.daemon.stop();
        let started =
            configuration::text(&self.config, guidance, &self.waits, self.daemon.folder())
                .map_err(|error| error.to_string())
                .and_then(|config| {
                    self.daemon
                        .start(guidance, &config)
                        .map_err(|error| format!("fccd cannot be started: {error}"))
                });
        started.or_else(failed)
    }

    /// Whether the daemon's last status line says that it is ready to engage.
    /// `parked` accepts that it is only too slow for that.
    pub(crate) fn is_ready(&self, since: Instant, parked: bool) -> bool {
        let Some(line) = self.daemon.status().filter(|line| line.at >= since) else {
            return false;
        };
        if !line.text.contains("  standby ") || line.text.contains("no measurements") {
            return false;
        }
        match line.text.split_once("not ready: ") {
            None => true,
            Some((_, inhibits)) => {
                parked
                    && inhibits.trim().starts_with("airspeed is below the floor")
                    && !inhibits.contains(", ")
            }
        }
    }

    /// Waits until the daemon is ready to engage, in a hold.
    pub(crate) fn ready(&mut self, guidance: Guidance) -> Done {
        self.start(guidance)?;
        let since = Instant::now();
        self.until("fccd becomes ready", READY_WITHIN, |bench| {
            bench.is_ready(since, false) || bench.daemon.has_ended()
        })?;
        if self.daemon.has_ended() {
            let last = self.daemon.last_message().unwrap_or("it said nothing");
            return Err(Stop::NotReady(format!("fccd ended: {last}")));
        }
        if self.is_ready(since, false) {
            return Ok(());
        }
        let last = self.daemon.status().map(|line| line.text.as_str());
        Err(Stop::NotReady(
            match last.and_then(|line| line.split_once("not ready: ")) {
                Some((_, inhibits)) => format!("fccd is not ready to engage: {inhibits}"),
                None => format!(
                    "fccd did not become ready to engage within {:.0} s; its last message: {}",
                    READY_WITHIN.as_secs_f64(),
                    self.daemon.last_message().unwrap_or("none")
                ),
            },
        ))
    }

    /// Engages by the switch, unless it is engaged.
    pub(crate) fn engage(&mut self, guidance: Guidance) -> Done {
        if self.daemon.read() && self.daemon.guidance() == Some(guidance) && self.is_held() {
            return Ok(());
        }
        self.set_switch(false);
        self.ready(guidance)?;
        self.wait("the engage switch is off", OFF_FOR)?;
        let since = Instant::now();
        self.set_switch(true);
        if self.until("fccd engages", ENGAGES_WITHIN, Bench::is_held)? {
            return Ok(());
        }
        let said = self.daemon.since(since);
        let refusal = said.iter().find(|line| line.text.contains("not engaged"));
        match refusal {
            Some(line) => Err(Stop::NotReady(line.text.trim().to_owned())),
            None => failed("both overrides are not on within 3 s of the engage switch"),
        }
    }

    /// Moves the engage switch.
    pub(crate) fn set_switch(&mut self, on: bool) {
        let path = self.link.path(Watched::EngageSwitch).to_owned();
        self.link.write(&path, f64::from(u8::from(on)));
    }

    /// Switches off, and waits until the controls are released.
    pub(crate) fn disengage(&mut self) -> Done {
        self.set_switch(false);
        self.expect("the overrides are released", ENGAGES_WITHIN, |bench| {
            !bench.is_overridden()
        })
    }
}
