// The colour bar, or a legend where colours are names.
import { cssGradient } from "../render/fields/color_map";
import type { Scale } from "../render/fields/grid_view";
import { scenery } from "../render/shading";
import { byId, make } from "./dom";
import { endsOf } from "./plot_model";

let shown = "";

/** Shows `scale`; undefined hides the bar. */
export function showScale(scale: Scale | undefined): void {
  const bar = byId("scale");
  bar.hidden = !scale;
  if (!scale) return;
  const ends = endsOf(scale.low, scale.high);
  const names = (scale.kinds ?? []).map(({ name }) => name).join(", ");
  const text = `${scale.label} ${ends.join(" ")} ${scale.map} ${scenery.theme} ${names}`;
  if (text === shown) return;
  shown = text;
  const [label, ramp, low, high, list] = [...bar.children] as [HTMLElement, HTMLElement, HTMLElement, HTMLElement, HTMLElement];
  ramp.hidden = low.hidden = high.hidden = names !== "";
  list.replaceChildren(
    ...(scale.kinds ?? []).map(({ name, color }) => {
      const mark = make("i", {});
      mark.style.background = `#${color.toString(16).padStart(6, "0")}`;
      return make("span", {}, mark, name);
    }),
  );
  label.textContent = scale.label;
  ramp.style.background = cssGradient(scale.map, scenery.theme);
  low.textContent = ends[0].replace("-", "−");
  high.textContent = ends[1].replace("-", "−");
}
