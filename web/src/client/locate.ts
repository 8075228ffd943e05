// Locates the value of a JSON pointer (RFC 6901) in a JSON text, so that an editor can show it. The text may be invalid
// further down: the scan stops at the first thing it cannot read.

export interface Range {
  start: number;
  end: number;
}

const space = /[\s]*/y;
const string = /"(?:[^"\\]|\\.)*"/y;
const scalar = /[^\s,\]}]+/y;

/** The range of the pointer's value, or of the deepest existing parent; undefined when nothing can be read. */
export function locate(text: string, pointer: string): Range | undefined {
  const path = pointer === "" ? [] : pointer.slice(1).split("/").map((part) => part.replaceAll("~1", "/").replaceAll("~0", "~"));
  let at = 0;

  const take = (pattern: RegExp): string | undefined => {
    pattern.lastIndex = at;
    const match = pattern.exec(text);
    if (match) at = pattern.lastIndex;
    return match?.[0];
  };

  /** Reads one value; `wanted` is the rest of the path while this value is on it. */
  const value = (wanted: string[] | undefined): Range | undefined => {
    take(space);
    const start = at;
    let found: Range | undefined;
    const open = text[at];
    if (open === "{" || open === "[") {
      const close = open === "{" ? "}" : "]";
      ++at;
      for (let index = 0; at < text.length; ++index) {
        take(space);
        if (text[at] === close) break;
        let key = String(index);
        const keyStart = at;
        if (open === "{") {
          const raw = take(string);
          if (raw === undefined) return found;
          try {
            key = JSON.parse(raw) as string;
          } catch {
            return found;
          }
          take(space);
          if (text[at] !== ":") return found;
          ++at;
        }
        const onPath = wanted !== undefined && wanted[0] === key;
        const inner = value(onPath ? wanted.slice(1) : undefined);
        if (onPath) found = wanted.length === 1 ? { start: keyStart, end: at } : (inner ?? { start: keyStart, end: at });
        take(space);
        if (text[at] !== ",") break;
        ++at;
      }
      take(space);
      if (text[at] === close) ++at;
    } else if (take(open === '"' ? string : scalar) === undefined) {
      return undefined;
    }
    return found ?? (wanted === undefined ? undefined : { start, end: at });
  };
  return value(path);
}
