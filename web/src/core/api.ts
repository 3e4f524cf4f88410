/** The station's HTTP interface. What changes something carries the token. */

import type { Plan } from "../plan/model";
import { watched } from "./state";

export type SetPoint = { name: string; unit: string; lowest: number; highest: number };

export interface Daemon {
  instance: string;
  software: string;
  rate_hz: number;
  /** When a plan can be uploaded. */
  plan_upload?: "standby" | "flight" | null;
  setpoints: SetPoint[];
  aircraft?: { stall_mps?: number | null; min_mps?: number | null; max_mps?: number | null; never_exceed_mps?: number | null } | null;
}

export interface Status {
  utc_ms?: number;
  software: string;
  writable: boolean;
  /** Daemons whose configuration the station knows, running or not. */
  configured: string[];
  daemons: Daemon[];
}

export interface Draft {
  name: string;
  revision: number;
  hash: string;
  plan: Plan;
}

export interface DraftEntry {
  name: string;
  revision: number;
  items: number;
  hash: string;
}

export interface Problem {
  item: number | null;
  field: string | null;
  message: string;
  level: "error" | "remark";
}

export interface Check {
  problems: Problem[];
  distance_m: number | null;
  duration_s: number | null;
  path: [number, number, number][];
  items: ({ distance_m: number; altitude_m: number } | null)[];
  terrain: [number, number][] | null;
  hash: string;
}

export interface VehiclePlan {
  hash: string;
  uploaded_utc_s: number;
  /** Null: its content is not known to the station. */
  plan: Plan | null;
}

export interface Flight {
  file: string;
  instance: string;
  start_utc_s: number;
  duration_s: number;
  distance_m: number | null;
  whole: boolean;
  ending?: string;
  /** It is the daemon's present recording. */
  being_written?: boolean;
  faults: number | null;
  bytes: number;
  thumbnail?: [number, number][] | null;
}

export interface FlightEvent {
  tick: number;
  time_s: number;
  text: string;
  code: number;
}

export interface Difference {
  what: string;
  a: number | string | null;
  b: number | string | null;
  unit: string;
  sentence: string;
}

// As `fccd doctor --json` prints it.
export interface Finding {
  name: string;
  grade: string;
  found: string;
  why: string;
  /** Lines that mend it, and where each is written. */
  remedies: { place: string; line: string }[];
}

export class Refused extends Error {
  constructor(readonly status: number, message: string, readonly body: unknown) {
    super(message);
  }
}

const TOKEN = "fcc.token";
export const writable = watched(false);

/** Takes the token of a link `#token=...` out of the address, once. */
export function takeToken(): void {
  const found = /[#&]token=([^&]+)/.exec(location.hash);
  if (!found?.[1]) return;
  sessionStorage.setItem(TOKEN, decodeURIComponent(found[1]));
  history.replaceState(null, "", `${location.pathname}#/fly`);
}

/** The station's clock minus this machine's, ms: a deadline is in the station's time. */
let clock_offset_ms = 0;

/** The station says its time; it was on its way for at most so long. */
export function noteClock(utc_ms: number, round_trip_ms: number): void {
  if (Number.isFinite(utc_ms)) clock_offset_ms = utc_ms + round_trip_ms / 2 - Date.now();
}

export const stationNow = (): number => Date.now() + clock_offset_ms;

async function failure(response: Response): Promise<Refused> {
  let body: unknown = null;
  let message = `${response.status} ${response.statusText}`;
  try {
    body = await response.json();
    if (body !== null && typeof body === "object") {
      const said = body as { error?: unknown; refused?: unknown };
      if (typeof said.refused === "string") message = said.refused;
      else if (typeof said.error === "string") message = said.error;
    }
  } catch {
    // Not JSON: the status is all there is.
  }
  if (response.status === 401) writable.set(false);
  return new Refused(response.status, message, body);
}

export async function request(method: string, path: string, body?: unknown, signal?: AbortSignal): Promise<Response> {
  const headers: Record<string, string> = {};
  const token = sessionStorage.getItem(TOKEN);
  if (token) headers["authorization"] = `Bearer ${token}`;
  const init: RequestInit = { method, headers, cache: "no-store" };
  if (signal) init.signal = signal;
  if (body !== undefined) {
    headers["content-type"] = "application/json";
    init.body = JSON.stringify(body);
  }
  let response: Response;
  try {
    response = await fetch(`/api${path}`, init);
  } catch (error) {
    if (signal?.aborted) throw error;
    throw new Refused(0, "The station does not answer. Check that it runs and the network.", null);
  }
  if (!response.ok) throw await failure(response);
  return response;
}

export async function getJson<T>(path: string, signal?: AbortSignal): Promise<T> {
  return (await (await request("GET", path, undefined, signal)).json()) as T;
}

export async function postJson<T>(path: string, body: unknown, signal?: AbortSignal): Promise<T> {
  return (await (await request("POST", path, body, signal)).json()) as T;
}

export const part = encodeURIComponent;

/** How long a command is worth carrying out: it is refused when it arrives later. */
const DEADLINE_MS = 5000;
let last_number = 0;

/** Numbers grow and are never used twice, in any page of this browser. */
export function commandEnvelope(): { number: number; deadline_ms_utc: number } {
  last_number = Math.max(last_number + 1, Date.now() * 1000 + Math.floor(Math.random() * 1000));
  return { number: last_number, deadline_ms_utc: Math.round(stationNow()) + DEADLINE_MS };
}

export type Command =
  | "engage" | "disengage" | "pause" | "resume" | "return" | "land"
  | { set: Record<string, number> }
  | { go_to: { latitude_deg: number; longitude_deg: number; altitude_m: number } };

export async function sendCommand(instance: string, command: Command): Promise<number> {
  const answer = await postJson<{ carried_out: number }>(`/live/${part(instance)}/command`, { ...commandEnvelope(), command });
  return answer.carried_out;
}

export const message = (error: unknown): string => error instanceof Error ? error.message : String(error);

export function socketUrl(path: string): string {
  return `${location.protocol === "https:" ? "wss:" : "ws:"}//${location.host}/api${path}`;
}
