// The colour bar of a grid.
import { cssGradient } from "../render/color_map";
import type { Scale } from "../render/grid_view";
import { byId } from "./dom";

const number = (x: number): string => Number(x.toPrecision(4)).toString();
let shown = "";

/** Shows `scale`; undefined hides the bar. */
export function showScale(scale: Scale | undefined): void {
  const bar = byId("scale");
  bar.hidden = !scale;
  if (!scale) return;
  const text = `${scale.label} ${number(scale.low)} ${number(scale.high)} ${scale.map}`;
  if (text === shown) return;
  shown = text;
  const [label, ramp, low, high] = [...bar.children] as [HTMLElement, HTMLElement, HTMLElement, HTMLElement];
  label.textContent = scale.label;
  ramp.style.background = cssGradient(scale.map);
  low.textContent = number(scale.low);
  high.textContent = number(scale.high);
}
