/** Where an aircraft was: a ring of places, thinned out while it flies straight. */

import { worldX, worldY } from "./mercator";

/** An hour at 2 places a second. */
export const CAPACITY = 7200;
/** Closer ones are not kept, m; nor those within this distance of a straight line. */
const CLOSEST_M = 4;
/** World pixels of a metre at the equator at zoom 0. */
const PX_PER_M = 256 / 40_075_017;

export class TrackPoints {
  readonly x = new Float64Array(CAPACITY);
  readonly y = new Float64Array(CAPACITY);
  count = 0;

  clear(): void {
    this.count = 0;
  }

  /** Says whether it is kept. */
  add(latitude_deg: number, longitude_deg: number): boolean {
    const x = worldX(longitude_deg);
    const y = worldY(latitude_deg);
    const last = (this.count - 1 + CAPACITY) % CAPACITY;
    const before = (this.count - 2 + CAPACITY) % CAPACITY;
    const close = (CLOSEST_M * PX_PER_M) / Math.max(0.05, Math.cos((latitude_deg * Math.PI) / 180));
    const from = (at: number) => Math.hypot(x - (this.x[at] ?? 0), y - (this.y[at] ?? 0));
    if (this.count > 0 && from(last) < close) return false;
    if (this.count > 2 && this.#onLine(before, last, x, y) < close / 4 && from(before) < close * 60) {
      this.x[last] = x;
      this.y[last] = y;
    } else {
      this.x[this.count % CAPACITY] = x;
      this.y[this.count % CAPACITY] = y;
      this.count += 1;
    }
    return true;
  }

  /** Distance of the last place from the line past it. */
  #onLine(before: number, last: number, x: number, y: number): number {
    const dx = x - (this.x[before] ?? 0);
    const dy = y - (this.y[before] ?? 0);
    const px = (this.x[last] ?? 0) - (this.x[before] ?? 0);
    const py = (this.y[last] ?? 0) - (this.y[before] ?? 0);
    return Math.abs(dx * py - dy * px) / (Math.hypot(dx, dy) || 1);
  }
}
