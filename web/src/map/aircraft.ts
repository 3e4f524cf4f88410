/**
 * The aircraft on the map, turned to its heading, with a line to where it is in a
 * minute. Both are elements that are moved and turned, so that no picture is drawn
 * anew for each record.
 */

import L from "leaflet";
import { h, svg } from "../core/dom";
import type { FlightState } from "../live/flight-state";

const OUTLINE =
  "0,-17 2.6,-11 2.8,-5 17,1 17,4.2 2.8,2.6 1.9,11 6.5,14 6.5,16.5 0,15 -6.5,16.5 -6.5,14 -1.9,11 -2.8,2.6 -17,4.2 -17,1 -2.8,-5 -2.6,-11";
const AHEAD_S = 60;
const AHEAD_PX = 64; // Its width in the style sheet.
const MOVING_MPS = 3;
const EQUATOR_M = 40_075_017;

export type Pose = Pick<FlightState, "latitude_deg" | "longitude_deg" | "heading_rad" | "north_mps" | "east_mps">;

export class AircraftLayer extends L.Layer {
  #pose: Pose | null = null;
  #map: L.Map | null = null;
  readonly #symbol = svg("svg", { viewBox: "-20 -20 40 40", class: "aircraft-symbol" }, svg("polygon", { points: OUTLINE }), svg("path", { class: "aircraft-cross", d: "M-15-15L15 15M15-15L-15 15" }));
  readonly #ahead = h("div", { class: "aircraft-ahead" });
  readonly #element: HTMLElement;
  readonly #place = () => this.#draw();

  constructor(
    second = false,
    private readonly ahead = true,
  ) {
    super();
    this.#element = h("div", { class: `aircraft${second ? " second" : ""}`, "aria-hidden": "true" }, this.#ahead);
    this.#element.append(this.#symbol);
  }

  override onAdd(map: L.Map): this {
    this.#map = map;
    map.getPane("markerPane")?.append(this.#element);
    map.on("zoom viewreset", this.#place);
    this.#draw();
    return this;
  }

  override onRemove(map: L.Map): this {
    map.off("zoom viewreset", this.#place);
    this.#element.remove();
    this.#map = null;
    return this;
  }

  show(pose: Pose | null, lost = false): void {
    this.#pose = pose;
    this.#element.classList.toggle("lost", lost);
    this.#draw();
  }

  #draw(): void {
    const pose = this.#pose;
    const map = this.#map;
    this.#element.classList.toggle("hidden", pose === null);
    if (!pose || !map) return;
    const { x, y } = map.latLngToLayerPoint([pose.latitude_deg, pose.longitude_deg]);
    this.#element.style.transform = `translate(${x}px, ${y}px)`;
    this.#symbol.style.transform = `rotate(${pose.heading_rad.toFixed(2)}rad)`;
    const speed = Math.hypot(pose.north_mps, pose.east_mps);
    const shown = this.ahead && speed > MOVING_MPS;
    this.#ahead.classList.toggle("hidden", !shown);
    if (!shown) return; // Scaled: another width would be laid out anew.
    const px_per_m = (256 * 2 ** map.getZoom()) / EQUATOR_M / Math.max(0.05, Math.cos((pose.latitude_deg * Math.PI) / 180));
    const length = (speed * AHEAD_S * px_per_m) / AHEAD_PX;
    this.#ahead.style.transform = `rotate(${Math.atan2(-pose.north_mps, pose.east_mps).toFixed(2)}rad) scaleX(${length.toFixed(2)})`;
  }
}
