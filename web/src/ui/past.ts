// Earlier samples of a plot, from the service: at the start, and where frames are missing.
import type { History } from "../client/rest";

const kHistory = 1500; // points of a plot's past
const kPause = 1500; // ms between two requests

export class Past {
  private filling = false;

  constructor(private readonly history: (id: string, points: number) => Promise<History>) {}

  /** Requests the past of the session `id`, unless a request is under way or has just been answered. */
  request(id: string, take: (history: History) => void): void {
    if (this.filling) return;
    this.filling = true;
    const done = (): void => void setTimeout(() => (this.filling = false), kPause);
    this.history(id, kHistory).then(take, () => undefined).finally(done);
  }
}
