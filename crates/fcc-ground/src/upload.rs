//! The vehicle's plan: what it is, and another one in its place.
//!
//! In flight the daemon replaces it in one tick, or refuses. In standby it has no command
//! for that: the file that it reads when it starts is replaced, and it is started again by
//! whoever supervises it. Either way the plan counts as uploaded when the record of a tick
//! has its hash.

use std::path::{Path, PathBuf};
use std::sync::{Arc, PoisonError};
use std::time::{Duration, Instant};

use axum::extract::{self, State};
use axum::http::StatusCode;
use axum::{Extension, Json};
use fcc_flight::replay::recorded_plan;
use fcc_live::Command;
use fcc_plan::{Format, Plan};
use fcc_record::Recording;
use fcc_telemetry::Instance;
use serde::Deserialize;
use serde_json::{Value, json};

use crate::failure::{Failure, Sent, aside, reading};
use crate::files;
use crate::guard::Peer;
use crate::live::Feed;
use crate::orders::{Order, utc_ms};
use crate::plans::{checked, hash_text};
use crate::requests::commands::send;
use crate::station::{Station, instance_of};

const HASH: &str = "desired_plan_hash";
const UPLOADED: &str = "desired_plan_uploaded_unix_s";
const STATE: &str = "state";
const STANDBY: u64 = 0;
/// How long the record may take to show a plan that was accepted.
const SHOWN_WITHIN: Duration = Duration::from_secs(3);
/// How long a daemon may take to be there again.
const BACK_WITHIN: Duration = Duration::from_secs(25);
const LOOK_EVERY: Duration = Duration::from_millis(20);

/// `GET /api/live/{instance}/plan`.
pub(crate) async fn vehicle_plan(
    State(station): State<Arc<Station>>,
    extract::Path(instance): extract::Path<String>,
) -> Result<Json<Value>, Failure> {
    let instance = instance_of(&instance)?;
    reading(move || {
        let feed = station.feed(&instance)?;
        let Some(hash) = feed.word(HASH).filter(|hash| *hash != 0) else {
            return Ok(Json(Value::Null));
        };
        Ok(Json(json!({
            "hash": format!("{hash:016x}"),
            "uploaded_utc_s": feed.word(UPLOADED),
            "plan": content(&station, &instance, hash),
        })))
    })
    .await
}

/// The content of the plan with this hash, if it is known here.
pub(crate) fn content(station: &Station, instance: &Instance, hash: u64) -> Option<Plan> {
    let uploaded = Some(uploaded_file(station, hash));
    let of_start = station.configs.plan_file(instance).map(Path::to_owned);
    let candidates = uploaded.into_iter().chain(of_start);
    let config = station.configs.of(Some(instance));
    let known = candidates.filter_map(|file| fcc_plan::read_file(&file).ok());
    let mut flown = known.filter_map(|plan| {
        let has = |plan: &Plan| plan.hash().first_64_bits() == hash;
        if has(&plan) {
            return Some(plan);
        }
        config.checked_plan(&plan).ok().filter(has)
    });
    flown.next().or_else(|| recorded_now(station, hash))
}

/// The plan of the newest recording, if it is this one.
fn recorded_now(station: &Station, hash: u64) -> Option<Plan> {
    let newest = fcc_record::files(&station.recordings).ok()?.pop()?;
    let recording = Recording::open(newest).ok()?;
    let (_, plan) = recorded_plan(recording.about())?;
    (plan.hash().first_64_bits() == hash).then_some(plan)
}

fn uploaded_file(station: &Station, hash: u64) -> PathBuf {
    station
        .state
        .join("uploads")
        .join(format!("{hash:016x}.plan"))
}

/// The body of an upload.
#[derive(Debug, Deserialize)]
pub(crate) struct Uploaded {
    draft: String,
    revision: u64,
    item: Option<u16>,
    number: u64,
    deadline_ms_utc: u64,
}

/// `POST /api/live/{instance}/plan`.
pub(crate) async fn upload(
    State(station): State<Arc<Station>>,
    extract::Path(instance): extract::Path<String>,
    Extension(peer): Extension<Peer>,
    Sent(uploaded): Sent<Uploaded>,
) -> Result<Json<Value>, Failure> {
    let instance = instance_of(&instance)?;
    let order = Order {
        number: uploaded.number,
        deadline_ms_utc: uploaded.deadline_ms_utc,
    };
    station.orders.take(order, utc_ms())?;
    let plan = aside(move || {
        let turn = station.orders.turn.lock();
        let _turn = turn.unwrap_or_else(PoisonError::into_inner);
        station.orders.permit_page()?;
        let draft = station.drafts.get(&uploaded.draft)?;
        if draft.revision != uploaded.revision {
            return Err(Failure::refused(
                "the draft was changed meanwhile: look at its newest revision, and upload that",
            ));
        }
        let from = (order, peer.sender());
        let item = uploaded.item.unwrap_or(1);
        let upload = Upload::new(&station, instance, (&draft.plan, item), from)?;
        let feed = upload.carry_out()?;
        Ok(json!({
            "hash": format!("{:016x}", upload.hash),
            "draft_hash": hash_text(&draft.plan),
            "uploaded_utc_s": feed.word(UPLOADED),
        }))
    });
    Ok(Json(plan.await?))
}

/// A plan on its way to a daemon.
pub(crate) struct Upload<'a> {
    station: &'a Station,
    instance: Instance,
    order: Order,
    sender: String,
    item: u16,
    text: String,
    /// Of the plan as it is flown.
    pub(crate) hash: u64,
}

impl<'a> Upload<'a> {
    /// A plan, from an item on.
    pub(crate) fn new(
        station: &'a Station,
        instance: Instance,
        (plan, item): (&Plan, u16),
        (order, sender): (Order, String),
    ) -> Result<Self, Failure> {
        let config = station.configs.of(Some(&instance));
        let flown = checked(plan, config).map_err(|problems| {
            let first = problems
                .first()
                .map(ToString::to_string)
                .unwrap_or_default();
            let refused = format!("the plan has {} problems: {first}", problems.len());
            let body = json!({ "refused": refused, "problems": problems });
            Failure::with(StatusCode::CONFLICT, body)
        })?;
        let text = fcc_plan::write(plan, Format::QgcPlan);
        Ok(Self {
            station,
            instance,
            order,
            sender,
            item,
            text: text.map_err(|_| Failure::internal("the plan cannot be written"))?,
            hash: flown.hash().first_64_bits(),
        })
    }

    /// Brings it to the daemon, and waits until a record shows it.
    pub(crate) fn carry_out(&self) -> Result<Arc<Feed>, Failure> {
        let feed = self.station.feed(&self.instance)?;
        let file = uploaded_file(self.station, self.hash);
        if let Some(folder) = file.parent() {
            std::fs::create_dir_all(folder).map_err(|error| failed(folder, &error))?;
        }
        files::replace(&file, self.text.as_bytes()).map_err(|error| failed(&file, &error))?;
        let plan_file = self.station.configs.plan_file(&self.instance);
        match plan_file {
            Some(plan_file) if self.station.restarts && feed.word(STATE) == Some(STANDBY) => {
                self.start_with(plan_file, &feed)
            }
            _ => self.replace(&file, &feed),
        }
    }

    /// Replaces the plan of a daemon that flies.
    fn replace(&self, file: &Path, feed: &Arc<Feed>) -> Result<Arc<Feed>, Failure> {
        let file = std::path::absolute(file).map_err(|error| failed(file, &error))?;
        let command = Command::ReplacePlan {
            file: file.display().to_string(),
            item: self.item,
        };
        send(&self.instance, &command, self.order, &self.sender)?;
        let feed = Arc::clone(feed);
        self.shown(SHOWN_WITHIN, move || Some(Arc::clone(&feed)))
            .ok_or_else(|| {
                Failure::refused(
                    "the daemon has accepted the plan, and its record shows another one: look at \
                     the vehicle's plan",
                )
            })
    }

    /// Starts a daemon in standby again, with this plan.
    fn start_with(&self, plan_file: &Path, before: &Feed) -> Result<Arc<Feed>, Failure> {
        if self.item != 1 {
            return Err(Failure::refused(
                "in standby a plan is flown from its first item: give 1",
            ));
        }
        self.order.in_time(utc_ms())?;
        let old = std::fs::read(plan_file);
        files::replace(plan_file, self.text.as_bytes())
            .map_err(|error| failed(plan_file, &error))?;
        let restore = || match &old {
            Ok(old) => files::replace(plan_file, old),
            Err(_) => files::remove(plan_file),
        };
        // Engaged meanwhile: it keeps its plan.
        let is_in_standby = before.word(STATE) == Some(STANDBY);
        let stopped = if is_in_standby {
            send(&self.instance, &Command::Stop, self.order, &self.sender)
        } else {
            Err(Failure::refused("the aircraft was engaged meanwhile"))
        };
        if let Err(refused) = stopped {
            restore().map_err(|error| failed(plan_file, &error))?;
            return Err(refused);
        }
        let process_id = before.info.process_id;
        let again = self.shown(BACK_WITHIN, || {
            let feed = self.station.daemons.feed(&self.instance)?;
            (feed.info.process_id != process_id).then_some(feed)
        });
        again.ok_or_else(|| {
            let seconds = BACK_WITHIN.as_secs();
            let restored = match restore() {
                Ok(()) => "its file has the plan from before again".to_owned(),
                Err(error) => format!("{}: cannot be restored: {error}", plan_file.display()),
            };
            Failure::refused(format!(
                "the daemon was stopped, and is not back with this plan after {seconds} s; \
                 {restored}: look at what starts it again"
            ))
        })
    }

    /// Waits until the record of a tick shows the plan.
    fn shown(&self, within: Duration, feed: impl Fn() -> Option<Arc<Feed>>) -> Option<Arc<Feed>> {
        let deadline = Instant::now() + within;
        loop {
            if let Some(feed) = feed().filter(|feed| feed.word(HASH) == Some(self.hash)) {
                return Some(feed);
            }
            if Instant::now() > deadline {
                return None;
            }
            std::thread::sleep(LOOK_EVERY);
        }
    }
}

fn failed(path: &Path, error: &std::io::Error) -> Failure {
    Failure::internal(format!("{}: cannot be written: {error}", path.display()))
}
