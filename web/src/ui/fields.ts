// The fields that the viewer requests from a stream.
import { meaning, partsOf, shownField } from "../client/parts";
import type { Hello, Topology } from "../client/gen/truestep/v1/stream_pb";

/** What points and lines are coloured by, and whether the colours are on the screen. */
export interface Coloring {
  colorBy: string;
  bySpeed: boolean;
}

/**
 * What the colours of grids show; positions; for rows with bodies also orientations and sleep states; and, where points and bodies are
 * coloured by a value, that field: the one that the scene names, otherwise their speed.
 */
export function fieldsOf({ colorBy, bySpeed }: Coloring, hello: Hello, topology: Topology | undefined): string[] {
  const parts = partsOf(hello);
  const wanted = new Set<string>();
  const want = (name: string | undefined): void => void (name && wanted.add(name));
  // Before the topology is known: the first frame has what the colours of grids show.
  const grids = topology ? topology.systems.map(({ system }) => parts.get(system)) : [...parts.values()];
  for (const part of grids) if (part?.lattice) want(shownField(part, colorBy));
  for (const drawn of topology?.systems ?? []) {
    const part = parts.get(drawn.system);
    const has = (name: string): string | undefined => (name && part?.fields.some((field) => field.name === name) ? name : undefined);
    const bodies = drawn.visuals.length > 0;
    want(meaning(part, "position"));
    if (bodies) for (const what of ["orientation", "asleep"]) want(meaning(part, what));
    const shown = colorBy || "speed";
    const surface = !part?.lattice && drawn.triangles.length > 0;
    if (bySpeed && (drawn.pointRadius > 0 || bodies || surface)) want(has(shown) ?? (shown === "speed" ? meaning(part, "velocity") : undefined));
    // Values of a system's lines, triangles and joints are in separate parts.
    const valued = [...parts.values()].filter((one) => one.elements !== "" && one.system === drawn.system);
    if (bySpeed && colorBy && valued.some((one) => one.fields.some((field) => field.name === colorBy))) want(colorBy);
  }
  return [...wanted];
}
