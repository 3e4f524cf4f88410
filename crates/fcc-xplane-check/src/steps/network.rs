//! Steps 1 to 4: the network.

use std::collections::{BTreeMap, BTreeSet};
use std::time::{Duration, Instant};

use crate::bench::{Bench, Done, Stop, failed};
use crate::configuration::Guidance;
use crate::figure::Limit;
use crate::step::Step;
use crate::watched::Watched;

/// How long X-Plane may take to answer a first request: the daemon repeats
/// requests each second.
const ANSWERS_WITHIN: Duration = Duration::from_secs(5);
/// The daemon reports missing values within 6 s of the first contact.
const MISSING_AFTER: Duration = Duration::from_secs(6);
/// The daemon reports a silent X-Plane, and writes without effect, within 2 s.
const REPORTED_WITHIN: Duration = Duration::from_secs(8);
/// After this long without a datagram nothing arrives.
const SILENT: Duration = Duration::from_millis(1_500);
/// The oldest version whose datarefs are known here.
const OLDEST_VERSION: f64 = 104_000.0;

/// What the daemon says when it hears nothing.
const NOTHING_HEARD: [&str; 4] = [
    "does not answer",
    "cannot be reached",
    "do not hear",
    "does not hear",
];
/// What it says when its writes have no effect.
const NO_EFFECT: [&str; 1] = ["no effect"];

/// What to do about an X-Plane that does not answer, in any step.
pub(crate) const NO_ANSWER: &str = "Start X-Plane, and load an aircraft. X-Plane 12: Settings > Network > \
    Accept incoming connections. Check the address in the configuration ([x-plane] simulator), and \
    firewalls on both machines for UDP: docs/x-plane.md.";

pub(super) const READY: Step = Step {
    number: 1,
    title: "the network is on and fccd is ready",
    action: "The check connects to X-Plane and starts fccd.",
    passes: "X-Plane answers, sends every dataref that fccd needs, and fccd reports that it is \
             ready (parked: that only the airspeed is too low).",
    source: "fccd requests everything again each second, and reports a missing value within 6 s",
    advice: NO_ANSWER,
    run: ready,
    restore: |_| {},
};

fn ready(bench: &mut Bench<'_>) -> Done {
    let at = bench.link.simulator();
    if !bench.until("X-Plane answers", ANSWERS_WITHIN, |b| {
        b.link.latest().is_some()
    })? {
        return failed(format!(
            "nothing arrives from X-Plane at {at}: `fccd run` says why"
        ));
    }
    bench.until("every dataref arrives", ANSWERS_WITHIN, |b| {
        missing(b, Watched::is_needed).is_empty()
    })?;
    for path in missing(bench, |what| !what.is_needed()) {
        bench.note(format!("X-Plane does not send {path}"));
    }
    let needed = missing(bench, Watched::is_needed);
    if !needed.is_empty() {
        return failed(format!("X-Plane does not send {}", needed.join(", ")));
    }
    let version = bench.number(Watched::Version);
    bench.measure(
        "version of X-Plane",
        version,
        "",
        Limit::AtLeast(OLDEST_VERSION),
    );
    let since = Instant::now();
    bench.start(Guidance::Hold)?;
    let is_ready = bench.until("fccd is ready", Duration::from_secs(20), |b| {
        b.is_ready(since, true) || b.daemon.has_ended()
    })?;
    if bench.daemon.has_ended() {
        let last = bench.daemon.last_message().unwrap_or("it said nothing");
        return Err(Stop::NotReady(format!("fccd ended: {last}")));
    }
    bench.measure(
        "from the start of fccd until it is ready",
        since.elapsed().as_secs_f64(),
        "s",
        Limit::Noted,
    );
    if is_ready {
        return Ok(());
    }
    // Why it is not.
    bench.wait("fccd says what is missing", MISSING_AFTER)?;
    let said = bench.daemon.status().map(|line| line.text.clone());
    failed(
        match said
            .as_deref()
            .and_then(|line| line.split_once("not ready: "))
        {
            Some((_, inhibits)) => format!("fccd is not ready: {inhibits}"),
            None => "fccd is not ready".to_owned(),
        },
    )
}

/// The chosen datarefs that have not arrived.
fn missing(bench: &Bench<'_>, chosen: impl Fn(Watched) -> bool) -> Vec<String> {
    Watched::all()
        .filter(|what| chosen(*what))
        .filter(|what| {
            bench
                .link
                .latest()
                .is_none_or(|last| last.get(*what).is_none())
        })
        .map(|what| bench.link.path(what).to_owned())
        .collect()
}

pub(super) const PORTS: Step = Step {
    number: 2,
    title: "replies come from one port, one datagram a frame",
    action: "The check receives for some seconds.",
    passes: "All replies come from one port; the values of one frame come in one datagram; at \
             least 19 frames a second.",
    source: "a reply has room for 183 values, and fewer are requested; below 19 frames a second \
             X-Plane's time runs slower",
    advice: "Two programs answer as X-Plane, or a router changes ports: end the other, or check \
             the network between the machines. For more frames a second reduce X-Plane's graphics.",
    run: ports,
    restore: |_| {},
};

fn ports(bench: &mut Bench<'_>) -> Done {
    let since = Instant::now();
    bench.wait("receiving", bench.waits.average * 2)?;
    let mut from = BTreeSet::new();
    let mut frames: BTreeMap<u64, u32> = BTreeMap::new();
    for sample in bench.link.since(since) {
        from.insert(sample.from);
        // Flight time is never negative, so its bits are in its order.
        *frames
            .entry(sample.number(Watched::FlightTime).to_bits())
            .or_default() += 1;
    }
    let elapsed_s = since.elapsed().as_secs_f64();
    let datagrams: u32 = frames.values().sum();
    let several = frames.values().filter(|count| **count > 1).count();
    bench.measure(
        "ports that replies come from",
        from.len() as f64,
        "",
        Limit::Between(1.0, 1.0),
    );
    bench.measure(
        "frames a second",
        frames.len() as f64 / elapsed_s,
        "1/s",
        Limit::AtLeast(19.0),
    );
    // A duplicated datagram on the network is no fault of X-Plane's.
    bench.measure(
        "frames whose values came in several datagrams",
        100.0 * several as f64 / frames.len().max(1) as f64,
        "%",
        Limit::AtMost(5.0),
    );
    bench.measure("datagrams", f64::from(datagrams), "", Limit::Noted);
    let requests_to = bench.link.simulator().port();
    for address in from {
        bench.note(format!(
            "requests go to port {requests_to}, replies come from {address}"
        ));
    }
    Ok(())
}

pub(super) const INCOMING: Step = Step {
    number: 3,
    title: "incoming connections off: fccd says so",
    action: "Switch Settings > Network > Accept incoming connections off, and on again when asked \
             (X-Plane 12; press s in X-Plane 11, which has no such setting).",
    passes: "While it is off no write has an effect, no override is set, and fccd names the cause \
             when it engages.",
    source: "fccd reports writes without effect after 1 s, and silence after 1.5 s",
    advice: "If writes still had an effect, the setting was not off. If fccd said nothing, send \
             this report.",
    run: incoming,
    restore: |bench| {
        let _ = bench.daemon.command("disengage");
        bench.set_switch(false);
    },
};

fn incoming(bench: &mut Bench<'_>) -> Done {
    bench.start(Guidance::Hold)?;
    let is_flying = bench.number(Watched::OnGround) < 0.5;
    if is_flying {
        bench.ready(Guidance::Hold)?;
    }
    let since = Instant::now();
    bench.have_confirmed(
        "incoming-off",
        "Switch Settings > Network > Accept incoming connections OFF, then press Enter.",
    )?;
    bench.wait("the setting takes effect", Duration::from_millis(300))?;
    if !light_follows(bench, 1.0)? && is_flying {
        // By the daemon's own command, since no write can move the switch.
        if let Err(refusal) = bench.daemon.command("engage") {
            bench.note(format!("fccd could not be told to engage: {refusal}"));
        }
        let texts = [&NOTHING_HEARD[..], &NO_EFFECT[..]].concat();
        let is_reported = bench.until("fccd reports it", REPORTED_WITHIN, |b| {
            b.has_said(since, &texts)
        })?;
        if !is_reported {
            return failed("fccd did not report that its writes have no effect");
        }
        let _ = bench.daemon.command("disengage");
    } else if is_flying {
        return failed("writes still have an effect, so incoming connections are not off");
    } else {
        bench.note("on the ground fccd does not engage, so only the check's own write was tried");
    }
    bench.measure_overridden("replies with an override set", since);
    bench.have_confirmed("incoming-on", "Switch it ON again, then press Enter.")?;
    bench.wait("the setting takes effect", Duration::from_millis(300))?;
    if light_follows(bench, 0.0)? {
        return Ok(());
    }
    failed("writes have no effect after incoming connections were switched on again")
}

/// Whether a light that is written is read back with that value.
fn light_follows(bench: &mut Bench<'_>, value: f64) -> Result<bool, Stop> {
    // From the other value, or it would follow without having been written.
    let other = if value >= 0.5 { 0.0 } else { 1.0 };
    let path = bench.link.path(Watched::SpareLight).to_owned();
    for value in [other, value] {
        bench.link.write(&path, value);
        let follows = bench.until(
            "a written light is read back",
            Duration::from_secs(1),
            |b| {
                (b.number(Watched::SpareLight) - value).abs() < 0.5
                    && !b.link.is_silent_for(Duration::from_millis(300))
            },
        )?;
        if !follows {
            return Ok(false);
        }
    }
    Ok(true)
}

pub(super) const FIREWALL: Step = Step {
    number: 4,
    title: "our own firewall lets replies through, and fccd says when it does not",
    action: "Switch this machine's firewall on (sudo ufw enable), without a rule for X-Plane, and \
             press Enter. If replies stop, add the rule when asked.",
    passes: "Replies reach a new socket, which has never received from X-Plane's reply port; if \
             the firewall stopped them, fccd reported it.",
    source: "X-Plane sends replies from another port than the one that it listens on; a firewall \
             that knows connections drops them",
    advice: "Allow UDP from X-Plane's address: sudo ufw allow from ADDRESS proto udp, or set a \
             fixed x-plane.local_port and allow that port: docs/x-plane.md.",
    run: firewall,
    restore: |_| {},
};

fn firewall(bench: &mut Bench<'_>) -> Done {
    bench.start(Guidance::Hold)?;
    let began = Instant::now();
    bench.until("fccd hears X-Plane", Duration::from_secs(20), |b| {
        b.is_ready(began, true)
    })?;
    let since = Instant::now();
    bench.have_confirmed(
        "firewall-on",
        "Switch this machine's firewall on, without a rule for X-Plane, then press Enter.",
    )?;
    bench.wait("replies stop, or not", Duration::from_secs(2))?;
    if bench.link.is_silent_for(SILENT) {
        bench.note("the firewall drops X-Plane's replies");
        let texts = NOTHING_HEARD;
        if !bench.until("fccd reports it", REPORTED_WITHIN, |b| {
            b.has_said(since, &texts)
        })? {
            return failed("fccd did not report that it does not hear X-Plane");
        }
    } else {
        bench.note("the firewall lets X-Plane's replies through");
    }
    bench.have_confirmed(
        "firewall-off",
        "If replies stopped, allow them: sudo ufw allow from ADDRESS proto udp. Then press Enter.",
    )?;
    let hears = bench.until("replies arrive again", ANSWERS_WITHIN, |b| {
        !b.link.is_silent_for(Duration::from_millis(300))
    })?;
    if !hears {
        return failed("X-Plane's replies do not arrive");
    }
    let Ok(mut fresh) = bench.link.another() else {
        return failed("no further socket can be opened");
    };
    let asked = Instant::now();
    while fresh.latest().is_none() && asked.elapsed() < ANSWERS_WITHIN {
        fresh.poll(Duration::from_millis(50));
        bench.wait("replies reach a new socket", Duration::from_millis(10))?;
    }
    bench.measure(
        "until the first reply to a new socket",
        if fresh.latest().is_some() {
            asked.elapsed().as_secs_f64()
        } else {
            f64::NAN
        },
        "s",
        Limit::AtMost(2.0),
    );
    Ok(())
}
