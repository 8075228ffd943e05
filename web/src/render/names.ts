// Names beside systems, when there are only a few.
import { Extent } from "./extent";
import type { Label } from "./labels";
import type { SceneInfo } from "./scene_info";
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

/** A name at every row that a probe watches. */
export function probeLabels(probes: SceneInfo["probes"], views: ReadonlyMap<string, { positions: Float32Array; count: number }>): Label[] {
  return probes.flatMap(({ name, system, row }) => {
    const view = views.get(system);
    const at = row < 0 ? (view?.count ?? 0) + row : row;
    if (!view || at < 0 || at >= view.count) return [];
    const [x = 0, y = 0, z = 0] = view.positions.subarray(3 * at, 3 * at + 3);
    return [{ text: name, at: [x, y, z] as [number, number, number], kind: "row" as const }];
  });
}
