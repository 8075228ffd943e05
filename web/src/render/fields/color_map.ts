// Perceptual colour maps, as in the service's pictures: stops at equal distances, lightness grows monotonically.
import { balancedarkHex, balanceHex, emberdarkHex, emberHex, sanddarkHex, sandHex, smokedarkHex, smokeHex, snowHex, viridisdarkHex, viridisHex, waterdarkHex, waterHex } from "./color_stops";

export type ColorMap = "viridis" | "water" | "ember" | "balance" | "smoke" | "snow" | "sand";

/** What the picture is on: maps begin at another colour on dark paper. */
export type Theme = "dark" | "light";

const stops: Record<Theme, Record<ColorMap, number[]>> = {
  light: { viridis: viridisHex, water: waterHex, ember: emberHex, balance: balanceHex, smoke: smokeHex, snow: snowHex, sand: sandHex },
  dark: { viridis: viridisdarkHex, water: waterdarkHex, ember: emberdarkHex, balance: balancedarkHex, smoke: smokedarkHex, snow: snowHex, sand: sanddarkHex },
};

const stopsOf = (map: ColorMap, theme: Theme): number[] => stops[theme][map] ?? stops[theme].viridis;

/** Lines over a surface that the map colours, sRGB. */
export const inkOn = (map: ColorMap, theme: Theme): string => (theme === "dark" && (map === "balance" || map === "smoke") ? "#e0e8f2" : "#14171f");

/** sRGB bytes, `count` of them from the lowest to the highest value. */
export function colorTable(map: ColorMap, count: number, theme: Theme): Uint8Array {
  const chosen = stopsOf(map, theme);
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
export function cssGradient(map: ColorMap, theme: Theme): string {
  return `linear-gradient(to right, ${stopsOf(map, theme).map((hex) => `#${hex.toString(16).padStart(6, "0")}`).join(", ")})`;
}
