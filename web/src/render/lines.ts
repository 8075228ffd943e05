// Springs and links as line segments over the system's shared positions. The kind of a line (structural,
// shear, bending) sets its colour; where a surface is drawn too, the structural
// lines alone are hinted at.
import { BufferAttribute, BufferGeometry, Color, LineBasicMaterial, LineSegments } from "three";

const kindColors = ["#dfe7f1", "#6fb7ff", "#e9b44c", "#9aa6b5"].map((hex) => new Color(hex));

/** Segments between rows of `positions`; `pairs` holds two rows a line. */
export function makeLines(positions: BufferAttribute, pairs: Uint32Array, kinds: Uint8Array, color: Color | undefined, faint: boolean): LineSegments {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", positions);
  // One colour per line needs the order of kinds, not a colour per vertex: sort into groups, one material each.
  const byKind: number[][] = [[], [], [], []];
  for (let line = 0; line < pairs.length / 2; ++line) byKind[Math.min(kinds[line] ?? 0, 3)]!.push(pairs[2 * line]!, pairs[2 * line + 1]!);
  const index = new Uint32Array(pairs.length);
  const materials = kindColors.map(
    (kindColor, kind) =>
      new LineBasicMaterial({ color: kind === 0 && color ? color : kindColor, transparent: true, opacity: faint ? 0.14 : [0.95, 0.4, 0.15, 0.6][kind]!, depthWrite: !faint }),
  );
  let start = 0;
  byKind.forEach((group, kind) => {
    if (group.length === 0 || (faint && kind > 0)) return;
    index.set(group, start);
    geometry.addGroup(start, group.length, kind);
    start += group.length;
  });
  geometry.setIndex(new BufferAttribute(index, 1));
  const lines = new LineSegments(geometry, materials as unknown as LineBasicMaterial);
  lines.frustumCulled = false;
  return lines;
}
