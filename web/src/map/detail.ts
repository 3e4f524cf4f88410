/** The user's own `.pmtiles`, if the station has one: streets and waters, or pictures. */

import type L from "leaflet";
import { leafletRasterLayer, PMTiles, TileType } from "pmtiles";
import { leafletLayer } from "protomaps-leaflet";

export async function detailLayer(url: string, dark: boolean): Promise<L.Layer> {
  const archive = new PMTiles(url);
  const { tileType, minZoom, maxZoom } = await archive.getHeader();
  // Above the canvas of coast lines, which Leaflet's style puts at 100.
  const zIndex = 200;
  if (tileType !== TileType.Mvt) return leafletRasterLayer(archive, { zIndex, minZoom, maxNativeZoom: maxZoom }) as L.Layer;
  return leafletLayer({ url, zIndex, flavor: dark ? "dark" : "light", lang: "en" }) as unknown as L.Layer;
}
