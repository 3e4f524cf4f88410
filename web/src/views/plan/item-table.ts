/** The items of a plan as a table; each drag on the map has its fields here. */

import type { Problem } from "../../core/api";
import { button, h, icon, replace } from "../../core/dom";
import { keepingFocus, numberField, quantityField, selectField } from "../../core/fields";
import { ADDABLE, asKind, KIND_NAMES, type Datum, type Item, type Kind, type LoiterEnd } from "../../plan/model";
import { places } from "./zones";

export interface ItemActions {
  change(index: number, item: Item, what: string): void;
  remove(index: number): void;
  swap(index: number, to: number): void;
  select(index: number): void;
  readonly writable: boolean;
}

const FRAMES: readonly (readonly [Datum, string])[] = [
  ["home", "home"],
  ["sea-level", "sea level"],
  ["terrain", "terrain"],
];
const LONGEST_M = 100_000;

export class ItemTable {
  readonly element = h("div", { class: "scroll item-table", tabindex: 0, role: "region", "aria-label": "Items of the plan" });

  show(items: readonly Item[], problems: readonly Problem[], selected: number | null, active: number, actions: ItemActions): void {
    keepingFocus(this.element, () => {
      const rows = items.flatMap((item, index) => [
        this.#row(item, index, items, selected === index, active === index + 1, actions),
        ...problems.filter((one) => one.item === index + 1).map((one) => problemRow(one)),
      ]);
      const head = h("tr", {}, ...["", "Action", "Altitude", "above", "Latitude °", "Longitude °", "Details"].map((text) => h("th", { scope: "col" }, text || h("span", { class: "visually-hidden" }, "Number"))), h("th", { scope: "col" }, h("span", { class: "visually-hidden" }, "Order")));
      replace(
        this.element,
        items.length > 0
          ? h("table", { class: "items" }, h("thead", {}, head), h("tbody", {}, ...rows))
          : h("p", { class: "note empty" }, "This plan has no items. Choose an action above the map and tap the map, or use “Add at centre”."),
      );
    });
  }

  #row(item: Item, index: number, items: readonly Item[], selected: boolean, active: boolean, actions: ItemActions): HTMLElement {
    const number = index + 1;
    const key = (name: string) => `item-${index}-${name}`;
    const off = !actions.writable;
    const change = (changed: Item, what: string) => actions.change(index, changed, `${what} of item ${number}`);
    const kinds = ADDABLE.includes(item.kind) ? ADDABLE : [...ADDABLE, item.kind];
    const kind = selectField<Kind>(key("kind"), `Action of item ${number}`, item.kind, kinds.map((one) => [one, KIND_NAMES[one]] as const), (now) => change(asKind(item, now, items.slice(0, index)), "action"), off);
    const classes = [selected ? "selected" : "", active ? "active" : ""].join(" ");
    const row = h(
      "tr",
      { class: classes, "aria-current": active ? "step" : null, focusin: () => actions.select(index) },
      h("th", { scope: "row", class: "number" }, h("button", { type: "button", class: "item-number", "data-key": key("number"), "aria-label": `Select item ${number}`, "aria-pressed": String(selected), click: () => actions.select(index) }, number)),
      h("td", {}, kind),
      ...this.#altitude(item, key, number, off, change),
      ...this.#place(item, number, off, change),
      h("td", { class: "details" }, ...details(item, key, number, off, change)),
      h(
        "td",
        { class: "order" },
        tool("up", `Move item ${number} up`, key("up"), off || index === 0, () => actions.swap(index, index - 1)),
        tool("down", `Move item ${number} down`, key("down"), off || index === items.length - 1, () => actions.swap(index, index + 1)),
        tool("trash", `Delete item ${number}`, key("delete"), off, () => actions.remove(index)),
      ),
    );
    return row;
  }

  #place(item: Item, number: number, off: boolean, change: (item: Item, what: string) => void): HTMLElement[] {
    if (!("place" in item)) return [h("td", {}), h("td", {})];
    const place = item.place;
    if (!place) return [h("td", { class: "note", colspan: 2 }, item.kind === "takeoff" ? "straight ahead" : item.kind === "land" ? "where it took off" : "here")];
    return places(`item-${number - 1}`, `item ${number}`, place, off, (now) => change({ ...item, place: now } as Item, "position"));
  }

  #altitude(item: Item, key: (name: string) => string, number: number, off: boolean, change: (item: Item, what: string) => void): HTMLElement[] {
    if (!("altitude" in item)) return [h("td", {}), h("td", {})];
    const { altitude } = item;
    return [
      h("td", {}, quantityField("altitude", {
        key: key("altitude"), label: `Altitude of item ${number}`, value: altitude.m, lowest: -1000, highest: 20_000, disabled: off,
        changed: (m) => m !== null && change({ ...item, altitude: { ...altitude, m } }, "altitude"),
      })),
      h("td", {}, selectField(key("frame"), `Altitude frame of item ${number}`, altitude.above, FRAMES, (above) => change({ ...item, altitude: { ...altitude, above } }, "altitude frame"), off)),
    ];
  }
}

function tool(name: "up" | "down" | "trash", label: string, key: string, disabled: boolean, action: () => void): HTMLButtonElement {
  return button(label, action, { icon: name, bare: true, class: "button small plain", key, disabled });
}

function problemRow(problem: Problem): HTMLElement {
  return h("tr", { class: `problem ${problem.level}` }, h("td", {}), h("td", { colspan: 7 }, icon("warning"), h("span", {}, `${problem.level === "error" ? "Error" : "Remark"}: ${problem.message}`)));
}

const labelled = (text: string, ...fields: Node[]): HTMLElement => h("span", { class: "labelled" }, h("span", { class: "unit" }, text), ...fields);

/** What an item says besides its place and altitude. */
function details(item: Item, key: (name: string) => string, number: number, off: boolean, change: (item: Item, what: string) => void): HTMLElement[] {
  const of = (what: string) => `${what} of item ${number}`;
  switch (item.kind) {
    case "waypoint":
      return [labelled("within", quantityField("length", { key: key("radius"), label: of("Radius"), value: item.radius_m, empty: "auto", lowest: 0, highest: LONGEST_M, disabled: off, changed: (radius_m) => change({ ...item, radius_m }, "radius") }))];
    case "loiter": {
      const end = typeof item.end === "string" ? item.end : "turns" in item.end ? "turns" : "seconds";
      const ends = { never: "never", altitude: "altitude", turns: { turns: 2 }, seconds: { seconds: 60 } } satisfies Record<string, LoiterEnd>;
      return [
        labelled("until", selectField(key("end"), of("End"), end, [["turns", "turns"], ["seconds", "time"], ["altitude", "its altitude"], ["never", "a command"]], (now) => change({ ...item, end: ends[now] }, "end"), off)),
        ...(typeof item.end === "string" ? [] : [numberField({ key: key("count"), label: of(end === "turns" ? "Turns" : "Seconds"), value: "turns" in item.end ? item.end.turns : item.end.seconds, digits: 1, lowest: 0, disabled: off, changed: (value) => value !== null && change({ ...item, end: end === "turns" ? { turns: value } : { seconds: value } }, "end") })]),
        labelled("radius", quantityField("length", { key: key("radius"), label: of("Radius"), value: item.radius_m, empty: "auto", lowest: 0, highest: LONGEST_M, disabled: off, changed: (radius_m) => change({ ...item, radius_m }, "radius") })),
        selectField(key("way"), of("Direction"), item.clockwise ? "right" : "left", [["right", "clockwise"], ["left", "counterclockwise"]], (way) => change({ ...item, clockwise: way === "right" }, "direction"), off),
      ];
    }
    case "takeoff":
      return [labelled("pitch", quantityField("angle", { key: key("pitch"), label: of("Pitch"), value: item.pitch_deg === null ? null : (item.pitch_deg * Math.PI) / 180, empty: "auto", lowest: 0, highest: Math.PI / 4, disabled: off, changed: (rad) => change({ ...item, pitch_deg: rad === null ? null : Math.round((rad * 180e6) / Math.PI) / 1e6 }, "pitch") }))];
    case "land":
      return [labelled("abort to", quantityField("altitude", { key: key("abort"), label: of("Abort altitude"), value: item.abort_altitude_m, empty: "auto", lowest: 0, highest: 20_000, disabled: off, changed: (abort_altitude_m) => change({ ...item, abort_altitude_m }, "abort altitude") }))];
    case "delay":
      return [labelled("wait", numberField({ key: key("seconds"), label: of("Seconds"), value: item.seconds, digits: 0, lowest: 0, disabled: off, changed: (seconds) => seconds !== null && change({ ...item, seconds }, "delay") })), h("span", { class: "unit" }, "s")];
    case "until-distance":
      return [labelled("within", quantityField("length", { key: key("distance"), label: of("Distance"), value: item.distance_m, lowest: 0, disabled: off, changed: (distance_m) => distance_m !== null && change({ ...item, distance_m }, "distance") }))];
    case "change-speed": {
      const ground = item.speed !== null && "ground-speed-mps" in item.speed;
      const mps = item.speed === null ? null : "ground-speed-mps" in item.speed ? item.speed["ground-speed-mps"] : item.speed["airspeed-mps"];
      const make = (value: number | null, over_ground: boolean) => (value === null ? null : over_ground ? { "ground-speed-mps": value } : { "airspeed-mps": value });
      return [
        quantityField("speed", { key: key("speed"), label: of("Speed"), value: mps, empty: "same", lowest: 0, highest: 340, disabled: off, changed: (value) => change({ ...item, speed: make(value, ground) }, "speed") }),
        selectField(key("of"), of("Kind of speed"), ground ? "ground" : "air", [["air", "airspeed"], ["ground", "over ground"]], (now) => change({ ...item, speed: make(mps, now === "ground") }, "kind of speed"), off),
      ];
    }
    case "jump":
      return [
        labelled("to item", numberField({ key: key("to"), label: of("Target"), value: item.to, digits: 0, lowest: 1, step: 1, disabled: off, changed: (to) => to !== null && change({ ...item, to }, "target") })),
        labelled("times", numberField({ key: key("times"), label: of("Times"), value: item.times, digits: 0, empty: "∞", lowest: 0, step: 1, disabled: off, changed: (times) => change({ ...item, times }, "times") })),
      ];
    case "camera":
      return [h("span", { class: "unit" }, `command ${item.command}, not carried out`)];
    default:
      return [];
  }
}
