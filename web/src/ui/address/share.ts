// Share: two addresses of what is on the screen, to copy. One makes each reader a run of their own, the other one only
// watches this run.
import type { Scene } from "../../client/rest";
import { byId } from "../dom";
import { packScene, writeAddress, type Shown } from "./address";

export interface Links {
  /** Undefined: the scene is too long for an address. */
  own: string | undefined;
  watch: string;
}

/** The links to what is shown: `scene` is packed where nothing shorter says how to make it. */
export async function linksOf(session: string, scene: Scene | undefined, shown: Shown): Promise<Links> {
  const packed = shown.gallery === undefined ? (shown.packed ?? (scene && (await packScene(scene).catch(() => undefined)))) : undefined;
  const own = shown.gallery !== undefined || packed !== undefined;
  return { own: own ? writeAddress({ ...shown, packed }) : undefined, watch: writeAddress({ watch: session }) };
}

/** `links` is asked when the list opens; undefined: nothing is on the screen. */
export function installShare(links: () => Promise<Links | undefined>, say: (text: string) => void): void {
  const menu = byId<HTMLDetailsElement>("share");
  const fill = async (): Promise<void> => {
    const found = await links();
    for (const kind of ["own", "watch"] as const) {
      const address = found?.[kind];
      byId<HTMLInputElement>(`share-${kind}`).value = address === undefined ? "" : location.origin + address;
      byId<HTMLButtonElement>(`copy-${kind}`).disabled = address === undefined;
    }
    byId("share-long").hidden = !found || found.own !== undefined;
  };
  menu.addEventListener("toggle", () => menu.open && void fill());
  document.addEventListener("pointerdown", (event) => !menu.contains(event.target as Node) && (menu.open = false));
  menu.addEventListener("keydown", (event) => {
    if (event.key === "Escape") menu.open = false;
    event.stopPropagation();
  });
  for (const kind of ["own", "watch"] as const) {
    byId(`copy-${kind}`).addEventListener("click", () => void copy(byId<HTMLInputElement>(`share-${kind}`)).then(() => say("copied")));
  }
}

async function copy(field: HTMLInputElement): Promise<void> {
  try {
    await navigator.clipboard.writeText(field.value);
  } catch {
    // Pages that are neither on this machine nor encrypted have no clipboard, but may copy a selection.
    field.select();
    document.execCommand("copy");
  }
}
