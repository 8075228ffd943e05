// Parts as named by a stream's Hello: rows that belong together, and fields that say what they mean.
import type { Hello, Part } from "./gen/truestep/v1/stream_pb";

/** The field of `part` that means `what`. */
export function meaning(part: Part | undefined, what: string): string | undefined {
  return part?.fields.find((field) => field.meaning === what)?.name;
}

/** The field whose colours a grid shows: the wanted one, or its first. */
export function shownField(part: Part | undefined, wanted: string): string | undefined {
  return (part?.fields.find((field) => field.name === wanted) ?? part?.fields[0])?.name;
}

/** The parts of `hello` by id. */
export function partsOf(hello: Hello): Map<string, Part> {
  return new Map(hello.parts.map((part) => [part.id, part]));
}
