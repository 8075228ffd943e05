// Perceptual colour maps, as in the service's pictures: stops at equal distances, lightness grows monotonically.
import { balanceHex, emberHex, sandHex, smokeHex, snowHex, viridisHex, waterHex } from "./color_stops";

export type ColorMap = "viridis" | "water" | "ember" | "balance" | "smoke" | "snow" | "sand";

const stops: Record<ColorMap, number[]> = { viridis: viridisHex, water: waterHex, ember: emberHex, balance: balanceHex, smoke: smokeHex, snow: snowHex, sand: sandHex };

/** sRGB bytes, `count` of them from the lowest to the highest value. */
export function colorTable(map: ColorMap, count: number): Uint8Array {
  const chosen = stops[map] ?? stops.viridis;
  const out = new Uint8Array(3 * count);
  for (let k = 0; k < count; ++k) {
    const x = (k / (count - 1)) * (chosen.length - 1);
    const i = Math.min(Math.floor(x), chosen.length - 2);
    for (let c = 0; c < 3; ++c) {
      const at = (j: number): number => (chosen[j]! >> (16 - 8 * c)) & 255;
      out[3 * k + c] = Math.round(at(i) + (x - i) * (at(i + 1) - at(i)));
    }
  }
  return out;
}

/** The map as a CSS gradient from left to right. */
export function cssGradient(map: ColorMap): string {
  return `linear-gradient(to right, ${(stops[map] ?? stops.viridis).map((hex) => `#${hex.toString(16).padStart(6, "0")}`).join(", ")})`;
}
