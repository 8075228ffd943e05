// Names beside systems, when there are only a few.
import { Extent } from "./extent";
import type { Label } from "./labels";
import type { SystemView } from "./system_view";
import { upward } from "./upright";

const kNames = 8;

/** A name above each system, in the colour of its parts; none if there is one system or more than eight. */
export function namesOf(views: SystemView[]): Label[] {
  const systems = views.filter((view) => !view.id.includes(".") && view.count > 0);
  if (systems.length < 2 || systems.length > kNames) return [];
  const labels: Label[] = [];
  for (const view of systems) {
    const parts = views.filter((part) => part === view || part.id.startsWith(`${view.id}.`));
    const color = parts.map((part) => part.givenColor).find((given) => given !== undefined) ?? view.tint;
    const reach = new Extent();
    view.reachOf(reach);
    if (reach.empty) continue;
    labels.push({ text: view.id.replaceAll("_", " "), at: reach.top(upward.toArray()), kind: "name", color: `#${color.getHexString()}` });
  }
  return labels;
}
