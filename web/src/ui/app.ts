// The viewer as a whole: which session is on the screen, and what the buttons do to it.
import { showScale } from "./scale";
import { connect, type Stream } from "../client/stream";
import { ProblemError, problemOf } from "../client/problem";
import { Service, type Instability, type Scene, type Session } from "../client/rest";
import { infoOf, type SceneInfo } from "../render/scene_info";
import type { Side } from "../render/framing";
import type { Theme } from "../render/shading";
import { meaning, partsOf } from "../client/parts";
import type { Hello, PlaybackState, Topology } from "../client/gen/truestep/v1/stream_pb";
import { Stage } from "../render/stage";
import { accuracyWords, type Accuracy } from "../studies/accuracy";
import { packScene, readShared, writeShared, type Shared } from "./address";
import { Compact } from "./compact";
import { byId, make } from "./dom";
import { Editor } from "./editor";
import { markScene, showGallery } from "./gallery";
import { Interaction } from "./interact";
import { Plot } from "./plot";
import { clearProblems, showProblem } from "./problems";
import { Readout } from "./readout";
import { installShortcuts } from "./shortcuts";
import { speedAtFirst, speedsFor, speedText } from "./speeds";

const kHistory = 1500; // points of a plot's past
const kAddress = 1200; // ms between two looks at what the address says
const kMarks = 5000; // pictures that leave a performance mark, for scripts/measure.mjs
const stateText = { connecting: "connecting", open: "live", waiting: "connection lost, trying again", closed: "closed" } as const;

export class App {
  private readonly service = new Service();
  private readonly canvas = byId<HTMLCanvasElement>("view");
  private readonly stage = new Stage(this.canvas);
  private readonly plot = new Plot();
  private readonly readout = new Readout();
  private readonly editor = new Editor(this.service, (scene) => this.create(scene, undefined));
  private readonly interaction: Interaction;
  private readonly speed = byId<HTMLSelectElement>("speed");
  private readonly compact = new Compact();
  private stream: Stream | undefined;
  private id: string | undefined;
  /** True for a session that this page created and therefore ends when it opens the next one. */
  private own = false;
  private playing = false;
  private readonly marks = { contacts: false, joints: false };
  private measured = 0;
  private speeds = speedsFor(undefined);
  /** Playing does not come to its speed, and the hint has said so. */
  private late = false;
  private info: SceneInfo = infoOf(undefined);
  /** The session's scene, with its defaults; undefined until it has come. */
  private scene: Scene | undefined;
  private galleryName: string | undefined;
  private packed: string | undefined;
  private time = 0;
  private ended = false;
  private filling = false;

  constructor() {
    this.interaction = new Interaction(this.stage, this.canvas, {
      send: (body) => void this.stream?.command(body).catch((error: unknown) => this.fail(error)),
      ask: async (body) => void (await this.stream?.command(body)),
      post: (body) => this.stream?.post(body),
      say: (text) => this.hint(text),
    });
    this.offerSpeeds(undefined, 1);
    this.theme((localStorage.getItem("theme") as Theme | null) ?? "dark");
    this.wire();
  }

  /** Opens what the address asks for. */
  async start(): Promise<void> {
    const query = new URLSearchParams(location.search);
    const session = query.get("session");
    const scene = query.get("gallery");
    const narrow = window.innerWidth < 720;
    this.panel(session || (scene && narrow) ? "none" : "gallery");
    const listed = this.listGallery();
    const shared = await readShared(location.hash);
    if (session) {
      await this.attempt(() => this.openSession(session, shared));
      // A session that is gone leaves nothing to look at but the way to another one.
      if (this.id === undefined) this.panel("gallery");
    } else if (scene) await this.attempt(() => this.openGallery(scene));
    await listed;
    setInterval(() => void this.measureTrip(), 2000);
    setInterval(() => this.address(), kAddress);
    void this.measureTrip();
  }

  private async listGallery(): Promise<void> {
    await this.attempt(async () => {
      const entries = await this.service.gallery();
      showGallery(
        entries,
        (name) => void this.attempt(() => this.openGallery(name)),
        (name) => void this.attempt(() => this.edit(name)),
      );
    });
  }

  private async edit(name: string): Promise<void> {
    this.editor.set((await this.service.galleryScene(name)).scene);
    this.panel("editor");
  }

  private async openGallery(name: string): Promise<void> {
    const entry = await this.service.galleryScene(name);
    await this.create(entry.scene, name);
    if (window.innerWidth < 720) this.panel("none");
  }

  /** Creates a session, shows it and plays it. Throws ProblemError when the service refuses. */
  private async create(scene: Scene, name: string | undefined, shared?: Shared): Promise<void> {
    const session = await this.service.createSession(name === undefined ? scene : { gallery: name });
    clearProblems();
    this.leave();
    this.own = true;
    this.galleryName = name;
    this.packed = undefined;
    if (name === undefined) void packScene(scene).then((text) => (this.packed = text)).catch(() => undefined);
    if (shared?.time !== undefined) await this.service.until(session.id, shared.time);
    await this.show(session);
    if (shared?.eye && shared.target) this.stage.framing.view = { eye: shared.eye, target: shared.target };
    if (name !== undefined || shared) this.editor.set(scene);
    markScene(name);
    history.replaceState(null, "", `/?session=${encodeURIComponent(session.id)}`);
    if (shared?.time !== undefined) return;
    await this.service.play(session.id, this.wanted());
  }

  /** Opens a session; one that is gone is made again if the address says how. */
  private async openSession(id: string, shared: Shared): Promise<void> {
    let session: Session;
    try {
      session = await this.service.session(id);
    } catch (error) {
      const gone = error instanceof ProblemError && [404, 410].includes(error.problem.status);
      if (!gone || (shared.gallery === undefined && shared.scene === undefined)) throw error;
      if (shared.gallery !== undefined) return this.create((await this.service.galleryScene(shared.gallery)).scene, shared.gallery, shared);
      return this.create(shared.scene!, undefined, shared);
    }
    this.leave();
    this.own = false;
    this.galleryName = shared.gallery;
    this.packed = undefined;
    await this.show(session);
    if (shared.eye && shared.target) this.stage.framing.view = { eye: shared.eye, target: shared.target };
    if (this.scene) this.editor.set(this.scene);
    markScene(this.galleryName);
    if (session.instability) this.unstable(session.instability);
    for (const { system, detail } of session.warnings ?? []) this.warn(`system "${system}": ${detail}`);
  }

  /** Ends what was on the screen. */
  private leave(): void {
    this.stream?.close();
    if (this.id !== undefined && this.own) void this.service.deleteSession(this.id).catch(() => undefined);
    this.lesson(undefined);
    this.accuracy(undefined);
    markScene(undefined);
  }

  private async show(session: Session): Promise<void> {
    this.id = session.id;
    this.scene = await this.service.sessionScene(session.id).catch(() => undefined);
    if (this.id !== session.id) return;
    this.info = infoOf(this.scene);
    this.time = Number(session.time ?? 0);
    this.ended = false;
    this.offerSpeeds(this.info.dt ?? session.dt, this.own ? speedAtFirst(this.info.dt, this.info.duration) : Number(session.speed ?? 1));
    this.stage.clear(session.viewer ?? {}, this.info);
    this.following(false);
    showScale(undefined);
    this.stage.show.colorBy = session.viewer?.color_by ?? "";
    this.plot.clear();
    this.plot.onGap = () => this.fillPlot(session.id);
    this.fillPlot(session.id);
    this.readout.clear();
    this.interaction.clear();
    this.title(session.title ?? session.name ?? "");
    const studies = byId<HTMLAnchorElement>("studies");
    studies.href = `/studies.html?session=${encodeURIComponent(session.id)}`;
    studies.querySelector("span")!.textContent = "Study this scene";
    this.lesson(session.teaches);
    this.accuracy(session.accuracy as Accuracy | undefined);
    byId("transport").hidden = false;
    document.body.classList.add("running");
    this.layout();
    this.playback(undefined);
    const stream = connect(this.service.streamUrl(session.id, location.origin), { observables: true, credit: 4, fields: (hello, topology) => this.fieldsOf(hello, topology), marks: () => this.marks });
    this.stream = stream;
    const mine = <T>(handler: (value: T) => void) => (value: T) => {
      if (this.stream === stream) handler(value);
    };
    this.connection("connecting");
    stream.on("state", mine((state) => this.connection(state)));
    stream.on("hello", mine((hello) => {
      const parts = partsOf(hello);
      this.compact.greet(hello);
      this.stage.setParts(parts);
    }));
    stream.on("topology", mine((topology) => {
      this.compact.connect(topology);
      this.stage.setTopology(topology);
      this.toggles();
    }));
    stream.on("shapes", mine((shapes) => this.stage.moveShapes(shapes)));
    stream.on("marks", mine((marks) => this.stage.setMarks(marks)));
    stream.on("playback", mine((state) => this.playback(state)));
    stream.on("observables", mine((observables) => this.plot.add(observables)));
    stream.on("problem", mine((problem) => showProblem(problem)));
    stream.on("event", mine((event) => {
      if (event.kind === "instability") void this.explain(session.id, event.detail);
      else if (/error|fail|full/.test(event.kind)) showProblem({ title: event.kind.replaceAll("_", " "), status: 0, code: event.kind, detail: event.detail });
      else if (event.kind === "warning") this.warn(event.detail);
    }));
    void this.consume(stream);
  }

  /** The session itself knows more than the event: what would have helped. */
  private async explain(id: string, detail: string): Promise<void> {
    const session = await this.service.session(id).catch(() => undefined);
    if (this.id === id) this.unstable(session?.instability ?? { detail });
  }

  private warn(detail: string): void {
    showProblem({ title: "Warning", status: 0, code: "warning", detail }, "warning");
  }

  private unstable(instability: Instability): void {
    showProblem({ title: "The simulation became unstable", status: 0, code: "instability", ...instability });
  }

  private async consume(stream: Stream): Promise<void> {
    try {
      for await (const frame of stream.frames()) {
        if (this.stream !== stream) break;
        stream.encode(this.compact.choose(frame));
        await this.stage.present(frame);
        showScale(this.stage.colorScale);
        this.time = frame.time;
        this.end();
        if (this.measured++ < kMarks) performance.mark(this.measured === 1 ? "first-picture" : "picture");
        this.interaction.follow();
        this.readout.shown(frame, stream.superseded);
      }
    } catch (error) {
      if (this.stream === stream) this.fail(error);
    }
  }

  /** Takes the past from the service: at the start, and where frames were missing. */
  private fillPlot(id: string): void {
    if (this.filling) return;
    this.filling = true;
    const done = (): void => void setTimeout(() => (this.filling = false), 1500);
    this.service.history(id, kHistory).then((history) => {
      if (this.id === id) this.plot.fill(history);
    }, () => undefined).finally(done);
  }

  /** A plot or a field that has come to the end of its scene stops there, once. */
  private end(): void {
    const { duration, dt = 0 } = this.info;
    if (!this.own || this.ended || duration === undefined || this.time < duration - 0.5 * dt || (!this.stage.plotted && !this.stage.onlyGrids)) return;
    this.ended = true;
    this.act((id) => this.service.pause(id));
    this.hint(`the end of the scene, after ${duration.toLocaleString("en-US", { maximumSignificantDigits: 4 })} s`);
  }

  /** Keeps in the address how to come back to what is on the screen. */
  private address(): void {
    if (this.id === undefined || this.stream?.state !== "open") return;
    const { framing } = this.stage;
    const hash = writeShared({ gallery: this.galleryName, packed: this.packed, time: this.time, ...(framing.held ? framing.view : {}) });
    const next = `/?session=${encodeURIComponent(this.id)}${hash}`;
    if (`${location.pathname}${location.search}${location.hash}` !== next) history.replaceState(null, "", next);
  }

  private offerSpeeds(dt: number | undefined, wanted: number): void {
    this.speeds = speedsFor(dt);
    if (!this.speeds.includes(wanted)) this.speeds = [...this.speeds, wanted].sort((a, b) => a - b);
    this.speed.replaceChildren(...this.speeds.map((value) => make("option", { value: String(value), selected: value === wanted }, speedText(value))));
  }

  private theme(theme: Theme): void {
    document.documentElement.dataset.theme = theme;
    localStorage.setItem("theme", theme);
    this.stage.setTheme(theme);
    this.plot.restyle();
    byId("theme").setAttribute("aria-pressed", String(theme === "light"));
  }

  private following(on: boolean): void {
    this.stage.framing.follow(on);
    byId("view-follow").setAttribute("aria-pressed", String(on));
  }

  private look(side: Side): void {
    this.following(false);
    this.stage.frameAll(side);
  }

  private async measureTrip(): Promise<void> {
    if (document.hidden || this.stream?.state !== "open") return;
    await this.service.roundTrip().then((ms) => this.readout.roundTrip(ms), () => undefined);
  }

  private wire(): void {
    const click = (id: string, action: () => void): void => byId(id).addEventListener("click", action);
    click("play", () => this.act((id) => (this.playing ? this.service.pause(id) : this.service.play(id, this.wanted()))));
    click("step", () => this.step(1));
    click("reset", () => this.act(async (id) => {
      await this.service.reset(id);
      this.ended = false;
      this.plot.clear();
      this.interaction.clear();
    }));
    this.speed.addEventListener("change", () => this.playing && this.act((id) => this.service.play(id, this.wanted())));
    click("camera", () => this.look("scene"));
    for (const side of ["front", "side", "top"] as const) click(`view-${side}`, () => this.look(side));
    click("view-follow", () => this.following(!this.stage.framing.following));
    click("theme", () => this.theme(document.documentElement.dataset.theme === "light" ? "dark" : "light"));
    const views = byId<HTMLDetailsElement>("views");
    document.addEventListener("pointerdown", (event) => !views.contains(event.target as Node) && (views.open = false));
    // Nobody looks any more: the session waits where it is.
    addEventListener("pagehide", () => {
      if (this.id !== undefined && this.own && this.playing) void fetch(`/v1/sessions/${encodeURIComponent(this.id)}/pause`, { method: "POST", keepalive: true, headers: { "content-type": "application/json" }, body: "{}" });
    });
    const toggle = (id: string, key: "points" | "lines" | "surface" | "bySpeed"): void =>
      click(id, () => {
        this.stage.show[key] = !this.stage.show[key];
        byId(id).setAttribute("aria-pressed", String(this.stage.show[key]));
        this.stage.applyVisibility();
        if (key === "bySpeed") this.stream?.resubscribe();
      });
    toggle("show-points", "points");
    toggle("show-lines", "lines");
    toggle("show-surface", "surface");
    toggle("show-speed", "bySpeed");
    const mark = (id: string, key: "contacts" | "joints"): void =>
      click(id, () => {
        this.marks[key] = !this.marks[key];
        byId(id).setAttribute("aria-pressed", String(this.marks[key]));
        if (!this.marks.contacts && !this.marks.joints) this.stage.setMarks(undefined);
        this.stream?.resubscribe();
      });
    mark("show-contacts", "contacts");
    mark("show-joints", "joints");
    click("show-side", () => {
      const side = byId("side");
      side.hidden = !side.hidden;
      byId("show-side").setAttribute("aria-pressed", String(!side.hidden));
      this.layout();
    });
    click("toggle-panel", () => this.panel(byId("panel").hidden ? "gallery" : "none"));
    click("close-panel", () => this.panel("none"));
    click("tab-gallery", () => this.panel("gallery"));
    click("tab-editor", () => this.panel("editor"));
    click("show-help", () => byId<HTMLDialogElement>("help").showModal());
    const layout = new ResizeObserver(() => this.layout());
    for (const id of ["app", "side", "panel"]) layout.observe(byId(id));
    installShortcuts({
      step: (steps) => this.step(steps),
      faster: (by) => this.faster(by),
      editor: () => this.panel("editor"),
      escape: () => this.panel("none"),
    });
  }

  private step(steps: number): void {
    this.act(async (id) => {
      if (this.playing) await this.service.pause(id);
      await this.service.step(id, steps);
    });
  }

  private faster(by: 1 | -1): void {
    const next = Math.min(this.speeds.length - 1, Math.max(0, this.speed.selectedIndex + by));
    this.speed.selectedIndex = next;
    this.speed.dispatchEvent(new Event("change"));
    this.hint(`speed ${speedText(this.speeds[next]!)}`);
  }

  private wanted(): number {
    return Number(this.speed.value);
  }

  private act(action: (id: string) => Promise<void>): void {
    const { id } = this;
    if (id !== undefined) void this.attempt(() => action(id));
  }

  private async attempt(action: () => Promise<void>): Promise<void> {
    try {
      await action();
    } catch (error) {
      this.fail(error);
    }
  }

  private fail(error: unknown): void {
    if (!(error instanceof ProblemError)) console.error(error);
    const problem = problemOf(error);
    // The connection line already says so, and the next attempt is under way.
    if (problem.code !== "connection_lost") showProblem(problem);
  }

  private playback(state: PlaybackState | undefined): void {
    this.playing = state?.playing ?? false;
    const button = byId("play");
    button.querySelector("use")?.setAttribute("href", this.playing ? "#i-pause" : "#i-play");
    button.setAttribute("aria-label", this.playing ? "Pause" : "Play");
    button.title = this.playing ? "Pause (Space)" : "Play (Space)";
    if (!state || state.speed <= 0) return;
    if (!state.playing) return;
    if (!this.speeds.includes(state.speed)) this.offerSpeeds(this.info.dt, state.speed);
    this.speed.value = String(state.speed);
    const late = state.achievedSpeed > 0 && state.achievedSpeed < 0.9 * state.speed;
    const comesTo = `${Number(state.achievedSpeed.toPrecision(2))}x`;
    this.speed.title = late ? `The service is at its limit: ${comesTo} is what it comes to` : "";
    if (late && !this.late) this.hint(`the service is at its limit: ${comesTo}`);
    this.late = late;
  }

  /** Shows only the switches that do something in this scene. */
  private toggles(): void {
    const { points, lines, surface, bodies } = this.stage.has;
    byId("show-points").hidden = !points;
    byId("show-speed").hidden = !points && !((bodies || lines) && this.stage.show.colorBy);
    byId("show-contacts").hidden = byId("show-joints").hidden = !bodies;
    byId("show-lines").hidden = !lines;
    byId("show-surface").hidden = !surface;
  }

  private panel(which: "gallery" | "editor" | "none"): void {
    byId("panel").hidden = which === "none";
    byId("gallery").hidden = which !== "gallery";
    byId("editor").hidden = which !== "editor";
    byId("tab-gallery").setAttribute("aria-selected", String(which === "gallery"));
    byId("tab-editor").setAttribute("aria-selected", String(which === "editor"));
    byId("app").dataset.panel = which;
    if (which === "editor") byId("scene-text").focus({ preventScroll: true });
    this.layout();
  }

  /** Tells the stage which part of the picture the panels leave free. */
  private layout(): void {
    const box = (id: string): DOMRect => byId(id).getBoundingClientRect();
    const panel = box("panel");
    const side = box("side");
    const bottom = box("transport").height > 0 ? 90 : 0;
    const running = document.body.classList.contains("running");
    if (window.innerWidth <= 720) {
      this.stage.setInset({ left: 0, right: 0, top: running && side.height > 0 ? side.bottom : 56, bottom: running ? Math.max(panel.height, bottom) : 0 });
    } else {
      this.stage.setInset({ left: running && panel.width > 0 ? panel.right : 0, right: running && side.width > 0 ? window.innerWidth - side.left : 0, top: 50, bottom });
    }
  }

  private title(text: string): void {
    byId("title").textContent = text;
    document.title = text ? `${text} · Truestep` : "Truestep";
  }

  private lesson(text: string | undefined): void {
    const lesson = byId("lesson");
    lesson.hidden = !text;
    lesson.textContent = text ?? "";
  }

  /** Which method a requested accuracy led to. */
  private accuracy(report: Accuracy | undefined): void {
    const line = byId("accuracy");
    line.hidden = !report;
    line.textContent = report ? accuracyWords(report) : "";
  }

  private connection(state: keyof typeof stateText): void {
    const line = byId("connection");
    line.dataset.state = state;
    line.querySelector("span")!.textContent = stateText[state];
  }

  private hintTimer: ReturnType<typeof setTimeout> | undefined;
  private hint(text: string): void {
    const hint = byId("hint");
    hint.textContent = text;
    hint.hidden = false;
    clearTimeout(this.hintTimer);
    this.hintTimer = setTimeout(() => (hint.hidden = true), 1600);
  }

  /**
   * Position; where rows carry bodies also orientation and who sleeps; and for points what the scene colours them
   * by, or their speed if they have no colour of their own.
   */
  private fieldsOf(hello: Hello, topology: Topology | undefined): string[] {
    const { colorBy, bySpeed } = this.stage.show;
    const parts = partsOf(hello);
    const wanted = new Set<string>();
    const want = (name: string | undefined): void => void (name && wanted.add(name));
    for (const drawn of topology?.systems ?? []) {
      const part = parts.get(drawn.system);
      const has = (name: string): string | undefined => (name && part?.fields.some((field) => field.name === name) ? name : undefined);
      const bodies = drawn.visuals.length > 0;
      want(meaning(part, "position"));
      if (part?.lattice) want(has(colorBy) ?? part.fields[0]?.name);
      if (bodies) for (const what of ["orientation", "asleep"]) want(meaning(part, what));
      const colored = (drawn.pointRadius > 0 && (colorBy || drawn.color.length === 0)) || (bodies && colorBy);
      if (bySpeed && colored) want(has(colorBy) ?? has("speed") ?? meaning(part, "velocity"));
      // A system's lines have values in a part of their own.
      const lines = [...parts.values()].find((one) => one.elements === "lines" && one.system === drawn.system);
      if (bySpeed && colorBy && lines?.fields.some((field) => field.name === colorBy)) want(colorBy);
    }
    return [...wanted];
  }
}
