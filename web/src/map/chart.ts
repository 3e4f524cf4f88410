/** The map of all views: coast lines, grid, relief, buttons; no picture comes from elsewhere. */

import L from "leaflet";
import "leaflet/dist/leaflet.css";
import { getJson } from "../core/api";
import { button, h, setText } from "../core/dom";
import { withUnit, unitSystem } from "../core/units";
import { palette } from "../design/theme";
import { CanvasLayer, type Projection } from "./canvas-layer";
import { followRelief, type Relief } from "./relief";

interface Ring {
  /** World pixels at zoom 0, x and y by turns. */
  points: Float64Array;
  west: number;
  east: number;
  north: number;
  south: number;
}

let coast: Promise<Ring[]> | null = null;

const COAST_AFTER_MS = 400;
Object.assign(L.Browser, { ie3d: true }); // Chromium gives each point that moves in space a layer.

/** The coast lines come in a part of their own, after the page is ready. */
function coastLines(): Promise<Ring[]> {
  coast ??= new Promise((done) => setTimeout(done, COAST_AFTER_MS)).then(() => import("./coast")).then((loaded) => loaded.rings());
  return coast;
}

/** Steps of the grid in degrees: whole parts of a degree or a minute. */
const STEPS_DEG = [30, 10, 5, 2, 1, 0.5, 1 / 6, 1 / 12, 1 / 30, 1 / 60, 1 / 120, 1 / 600, 1 / 1200, 1 / 6000];
const WIDEST_GRID_PX = 190;

function stepOf(degrees_per_px: number): number {
  return STEPS_DEG.find((step) => step / degrees_per_px <= WIDEST_GRID_PX) ?? STEPS_DEG.at(-1) ?? 1;
}

function gridLabel(degrees: number, step: number, letters: string): string {
  const letter = letters[degrees < 0 ? 1 : 0] ?? "";
  const whole = Math.abs(degrees);
  if (step >= 1) return `${Math.round(whole)}°${letter}`;
  const minutes = Math.round(whole * 6000) / 100;
  const rest = minutes % 60;
  return `${Math.floor(minutes / 60)}°${rest.toFixed(step < 1 / 120 ? 2 : step < 1 / 60 ? 1 : 0).padStart(2, "0")}′${letter}`;
}

/** Land, relief and grid on one opaque picture, which is cheap to put together with the rest. */
class BaseLayer extends CanvasLayer {
  rings: Ring[] = [];
  relief: Relief | null = null;

  override draw(context: CanvasRenderingContext2D, view: Projection): void {
    const colours = palette.get();
    context.fillStyle = this.rings.length > 0 ? colours.sea : colours.land;
    context.fillRect(0, 0, view.width, view.height);
    this.#land(context, view, colours.land, colours.coast);
    if (this.relief) {
      const { picture, bounds } = this.relief;
      const west = view.x(bounds.getWest()), north = view.y(bounds.getNorth());
      context.drawImage(picture, west, north, view.x(bounds.getEast()) - west, view.y(bounds.getSouth()) - north);
    }
    this.#grid(context, view, colours.grid, colours["grid-text"]);
  }

  #land(context: CanvasRenderingContext2D, view: Projection, fill: string, stroke: string): void {
    const { scale, x0, y0, width, height } = view;
    const west = x0 / scale, east = (x0 + width) / scale, north = y0 / scale, south = (y0 + height) / scale;
    context.beginPath();
    for (const ring of this.rings) {
      if (ring.east < west || ring.west > east || ring.south < north || ring.north > south) continue;
      const { points } = ring;
      let last_x = NaN, last_y = NaN;
      for (let at = 0; at < points.length; at += 2) {
        const x = (points[at] ?? 0) * scale - x0;
        const y = (points[at + 1] ?? 0) * scale - y0;
        if (Math.abs(x - last_x) < 0.7 && Math.abs(y - last_y) < 0.7) continue;
        if (at === 0) context.moveTo(x, y);
        else context.lineTo(x, y);
        last_x = x;
        last_y = y;
      }
      context.closePath();
    }
    context.fillStyle = fill;
    context.fill("evenodd");
    context.strokeStyle = stroke;
    context.lineWidth = 1;
    context.stroke();
  }

  #grid(context: CanvasRenderingContext2D, view: Projection, line: string, text: string): void {
    const corner = view.place(0, 0);
    const other = view.place(view.width, view.height);
    const step = stepOf((other.lng - corner.lng) / view.width);
    context.strokeStyle = line;
    context.fillStyle = text;
    context.lineWidth = 1;
    context.font = "10px ui-monospace, monospace";
    context.textBaseline = "bottom";
    context.beginPath();
    let free = 0;
    for (let n = Math.ceil(corner.lng / step); n * step < other.lng; n += 1) {
      const x = Math.round(view.x(n * step)) + 0.5;
      context.moveTo(x, 0);
      context.lineTo(x, view.height);
      if (x < free) continue;
      const label = gridLabel(n * step, step, "EW");
      context.fillText(label, x + 4, view.height - 4);
      free = x + context.measureText(label).width + 12;
    }
    for (let n = Math.ceil(other.lat / step); n * step < corner.lat; n += 1) {
      const y = Math.round(view.y(n * step)) + 0.5;
      context.moveTo(0, y);
      context.lineTo(view.width, y);
      context.fillText(gridLabel(n * step, step, "NS"), 4, y - 3);
    }
    context.stroke();
  }
}

export interface Chart {
  map: L.Map;
  element: HTMLElement;
  /** Buttons of the map, top right. */
  controls: HTMLElement;
  close(): void;
}

const INITIAL: L.LatLngExpression = [30, 8];

export function createChart(label: string): Chart {
  const canvas = h("div", { class: "chart-map", role: "application", "aria-label": label });
  const controls = h("div", { class: "chart-controls" });
  const scale = h("div", { class: "chart-scale", "aria-hidden": "true" });
  const scale_text = h("span", {});
  const scale_bar = h("div", { class: "chart-scale-bar" });
  scale.append(scale_bar, scale_text);
  const attribution = h("div", { class: "chart-attribution" }, "Coast lines: Natural Earth");
  const element = h("div", { class: "chart" }, canvas, controls, scale, attribution);
  const map = L.map(canvas, {
    attributionControl: false, zoomControl: false, zoomAnimation: false, markerZoomAnimation: false, fadeAnimation: false,
    zoomSnap: 0.25, zoomDelta: 1, wheelPxPerZoomLevel: 120, inertia: !matchMedia("(prefers-reduced-motion: reduce)").matches,
    minZoom: 2, maxZoom: 19, worldCopyJump: false, maxBoundsViscosity: 1, keyboardPanDelta: 60,
  });
  map.setView(INITIAL, 3);
  const base = new BaseLayer("tilePane").addTo(map);
  controls.append(
    button("Zoom in", () => map.zoomIn(), { icon: "add", bare: true, class: "map-button" }),
    button("Zoom out", () => map.zoomOut(), { icon: "minus", bare: true, class: "map-button" }),
  );
  let closed = false;
  void coastLines().then((rings) => {
    base.rings = rings;
    base.invalidate();
  });
  const relief = followRelief(map, (found) => {
    base.relief = found;
    base.invalidate();
  });
  void getJson<{ pmtiles: string | null; attribution: string | null }>("/map").then(async (found) => {
    if (found.attribution) setText(attribution, found.attribution);
    if (!found.pmtiles || closed) return;
    const { detailLayer } = await import("./detail");
    const detail = await detailLayer(found.pmtiles, document.documentElement.dataset["theme"] === "dark");
    if (!closed) detail.addTo(map);
  }, () => undefined);

  const measure = () => {
    const size = map.getSize();
    if (size.x === 0) return;
    const y = size.y / 2;
    const metres = map.distance(map.containerPointToLatLng([0, y]), map.containerPointToLatLng([100, y]));
    const nice = niceBelow(unitSystem.get() === "aviation" ? metres / 1852 : metres);
    const wide_m = unitSystem.get() === "aviation" ? nice * 1852 : nice;
    scale_bar.style.width = `${(wide_m / metres) * 100}px`;
    setText(scale_text, unitSystem.get() === "aviation" ? `${nice} NM` : wide_m >= 1000 ? withUnit("distance", wide_m).replace(/[.,]0+(?=\D)/, "") : `${nice} m`);
  };
  map.on("move zoom resize", measure);
  const stops = [
    palette.watch(() => base.invalidate()),
    unitSystem.watch(measure),
  ];
  const observer = new ResizeObserver(() => map.invalidateSize({ animate: false, pan: map.getSize().x === 0 }));
  observer.observe(canvas);
  return {
    map,
    element,
    controls,
    close() {
      closed = true;
      observer.disconnect();
      relief();
      for (const stop of stops) stop();
      // Before the renderers: a path that is removed after its renderer would draw on nothing.
      map.eachLayer((layer) => {
        if (!(layer instanceof L.Renderer)) layer.remove();
      });
      map.remove();
    },
  };
}

/** 1, 2 or 5 times a power of ten, at most the value. */
function niceBelow(value: number): number {
  const power = 10 ** Math.floor(Math.log10(value));
  const digit = value / power;
  return Number(((digit >= 5 ? 5 : digit >= 2 ? 2 : 1) * power).toPrecision(1));
}
