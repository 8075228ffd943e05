// The service's HTTP interface as typed calls. Every refusal is a ProblemError.
import { ProblemError, problemOfResponse, type Issue } from "./problem";
import type { Method, Operation, StudyKind, StudyResult } from "./studies";

export interface GalleryEntry {
  name: string;
  title: string;
  teaches?: string;
  description?: string;
  thumbnail?: string;
  tags?: string[];
  /** The types of its systems. */
  systems?: string[];
}

export interface Expectation {
  quantity: string;
  source?: string;
  [bound: string]: unknown;
}

/** What a scene says about how it is shown; lengths in m, fov in rad. */
export interface ViewerSettings {
  camera?: { eye?: number[]; target?: number[]; up?: number[]; fov?: number };
  color_by?: string;
  /** What the colours show; without it the field's name. */
  legend?: string;
  color_map?: "automatic" | "viridis" | "water" | "ember" | "balance" | "smoke" | "snow" | "sand";
  /** Of the values 0, 1, 2 ..., or of equal parts of the range: each has a colour of its own. */
  names?: string[];
  /** Lowest and highest value of the colours. */
  range?: number[];
  /** Of a grid in space. */
  slice?: { axis?: "x" | "y" | "z"; at?: number };
  /** m per unit of a grid's value. */
  height?: number;
  /** How particles that have a size are drawn. */
  liquid?: "balls" | "surface";
  /** Lines of equal value over a plane of a grid. */
  contours?: number;
  /** Lines along a vector field; without them it is drawn as arrows. */
  streamlines?: number;
  /** Names beside systems. */
  labels?: boolean;
  /** Names of probes beside what they watch. */
  probe_labels?: boolean;
  /** s; for how long points leave a trail. */
  trail?: number;
}

/** A scene as the service takes it; the viewer only looks at the parts named here. */
export interface Scene {
  name?: string;
  title?: string;
  viewer?: ViewerSettings;
  expect?: Expectation[];
  [key: string]: unknown;
}

export interface GalleryScene extends GalleryEntry {
  scene: Scene;
  expect?: Expectation[];
}

export interface Session {
  id: string;
  dt?: number;
  name?: string;
  title?: string;
  teaches?: string;
  viewer?: ViewerSettings;
  links: Record<string, string>;
  /** A recording of it is being written. */
  recorded?: boolean;
  /** Present when the session stopped because its numbers no longer made sense. */
  instability?: Instability;
  /** Results that may be wrong although nothing has failed. */
  warnings?: { system: string; quantity: string; detail: string; suggested_dt?: number }[];
  [key: string]: unknown;
}

/** The series that a session keeps of its observables; only those that its scene names. */
export interface History {
  units: Record<string, string>;
  series: { time: number[]; values: Record<string, (number | null)[]> };
}

/** Why a session stopped, and what would have helped. */
export interface Instability {
  detail: string;
  last_good_step?: number;
  suggested_dt?: number;
  remedies?: string[];
}

export interface Validation {
  valid?: boolean;
  errors?: Issue[];
  warnings?: Issue[];
  suggestions?: Issue[];
  estimate?: Record<string, unknown>;
  [key: string]: unknown;
}

/** The service at `base` ("" is the page's own origin). */
export class Service {
  constructor(
    readonly base = "",
    private readonly fetcher: typeof fetch = (input, init) => fetch(input, init),
  ) {}

  async gallery(): Promise<GalleryEntry[]> {
    return ((await this.call("GET", "/v1/gallery")) as { scenes: GalleryEntry[] }).scenes;
  }

  async galleryScene(name: string): Promise<GalleryScene> {
    return (await this.call("GET", `/v1/gallery/${encodeURIComponent(name)}`)) as GalleryScene;
  }

  async validate(scene: unknown): Promise<Validation> {
    return (await this.call("POST", "/v1/scenes/validate", scene)) as Validation;
  }

  async createSession(body: { gallery: string } | Scene): Promise<Session> {
    let session = (await this.call("POST", "/v1/sessions", body)) as Session;
    // Large scenes take a while to build; meanwhile the session reports its progress.
    while (session.status === "creating") {
      await new Promise((resolve) => setTimeout(resolve, 500));
      session = await this.session(session.id);
    }
    return session;
  }

  async session(id: string): Promise<Session> {
    return (await this.call("GET", this.path(id))) as Session;
  }

  /** The scene as the session runs it, with every default. */
  async sessionScene(id: string): Promise<Scene> {
    return (await this.call("GET", this.path(id, "/scene"))) as Scene;
  }

  async history(id: string, maxPoints: number): Promise<History> {
    return (await this.call("GET", this.path(id, `/observables?max_points=${maxPoints}`))) as History;
  }

  /** Steps until `time` (s), however long that takes. */
  async until(id: string, time: number): Promise<void> {
    await this.call("POST", this.path(id, "/step"), { until: time });
  }

  async deleteSession(id: string): Promise<void> {
    await this.call("DELETE", this.path(id));
  }

  async play(id: string, speed: number): Promise<void> {
    await this.call("POST", this.path(id, "/play"), { speed });
  }

  async pause(id: string): Promise<void> {
    await this.call("POST", this.path(id, "/pause"), {});
  }

  async reset(id: string): Promise<void> {
    await this.call("POST", this.path(id, "/reset"), {});
  }

  /** Records the session from now on. */
  async startRecording(id: string): Promise<void> {
    await this.call("POST", this.path(id, "/recording"), {});
  }

  /** Ends that; the file is at `recording`. */
  async endRecording(id: string): Promise<{ frames: number; recording: string }> {
    return (await this.call("DELETE", this.path(id, "/recording"))) as { frames: number; recording: string };
  }

  /** Goes to a time of the run, exactly. */
  async seek(id: string, time: number): Promise<void> {
    await this.call("POST", this.path(id, "/seek"), { time });
  }

  async step(id: string, steps: number): Promise<void> {
    await this.call("POST", this.path(id, "/step"), { steps });
  }

  async studies(): Promise<StudyKind[]> {
    return ((await this.call("GET", "/v1/studies")) as { studies: StudyKind[] }).studies;
  }

  async startStudy(body: Record<string, unknown>): Promise<Operation> {
    return (await this.call("POST", "/v1/studies", body)) as Operation;
  }

  async operations(): Promise<Operation[]> {
    return ((await this.call("GET", "/v1/operations")) as { operations: Operation[] }).operations;
  }

  async operation(id: string): Promise<Operation> {
    return (await this.call("GET", `/v1/operations/${encodeURIComponent(id)}`)) as Operation;
  }

  async cancelOperation(id: string): Promise<Operation> {
    return (await this.call("POST", `/v1/operations/${encodeURIComponent(id)}/cancel`, {})) as Operation;
  }

  async studyResult(id: string): Promise<StudyResult> {
    return (await this.call("GET", `/v1/operations/${encodeURIComponent(id)}/result`)) as StudyResult;
  }

  /** The methods that a kind of system can be advanced with. */
  async methods(type: string): Promise<Method[]> {
    return ((await this.call("GET", `/v1/systems/${encodeURIComponent(type)}`)) as { integrators?: Method[] }).integrators ?? [];
  }

  /** Milliseconds that the smallest request takes there and back. */
  async roundTrip(): Promise<number> {
    const start = performance.now();
    await (await this.fetcher(`${this.base}/healthz`, { cache: "no-store" })).arrayBuffer();
    return performance.now() - start;
  }

  /** The WebSocket address of a session's stream. */
  streamUrl(id: string, origin: string): string {
    const url = new URL(this.path(id, "/stream"), this.base || origin);
    url.protocol = url.protocol === "https:" ? "wss:" : "ws:";
    return url.href;
  }

  private path(id: string, rest = ""): string {
    return `/v1/sessions/${encodeURIComponent(id)}${rest}`;
  }

  private async call(method: string, path: string, body?: unknown): Promise<unknown> {
    // A lost answer is requested again, once: the key makes the service create or step only once.
    const headers: Record<string, string> = { accept: "application/json" };
    if (body !== undefined) headers["content-type"] = "application/json";
    if (method === "POST") headers["idempotency-key"] = `${Date.now().toString(36)}-${Math.random().toString(36).slice(2)}`;
    const ask = (): Promise<Response> => this.fetcher(this.base + path, { method, headers, ...(body === undefined ? {} : { body: JSON.stringify(body) }) });
    let response: Response;
    try {
      response = await ask().catch(async () => {
        await new Promise((resolve) => setTimeout(resolve, 400));
        return ask();
      });
    } catch {
      throw new ProblemError({
        title: "The service does not answer",
        status: 0,
        code: "unreachable",
        detail: `${method} ${path} got no answer. Is the server still running?`,
      });
    }
    if (!response.ok) throw new ProblemError(await problemOfResponse(response));
    const text = await response.text();
    return text === "" ? undefined : JSON.parse(text);
  }
}
