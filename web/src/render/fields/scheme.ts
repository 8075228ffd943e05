// What colours mean, as in the service's pictures (engine/sinks/picture/draw/draw_scale): the map that suits a field, or
// a colour for each of its kinds.
import type { ViewerSettings } from "../../client/rest";
import type { ColorMap } from "./color_map";
import { naturalHex, naturalNames, paletteHex } from "./color_stops";

export interface Kind {
  name: string;
  /** sRGB. */
  color: number;
}

export interface Scheme {
  map: ColorMap;
  /** Zero is the middle of the map. */
  balanced: boolean;
  /** Names and colours of equal parts of `ends`; empty: the field is an amount. */
  kinds: Kind[];
  ends: [number, number];
}

/** What is known of a field besides its values. */
export interface FieldMeaning {
  width: number;
  scale: string;
  kinds: string[];
}

/** As many colours as a ramp has: kinds beyond share them. */
export const kRampStops = 16;

/** The colour of the k-th kind: its own if it is a material that people know, otherwise the palette's. */
export function colorOfKind(name: string, k: number): number {
  const natural = naturalNames.indexOf(name);
  return natural >= 0 ? naturalHex[natural]! : paletteHex[k % paletteHex.length]!;
}

/** How the field `name` is coloured in a scene with these settings. */
export function schemeOf(settings: ViewerSettings, name: string, field: FieldMeaning | undefined): Scheme {
  const own = !settings.color_by || name === settings.color_by;
  const chosen = (own && settings.color_map) || "automatic";
  const deviates = field?.scale === "deviation" && field.width === 1;
  const map = chosen === "automatic" ? (deviates ? "balance" : "viridis") : chosen;
  const names = own && settings.names?.length ? settings.names : (field?.kinds ?? []);
  const range = own && settings.range?.length === 2 ? (settings.range as [number, number]) : undefined;
  const kinds = names.map((kind, k) => ({ name: kind, color: colorOfKind(kind, k) }));
  return { map, balanced: map === "balance", kinds, ends: range ?? [-0.5, names.length - 0.5] };
}

/** The number of the kind that has this value. */
export function kindAt({ kinds, ends: [low, high] }: Scheme, value: number): number {
  const place = Math.floor(((value - low) / (high - low)) * kinds.length);
  return Math.min(Math.max(Number.isFinite(place) ? place : 0, 0), kinds.length - 1);
}

/** As far to both sides of zero. */
export function balanced([low, high]: [number, number]): [number, number] {
  const reach = Math.max(Math.abs(low), Math.abs(high));
  return [-reach, reach];
}
