// Follows an operation to its end: by server-sent events, or by polling if those do not arrive.
import type { Service } from "./rest";
import { ended, type Operation } from "./studies";

const kAskEvery = 700; // ms

export interface Watcher {
  changed(operation: Operation): void;
  failed(error: unknown): void;
}

/** Calls `changed` after every change, the last time with an operation that has ended; the answer stops it. */
export function watch(service: Service, operation: Operation, watcher: Watcher): () => void {
  let stopped = false;
  let source: EventSource | undefined;
  let timer: ReturnType<typeof setTimeout> | undefined;

  const stop = (): void => {
    stopped = true;
    source?.close();
    clearTimeout(timer);
  };
  const take = (next: Operation): void => {
    if (stopped) return;
    if (ended(next)) stop();
    watcher.changed(next);
  };
  const ask = async (): Promise<void> => {
    if (stopped) return;
    try {
      take(await service.operation(operation.id));
      if (!stopped) timer = setTimeout(() => void ask(), kAskEvery);
    } catch (error) {
      if (!stopped) watcher.failed(error);
      stop();
    }
  };

  if (ended(operation)) {
    queueMicrotask(() => take(operation));
    return stop;
  }
  const events = operation.links.events;
  if (!events || typeof EventSource === "undefined") {
    void ask();
    return stop;
  }
  source = new EventSource(service.base + events);
  const heard = (event: MessageEvent<string>): void => take(JSON.parse(event.data) as Operation);
  source.addEventListener("progress", heard);
  source.addEventListener("end", heard);
  source.addEventListener("error", () => {
    // The browser reconnects after a broken connection, but not after a refused one.
    if (source?.readyState !== EventSource.CLOSED) return;
    void ask();
  });
  return stop;
}
