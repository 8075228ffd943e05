// The colour bar of a grid.
import { cssGradient } from "../render/fields/color_map";
import type { Scale } from "../render/fields/grid_view";
import { byId } from "./dom";
import { endsOf } from "./plot_model";

let shown = "";

/** Shows `scale`; undefined hides the bar. */
export function showScale(scale: Scale | undefined): void {
  const bar = byId("scale");
  bar.hidden = !scale;
  if (!scale) return;
  const ends = endsOf(scale.low, scale.high);
  const text = `${scale.label} ${ends.join(" ")} ${scale.map}`;
  if (text === shown) return;
  shown = text;
  const [label, ramp, low, high] = [...bar.children] as [HTMLElement, HTMLElement, HTMLElement, HTMLElement];
  label.textContent = scale.label;
  ramp.style.background = cssGradient(scale.map);
  low.textContent = ends[0].replace("-", "−");
  high.textContent = ends[1].replace("-", "−");
}
