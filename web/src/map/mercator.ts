/** Web Mercator, in pixels of the world at zoom 0. */

const WORLD_PX = 256;

export const worldX = (longitude_deg: number): number => ((longitude_deg + 180) / 360) * WORLD_PX;
export function worldY(latitude_deg: number): number {
  const sine = Math.sin((Math.min(85.0511, Math.max(-85.0511, latitude_deg)) * Math.PI) / 180);
  return (0.5 - Math.log((1 + sine) / (1 - sine)) / (4 * Math.PI)) * WORLD_PX;
}
