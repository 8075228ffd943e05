// What a session was made from, for the page of studies: the service does not give a session's scene back.
import type { Scene } from "../client/rest";

const key = (session: string): string => `truestep.scene.${session}`;

/** Keeps the scene as long as the tab lives; a scene too large for that is not kept. */
export function rememberScene(session: string, scene: Scene): void {
  try {
    sessionStorage.setItem(key(session), JSON.stringify(scene));
  } catch {
    // Storage is full or switched off: the page of studies then offers the gallery only.
  }
}

export function recallScene(session: string): Scene | undefined {
  try {
    const text = sessionStorage.getItem(key(session));
    return text === null ? undefined : (JSON.parse(text) as Scene);
  } catch {
    return undefined;
  }
}
