/** What all views share: the chosen daemon, its connection, its events, the link. */

import { getJson, message, noteClock, writable, type Daemon, type FlightEvent, type Status } from "../core/api";
import { watched } from "../core/state";
import { Connection, type RunStatus } from "./connection";
import { TrackPoints } from "../map/track-points";
import { flightState } from "./flight-state";
import type { LiveRecord } from "./record";

const STATUS_EVERY_MS = 3000;
const EVENTS_KEPT = 500;

export const daemons = watched<Daemon[]>([]);
export const daemon = watched<Daemon | null>(null);
/** Why there is no live data, or "" while there is. */
export const linkProblem = watched("connecting to the station");
export const run = watched<RunStatus | null>(null);
export const events: FlightEvent[] = [];
export const run_started_utc_s = watched(0);
/** Where the aircraft was in this run, whichever view is open. */
export const flown = new TrackPoints();

type RecordListener = (record: LiveRecord) => void;
/** An event, or null when the list begins anew. */
type EventListener = (event: FlightEvent | null) => void;
const record_listeners = new Set<RecordListener>();
const event_listeners = new Set<EventListener>();
let connection: Connection | null = null;

export const newest = (): LiveRecord | null => connection?.newest ?? null;
/** Since the newest record arrived, s. */
export const linkAge = (): number =>
  connection ? (performance.now() - connection.arrived_ms) / 1000 : Infinity;

export function onRecord(listener: RecordListener): () => void {
  record_listeners.add(listener);
  return () => record_listeners.delete(listener);
}

/** Also tells those that were. */
export function onEvent(listener: EventListener): () => void {
  events.forEach(listener);
  event_listeners.add(listener);
  return () => event_listeners.delete(listener);
}

function addEvent(event: FlightEvent): void {
  // After a reconnection the station repeats the last events.
  if (events.some((known) => known.tick === event.tick && known.code === event.code && known.text === event.text)) return;
  events.push(event);
  if (events.length > EVENTS_KEPT) events.shift();
  for (const listener of [...event_listeners]) listener(event);
}

function clearEvents(): void {
  events.length = 0;
  flown.clear();
  for (const listener of [...event_listeners]) listener(null);
}

export function choose(instance: string): void {
  const chosen = daemons.get().find((one) => one.instance === instance) ?? null;
  daemon.set(chosen);
  sessionStorage.setItem(CHOSEN, instance);
  if (connection?.instance === instance) return;
  connection?.close();
  connection = null;
  run.set(null);
  clearEvents();
  if (!chosen) return;
  connection = new Connection(instance, {
    record: (record) => {
      const { position_known, latitude_deg, longitude_deg } = flightState(record, 0);
      if (position_known) flown.add(latitude_deg, longitude_deg);
      for (const listener of record_listeners) listener(record);
    },
    event: addEvent,
    track: (places) => {
      flown.clear();
      for (const [latitude_deg, longitude_deg] of places) flown.add(latitude_deg, longitude_deg);
    },
    status: (status) => run.set(status),
    hello: (started) => {
      if (started !== run_started_utc_s.get() && run_started_utc_s.get() !== 0) {
        clearEvents();
        addEvent({ tick: 0, time_s: 0, code: 17, text: "The daemon was started again: how its last run ended is in Flights." });
      }
      run_started_utc_s.set(started);
    },
    link: (connected, reason) => linkProblem.set(connected ? "" : reason),
  });
}

const CHOSEN = "fcc.instance";

/** The one that was chosen in this tab; else one that the station starts; else the first. */
function preferred(found: Daemon[]): Daemon | undefined {
  const chosen = sessionStorage.getItem(CHOSEN);
  return found.find((one) => one.instance === chosen) ?? found.find((one) => one.plan_upload === "standby") ?? found[0];
}

async function refresh(): Promise<void> {
  try {
    const sent = performance.now();
    const status = await getJson<Status>("/status");
    noteClock(status.utc_ms ?? NaN, performance.now() - sent);
    writable.set(status.writable);
    daemons.set(status.daemons);
    const current = daemon.get();
    const again = current && status.daemons.find((one) => one.instance === current.instance);
    if (again) {
      if (JSON.stringify(again) !== JSON.stringify(current)) daemon.set(again);
    } else if (current) {
      // Another aircraft is shown only when it is chosen.
      if (!connection?.connected) linkProblem.set(`${current.instance} does not run`);
    } else {
      const first = preferred(status.daemons);
      if (first) choose(first.instance);
    }
    if (status.daemons.length === 0 && !current) linkProblem.set("no daemon runs: start one with fccd run or fccd fly");
  } catch (error) {
    if (!connection?.connected) linkProblem.set(message(error));
  }
}

export async function startSession(): Promise<void> {
  await refresh();
  setInterval(() => void refresh(), STATUS_EVERY_MS);
}
