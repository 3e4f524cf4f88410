/** Relief from the daemon's terrain tiles: light from the north-west, height as a tint. */

import type L from "leaflet";
import { getJson } from "../core/api";
import { palette } from "../design/theme";

interface Elevations {
  n: number;
  elevations_m: (number | null)[];
}

export interface Relief {
  picture: HTMLCanvasElement;
  bounds: L.LatLngBounds;
}

const CELLS = 160;
/** The map below stays visible. */
const OPACITY = 185;
const WAIT_MS = 350;
/** Beyond this the tiles are too many, and a relief shows nothing useful. */
const WIDEST_DEG = 3;
const EARTH_M_PER_DEG = 111_195;

/** Follows the map; `changed` gets the relief of its surroundings. Returns what ends it. */
export function followRelief(map: L.Map, changed: (relief: Relief) => void): () => void {
  let known: { data: Elevations; bounds: L.LatLngBounds } | null = null;
  let timer: ReturnType<typeof setTimeout> | undefined;
  let request: AbortController | null = null;
  let off = false;

  const draw = () => {
    if (known) changed({ picture: picture(known.data, known.bounds, document.documentElement.dataset["theme"] === "dark"), bounds: known.bounds });
  };
  const load = async () => {
    const bounds = map.getBounds().pad(0.35);
    const wide = bounds.getEast() - bounds.getWest();
    if (off || wide > WIDEST_DEG || wide === 0) return;
    if (known?.bounds.contains(map.getBounds()) && wide > (known.bounds.getEast() - known.bounds.getWest()) * 0.4) return;
    request?.abort();
    request = new AbortController();
    const query = `south=${bounds.getSouth()}&west=${bounds.getWest()}&north=${bounds.getNorth()}&east=${bounds.getEast()}&n=${CELLS}`;
    try {
      const data = await getJson<Elevations | null>(`/terrain?${query}`, request.signal);
      // Without tiles it is not asked again; a place without a tile is asked again elsewhere.
      if (data === null) off = true;
      else if (data.elevations_m.some((one) => one !== null)) {
        known = { data, bounds };
        draw();
      }
    } catch {
      // Relief is an addition: the map is complete without it.
    }
  };
  const soon = () => {
    clearTimeout(timer);
    timer = setTimeout(() => void load(), WAIT_MS);
  };
  map.on("moveend zoomend", soon);
  soon();
  const stop = palette.watch(draw);
  return () => {
    stop();
    clearTimeout(timer);
    request?.abort();
  };
}

function picture({ n, elevations_m }: Elevations, bounds: L.LatLngBounds, dark: boolean): HTMLCanvasElement {
  const canvas = document.createElement("canvas");
  canvas.width = n;
  canvas.height = n;
  const context = canvas.getContext("2d");
  if (!context) return canvas;
  const image = context.createImageData(n, n);
  const cell_m = ((bounds.getEast() - bounds.getWest()) / n) * EARTH_M_PER_DEG * Math.cos((bounds.getCenter().lat * Math.PI) / 180);
  const at = (row: number, column: number): number =>
    elevations_m[Math.min(n - 1, Math.max(0, row)) * n + Math.min(n - 1, Math.max(0, column))] ?? 0;
  const heights = elevations_m.filter((one): one is number => one !== null);
  const low = heights.reduce((a, b) => Math.min(a, b), Infinity);
  const span = Math.max(200, heights.reduce((a, b) => Math.max(a, b), -Infinity) - low);
  for (let row = 0; row < n; row += 1)
    for (let column = 0; column < n; column += 1) {
      const east = (at(row, column + 1) - at(row, column - 1)) / (2 * cell_m);
      const north = (at(row - 1, column) - at(row + 1, column)) / (2 * cell_m);
      // Lambert's law, light from the north-west at 45°.
      const light = (-east * -0.5 + -north * 0.5 + 0.707) / Math.hypot(east, north, 1);
      const shade = Math.max(-1, Math.min(1, (light - 0.707) * 3)) * (dark ? 60 : 70);
      const height = (at(row, column) - low) / span;
      const pixel = (row * n + column) * 4;
      const [red, green, blue] = dark ? [34 + 60 * height, 52 + 34 * height, 46 + 10 * height] : [196 + 30 * height, 214 - 22 * height, 178 - 24 * height];
      image.data[pixel] = red + shade;
      image.data[pixel + 1] = green + shade;
      image.data[pixel + 2] = blue + shade;
      image.data[pixel + 3] = elevations_m[row * n + column] === null ? 0 : OPACITY;
    }
  context.putImageData(image, 0, 0);
  return canvas;
}
