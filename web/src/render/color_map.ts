// Perceptual colour maps, as in the service's pictures: stops at equal distances, lightness grows monotonically.
export type ColorMap = "viridis" | "water" | "ember";

const stops: Record<ColorMap, number[]> = {
  viridis: [0x440154, 0x482878, 0x3e4a89, 0x31688e, 0x26828e, 0x1f9e89, 0x35b779, 0x6dcd59, 0xb4de2c, 0xfde725],
  water: [0x0b3c7d, 0x14599f, 0x1f78bd, 0x3c9ad2, 0x6dbbe3, 0xa6d9f0, 0xe4f5fc],
  ember: [0x3b0f2e, 0x6f1a3a, 0xa52c3a, 0xd54a2f, 0xf07c2a, 0xf9b04a, 0xfde6a0],
};

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
