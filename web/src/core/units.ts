/** SI to what is shown, and back. Each number on the page has its unit beside it. */

import { kept } from "./state";

export type UnitSystem = "metric" | "aviation";
export const unitSystem = kept<UnitSystem>("fcc.units", ["metric", "aviation"], "metric");

export type Quantity = "altitude" | "speed" | "climb" | "distance" | "wind" | "angle" | "heading" | "length";

interface Unit {
  unit: string;
  /** Shown value of one SI unit. */
  factor: number;
  digits: number;
}

/** 1 kt = 1,852 m/h, 1 ft = 0.3048 m, 1 NM = 1,852 m: exact by definition. */
const KNOT = 3600 / 1852;
const FOOT = 1 / 0.3048;
export const DEGREES = 180 / Math.PI;

const ANGLE: Unit = { unit: "°", factor: DEGREES, digits: 1 };
const HEADING: Unit = { unit: "°", factor: DEGREES, digits: 0 };

const UNITS: Record<UnitSystem, Record<Quantity, Unit>> = {
  metric: {
    altitude: { unit: "m", factor: 1, digits: 0 },
    speed: { unit: "m/s", factor: 1, digits: 1 },
    climb: { unit: "m/s", factor: 1, digits: 1 },
    distance: { unit: "km", factor: 1e-3, digits: 2 },
    wind: { unit: "m/s", factor: 1, digits: 1 },
    length: { unit: "m", factor: 1, digits: 0 },
    angle: ANGLE,
    heading: HEADING,
  },
  aviation: {
    altitude: { unit: "ft", factor: FOOT, digits: 0 },
    speed: { unit: "kt", factor: KNOT, digits: 1 },
    climb: { unit: "ft/min", factor: FOOT * 60, digits: 0 },
    distance: { unit: "NM", factor: 1 / 1852, digits: 2 },
    wind: { unit: "kt", factor: KNOT, digits: 0 },
    length: { unit: "m", factor: 1, digits: 0 },
    angle: ANGLE,
    heading: HEADING,
  },
};

export const unitOf = (quantity: Quantity): string => UNITS[unitSystem.get()][quantity].unit;
export const toShown = (quantity: Quantity, si: number): number =>
  si * UNITS[unitSystem.get()][quantity].factor;
export const toSi = (quantity: Quantity, shown: number): number =>
  shown / UNITS[unitSystem.get()][quantity].factor;
export const digitsOf = (quantity: Quantity): number => UNITS[unitSystem.get()][quantity].digits;

const MISSING = "–";

export function fixed(value: number, digits: number): string {
  if (!Number.isFinite(value)) return MISSING;
  const text = value.toFixed(digits);
  // Minus zero is shown as zero, and minus as the sign of that width.
  return Number(text) === 0 ? text.replace("-", "") : text.replace("-", "\u2212");
}

export function shown(quantity: Quantity, si: number): string {
  if (quantity === "heading") {
    if (!Number.isFinite(si)) return MISSING;
    const degrees = ((Math.round(si * DEGREES) % 360) + 360) % 360;
    return String(degrees === 0 ? 360 : degrees).padStart(3, "0");
  }
  return fixed(toShown(quantity, si), digitsOf(quantity));
}

/** With its unit. */
export function withUnit(quantity: Quantity, si: number): string {
  const unit = unitOf(quantity);
  return `${shown(quantity, si)}${unit === "°" ? "" : "\u202f"}${unit}`;
}

const WRITTEN = /(\u2212|-)?(\d[\d.]*)(?: to (-?\d[\d.]*))? (ft\/min|ft|kt|NM|m\/s|km)(?![\w/²])/g;

/** A text of the daemon with its speeds and altitudes in the chosen units. */
export function inUnits(text: string): string {
  const other = UNITS[unitSystem.get() === "metric" ? "aviation" : "metric"];
  return text.replace(WRITTEN, (all: string, minus: string | undefined, from: string, to: string | undefined, unit: string) => {
    const quantity = (Object.keys(other) as Quantity[]).find((one) => other[one].unit === unit);
    if (!quantity) return all;
    const converted = (number: string) => shown(quantity, Number(number) / other[quantity].factor);
    return `${converted((minus ? "-" : "") + from)}${to ? ` to ${converted(to)}` : ""}\u202f${unitOf(quantity)}`;
  });
}

export function duration(seconds: number): string {
  if (!Number.isFinite(seconds)) return MISSING;
  const whole = Math.max(0, Math.round(seconds));
  const part = (value: number) => String(value).padStart(2, "0");
  const hours = Math.floor(whole / 3600);
  const rest = `${part(Math.floor(whole / 60) % 60)}:${part(whole % 60)}`;
  return hours > 0 ? `${hours}:${rest}` : rest;
}

/** A time of the loop. */
export function microseconds(us: number, digits: number): string {
  return us >= 1000 ? `${fixed(us / 1000, 2)}\u202fms` : `${fixed(us, digits)}\u202fµs`;
}

export function bytes(count: number): string {
  if (!Number.isFinite(count)) return MISSING;
  const units = ["B", "kB", "MB", "GB", "TB"];
  let step = 0;
  while (count >= 1000 && step < units.length - 1) {
    count /= 1000;
    step += 1;
  }
  return `${fixed(count, step > 0 && count < 100 ? 1 : 0)}\u202f${units[step] ?? ""}`;
}

export function utc(seconds: number): string {
  if (!Number.isFinite(seconds) || seconds <= 0) return MISSING;
  return `${new Date(seconds * 1000).toISOString().slice(0, 19).replace("T", " ")} UTC`;
}
