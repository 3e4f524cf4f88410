// The plan that the mock begins with, and a check that measures distances alone.
import { createHash } from "node:crypto";

const home = { latitude_deg: 45, longitude_deg: 8 };
const at = (latitude_deg, longitude_deg) => ({ latitude_deg, longitude_deg });
const above = (m, datum = "home") => ({ m, above: datum });

export const CIRCUIT = {
  home: { place: home, altitude_m: 120 },
  cruise_mps: null,
  items: [
    { kind: "takeoff", place: at(45.02699498, 8), altitude: above(150), pitch_deg: 8 },
    { kind: "change-speed", speed: { "airspeed-mps": 46 }, throttle_percent: null },
    { kind: "waypoint", place: at(45.04499163, 8), altitude: above(250), radius_m: 100 },
    { kind: "waypoint", place: at(45.04499163, 7.96195155), altitude: above(300), radius_m: null },
    { kind: "waypoint", place: at(44.94601004, 7.96195155), altitude: above(300), radius_m: null },
    { kind: "change-speed", speed: { "airspeed-mps": 41 }, throttle_percent: null },
    { kind: "land-start", place: at(44.94601004, 7.98097577) },
    { kind: "waypoint", place: at(44.94601004, 8), altitude: above(250), radius_m: null },
    { kind: "land", place: at(45.0026995, 8), altitude: above(0), abort_altitude_m: 200 },
  ],
  fence: {
    polygons: [{ corners: [at(45.07, 7.92), at(45.07, 8.05), at(44.92, 8.05), at(44.92, 7.92)], inclusion: true, group: 0 }],
    circles: [{ centre: at(45.01, 7.978), radius_m: 500, inclusion: false, group: 0 }],
    floor_m: null, ceiling_m: 900, return_point: null,
  },
  rally: [{ place: at(45.02, 8.03), altitude_m: 150 }],
  obstacles: [{ centre: at(45.033, 7.975), radius_m: 60, top_m: 280 }],
};

/** Made of the content alone, whatever the order of its keys. */
export function hashOf(plan) {
  const sorted = (value) =>
    value && typeof value === "object" && !Array.isArray(value)
      ? Object.fromEntries(Object.keys(value).sort().map((key) => [key, sorted(value[key])]))
      : Array.isArray(value) ? value.map(sorted) : value;
  return createHash("sha256").update(JSON.stringify(sorted(plan))).digest("hex").slice(0, 16);
}

const RAD = Math.PI / 180;
function metres(a, b) {
  const north = (b.latitude_deg - a.latitude_deg) * RAD;
  const east = (b.longitude_deg - a.longitude_deg) * RAD * Math.cos(a.latitude_deg * RAD);
  return Math.hypot(north, east) * 6371008.8;
}

export const elevation = (latitude_deg, longitude_deg) =>
  110 + 70 * Math.sin(latitude_deg * 160) ** 2 + 90 * Math.max(0, 7.99 - longitude_deg) * 20 * (0.6 + 0.4 * Math.sin(latitude_deg * 300 + longitude_deg * 200));

export function check(plan) {
  const problems = [];
  const items = [];
  const path = [];
  const terrain = [];
  let last = plan.home?.place ?? null;
  let distance_m = 0;
  plan.items.forEach((item, index) => {
    const base = item.altitude?.above === "sea-level" ? 0 : (plan.home?.altitude_m ?? 0);
    const altitude_m = item.altitude ? item.altitude.m + base : null;
    if (item.place) {
      if (last) {
        const length = metres(last, item.place);
        for (let part = 0; part < 12; part += 1) {
          const at = part / 12;
          terrain.push([distance_m + length * at, elevation(last.latitude_deg + (item.place.latitude_deg - last.latitude_deg) * at, last.longitude_deg + (item.place.longitude_deg - last.longitude_deg) * at)]);
        }
        distance_m += length;
      }
      last = item.place;
      path.push([item.place.latitude_deg, item.place.longitude_deg, altitude_m ?? 0]);
    }
    items.push({ distance_m, altitude_m: altitude_m ?? path.at(-1)?.[2] ?? 0 });
    if (item.altitude && altitude_m > 1500)
      problems.push({ item: index + 1, field: "altitude", message: `altitude is ${altitude_m.toFixed(0)} m: choose at most 1500 m`, level: "error" });
    if (item.kind === "change-speed" && item.speed?.["airspeed-mps"] > 65)
      problems.push({ item: index + 1, field: "speed", message: "airspeed is above 65 m/s: choose 34 to 65 m/s", level: "error" });
  });
  if (plan.items.length > 0 && !plan.items.some((item) => item.kind === "land"))
    problems.push({ item: null, field: null, message: "the plan has no landing: the aircraft circles at its end", level: "remark" });
  return { problems, distance_m, duration_s: distance_m / 45, path, items, terrain, hash: hashOf(plan) };
}
