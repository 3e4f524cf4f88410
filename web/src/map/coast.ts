/** Coast lines of Natural Earth at 1:50 million, as rings in world pixels at zoom 0. */

import type { Polygon, MultiPolygon, Feature, FeatureCollection, Position } from "geojson";
import { feature } from "topojson-client";
import type { Topology } from "topojson-specification";
import source from "world-atlas/land-50m.json?url";
import { worldX, worldY } from "./mercator";

/** Rings that cross the 180th meridian, as the parts on each side of it. */
function cut(ring: Position[]): Position[][] {
  const parts: Position[][] = [[]];
  ring.forEach((point, at) => {
    const before = ring[at - 1];
    if (before && Math.abs((point[0] ?? 0) - (before[0] ?? 0)) > 180) parts.push([]);
    parts.at(-1)?.push(point);
  });
  return parts;
}

export async function rings() {
  const topology = (await (await fetch(source)).json()) as Topology;
  const land = topology.objects["land"];
  if (!land) return [];
  const found = feature(topology, land) as Feature | FeatureCollection;
  const features = found.type === "FeatureCollection" ? found.features : [found];
  return features
    .map((one) => one.geometry as Polygon | MultiPolygon)
    .flatMap((geometry) => (geometry.type === "Polygon" ? [geometry.coordinates] : geometry.coordinates))
    .flat()
    .flatMap(cut)
    .map((ring) => {
      const points = new Float64Array(ring.length * 2);
      let west = Infinity, east = -Infinity, north = Infinity, south = -Infinity;
      ring.forEach(([longitude = 0, latitude = 0], at) => {
        const x = worldX(longitude);
        const y = worldY(latitude);
        points[at * 2] = x;
        points[at * 2 + 1] = y;
        west = Math.min(west, x);
        east = Math.max(east, x);
        north = Math.min(north, y);
        south = Math.max(south, y);
      });
      return { points, west, east, north, south };
    });
}
