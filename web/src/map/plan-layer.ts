/** A plan on the map: its path, items, fence, rally points and obstacles. */

import L from "leaflet";
import { h } from "../core/dom";
import { palette, type Palette } from "../design/theme";
import { KIND_NAMES, placeOf, type Item, type Place, type Plan } from "../plan/model";

export const latLng = (place: Place): L.LatLngTuple => [place.latitude_deg, place.longitude_deg];
export const toPlace = (at: L.LatLng): Place => ({
  latitude_deg: Math.round(at.lat * 1e8) / 1e8,
  longitude_deg: Math.round(L.Util.wrapNum(at.lng, [-180, 180], true) * 1e8) / 1e8,
});

export type Part =
  | { of: "item"; index: number }
  | { of: "home" }
  | { of: "rally"; index: number }
  | { of: "obstacle"; index: number }
  | { of: "circle"; index: number }
  | { of: "corner"; index: number; corner: number };

export interface PlanLayerOptions {
  /** Parts can be moved. */
  moved?: (part: Part, place: Place) => void;
  selected?: (part: Part) => void;
}

const NONE: Set<number> = new Set();
const MARKER_PX = 28;
const GLYPHS: Partial<Record<Item["kind"], string>> = { takeoff: "T", land: "L", loiter: "↻", "land-start": "S" };

/** Metres that an arrow key moves a point; with shift ten times as far. */
const KEY_STEP_M = 10;
const M_PER_DEG = 111_195;

export class PlanLayer {
  readonly group = L.layerGroup();
  #plan: Plan | null = null;
  #path: [number, number, number][] | null = null;
  #active = 0;
  #selected: Part | null = null;
  #wrong = NONE;
  #dragging = false;
  readonly #stop: () => void;

  constructor(
    private readonly map: L.Map,
    private readonly options: PlanLayerOptions = {},
  ) {
    this.group.addTo(map);
    this.#stop = palette.watch(() => this.#build());
  }

  close(): void {
    this.#stop();
    this.group.remove();
  }

  /** `path` is the checked one, with its turns; without it the items are joined. */
  show(plan: Plan | null, path: [number, number, number][] | null): void {
    if (plan === this.#plan && path === this.#path) return;
    this.#plan = plan;
    this.#path = path;
    this.#build();
  }

  mark(active: number, selected: Part | null = null, wrong: Set<number> = NONE): void {
    if (active === this.#active && selected === this.#selected && [...wrong].join() === [...this.#wrong].join()) return;
    this.#active = active;
    this.#selected = selected;
    this.#wrong = wrong;
    this.#build();
  }

  bounds(): L.LatLngBounds | null {
    const plan = this.#plan;
    if (!plan) return null;
    const places = [...plan.items.map(placeOf), plan.home?.place ?? null].filter((one): one is Place => one !== null);
    return places.length > 0 ? L.latLngBounds(places.map(latLng)).pad(0.15) : null;
  }

  #build(): void {
    const focused = this.map.getContainer().ownerDocument.activeElement?.getAttribute("data-part") ?? null;
    // A point that is dragged would be taken out of the hand.
    if (this.#dragging) return;
    this.group.clearLayers();
    const plan = this.#plan;
    if (!plan) return;
    const colours = palette.get();
    this.#fence(plan, colours);
    for (const [index, one] of plan.obstacles.entries()) {
      L.circle(latLng(one.centre), { radius: one.radius_m, color: colours.warning, weight: 1.5, fillOpacity: 0.3, interactive: false }).addTo(this.group);
      this.#marker({ of: "obstacle", index }, one.centre, "▲", "obstacle", `Obstacle ${index + 1}`);
    }
    this.#lines(plan, colours);
    if (plan.home) L.circleMarker(latLng(plan.home.place), { radius: 4, color: colours.good, weight: 2, fillOpacity: 1, interactive: false }).addTo(this.group);
    if (plan.home) this.#marker({ of: "home" }, plan.home.place, "H", "home", "Home");
    for (const [index, one] of plan.rally.entries()) this.#marker({ of: "rally", index }, one.place, "R", "rally", `Rally point ${index + 1}`);
    for (const [index, item] of plan.items.entries()) {
      const place = placeOf(item);
      if (!place) continue;
      const radius = item.kind === "loiter" ? item.radius_m : null;
      if (radius !== null) L.circle(latLng(place), { radius: Math.abs(radius), color: colours.path, weight: 1.5, fill: false, interactive: false }).addTo(this.group);
      const kind = [item.kind, this.#active === index + 1 ? "active" : "", this.#wrong.has(index + 1) ? "wrong" : ""].join(" ");
      const text = `${index + 1}${GLYPHS[item.kind] ?? ""}`;
      this.#marker({ of: "item", index }, place, text, kind, `Item ${text}, ${KIND_NAMES[item.kind]}`);
    }
    if (focused) this.map.getContainer().querySelector<HTMLElement>(`[data-part="${CSS.escape(focused)}"]`)?.focus();
  }

  #lines(plan: Plan, colours: Palette): void {
    const joined = plan.items.map(placeOf).filter((one): one is Place => one !== null).map(latLng);
    const first = plan.items.find((item) => placeOf(item) !== null);
    if (plan.home && first?.kind === "takeoff") joined.unshift(latLng(plan.home.place));
    const path = this.#path && this.#path.length > 1 ? this.#path.map(([lat, lon]): L.LatLngTuple => [lat, lon]) : joined;
    L.polyline(path, { color: colours.panel, weight: 5, opacity: 0.9, interactive: false }).addTo(this.group);
    L.polyline(path, { color: colours.path, weight: 2.2, interactive: false }).addTo(this.group);
  }

  #fence(plan: Plan, colours: Palette): void {
    const style = (inclusion: boolean): L.PathOptions => ({
      color: inclusion ? colours.good : colours.warning, weight: 1.8, dashArray: "7 5", fill: !inclusion, fillOpacity: 0.13, interactive: false,
    });
    for (const [index, one] of plan.fence.polygons.entries()) {
      L.polygon(one.corners.map(latLng), style(one.inclusion)).addTo(this.group);
      if (this.options.moved)
        for (const [corner, place] of one.corners.entries())
          this.#marker({ of: "corner", index, corner }, place, "", "corner", `Corner ${corner + 1} of fence ${index + 1}`);
    }
    for (const [index, one] of plan.fence.circles.entries()) {
      L.circle(latLng(one.centre), { ...style(one.inclusion), radius: one.radius_m }).addTo(this.group);
      if (this.options.moved) this.#marker({ of: "circle", index }, one.centre, "", "corner", `Centre of fence circle ${index + 1}`);
    }
  }

  #marker(part: Part, place: Place, text: string, kind: string, label: string): void {
    const movable = this.options.moved !== undefined;
    const chosen = this.#selected !== null && JSON.stringify(this.#selected) === JSON.stringify(part);
    const size = part.of === "corner" || part.of === "circle" ? 24 : MARKER_PX;
    const html = h("span", { class: `point ${kind}${chosen ? " selected" : ""}` }, text);
    // The home is below its place: a landing is often at the same one.
    const anchor: L.PointTuple = part.of === "home" ? [size / 2, -6] : [size / 2, size / 2];
    const marker = L.marker(latLng(place), {
      icon: L.divIcon({ className: "point-box", html, iconSize: [size, size], iconAnchor: anchor }),
      draggable: movable, keyboard: movable, interactive: movable, title: label, alt: label, autoPan: true, zIndexOffset: part.of === "item" ? 100 : 0,
    });
    marker.on("click", () => this.options.selected?.(part));
    marker.on("dragstart", () => {
      this.#dragging = true;
      this.options.selected?.(part);
    });
    marker.on("dragend", () => {
      this.#dragging = false;
      this.options.moved?.(part, toPlace(marker.getLatLng()));
      this.#build();
    });
    marker.addTo(this.group);
    const element = marker.getElement();
    if (!element) return;
    element.setAttribute("data-part", JSON.stringify(part));
    element.setAttribute("aria-label", movable ? `${label}. Arrow keys move it.` : label);
    if (!movable) return;
    element.addEventListener("keydown", (event) => {
      const step = (KEY_STEP_M * (event.shiftKey ? 10 : 1)) / M_PER_DEG;
      const north = event.key === "ArrowUp" ? 1 : event.key === "ArrowDown" ? -1 : 0;
      const east = event.key === "ArrowRight" ? 1 : event.key === "ArrowLeft" ? -1 : 0;
      if (north === 0 && east === 0) return;
      event.preventDefault();
      event.stopPropagation();
      const at = marker.getLatLng();
      this.options.moved?.(part, toPlace(L.latLng(at.lat + north * step, at.lng + (east * step) / Math.cos((at.lat * Math.PI) / 180))));
    });
  }
}
