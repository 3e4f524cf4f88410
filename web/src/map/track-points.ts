/** Where an aircraft was, thinned out while it flies straight. */

/** An hour at 2 places a second; of more, the oldest are left out, several at once. */
const CAPACITY = 7200;
const LEFT_OUT = 400;
/** Closer ones are not kept, m; nor those so close to a straight line, m. */
const CLOSEST_M = 4;
const OFF_LINE_M = 1;
/** A straight line has a point at least so often, m. */
const LONGEST_M = 240;
const M_PER_DEG = 111_195;

type Degrees = [latitude: number, longitude: number];

export class TrackPoints {
  readonly places: Degrees[] = [];
  /** Grows with each change. */
  changes = 0;

  clear(): void {
    this.places.length = 0;
    this.changes += 1;
  }

  /** Says whether it is kept. */
  add(latitude_deg: number, longitude_deg: number): boolean {
    const { places } = this;
    const east = Math.max(0.05, Math.cos((latitude_deg * Math.PI) / 180)) * M_PER_DEG;
    const from = (one: Degrees): [number, number] => [(longitude_deg - one[1]) * east, (latitude_deg - one[0]) * M_PER_DEG];
    const last = places.at(-1);
    const before = places.at(-2);
    if (last && Math.hypot(...from(last)) < CLOSEST_M) return false;
    this.changes += 1;
    if (last && before) {
      const [dx, dy] = from(before);
      const length = Math.hypot(dx, dy);
      const [lx, ly] = [(last[1] - before[1]) * east, (last[0] - before[0]) * M_PER_DEG];
      if (length < LONGEST_M && Math.abs(dx * ly - dy * lx) / length < OFF_LINE_M) {
        places[places.length - 1] = [latitude_deg, longitude_deg];
        return true;
      }
    }
    places.push([latitude_deg, longitude_deg]);
    if (places.length > CAPACITY) places.splice(0, LEFT_OUT);
    return true;
  }
}
