// Preview of a gallery card under the mouse: pictures drawn by the service of a session stepped for them. It starts
// after a moment, so that a passing mouse costs nothing, and ends with the session.
import { Service } from "../client/rest";

const kRest = 350; // ms that the mouse must rest before a card plays
const kPictures = 60;
const kEvery = 0.12; // s of a scene of kWhole s between two pictures
const kWhole = 7;
const kSize = "width=360&height=228";

let running: AbortController | undefined;

/** Plays scene `name` in `picture` while the mouse is on `card`. */
export function preview(card: HTMLElement, picture: HTMLElement, name: string): void {
  let timer: ReturnType<typeof setTimeout> | undefined;
  card.addEventListener("pointerenter", (event) => {
    if (event.pointerType !== "mouse" || matchMedia("(prefers-reduced-motion: reduce)").matches) return;
    clearTimeout(timer);
    timer = setTimeout(() => {
      running?.abort();
      running = new AbortController();
      void play(picture, name, running.signal).catch(() => undefined);
    }, kRest);
  });
  const stop = (): void => {
    clearTimeout(timer);
    running?.abort();
    running = undefined;
  };
  card.addEventListener("pointerleave", stop);
  card.addEventListener("click", stop);
}

async function play(picture: HTMLElement, name: string, signal: AbortSignal): Promise<void> {
  const image = picture.querySelector("img");
  if (!image) return;
  const service = new Service();
  const still = image.src;
  const session = await service.createSession({ gallery: name });
  let shown: string | undefined;
  try {
    const scene = await service.sessionScene(session.id);
    const { duration = kWhole, dt = 1e-3 } = (scene.time as { duration?: number; dt?: number } | undefined) ?? {};
    const every = Math.max(1, Math.round((duration < 1.5 || duration > 60 ? (duration * kEvery) / kWhole : kEvery) / dt));
    for (let k = 0; k < kPictures && !signal.aborted; ++k) {
      await service.step(session.id, every);
      const response = await fetch(`/v1/sessions/${encodeURIComponent(session.id)}/picture.png?${kSize}`, { signal });
      if (!response.ok) break;
      const next = URL.createObjectURL(await response.blob());
      image.src = next;
      await image.decode().catch(() => undefined);
      if (shown) URL.revokeObjectURL(shown);
      shown = next;
      picture.dataset.playing = String(k + 1);
    }
    // The last picture stays while the mouse does.
    if (!signal.aborted) await new Promise<void>((resolve) => signal.addEventListener("abort", () => resolve(), { once: true }));
  } finally {
    delete picture.dataset.playing;
    image.src = still;
    if (shown) URL.revokeObjectURL(shown);
    await service.deleteSession(session.id).catch(() => undefined);
  }
}
