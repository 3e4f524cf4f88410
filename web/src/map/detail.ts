/** The user's own `.pmtiles`, if the station has one: streets, waters, land use. */

import { leafletLayer } from "protomaps-leaflet";
import type L from "leaflet";

export function detailLayer(url: string, dark: boolean): L.Layer {
  return leafletLayer({ url, flavor: dark ? "dark" : "light", lang: "en" }) as unknown as L.Layer;
}
