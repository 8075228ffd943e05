// Values of joints as colours of their marks: which row of which part a mark shows, and its colour.
import { Color, SRGBColorSpace } from "three";
import { uints, type FieldArray } from "../../client/decode";
import type { Marks, Part } from "../../client/gen/truestep/v1/stream_pb";
import { colorTable, type ColorMap } from "./color_map";
import { scenery } from "../shading";
import { ValueRange } from "../value_range";
import { sizes } from "../values";

const kColors = 256;

/** The value of each joint of `marks`; NaN for joints without one. `values` by the place of their part. */
export function jointValues(marks: Pick<Marks, "joints" | "jointRows">, values: ReadonlyMap<number, ArrayLike<number>>): Float32Array {
  const rows = uints(marks.jointRows);
  return Float32Array.from({ length: Math.floor(marks.joints.byteLength / 36) }, (_, k) => values.get(rows[2 * k] ?? -1)?.[rows[2 * k + 1] ?? -1] ?? NaN);
}

export class JointValues {
  private readonly own = new ValueRange();
  private values = new Map<number, Float32Array>();

  /** Takes a frame's values of joints, of the field `name`; "" for none. */
  take(fields: readonly FieldArray[], parts: ReadonlyMap<string, Part>, name: string): void {
    this.values = new Map();
    [...parts].forEach(([id, part], place) => {
      const field = part.elements === "joints" && name ? fields.find((one) => one.system === id && one.field === name) : undefined;
      if (field) this.values.set(place, sizes(field));
    });
    for (const values of this.values.values()) this.own.take(values, values.length);
    if (this.values.size === 0) this.own.forget();
  }

  /** Lowest and highest value that colours show. */
  get ownRange(): [number, number] | undefined {
    return this.own.ends;
  }

  forgetRange(): void {
    this.own.forget();
  }

  /** A colour per joint of `marks`; undefined where its kind gives the colour. */
  colors(marks: Marks, map: ColorMap, [low, high]: [number, number]): (Color | undefined)[] {
    if (this.values.size === 0) return [];
    const table = colorTable(map, kColors, scenery.theme);
    return Array.from(jointValues(marks, this.values), (value) => {
      if (!Number.isFinite(value)) return undefined;
      const t = high > low ? Math.min(Math.max((value - low) / (high - low), 0), 1) : 0;
      const k = 3 * Math.round(t * (kColors - 1));
      return new Color().setRGB(table[k]! / 255, table[k + 1]! / 255, table[k + 2]! / 255, SRGBColorSpace);
    });
  }
}
