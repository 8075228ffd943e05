// The viewer as a whole: which session is on the screen, and what the buttons do to it.
import { ProblemError, type Problem } from "../client/problem";
import { Service, type Instability, type Scene, type Session } from "../client/rest";
import type { PlaybackState } from "../client/gen/truestep/v1/stream_pb";
import { infoOf, withStep, type SceneInfo } from "../render/scene_info";
import { Stage } from "../render/stage";
import type { Accuracy } from "../studies/accuracy";
import { packScene, readAddress, unpackScene, writeAddress, type Asked, type Shown } from "./address/address";
import { forgetRun, keepRun, keptRun, writeEntry } from "./address/kept";
import { Neighbours } from "./address/neighbours";
import { installShare, linksOf } from "./address/share";
import { installControls, showPlaying, type Controls } from "./controls";
import { byId } from "./dom";
import { Editor } from "./editor";
import { markScene, showGallery } from "./gallery";
import { Interaction } from "./interact";
import { Live } from "./live";
import { Look } from "./look";
import { Page } from "./page";
import { Past } from "./past";
import { Plot } from "./plot";
import { clearProblems, dismissProblems, type Action } from "./problems";
import { Readout } from "./readout";
import { Recorder } from "./recorder";
import { fail, tell, unstable, warn } from "./reports";
import { showScale } from "./scale";
import { installShortcuts } from "./shortcuts";
import { SpeedChoice } from "./speed_choice";
import { speedAtFirst } from "./speeds";
import { Timeline } from "./timeline";
import { measureTrips } from "../client/trips";

const kAddress = 1200; // ms between two updates of the address

/** What this page may do to its session: it made it, and ends it when it opens the next one; it was given it; it follows it. */
type Hold = "own" | "shared" | "watched";

export class App {
  private readonly service = new Service();
  private readonly canvas = byId<HTMLCanvasElement>("view");
  private readonly stage = new Stage(this.canvas);
  private readonly page = new Page(this.stage);
  private readonly plot = new Plot();
  private readonly look = new Look(this.stage, this.plot);
  private readonly readout = new Readout();
  private readonly marks = { contacts: false, joints: false };
  private readonly live = new Live({ stage: this.stage, page: this.page, plot: this.plot, readout: this.readout, marks: this.marks });
  private readonly editor = new Editor(this.service, (scene) => this.create(scene, undefined));
  private readonly interaction: Interaction;
  private readonly speed = new SpeedChoice();
  private readonly neighbours = new Neighbours();
  private readonly recorder = new Recorder(this.service, (action) => this.attempt(action), (text) => this.page.hint(text));
  private readonly past = new Past((id, points) => this.service.history(id, points));
  private readonly timeline = new Timeline((time) => this.act((id) => this.seek(id, time)), (text) => this.page.hint(text));
  private id: string | undefined;
  private hold: Hold = "shared";
  private playing = false;
  private info: SceneInfo = infoOf(undefined);
  /** The session's scene, with its defaults; undefined until it has been received. */
  private scene: Scene | undefined;
  private galleryName: string | undefined;
  private packed: string | undefined;
  private time = 0;
  private ended = false;
  /** s; where the session became unstable, until it has left that state. */
  private stoppedAt: number | undefined;

  constructor() {
    this.interaction = new Interaction(this.stage, this.canvas, {
      send: (body) => void this.live.command(body).catch((error: unknown) => fail(error)),
      ask: (body) => this.live.command(body),
      post: (body) => this.live.post(body),
      say: (text) => this.page.hint(text),
    });
    this.speed.offer(undefined, 1);
    this.wire();
  }

  /** Opens what the address refers to. */
  async start(): Promise<void> {
    const asked = readAddress(location.search, location.hash);
    const narrow = window.innerWidth < 720;
    const one = asked.watch ?? asked.session ?? asked.packed ?? asked.time ?? keptRun(undefined);
    this.page.panel(one !== undefined || (asked.gallery !== undefined && narrow) ? "none" : "gallery");
    const listed = this.listGallery();
    await this.attempt(() => this.openAddress());
    // If nothing was opened, all that is left is to choose.
    if (this.id === undefined) this.page.panel("gallery");
    await listed;
    markScene(this.galleryName);
    addEventListener("hashchange", () => void this.attempt(() => this.openAddress()));
    measureTrips(this.service, () => this.live.state === "open", (ms) => this.readout.roundTrip(ms));
    setInterval(() => this.live.state === "open" && this.address(), kAddress);
  }

  private async openAddress(): Promise<void> {
    const asked = readAddress(location.search, location.hash);
    if (asked.watch !== undefined) return this.openSession(asked.watch, "watched", asked);
    const run = keptRun(asked.session);
    if (run && !(await this.neighbours.taken(run.session))) return this.openSession(run.session, "own", { ...asked, ...run } as Asked);
    if (asked.session !== undefined) return this.openSession(asked.session, "shared", asked);
    return this.make(asked);
  }

  /** Makes the run that an address describes. */
  private async make(asked: Asked): Promise<void> {
    if (asked.gallery !== undefined) return this.create((await this.service.galleryScene(asked.gallery)).scene, asked.gallery, asked);
    if (asked.packed === undefined) return;
    return this.create(await unpackScene(asked.packed), undefined, asked);
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
  private async create(scene: Scene, name: string | undefined, asked: Asked = {}): Promise<void> {
    const session = await this.service.createSession(name === undefined ? scene : { gallery: name });
    const packed = name === undefined ? await packScene(scene).catch(() => undefined) : undefined;
    clearProblems();
    this.leave();
    this.hold = "own";
    this.galleryName = name;
    this.packed = packed;
    keepRun({ session: session.id, gallery: name, packed });
    await this.show(session, true);
    this.view(asked);
    if (name !== undefined || asked.packed !== undefined) this.editor.set(scene);
    markScene(name);
    this.address();
    if (asked.time === undefined) return this.service.play(session.id, this.speed.value);
    return this.service.until(session.id, asked.time);
  }

  /** Opens a session; one that is gone is made again if the address says how, but for those who watch. */
  private async openSession(id: string, hold: Hold, asked: Asked): Promise<void> {
    let session: Session;
    try {
      session = await this.service.session(id);
    } catch (error) {
      const gone = error instanceof ProblemError && [404, 410].includes(error.problem.status);
      const known = asked.gallery !== undefined || asked.packed !== undefined;
      if (gone && hold === "own") forgetRun(id);
      if (!gone || hold === "watched" || (hold === "shared" && !known)) throw error;
      return this.make(asked);
    }
    this.leave();
    this.hold = hold;
    this.galleryName = asked.gallery;
    this.packed = asked.packed;
    await this.show(session, false);
    this.view(asked);
    if (this.scene) this.editor.set(this.scene);
    markScene(this.galleryName);
    this.address();
    if (session.instability) this.unstable(session.instability);
    for (const { system, detail } of session.warnings ?? []) warn(`system "${system}": ${detail}`);
  }

  private view({ eye, target }: Asked): void {
    if (eye && target) this.stage.framing.view = { eye, target };
  }

  private leave(): void {
    this.live.close();
    this.past.forget();
    if (this.id !== undefined && this.hold === "own") {
      forgetRun(this.id);
      if (!this.neighbours.share(this.id)) void this.service.deleteSession(this.id).catch(() => undefined);
    }
    this.page.lesson(undefined);
    this.page.accuracy(undefined);
    markScene(undefined);
  }

  /** Shows a session; `fresh`: it was made just now. */
  private async show(session: Session, fresh: boolean): Promise<void> {
    const watched = this.hold === "watched";
    this.id = session.id;
    // Who only watches does not keep a session from ending.
    this.neighbours.show(watched ? undefined : session.id);
    this.interaction.enabled = !watched;
    this.page.watching(watched);
    this.scene = await this.service.sessionScene(session.id).catch(() => undefined);
    if (this.id !== session.id) return;
    this.info = infoOf(this.scene);
    this.time = Number(session.time ?? 0);
    this.ended = this.atEnd();
    this.stoppedAt = undefined;
    // One that was made by a request and has not run is watched for the first time, too.
    const first = fresh || (!session.step && session.status === "paused" && Number(session.speed ?? 1) === 1);
    this.speed.offer(this.info.dt ?? session.dt, first ? speedAtFirst(this.info.dt, this.info.duration) : Number(session.speed ?? 1));
    this.stage.clear(session.viewer ?? {}, this.info);
    this.look.following(false);
    showScale(undefined);
    // As in pictures: colours show values where the scene names a field.
    this.stage.show.colorBy = session.viewer?.color_by ?? "";
    this.stage.show.bySpeed = this.stage.show.colorBy !== "";
    this.timeline.offer(this.info.duration, this.info.dt);
    this.plot.clear(this.info.observables);
    const fill = (): void => this.past.request(session.id, (history) => this.id === session.id && this.plot.fill(history));
    this.plot.onGap = fill;
    fill();
    this.readout.duration = this.info.duration;
    this.readout.clear();
    this.interaction.clear();
    this.page.title(session.title ?? session.name ?? "");
    this.recorder.show(session);
    const studies = byId<HTMLAnchorElement>("studies");
    studies.href = `/studies.html?session=${encodeURIComponent(session.id)}`;
    studies.querySelector("span")!.textContent = "Study this scene";
    this.page.lesson(session.teaches);
    this.page.accuracy(session.accuracy as Accuracy | undefined);
    byId("transport").hidden = false;
    document.body.classList.add("running");
    this.page.layout();
    this.playback(undefined);
    this.live.open(this.service.streamUrl(session.id, location.origin), {
      state: (state) => {
        if (state === "open") dismissProblems("unreachable");
        if (state === "closed") this.playback(undefined);
      },
      playback: (state) => this.playback(state),
      event: (event) => {
        if (event.kind === "instability") void this.explain(session.id, event.detail);
        else if (event.kind.startsWith("recording")) void this.attempt(() => this.recorder.look());
        tell(event);
      },
      shown: (frame) => {
        if (this.stoppedAt !== undefined && frame.time < this.stoppedAt - 0.5 * (this.info.dt ?? 0)) this.recovered();
        this.time = frame.time;
        this.timeline.shown(frame.time);
        this.end();
        this.interaction.follow();
      },
      failed: (error) => fail(error),
    });
  }

  /** The session knows more than the event: what would have helped. */
  private async explain(id: string, detail: string): Promise<void> {
    const session = await this.service.session(id).catch(() => undefined);
    if (this.id === id) this.unstable(session?.instability ?? { detail });
  }

  /** The session has stopped at its last good step: from there it can only go back. */
  private unstable(instability: Instability): void {
    const { suggested_dt: dt } = instability;
    const { scene } = this;
    const watched = this.hold === "watched";
    const actions: Action[] = watched ? [] : [{ label: "Start again", run: () => this.reset() }];
    const shorter = dt && Number(dt.toPrecision(4));
    if (scene && shorter && !watched) actions.push({ label: `Start with a step of ${shorter} s`, run: () => void this.attempt(() => this.create(withStep(scene, shorter), undefined)) });
    unstable(instability, actions);
    this.stoppedAt = this.time;
  }

  private reset(): void {
    this.act(async (id) => {
      await this.service.reset(id);
      this.recovered();
      this.ended = false;
      this.plot.clear(this.info.observables);
      this.interaction.clear();
    });
  }

  /** The session is no longer where it became unstable. */
  private recovered(): void {
    this.stoppedAt = undefined;
    dismissProblems("instability");
  }

  private fail(error: unknown): void {
    if (error instanceof ProblemError && error.problem.code === "instability") this.unstable(error.problem as Problem & Instability);
    else fail(error);
  }

  private atEnd(): boolean {
    const { duration, dt = 0 } = this.info;
    return duration !== undefined && this.time >= duration - 0.5 * dt;
  }

  /** Pauses the page's own run once at the end of its scene; played again, it goes on. */
  private end(): void {
    if (this.hold !== "own" || this.ended || !this.atEnd()) return;
    this.ended = true;
    this.act((id) => this.service.pause(id));
    this.page.hint(`the end of the scene, after ${this.info.duration!.toLocaleString("en-US", { maximumSignificantDigits: 4 })} s`);
  }

  /** Keeps in the address how to return to what is on the screen: for the page's own run, how to make it. */
  private address(): void {
    const { id, hold } = this;
    if (id !== undefined) writeEntry(id, writeAddress({ ...(hold === "own" ? {} : { [hold === "watched" ? "watch" : "session"]: id }), ...this.shown() }));
  }

  private shown(): Shown {
    const { framing } = this.stage;
    return { gallery: this.galleryName, packed: this.packed, time: this.time, ...(framing.held ? framing.view : {}) };
  }

  private wire(): void {
    this.speed.onChange(() => this.playing && this.act((id) => this.service.play(id, this.speed.value)));
    const controls: Controls = {
      playOrPause: () => this.act((id) => (this.playing ? this.service.pause(id) : this.service.play(id, this.speed.value))),
      step: () => this.step(1),
      reset: () => this.reset(),
      look: (side) => this.look.from(side),
      follow: () => this.look.following(!this.stage.framing.following),
      theme: () => this.look.otherTheme(),
      shown: (key) => {
        this.stage.applyVisibility();
        if (key === "bySpeed") this.live.resubscribe();
      },
      marked: () => {
        if (!this.marks.contacts && !this.marks.joints) this.stage.setMarks(undefined);
        this.live.resubscribe();
      },
      panel: (which) => this.page.panel(which),
      layout: () => this.page.layout(),
      // The session is paused where it is.
      left: () => {
        this.neighbours.show(undefined);
        if (this.id !== undefined && this.hold === "own" && this.playing && !this.neighbours.share(this.id)) void fetch(`/v1/sessions/${encodeURIComponent(this.id)}/pause`, { method: "POST", keepalive: true, headers: { "content-type": "application/json" }, body: "{}" });
      },
    };
    installControls(controls, this.stage.show, this.marks);
    installShare(async () => (this.id === undefined ? undefined : linksOf(this.id, this.scene, this.shown())), (text) => this.page.hint(text));
    installShortcuts({
      step: (steps) => this.step(steps),
      faster: (by) => this.hold !== "watched" && this.page.hint(this.speed.next(by)),
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
    if (id === undefined || this.hold === "watched") return;
    void this.attempt(() => (this.live.state === "closed" ? this.revive() : action(id)));
  }

  private async seek(id: string, time: number): Promise<void> {
    this.ended = false;
    await this.service.seek(id, time);
  }

  /** Makes a session again that has ended under the page, where it was, and plays it. */
  private async revive(): Promise<void> {
    if (!this.scene) throw new ProblemError({ title: "The session has ended", status: 0, code: "session_ended", detail: "choose a scene again" });
    this.hold = "shared"; // there is nothing left to end
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

  private playback(state: PlaybackState | undefined): void {
    this.playing = state?.playing ?? false;
    showPlaying(this.playing);
    if (!state?.playing || state.speed <= 0) return;
    const hint = this.speed.playing(state.speed, state.achievedSpeed, this.info.dt);
    if (hint) this.page.hint(hint);
  }
}
