// What a colour bar is labelled with.
import type { ViewerSettings } from "../../client/rest";

/** What stands beside the colour bar of a field: the scene's legend or else the field's name, and the unit; pure numbers have none. */
export function scaleLabel({ color_by, legend }: ViewerSettings, field: string, unit: string, isLength = false): string {
  const shown = legend && field === color_by ? legend : `${field}${isLength ? ", length" : ""}`;
  return unit && unit !== "1" ? `${shown} (${unit})` : shown;
}
