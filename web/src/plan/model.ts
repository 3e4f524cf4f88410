/** A flight plan: the JSON of `fcc_plan::Plan`, and what the page changes in it. */

export interface Place {
  latitude_deg: number;
  longitude_deg: number;
}
export type Datum = "sea-level" | "home" | "terrain";
export interface Altitude {
  m: number;
  above: Datum;
}
export type Speed = { "airspeed-mps": number } | { "ground-speed-mps": number };
export type LoiterEnd = "never" | "altitude" | { turns: number } | { seconds: number };

export type Item =
  | { kind: "waypoint"; place: Place; altitude: Altitude; radius_m: number | null }
  | { kind: "loiter"; place: Place | null; altitude: Altitude; radius_m: number | null; clockwise: boolean; end: LoiterEnd; leave_towards_next: boolean }
  | { kind: "return" }
  | { kind: "land"; place: Place | null; altitude: Altitude; abort_altitude_m: number | null }
  | { kind: "takeoff"; place: Place | null; altitude: Altitude; pitch_deg: number | null }
  | { kind: "delay"; seconds: number }
  | { kind: "until-distance"; distance_m: number }
  | { kind: "change-altitude"; altitude: Altitude }
  | { kind: "change-speed"; speed: Speed | null; throttle_percent: number | null }
  | { kind: "jump"; to: number; times: number | null }
  | { kind: "land-start"; place: Place | null }
  | { kind: "camera"; command: number; frame: number; parameters: (number | null)[] };
export type Kind = Item["kind"];

export interface FencePolygon {
  corners: Place[];
  inclusion: boolean;
  group: number;
}
export interface FenceCircle {
  centre: Place;
  radius_m: number;
  inclusion: boolean;
  group: number;
}
export interface Plan {
  home: { place: Place; altitude_m: number } | null;
  cruise_mps: number | null;
  items: Item[];
  fence: { polygons: FencePolygon[]; circles: FenceCircle[]; floor_m: number | null; ceiling_m: number | null; return_point: [Place, number] | null };
  rally: { place: Place; altitude_m: number }[];
  obstacles: { centre: Place; radius_m: number; top_m: number }[];
}

export const KIND_NAMES: Record<Kind, string> = {
  takeoff: "Take-off",
  waypoint: "Waypoint",
  loiter: "Loiter",
  "change-speed": "Change speed",
  "change-altitude": "Change altitude",
  delay: "Delay",
  "until-distance": "Until distance",
  jump: "Jump",
  "land-start": "Landing start",
  land: "Land",
  return: "Return",
  camera: "Camera",
};

/** What a page can add; a camera's command is kept as it was read. */
export const ADDABLE: readonly Kind[] = (Object.keys(KIND_NAMES) as Kind[]).filter((kind) => kind !== "camera");

export const emptyPlan = (): Plan => ({
  home: null,
  cruise_mps: null,
  items: [],
  fence: { polygons: [], circles: [], floor_m: null, ceiling_m: null, return_point: null },
  rally: [],
  obstacles: [],
});

export const placeOf = (item: Item): Place | null => ("place" in item ? item.place : null);
export const altitudeOf = (item: Item): Altitude | null => "altitude" in item ? item.altitude : null;

const FIRST_ALTITUDE_M = 150;

function altitudeBefore(items: readonly Item[], at: number): Altitude {
  for (let index = at - 1; index >= 0; index -= 1) {
    const item = items[index];
    const altitude = item && item.kind !== "land" ? altitudeOf(item) : null;
    if (altitude) return { ...altitude };
  }
  return { m: FIRST_ALTITUDE_M, above: "home" };
}

/** A new item, at the altitude of those before it. */
export function newItem(kind: Kind, place: Place | null, before: readonly Item[]): Item {
  const altitude = altitudeBefore(before, before.length);
  const here = place ?? { latitude_deg: 0, longitude_deg: 0 };
  switch (kind) {
    case "waypoint":
      return { kind, place: here, altitude, radius_m: null };
    case "loiter":
      return { kind, place, altitude, radius_m: null, clockwise: true, end: { turns: 2 }, leave_towards_next: true };
    case "land":
      return { kind, place, altitude: { m: 0, above: "home" }, abort_altitude_m: null };
    case "takeoff":
      return { kind, place, altitude, pitch_deg: null };
    case "delay":
      return { kind, seconds: 10 };
    case "until-distance":
      return { kind, distance_m: 500 };
    case "change-altitude":
      return { kind, altitude };
    case "change-speed":
      return { kind, speed: { "airspeed-mps": 45 }, throttle_percent: null };
    case "jump":
      return { kind, to: 1, times: 1 };
    case "land-start":
      return { kind, place };
    case "return":
    case "camera":
      return { kind: "return" };
  }
}

/** The same item as another kind: its place and altitude stay. */
export function asKind(item: Item, kind: Kind, before: readonly Item[]): Item {
  const made = newItem(kind, placeOf(item) ?? null, before);
  const altitude = altitudeOf(item);
  if (altitude && "altitude" in made && kind !== "land" && item.kind !== "land") made.altitude = { ...altitude };
  return made;
}

/** Jumps lead to the same items after one was inserted or removed at `at` (from 0). */
function renumbered(items: Item[], change: (number: number) => number): Item[] {
  return items.map((item) => (item.kind === "jump" ? { ...item, to: Math.max(1, change(item.to)) } : item));
}

export function inserted(items: readonly Item[], at: number, item: Item): Item[] {
  const moved = renumbered([...items], (number) => (number > at ? number + 1 : number));
  moved.splice(at, 0, item);
  return moved;
}

export function removed(items: readonly Item[], at: number): Item[] {
  const rest = items.filter((_, index) => index !== at);
  return renumbered(rest, (number) => (number > at + 1 ? number - 1 : number));
}

export function swapped(items: readonly Item[], at: number, to: number): Item[] {
  const one = items[at];
  const other = items[to];
  if (!one || !other) return [...items];
  const next = [...items];
  next[at] = other;
  next[to] = one;
  return renumbered(next, (number) => (number === at + 1 ? to + 1 : number === to + 1 ? at + 1 : number));
}

/** Content alone decides, not the order of the keys. */
export function same(a: unknown, b: unknown): boolean {
  if (Object.is(a, b)) return true;
  if (typeof a !== "object" || typeof b !== "object" || a === null || b === null) return false;
  const keys = Object.keys(a);
  return keys.length === Object.keys(b).length && keys.every((key) => same((a as Record<string, unknown>)[key], (b as Record<string, unknown>)[key]));
}
