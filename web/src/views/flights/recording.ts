/** A recording in the page: columns by name, and a row at any time. */

import { getJson, part, request, type Daemon, type FlightEvent, type VehiclePlan } from "../../core/api";
import type { Row } from "../../live/flight-state";
import type { Column } from "../../live/record";

/** What the instruments, the map and the plots of a replay need. */
export const REPLAY_COLUMNS = [
  "estimated_roll_rad", "estimated_pitch_rad", "estimated_heading_rad", "estimated_airspeed_mps", "estimated_altitude_m", "estimated_climb_rate_mps",
  "estimated_side_force_mps2", "estimated_load_factor", "estimated_latitude_rad", "estimated_longitude_rad", "estimated_north_mps", "estimated_east_mps",
  "estimated_wind_north_mps", "estimated_wind_east_mps", "estimated_position_uncertainty_m", "latitude_rad", "longitude_rad",
  "desired_airspeed_mps", "desired_heading_rad", "desired_altitude_m", "desired_roll_rad", "desired_climb_rate_mps", "desired_pitch_rad",
  "desired_guidance_mode", "desired_guidance_item", "desired_cross_track_m", "desired_to_go_m", "desired_contingency", "state", "total_time_ns", "battery_charge",
] as const;

/** Enough for 10 rows a second of an hour. */
const POINTS = 36_000;

interface Header {
  columns: (Column | string)[];
  rows: number;
  start_utc_s: number;
}

/** A part of the flight in which a column keeps its value. */
export interface Run {
  value: number;
  name: string;
  from_s: number;
  to_s: number;
}

export class Recording {
  readonly #columns = new Map<string, Float64Array>();
  readonly #described = new Map<string, Column>();
  readonly time: Float64Array;
  readonly start_utc_s: number;
  events: FlightEvent[] = [];
  plan: VehiclePlan | null = null;
  /** The limits that it was flown with. */
  aircraft: Daemon["aircraft"] = null;

  constructor(
    readonly file: string,
    buffer: ArrayBuffer,
  ) {
    const length = new DataView(buffer).getUint32(0, true);
    const header = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length))) as Header;
    const begin = Math.ceil((4 + length) / 8) * 8;
    header.columns.forEach((column, index) => {
      const described: Column = typeof column === "string" ? { name: column, kind: "f64" } : column;
      this.#described.set(described.name, described);
      this.#columns.set(described.name, new Float64Array(buffer, begin + index * header.rows * 8, header.rows));
    });
    this.start_utc_s = header.start_utc_s;
    this.time = this.column("time_s");
  }

  static async open(file: string): Promise<Recording> {
    const path = `/flights/${part(file)}`;
    const [data, events, plan, aircraft] = await Promise.all([
      request("GET", `${path}/data?columns=${REPLAY_COLUMNS.join(",")}&points=${POINTS}`).then((answer) => answer.arrayBuffer()),
      getJson<FlightEvent[]>(`${path}/events`),
      getJson<VehiclePlan | null>(`${path}/plan`).catch(() => null),
      getJson<Daemon["aircraft"]>(`${path}/aircraft`).catch(() => null),
    ]);
    return Object.assign(new Recording(file, data), { events, plan, aircraft });
  }

  column(name: string): Float64Array {
    return this.#columns.get(name) ?? new Float64Array(0);
  }

  get begin_s(): number { return this.time[0] ?? 0; }
  get end_s(): number { return this.time.at(-1) ?? 0; }

  /** The last row at or before a time. */
  index(time_s: number): number {
    let low = 0;
    let high = this.time.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if ((this.time[middle] ?? 0) <= time_s) low = middle;
      else high = middle - 1;
    }
    return low;
  }

  /** Values between two rows are interpolated, angles the short way round. */
  row(time_s: number): Row {
    const at = this.index(time_s);
    const t0 = this.time[at] ?? 0;
    const t1 = this.time[at + 1] ?? t0;
    const part = t1 > t0 ? Math.min(1, Math.max(0, (time_s - t0) / (t1 - t0))) : 0;
    return {
      number: (name) => {
        const values = this.#columns.get(name);
        const a = values?.[at] ?? NaN;
        const b = values?.[at + 1] ?? a;
        if (this.#described.get(name)?.kind !== "f64" || !Number.isFinite(b)) return a;
        const step = name.endsWith("heading_rad") ? Math.atan2(Math.sin(b - a), Math.cos(b - a)) : b - a;
        return a + step * part;
      },
    };
  }

  named(name: string, time_s: number): string {
    const value = this.#columns.get(name)?.[this.index(time_s)] ?? NaN;
    return this.#described.get(name)?.names?.[value] ?? (Number.isFinite(value) ? String(value) : "");
  }

  runs(name: string): Run[] {
    const values = this.column(name);
    const starts = [...values.keys()].filter((at) => values[at] !== values[at - 1]);
    const time = (at: number) => this.time[Math.min(at, values.length - 1)] ?? 0;
    return starts.map((at, n) => ({ value: values[at] ?? 0, name: this.#described.get(name)?.names?.[values[at] ?? 0] ?? "", from_s: time(at), to_s: time(starts[n + 1] ?? values.length) }));
  }

  /** When control was first taken; the begin without it. */
  engaged_s(): number {
    const at = this.column("state").findIndex((state) => state === 1);
    return this.time[Math.max(0, at)] ?? 0;
  }

  /** Places, in degrees, NaN where there is none. */
  place(index: number): [number, number] {
    const degrees = 180 / Math.PI;
    const lat = this.column("estimated_latitude_rad")[index] ?? NaN;
    const lon = this.column("estimated_longitude_rad")[index] ?? NaN;
    return lat === 0 && lon === 0 ? [NaN, NaN] : [lat * degrees, lon * degrees];
  }
}
