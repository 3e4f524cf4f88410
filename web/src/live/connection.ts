/** The live stream of one daemon: newest record only, reconnected with growing pauses. */

import { socketUrl, part, type FlightEvent } from "../core/api";
import { Layout, LiveRecord, type Column } from "./record";

export interface RunStatus {
  time_s?: number;
  ticks?: number;
  missed?: number;
  lateness_p50_us?: number | null; lateness_p99_us?: number | null; lateness_p99_9_us?: number | null; lateness_max_us?: number | null;
  lateness_counts?: number[] | null;
  recorder?: string | null; recording?: string | null; recorded?: number | null; not_recorded?: number | null; recording_bytes?: number | null;
  watchers?: number | null;
  load?: number[] | null; processors?: number | null; temperature_c?: number | null;
  memory_available_bytes?: number | null; disk_available_bytes?: number | null;
  station?: { clients?: number; cpu_percent?: number | null; memory_bytes?: number | null } | null;
}

export interface LiveListener {
  record?(record: LiveRecord): void;
  event?(event: FlightEvent): void;
  /** Where it was until now, in degrees. */
  track?(places: [number, number][]): void;
  status?(status: RunStatus): void;
  /** Connected, or why not. */
  link?(connected: boolean, reason: string): void;
  /** Another run begins, or the same is met again: its events come anew. */
  hello?(run_started_utc_s: number): void;
}

interface Message {
  hello?: { columns: Column[]; rate_hz: number; run_started_utc_s: number };
  track?: [number, number][];
  event?: FlightEvent;
  status?: RunStatus;
  end?: string;
}

const FIRST_PAUSE_MS = 250;
const LONGEST_PAUSE_MS = 5000;

/** Pauses between attempts: doubled each time, with a quarter of chance against bursts. */
export function pauseBefore(attempt: number, chance: number): number {
  const pause = Math.min(FIRST_PAUSE_MS * 2 ** attempt, LONGEST_PAUSE_MS);
  return pause * (0.75 + 0.25 * chance);
}

export class Connection {
  #socket: WebSocket | null = null;
  #layout: Layout | null = null;
  #attempt = 0;
  #timer: ReturnType<typeof setTimeout> | undefined;
  #closed = false;
  /** When the newest record arrived, on the clock of `performance.now()`. */
  arrived_ms = -Infinity;
  rate_hz = 0;
  newest: LiveRecord | null = null;
  status: RunStatus | null = null;
  connected = false;

  constructor(
    readonly instance: string,
    private readonly listener: LiveListener,
  ) {
    this.#open();
  }

  #open(): void {
    const socket = new WebSocket(socketUrl(`/live/${part(this.instance)}`));
    socket.binaryType = "arraybuffer";
    this.#socket = socket;
    socket.onmessage = (event) => {
      if (event.data instanceof ArrayBuffer) this.#record(event.data);
      else this.#text(String(event.data));
    };
    socket.onclose = () => this.#lost();
  }

  #record(buffer: ArrayBuffer): void {
    if (!this.#layout || buffer.byteLength !== this.#layout.bytes) return;
    this.newest = new LiveRecord(this.#layout, buffer);
    this.arrived_ms = performance.now();
    this.listener.record?.(this.newest);
  }

  #text(text: string): void {
    let message: Message;
    try {
      message = JSON.parse(text) as Message;
    } catch {
      return;
    }
    if (message.hello) {
      this.#layout = new Layout(message.hello.columns);
      this.rate_hz = message.hello.rate_hz;
      this.#attempt = 0;
      this.connected = true;
      this.listener.hello?.(message.hello.run_started_utc_s);
      this.listener.link?.(true, "");
    }
    if (message.track) this.listener.track?.(message.track);
    if (message.event) this.listener.event?.(message.event);
    if (message.status) {
      this.status = message.status;
      this.listener.status?.(message.status);
    }
    if (message.end) this.listener.link?.(false, message.end);
  }

  #lost(): void {
    if (this.#closed) return;
    if (this.connected || this.#attempt === 0) this.listener.link?.(false, "no connection to the station");
    this.connected = false;
    this.#timer = setTimeout(() => this.#open(), pauseBefore(this.#attempt, Math.random()));
    this.#attempt += 1;
  }

  close(): void {
    this.#closed = true;
    clearTimeout(this.#timer);
    this.#socket?.close();
  }
}
