/** What the instruments show, from a live record or a row of a recording, with its ages. */

/** Grey after this, crossed out after `LOST_S`. */
export const STALE_S = 1;
export const LOST_S = 3;

export type Freshness = "fresh" | "stale" | "lost";

export function freshness(age_s: number): Freshness {
  return age_s >= LOST_S ? "lost" : age_s >= STALE_S ? "stale" : "fresh";
}

/** A mode, with the item where a plan is flown. */
export const modeText = (mode: string, item: number): string => `${mode.replace("takeoff", "take-off")}${item > 0 && ["plan", "takeoff", "land"].includes(mode) ? `, item ${item}` : ""}`;

/** A row of columns by name; NaN without such a column. */
export interface Row {
  number(name: string): number;
}

export interface FlightState {
  pitch_rad: number;
  roll_rad: number;
  heading_rad: number;
  airspeed_mps: number;
  altitude_m: number;
  climb_mps: number;
  side_force_mps2: number;
  load_factor: number;
  latitude_deg: number;
  longitude_deg: number;
  north_mps: number;
  east_mps: number;
  ground_speed_mps: number;
  /** True course over the ground. */
  course_rad: number;
  /** Where the wind blows from, true. */
  wind_from_rad: number;
  wind_mps: number;
  position_known: boolean;
  /** Set points; NaN while nothing is held. */
  set: { airspeed_mps: number; heading_rad: number; altitude_m: number; climb_mps: number; roll_rad: number; pitch_rad: number };
  engaged: boolean;
  ages: { attitude: number; heading: number; airspeed: number; altitude: number; position: number };
}

const DEGREES = 180 / Math.PI;
const NOT_SET = { airspeed_mps: NaN, heading_rad: NaN, altitude_m: NaN, climb_mps: NaN, roll_rad: NaN, pitch_rad: NaN };

/** Age of a reading in its record, s; 0 where it is not measured but estimated alone. */
function ageIn(row: Row, reading: string): number {
  const age = (row.number("woke_ns") - row.number(`${reading}_taken_ns`)) / 1e9;
  return Number.isFinite(age) ? Math.max(0, age) : 0;
}

/** Of the newest measured position, by whichever source. */
function positionAge(row: Row): number {
  const taken = Math.max(...["position", "gnss"].map((one) => row.number(`${one}_taken_ns`)).filter(Number.isFinite), -Infinity);
  return Number.isFinite(taken) ? Math.max(0, (row.number("woke_ns") - taken) / 1e9) : 0;
}

export function flightState(row: Row, link_age_s: number): FlightState {
  const engaged = row.number("state") === 1;
  const latitude = row.number("estimated_latitude_rad");
  const longitude = row.number("estimated_longitude_rad");
  // Before the navigation knows it, the estimate is 0, 0: then where it was measured.
  const estimated = latitude !== 0 || longitude !== 0;
  const measured = (name: string) => [row.number(`gnss_${name}`), row.number(name)].find((one) => Number.isFinite(one) && one !== 0) ?? NaN;
  const lat = estimated ? latitude : measured("latitude_rad");
  const lon = estimated ? longitude : measured("longitude_rad");
  const north = row.number("estimated_north_mps");
  const east = row.number("estimated_east_mps");
  const wind_north = row.number("estimated_wind_north_mps");
  const wind_east = row.number("estimated_wind_east_mps");
  const age = (reading: string) => link_age_s + ageIn(row, reading);
  return {
    pitch_rad: row.number("estimated_pitch_rad"),
    roll_rad: row.number("estimated_roll_rad"),
    heading_rad: row.number("estimated_heading_rad"),
    airspeed_mps: row.number("estimated_airspeed_mps"),
    altitude_m: row.number("estimated_altitude_m"),
    climb_mps: row.number("estimated_climb_rate_mps"),
    side_force_mps2: row.number("estimated_side_force_mps2"),
    load_factor: row.number("estimated_load_factor"),
    latitude_deg: lat * DEGREES,
    longitude_deg: lon * DEGREES,
    north_mps: north,
    east_mps: east,
    ground_speed_mps: Math.hypot(north, east),
    course_rad: Math.atan2(east, north),
    wind_from_rad: Math.atan2(-wind_east, -wind_north),
    wind_mps: Math.hypot(wind_north, wind_east),
    position_known: Number.isFinite(lat) && Number.isFinite(lon),
    set: engaged
      ? {
          airspeed_mps: row.number("desired_airspeed_mps"),
          heading_rad: row.number("desired_heading_rad"),
          altitude_m: row.number("desired_altitude_m"),
          climb_mps: row.number("desired_climb_rate_mps"),
          roll_rad: row.number("desired_roll_rad"),
          pitch_rad: row.number("desired_pitch_rad"),
        }
      : NOT_SET,
    engaged,
    ages: {
      attitude: age("attitude"),
      heading: age("heading"),
      airspeed: age("airspeed"),
      altitude: age("altitude"),
      position: link_age_s + Math.min(positionAge(row), 1e6),
    },
  };
}
