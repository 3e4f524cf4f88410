/** A layer of the map that is drawn on one opaque canvas of the map's size. */

import L from "leaflet";
import { worldX, worldY } from "./mercator";
import { notOnNextFrame, onNextFrame } from "../core/frame";

/** From places to points of the canvas. */
export interface Projection {
  width: number;
  height: number;
  /** World pixels at zoom 0 times this are world pixels now. */
  scale: number;
  /** World pixel of the canvas' corner. */
  x0: number;
  y0: number;
  x(longitude_deg: number): number;
  y(latitude_deg: number): number;
  place(x: number, y: number): L.LatLng;
}

export abstract class CanvasLayer extends L.Layer {
  #canvas: HTMLCanvasElement | null = null;
  #map: L.Map | null = null;
  readonly #draw = () => this.#redraw();
  readonly #moved = () => this.invalidate();

  constructor(pane: string) {
    super();
    L.setOptions(this, { pane });
  }

  abstract draw(context: CanvasRenderingContext2D, view: Projection): void;

  override onAdd(map: L.Map): this {
    this.#map = map;
    this.#canvas = L.DomUtil.create("canvas", "leaflet-layer") as HTMLCanvasElement;
    this.#canvas.setAttribute("aria-hidden", "true");
    this.getPane()?.append(this.#canvas);
    map.on("move zoom viewreset resize", this.#moved);
    this.#redraw();
    return this;
  }

  override onRemove(map: L.Map): this {
    map.off("move zoom viewreset resize", this.#moved);
    notOnNextFrame(this.#draw);
    this.#canvas?.remove();
    this.#canvas = null;
    this.#map = null;
    return this;
  }

  invalidate(): void {
    if (this.#canvas) onNextFrame(this.#draw);
  }

  #redraw(): void {
    const canvas = this.#canvas;
    const map = this.#map;
    if (!canvas || !map) return;
    const size = map.getSize();
    const ratio = Math.min(2, devicePixelRatio || 1);
    if (canvas.width !== size.x * ratio || canvas.height !== size.y * ratio) {
      canvas.width = size.x * ratio;
      canvas.height = size.y * ratio;
      canvas.style.width = `${size.x}px`;
      canvas.style.height = `${size.y}px`;
    }
    L.DomUtil.setPosition(canvas, map.containerPointToLayerPoint([0, 0]));
    const context = canvas.getContext("2d", { alpha: false });
    if (!context) return;
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    const scale = 2 ** map.getZoom();
    const centre = map.getCenter();
    const x0 = Math.round(worldX(centre.lng) * scale - size.x / 2);
    const y0 = Math.round(worldY(centre.lat) * scale - size.y / 2);
    this.draw(context, {
      width: size.x,
      height: size.y,
      scale,
      x0,
      y0,
      x: (longitude_deg) => worldX(longitude_deg) * scale - x0,
      y: (latitude_deg) => worldY(latitude_deg) * scale - y0,
      place: (x, y) => map.containerPointToLatLng([x, y]),
    });
  }
}
