import { describe, expect, it } from "vitest";
import { pauseBefore } from "../src/live/connection";
import { freshness } from "../src/live/flight-state";
import { LiveRecord, Layout } from "../src/live/record";
import { worldX, worldY } from "../src/map/mercator";
import { TrackPoints } from "../src/map/track-points";
import { History } from "../src/plan/history";
import { emptyPlan, inserted, newItem, removed, same, swapped, type Item, type Plan } from "../src/plan/model";
import { duration, fixed, inUnits, microseconds, shown, toSi, unitSystem, withUnit } from "../src/core/units";
import { decimate } from "../src/views/flights/decimate";

const at = { latitude_deg: 47, longitude_deg: 8 };
const waypoint = (): Item => newItem("waypoint", at, []);

describe("records", () => {
  const layout = new Layout([
    { name: "pitch", kind: "f64" },
    { name: "taken", kind: "i64" },
    { name: "mode", kind: "enum", names: ["none", "hold"] },
    { name: "faults", kind: "flags", names: ["first", "second", "third"] },
  ]);

  it("reads words by their description", () => {
    // Written by hand: 0.5 as IEEE 754, -2, 1 and the bits 0 and 2, each little-endian.
    const words = [
      [0, 0, 0, 0, 0, 0, 0xe0, 0x3f],
      [0xfe, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff],
      [1, 0, 0, 0, 0, 0, 0, 0],
      [5, 0, 0, 0, 0, 0, 0, 0],
    ];
    const record = new LiveRecord(layout, new Uint8Array(words.flat()).buffer);
    expect(record.number("pitch")).toBe(0.5);
    expect(record.number("taken")).toBe(-2);
    expect(record.named("mode")).toBe("hold");
    expect(record.flags("faults")).toEqual(["first", "third"]);
    expect(record.number("no such column")).toBeNaN();
  });

  it("takes the smallest i64 for never", () => {
    const buffer = new ArrayBuffer(32);
    new DataView(buffer).setUint8(15, 0x80);
    expect(new LiveRecord(layout, buffer).number("taken")).toBeNaN();
  });

  it("refuses a record of another length", () => {
    expect(() => new LiveRecord(layout, new ArrayBuffer(24))).toThrow(RangeError);
  });
});

describe("ages", () => {
  it("are grey after 1 s and crossed out after 3 s", () => {
    expect([0.99, 1, 2.99, 3].map(freshness)).toEqual(["fresh", "stale", "stale", "lost"]);
  });
});

describe("reconnecting", () => {
  it("waits longer each time, at most 5 s", () => {
    expect(pauseBefore(0, 1)).toBe(250);
    expect(pauseBefore(3, 1)).toBe(2000);
    expect(pauseBefore(30, 1)).toBe(5000);
  });
});

describe("units", () => {
  it("are those of the tables of the ICAO", () => {
    unitSystem.set("aviation");
    expect(withUnit("altitude", 304.8)).toBe("1000\u202fft");
    expect(withUnit("speed", 51.444)).toBe("100.0\u202fkt");
    expect(withUnit("distance", 1852)).toBe("1.00\u202fNM");
    expect(withUnit("climb", 5.08)).toBe("1000\u202fft/min");
    expect(toSi("altitude", 1000)).toBeCloseTo(304.8, 9);
    unitSystem.set("metric");
    expect(withUnit("speed", 51.444)).toBe("51.4\u202fm/s");
  });

  it("of the daemon's texts are converted, number and unit together", () => {
    unitSystem.set("metric");
    // 3,000 ft are 914.4 m, 60 kt 30.87 m/s, 70 kt 36.01 m/s, 1,640 ft 499.9 m: by the definitions.
    expect(inUnits("go to 47.123456°, -8.100000°, 3000 ft")).toBe("go to 47.123456°, -8.100000°, 914\u202fm");
    expect(inUnits("airspeed is 300 kt: choose 60 to 70 kt")).toBe("airspeed is 154.3\u202fm/s: choose 30.9 to 36.0\u202fm/s");
    expect(inUnits("choose -1640 to 3000 ft")).toBe("choose \u2212500 to 914\u202fm");
    expect(inUnits("item 3 of the plan is reached, 15 m off its altitude")).toBe("item 3 of the plan is reached, 15 m off its altitude");
    unitSystem.set("aviation");
    expect(inUnits("15 kt of tail wind")).toBe("15 kt of tail wind");
    expect(inUnits("airspeed 30.87 m/s, 2 m/s², 5 ftp")).toBe("airspeed 60.0\u202fkt, 2 m/s², 5 ftp");
    unitSystem.set("metric");
  });

  it("show north as 360 and a heading in three digits", () => {
    expect(shown("heading", 0)).toBe("360");
    expect(shown("heading", -0.001)).toBe("360");
    expect(shown("heading", Math.PI / 2)).toBe("090");
  });

  it("of the loop are microseconds, from 1 ms on milliseconds", () => {
    expect(microseconds(0.02, 2)).toBe("0.02\u202fµs");
    expect(microseconds(999, 0)).toBe("999\u202fµs");
    expect(microseconds(1000, 0)).toBe("1.00\u202fms");
    expect(microseconds(20_000, 1)).toBe("20.00\u202fms");
    expect(microseconds(NaN, 1)).toBe("–\u202fµs");
  });

  it("show no minus before zero, and no number for what is missing", () => {
    expect(fixed(-0.04, 1)).toBe("0.0");
    expect(fixed(NaN, 1)).toBe("–");
    expect(duration(3671)).toBe("1:01:11");
  });
});

describe("a plan's edits", () => {
  const plan = (items: Item[]): Plan => ({ ...emptyPlan(), items });

  it("are undone and redone one by one", () => {
    const history = new History(plan([]));
    const one = plan([waypoint()]);
    const two = plan([waypoint(), waypoint()]);
    history.edit(one, "add 1");
    history.edit(two, "add 2");
    expect(history.undo()).toBe("add 2");
    expect(history.current.items).toHaveLength(1);
    expect(history.undo()).toBe("add 1");
    expect(history.current.items).toHaveLength(0);
    expect(history.undo()).toBeNull();
    history.redo();
    history.redo();
    expect(history.current).toEqual(two);
    expect(history.redo()).toBeNull();
  });

  it("are none when nothing changed, and an edit ends what could be redone", () => {
    const history = new History(plan([waypoint()]));
    expect(history.edit(plan([waypoint()]), "nothing")).toBe(false);
    history.edit(plan([]), "delete");
    history.undo();
    history.edit(plan([waypoint(), waypoint()]), "add");
    expect(history.redoes).toBeNull();
  });

  it("keep jumps at their item", () => {
    const jump: Item = { kind: "jump", to: 2, times: 1 };
    const items = [waypoint(), newItem("loiter", at, []), jump];
    const target = (list: Item[]) => list[((list.find((one) => one.kind === "jump") as { to: number }).to) - 1]?.kind;
    expect(target(items)).toBe("loiter");
    expect(target(inserted(items, 0, waypoint()))).toBe("loiter");
    expect(target(removed(items, 0))).toBe("loiter");
    expect(target(swapped(items, 0, 1))).toBe("loiter");
  });

  it("are compared by content, not by the order of keys", () => {
    expect(same({ a: 1, b: [1, { c: null }] }, { b: [1, { c: null }], a: 1 })).toBe(true);
    expect(same({ a: 1 }, { a: 1, b: undefined })).toBe(false);
  });

  it("take the altitude of what is before", () => {
    const high = newItem("waypoint", at, []);
    if (high.kind === "waypoint") high.altitude = { m: 900, above: "sea-level" };
    expect(newItem("waypoint", at, [high])).toMatchObject({ altitude: { m: 900, above: "sea-level" } });
  });
});

describe("thinning out", () => {
  it("keeps each extreme", () => {
    const time = Float64Array.from({ length: 100_000 }, (_, n) => n * 0.025);
    const values = Float64Array.from(time, (t) => Math.sin(t));
    values[77_777] = 1000;
    values[33_333] = -1000;
    const [times, series = []] = decimate(time, [values], 0, Infinity, 400);
    expect(times).toHaveLength(800);
    expect(Math.max(...series)).toBe(1000);
    expect(Math.min(...series)).toBe(-1000);
    expect(times.every((one, n) => n === 0 || one >= (times[n - 1] ?? 0))).toBe(true);
  });

  it("shows all of a short range", () => {
    const time = [0, 1, 2, 3, 4, 5];
    expect(decimate(time, [time], 1, 4, 400)).toEqual([[1, 2, 3], [1, 2, 3]]);
  });
});

describe("the map", () => {
  it("has the corners of Web Mercator", () => {
    expect(worldX(-180)).toBe(0);
    expect(worldX(180)).toBe(256);
    expect(worldY(0)).toBeCloseTo(128, 9);
    // EPSG:3857: latitude 85.0511° is the upper edge; 66.51326° is a quarter of the height.
    expect(worldY(85.0511)).toBeCloseTo(0, 3);
    expect(worldY(66.51326)).toBeCloseTo(64, 4);
  });

  it("keeps a straight track in few points, and the newest", () => {
    const points = new TrackPoints();
    for (let n = 0; n <= 1000; n += 1) points.add(47, 8 + n * 0.0001);
    // 0.1° of longitude at 47° are 7,583 m: a point each 240 m, with one more at the ends.
    expect(points.places.length).toBeGreaterThan(30);
    expect(points.places.length).toBeLessThan(36);
    expect(points.places.at(-1)).toEqual([47, 8 + 1000 * 0.0001]);
  });
});
