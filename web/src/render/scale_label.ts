// The words beside a colour bar.
import type { ViewerSettings } from "../client/rest";

/** What stands beside a colour bar: the scene's legend or else `name`, and the unit; pure numbers have none. */
export function scaleLabel({ legend }: ViewerSettings, name: string, unit: string): string {
  const shown = legend || name;
  return unit && unit !== "1" ? `${shown} (${unit})` : shown;
}
