/** Where an aircraft was, on the map. */

import L from "leaflet";
import { palette, type Palette } from "../design/theme";
import type { TrackPoints } from "./track-points";

const GROWN_EVERY_MS = 400;

export class TrackLayer extends L.LayerGroup {
  readonly #edge: L.Polyline;
  readonly #line: L.Polyline;
  #grown_ms = -Infinity;
  #drawn = -1;
  #stop: (() => void) | null = null;

  constructor(
    readonly points: TrackPoints,
    private readonly colour: keyof Palette = "track",
    dashed = false,
  ) {
    // Above the path of the plan, below the points.
    const style: L.PolylineOptions = { pane: "shadowPane", interactive: false, smoothFactor: 1, ...(dashed ? { dashArray: "8 6" } : {}) };
    const edge = L.polyline([], { ...style, weight: 4.5 });
    const line = L.polyline([], { ...style, weight: 2.2 });
    super([edge, line]);
    this.#edge = edge;
    this.#line = line;
    this.grow();
  }

  override onAdd(map: L.Map): this {
    super.onAdd(map);
    this.#stop = palette.watch((colours) => {
      this.#edge.setStyle({ color: colours.panel });
      this.#line.setStyle({ color: colours[this.colour] });
    });
    return this;
  }

  override onRemove(map: L.Map): this {
    this.#stop?.();
    return super.onRemove(map);
  }

  /** More places may have been added. */
  grow(): void {
    const now = performance.now();
    if (now - this.#grown_ms < GROWN_EVERY_MS || this.points.changes === this.#drawn) return;
    this.#grown_ms = now;
    this.#drawn = this.points.changes;
    this.#edge.setLatLngs(this.points.places);
    this.#line.setLatLngs(this.points.places);
  }
}
