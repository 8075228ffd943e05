// The viewer as a whole: which session is on the screen, and what the buttons do to it.
import { showScale } from "./scale";
import { connect, type Stream } from "../client/stream";
import { ProblemError, problemOf } from "../client/problem";
import { Service, type Instability, type Scene, type Session } from "../client/rest";
import { infoOf, type SceneInfo } from "../render/scene_info";
import type { Side } from "../render/framing";
import type { Theme } from "../render/shading";
import { partsOf } from "../client/parts";
import type { PlaybackState } from "../client/gen/truestep/v1/stream_pb";
import { Stage } from "../render/stage";
import type { Accuracy } from "../studies/accuracy";
import { packScene, readShared, writeShared, type Shared } from "./address";
import { Compact } from "./compact";
import { installControls, type Controls } from "./controls";
import { byId } from "./dom";
import { Editor } from "./editor";
import { fieldsOf } from "./fields";
import { markScene, showGallery } from "./gallery";
import { Interaction } from "./interact";
import { Page } from "./page";
import { Plot } from "./plot";
import { clearProblems, dismissProblems, showProblem } from "./problems";
import { Readout } from "./readout";
import { installShortcuts } from "./shortcuts";
import { SpeedChoice } from "./speed_choice";
import { speedAtFirst } from "./speeds";
import { Timeline } from "./timeline";

const kHistory = 1500; // points of a plot's past
const kAddress = 1200; // ms between two updates of the address
const kMarks = 5000; // pictures that leave a performance mark, for scripts/measure.mjs

export class App {
  private readonly service = new Service();
  private readonly canvas = byId<HTMLCanvasElement>("view");
  private readonly stage = new Stage(this.canvas);
  private readonly page = new Page(this.stage);
  private readonly plot = new Plot();
  private readonly readout = new Readout();
  private readonly editor = new Editor(this.service, (scene) => this.create(scene, undefined));
  private readonly interaction: Interaction;
  private readonly speed = new SpeedChoice();
  private readonly compact = new Compact();
  private readonly timeline = new Timeline((time) => this.act((id) => this.seek(id, time)), (text) => this.page.hint(text));
  private stream: Stream | undefined;
  private id: string | undefined;
  /** True for a session that this page created and therefore ends when it opens the next one. */
  private own = false;
  private playing = false;
  private readonly marks = { contacts: false, joints: false };
  private measured = 0;
  private info: SceneInfo = infoOf(undefined);
  /** The session's scene, with its defaults; undefined until it has been received. */
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
      say: (text) => this.page.hint(text),
    });
    this.speed.offer(undefined, 1);
    this.theme((localStorage.getItem("theme") as Theme | null) ?? "dark");
    this.wire();
  }

  /** Opens what the address refers to. */
  async start(): Promise<void> {
    const query = new URLSearchParams(location.search);
    const session = query.get("session");
    const scene = query.get("gallery");
    const narrow = window.innerWidth < 720;
    this.page.panel(session || (scene && narrow) ? "none" : "gallery");
    const listed = this.listGallery();
    const shared = await readShared(location.hash);
    if (session) {
      await this.attempt(() => this.openSession(session, shared));
      // If the session is gone, all that is left is to choose another one.
      if (this.id === undefined) this.page.panel("gallery");
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
    this.page.panel("editor");
  }

  private async openGallery(name: string): Promise<void> {
    const entry = await this.service.galleryScene(name);
    await this.create(entry.scene, name);
    if (window.innerWidth < 720) this.page.panel("none");
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
    await this.service.play(session.id, this.speed.value);
  }

  /** Opens a session; one that is gone is recreated if the address says how. */
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

  private leave(): void {
    this.stream?.close();
    if (this.id !== undefined && this.own) void this.service.deleteSession(this.id).catch(() => undefined);
    this.page.lesson(undefined);
    this.page.accuracy(undefined);
    markScene(undefined);
  }

  private async show(session: Session): Promise<void> {
    this.id = session.id;
    this.scene = await this.service.sessionScene(session.id).catch(() => undefined);
    if (this.id !== session.id) return;
    this.info = infoOf(this.scene);
    this.time = Number(session.time ?? 0);
    this.ended = false;
    this.speed.offer(this.info.dt ?? session.dt, this.own ? speedAtFirst(this.info.dt, this.info.duration) : Number(session.speed ?? 1));
    this.stage.clear(session.viewer ?? {}, this.info);
    this.following(false);
    showScale(undefined);
    this.stage.show.colorBy = session.viewer?.color_by ?? "";
    this.timeline.offer(this.info.duration, this.info.dt);
    this.plot.clear(this.info.observables);
    this.plot.onGap = () => this.fillPlot(session.id);
    this.fillPlot(session.id);
    this.readout.clear();
    this.interaction.clear();
    this.page.title(session.title ?? session.name ?? "");
    const studies = byId<HTMLAnchorElement>("studies");
    studies.href = `/studies.html?session=${encodeURIComponent(session.id)}`;
    studies.querySelector("span")!.textContent = "Study this scene";
    this.page.lesson(session.teaches);
    this.page.accuracy(session.accuracy as Accuracy | undefined);
    byId("transport").hidden = false;
    document.body.classList.add("running");
    this.page.layout();
    this.playback(undefined);
    const stream = connect(this.service.streamUrl(session.id, location.origin), { observables: true, credit: 4, fields: (hello, topology) => fieldsOf(this.stage.show, hello, topology), marks: () => this.marks });
    this.stream = stream;
    const mine = <T>(handler: (value: T) => void) => (value: T) => {
      if (this.stream === stream) handler(value);
    };
    this.page.connection("connecting");
    stream.on("state", mine((state) => {
      this.page.connection(state);
      if (state === "open") dismissProblems("unreachable");
      if (state === "closed") this.playback(undefined);
    }));
    stream.on("hello", mine((hello) => {
      const parts = partsOf(hello);
      this.compact.greet(hello);
      this.stage.setParts(parts);
    }));
    stream.on("topology", mine((topology) => {
      this.compact.connect(topology);
      this.stage.setTopology(topology);
      this.page.toggles();
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

  /** The session knows more than the event: what would have helped. */
  private async explain(id: string, detail: string): Promise<void> {
    const session = await this.service.session(id).catch(() => undefined);
    if (this.id === id) this.unstable(session?.instability ?? { detail });
  }

  private readonly warn = (detail: string): void => showProblem({ title: "Warning", status: 0, code: "warning", detail }, "warning");

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
        this.timeline.shown(frame.time);
        this.end();
        if (this.measured++ < kMarks) performance.mark(this.measured === 1 ? "first-picture" : "picture");
        this.interaction.follow();
        this.readout.shown(frame, stream.superseded);
      }
    } catch (error) {
      if (this.stream === stream) this.fail(error);
    }
  }

  /** Fetches earlier samples from the service: at the start, and where frames are missing. */
  private fillPlot(id: string): void {
    if (this.filling) return;
    this.filling = true;
    const done = (): void => void setTimeout(() => (this.filling = false), 1500);
    this.service.history(id, kHistory).then((history) => {
      if (this.id === id) this.plot.fill(history);
    }, () => undefined).finally(done);
  }

  /** Pauses a plot or field once at the end of its scene. */
  private end(): void {
    const { duration, dt = 0 } = this.info;
    if (!this.own || this.ended || duration === undefined || this.time < duration - 0.5 * dt || (!this.stage.plotted && !this.stage.onlyGrids)) return;
    this.ended = true;
    this.act((id) => this.service.pause(id));
    this.page.hint(`the end of the scene, after ${duration.toLocaleString("en-US", { maximumSignificantDigits: 4 })} s`);
  }

  /** Keeps in the address how to return to what is on the screen. */
  private address(): void {
    if (this.id === undefined || this.stream?.state !== "open") return;
    const { framing } = this.stage;
    const hash = writeShared({ gallery: this.galleryName, packed: this.packed, time: this.time, ...(framing.held ? framing.view : {}) });
    const next = `/?session=${encodeURIComponent(this.id)}${hash}`;
    if (`${location.pathname}${location.search}${location.hash}` !== next) history.replaceState(null, "", next);
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
    this.speed.onChange(() => this.playing && this.act((id) => this.service.play(id, this.speed.value)));
    const controls: Controls = {
      playOrPause: () => this.act((id) => (this.playing ? this.service.pause(id) : this.service.play(id, this.speed.value))),
      step: () => this.step(1),
      reset: () => this.act(async (id) => {
        await this.service.reset(id);
        this.ended = false;
        this.plot.clear(this.info.observables);
        this.interaction.clear();
      }),
      look: (side) => this.look(side),
      follow: () => this.following(!this.stage.framing.following),
      theme: () => this.theme(document.documentElement.dataset.theme === "light" ? "dark" : "light"),
      shown: (key) => {
        this.stage.applyVisibility();
        if (key === "bySpeed") this.stream?.resubscribe();
      },
      marked: () => {
        if (!this.marks.contacts && !this.marks.joints) this.stage.setMarks(undefined);
        this.stream?.resubscribe();
      },
      panel: (which) => this.page.panel(which),
      layout: () => this.page.layout(),
      // The session is paused where it is.
      left: () => {
        if (this.id !== undefined && this.own && this.playing) void fetch(`/v1/sessions/${encodeURIComponent(this.id)}/pause`, { method: "POST", keepalive: true, headers: { "content-type": "application/json" }, body: "{}" });
      },
    };
    installControls(controls, this.stage.show, this.marks);
    installShortcuts({
      step: (steps) => this.step(steps),
      faster: (by) => this.page.hint(this.speed.next(by)),
      editor: () => this.page.panel("editor"),
      escape: () => this.page.panel("none"),
    });
  }

  private step(steps: number): void {
    this.act(async (id) => {
      if (this.playing) await this.service.pause(id);
      await this.service.step(id, steps);
    });
  }

  private act(action: (id: string) => Promise<void>): void {
    const { id } = this;
    if (id === undefined) return;
    void this.attempt(() => (this.stream?.state === "closed" ? this.revive() : action(id)));
  }

  private async seek(id: string, time: number): Promise<void> {
    this.ended = false;
    await this.service.seek(id, time);
  }

  /** Makes a session again that has ended under the page, where it was, and plays it. */
  private async revive(): Promise<void> {
    if (!this.scene) throw new ProblemError({ title: "The session has ended", status: 0, code: "session_ended", detail: "choose a scene again" });
    this.own = false;
    await this.create(this.scene, this.galleryName, { time: this.time, ...(this.stage.framing.held ? this.stage.framing.view : {}) });
    await this.service.play(this.id!, this.speed.value);
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
    if (!state?.playing || state.speed <= 0) return;
    const hint = this.speed.playing(state.speed, state.achievedSpeed, this.info.dt);
    if (hint) this.page.hint(hint);
  }
}
