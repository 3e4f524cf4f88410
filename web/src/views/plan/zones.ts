/** Home, fence, rally points and obstacles as tables. */

import { button, h, replace } from "../../core/dom";
import { keepingFocus, numberField, quantityField, selectField } from "../../core/fields";
import type { Place, Plan } from "../../plan/model";

export interface ZoneActions {
  edit(plan: Plan, what: string): void;
  /** Where something new goes without a tap: the centre of the map. */
  centre(): Place;
  readonly writable: boolean;
}

const NEW_RADIUS_M = 300;
const NEW_SIDE_DEG = 0.01;
const NEW_OBSTACLE_M = { radius_m: 30, height_m: 60 };
const LONGEST_M = 100_000;

const without = <T>(list: readonly T[], index: number): T[] => list.filter((_, at) => at !== index);
const changed = <T>(list: readonly T[], index: number, value: T): T[] => list.map((one, at) => (at === index ? value : one));

export class Zones {
  readonly element = h("div", { class: "zones scroll", tabindex: 0, role: "region", "aria-label": "Home, fence, rally points and obstacles" });

  show(plan: Plan, actions: ZoneActions): void {
    keepingFocus(this.element, () => replace(this.element, home(plan, actions), fence(plan, actions), rally(plan, actions), obstacles(plan, actions)));
  }
}

export function places(key: string, name: string, place: Place, off: boolean, set: (place: Place) => void): HTMLElement[] {
  return (["latitude_deg", "longitude_deg"] as const).map((axis) =>
    h("td", {}, numberField({
      key: `${key}-${axis}`, label: `${axis === "latitude_deg" ? "Latitude" : "Longitude"} of ${name}, degrees`, value: place[axis], digits: 6, fixed: true, disabled: off, class: "place",
      lowest: axis === "latitude_deg" ? -90 : -180, highest: axis === "latitude_deg" ? 90 : 180,
      changed: (value) => value !== null && set({ ...place, [axis]: value }),
    })),
  );
}

function section(title: string, columns: string[], rows: HTMLElement[], ...actions: HTMLElement[]): HTMLElement {
  return h(
    "section",
    { class: "zone" },
    h("div", { class: "row end" }, h("h2", {}, title), h("div", { class: "row" }, ...actions)),
    rows.length > 0 ? h("table", {}, h("thead", {}, h("tr", {}, ...columns.map((one) => h("th", { scope: "col" }, one || h("span", { class: "visually-hidden" }, "Actions"))))), h("tbody", {}, ...rows)) : null,
  );
}

function remover(name: string, off: boolean, action: () => void): HTMLElement {
  return h("td", { class: "order" }, button(`Delete ${name}`, action, { icon: "trash", bare: true, class: "button small plain", disabled: off }));
}

function adder(label: string, off: boolean, action: () => void): HTMLButtonElement {
  return button(label, action, { icon: "add", class: "button small", disabled: off });
}

function home(plan: Plan, { edit, centre, writable }: ZoneActions): HTMLElement {
  const off = !writable;
  const one = plan.home;
  const rows = one
    ? [h("tr", {}, ...places("home", "home", one.place, off, (place) => edit({ ...plan, home: { ...one, place } }, "home")), h("td", {}, quantityField("altitude", { key: "home-altitude", label: "Altitude of home above sea level", value: one.altitude_m, disabled: off, lowest: -1000, highest: 9000, changed: (altitude_m) => altitude_m !== null && edit({ ...plan, home: { ...one, altitude_m } }, "home's altitude") })))]
    : [];
  const cruise = h("label", { class: "labelled" }, h("span", { class: "unit" }, "cruise speed"), quantityField("speed", { key: "cruise", label: "Airspeed of the first leg", value: plan.cruise_mps, empty: "usual", lowest: 0, highest: 340, disabled: off, changed: (cruise_mps) => edit({ ...plan, cruise_mps }, "cruise speed") }));
  return section("Home", ["Latitude °", "Longitude °", "Above sea level"], rows, cruise, ...(one ? [] : [adder("Set home at centre", off, () => edit({ ...plan, home: { place: centre(), altitude_m: 0 } }, "home"))]));
}

function fence(plan: Plan, { edit, centre, writable }: ZoneActions): HTMLElement {
  const off = !writable;
  const zone = plan.fence;
  const set = (change: Partial<Plan["fence"]>, what: string) => edit({ ...plan, fence: { ...zone, ...change } }, what);
  const side = (key: string, name: string, inclusion: boolean, put: (inclusion: boolean) => void) =>
    h("td", {}, selectField(key, `Side of ${name}`, inclusion ? "in" : "out", [["in", "stay inside"], ["out", "stay outside"]], (now) => put(now === "in"), off));
  const polygons = zone.polygons.flatMap((one, index) => {
    const name = `fence polygon ${index + 1}`;
    const put = (corners: Place[], what: string) => set({ polygons: changed(zone.polygons, index, { ...one, corners }) }, what);
    return [
      h("tr", {}, h("th", { scope: "row" }, `Polygon ${index + 1}`), side(`polygon-${index}`, name, one.inclusion, (inclusion) => set({ polygons: changed(zone.polygons, index, { ...one, inclusion }) }, `side of ${name}`)), h("td", { colspan: 2, class: "unit" }, `${one.corners.length} corners`), remover(name, off, () => set({ polygons: without(zone.polygons, index) }, `delete ${name}`))),
      ...one.corners.map((corner, at) =>
        h("tr", { class: "corner-row" }, h("td", {}), h("td", { class: "unit" }, `corner ${at + 1}`), ...places(`corner-${index}-${at}`, `corner ${at + 1} of ${name}`, corner, off, (place) => put(changed(one.corners, at, place), `corner of ${name}`)), one.corners.length > 3 ? remover(`corner ${at + 1} of ${name}`, off, () => put(without(one.corners, at), `delete a corner of ${name}`)) : h("td", {})),
      ),
    ];
  });
  const circles = zone.circles.map((one, index) => {
    const name = `fence circle ${index + 1}`;
    const put = (change: Partial<typeof one>, what: string) => set({ circles: changed(zone.circles, index, { ...one, ...change }) }, what);
    return h("tr", {}, h("th", { scope: "row" }, `Circle ${index + 1}`, h("br"), quantityField("length", { key: `circle-${index}-radius`, label: `Radius of ${name}`, value: one.radius_m, lowest: 1, highest: LONGEST_M, disabled: off, changed: (radius_m) => radius_m !== null && put({ radius_m }, `radius of ${name}`) })), side(`circle-${index}`, name, one.inclusion, (inclusion) => put({ inclusion }, `side of ${name}`)), ...places(`circle-${index}`, name, one.centre, off, (place) => put({ centre: place }, `centre of ${name}`)), remover(name, off, () => set({ circles: without(zone.circles, index) }, `delete ${name}`)));
  });
  const limit = (key: "floor_m" | "ceiling_m", name: string) =>
    h("label", { class: "labelled" }, h("span", { class: "unit" }, name), quantityField("altitude", { key, label: `${name} above sea level`, value: zone[key], empty: "none", lowest: -1000, highest: 20_000, disabled: off, changed: (value) => set({ [key]: value }, name) }));
  const square = (): Place[] => {
    const { latitude_deg: lat, longitude_deg: lon } = centre();
    return [[1, -1], [1, 1], [-1, 1], [-1, -1]].map(([north = 0, east = 0]) => ({ latitude_deg: lat + north * NEW_SIDE_DEG, longitude_deg: lon + east * NEW_SIDE_DEG }));
  };
  return section(
    "Fence", ["Zone", "Side", "Latitude °", "Longitude °", ""], [...polygons, ...circles],
    limit("floor_m", "floor"), limit("ceiling_m", "ceiling"),
    adder("Polygon", off, () => set({ polygons: [...zone.polygons, { corners: square(), inclusion: true, group: 0 }] }, "add a fence polygon")),
    adder("Circle", off, () => set({ circles: [...zone.circles, { centre: centre(), radius_m: NEW_RADIUS_M, inclusion: false, group: 0 }] }, "add a fence circle")),
  );
}

function rally(plan: Plan, { edit, centre, writable }: ZoneActions): HTMLElement {
  const off = !writable;
  const rows = plan.rally.map((one, index) => {
    const name = `rally point ${index + 1}`;
    const put = (change: Partial<typeof one>) => edit({ ...plan, rally: changed(plan.rally, index, { ...one, ...change }) }, name);
    return h("tr", {}, h("th", { scope: "row" }, String(index + 1)), ...places(`rally-${index}`, name, one.place, off, (place) => put({ place })), h("td", {}, quantityField("altitude", { key: `rally-${index}-altitude`, label: `Altitude of ${name} above home`, value: one.altitude_m, disabled: off, changed: (altitude_m) => altitude_m !== null && put({ altitude_m }) })), remover(name, off, () => edit({ ...plan, rally: without(plan.rally, index) }, `delete ${name}`)));
  });
  return section("Rally points", ["#", "Latitude °", "Longitude °", "Above home", ""], rows, adder("Rally point", off, () => edit({ ...plan, rally: [...plan.rally, { place: centre(), altitude_m: 100 }] }, "add a rally point")));
}

function obstacles(plan: Plan, { edit, centre, writable }: ZoneActions): HTMLElement {
  const off = !writable;
  const rows = plan.obstacles.map((one, index) => {
    const name = `obstacle ${index + 1}`;
    const put = (change: Partial<typeof one>) => edit({ ...plan, obstacles: changed(plan.obstacles, index, { ...one, ...change }) }, name);
    return h("tr", {}, h("th", { scope: "row" }, String(index + 1)), ...places(`obstacle-${index}`, name, one.centre, off, (place) => put({ centre: place })), h("td", {}, quantityField("length", { key: `obstacle-${index}-radius`, label: `Radius of ${name}`, value: one.radius_m, lowest: 1, highest: LONGEST_M, disabled: off, changed: (radius_m) => radius_m !== null && put({ radius_m }) })), h("td", {}, quantityField("altitude", { key: `obstacle-${index}-top`, label: `Top of ${name} above sea level`, value: one.top_m, disabled: off, changed: (top_m) => top_m !== null && put({ top_m }) })), remover(name, off, () => edit({ ...plan, obstacles: without(plan.obstacles, index) }, `delete ${name}`)));
  });
  return section("Obstacles", ["#", "Latitude °", "Longitude °", "Radius", "Top (sea level)", ""], rows, adder("Obstacle", off, () => edit({ ...plan, obstacles: [...plan.obstacles, { centre: centre(), radius_m: NEW_OBSTACLE_M.radius_m, top_m: (plan.home?.altitude_m ?? 0) + NEW_OBSTACLE_M.height_m }] }, "add an obstacle")));
}
