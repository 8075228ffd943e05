// The page of studies: choose a question and a scene, start, follow, read.
import { ProblemError, problemOf, type Problem } from "../client/problem";
import { Service, type GalleryEntry, type Scene } from "../client/rest";
import type { Operation, StudyKind } from "../client/studies";
import { watch } from "../client/watch";
import { byId, make } from "../ui/dom";
import { clearProblems, showProblem } from "../ui/problems";
import { Form, type Offers } from "./form";
import { readDraft, systemsOf, type Draft } from "./form_model";
import { Outcome } from "./outcome";
import { questionOf, titleOf } from "./words";

const kOwn = ":own"; // choice of the session's scene; no gallery name starts with a colon
const kEarlier = 6;
const needsMethods = new Set(["work_precision", "convergence", "stability"]);

export class StudyPage {
  private readonly service = new Service();
  private readonly draft: Draft = new Map();
  private readonly form = new Form(byId("fields"), this.draft);
  private readonly outcome = new Outcome();
  private readonly scenes = byId<HTMLSelectElement>("scene");
  private kinds: StudyKind[] = [];
  private gallery: GalleryEntry[] = [];
  /** The scene of the session that this page was opened from. */
  private own: Scene | undefined;
  private scene: Scene | undefined;
  private current: Operation | undefined;
  private stop: () => void = () => undefined;
  private chosen = 0;
  private refused = false;

  async start(): Promise<void> {
    const query = new URLSearchParams(location.search);
    const session = query.get("session");
    if (session) {
      byId<HTMLAnchorElement>("back").href = `/?session=${encodeURIComponent(session)}`;
      byId("back-text").textContent = "Back to the scene";
    }
    byId<HTMLFormElement>("study-form").addEventListener("submit", (event) => {
      event.preventDefault();
      void this.attempt(() => this.begin());
    });
    this.scenes.addEventListener("change", () => void this.attempt(() => this.chooseScene()));
    byId("cancel").addEventListener("click", () => void this.attempt(() => this.cancel()));
    await this.attempt(async () => {
      // If the session has ended, the gallery is left to choose from.
      const own = session ? this.attempt(async () => { this.own = await this.service.sessionScene(session); }) : undefined;
      [this.kinds, this.gallery] = await Promise.all([this.service.studies(), this.service.gallery(), own]);
      this.listKinds(query.get("kind") ?? "");
      this.listScenes(query.get("gallery") ?? "");
      await this.chooseScene();
    });
    const operation = query.get("operation");
    if (operation) await this.attempt(async () => this.open(await this.service.operation(operation)));
    await this.listEarlier();
  }

  private listKinds(wanted: string): void {
    const first = this.kinds.some((kind) => kind.kind === wanted) ? wanted : this.kinds[0]?.kind;
    byId("kinds").replaceChildren(
      ...this.kinds.map((kind) => make("label", { class: "kind" }, make("input", { type: "radio", name: "kind", value: kind.kind, checked: kind.kind === first, onchange: () => void this.attempt(() => this.showForm()) }), make("span", {}, make("b", {}, titleOf(kind.kind)), make("small", {}, questionOf(kind.kind, kind.sentence))))),
    );
  }

  private listScenes(wanted: string): void {
    const own = this.own ? [make("option", { value: kOwn }, `${this.own.title ?? this.own.name ?? "The scene"} (from your session)`)] : [];
    this.scenes.replaceChildren(...own, ...this.gallery.map((entry) => make("option", { value: entry.name }, entry.title || entry.name)));
    if (this.gallery.some((entry) => entry.name === wanted)) this.scenes.value = wanted;
  }

  private async chooseScene(): Promise<void> {
    const mine = ++this.chosen;
    const name = this.scenes.value;
    const scene = name === kOwn ? this.own : name === "" ? undefined : (await this.service.galleryScene(name)).scene;
    // Another scene was chosen while this one was loading.
    if (mine !== this.chosen) return;
    this.scene = scene;
    const entry = this.gallery.find((one) => one.name === name);
    byId("scene-about").textContent = entry?.teaches ?? entry?.description ?? (scene?.teaches as string | undefined) ?? "";
    const picture = byId<HTMLImageElement>("scene-picture");
    picture.hidden = !entry?.thumbnail;
    if (entry?.thumbnail) picture.src = entry.thumbnail;
    await this.showForm();
  }

  private async showForm(): Promise<void> {
    const mine = this.chosen;
    const kind = this.kind();
    if (!kind) return;
    // The first system whose method can be chosen, as in the service.
    const types = [...new Set(systemsOf(this.scene).map((system) => system.type))];
    const all = await Promise.all(types.map((type) => this.service.methods(type).catch(() => [])));
    if (mine !== this.chosen) return;
    const methods = all.find((some) => some.length > 0) ?? [];
    this.refuse(needsMethods.has(kind.kind) && this.scene !== undefined && methods.length === 0
      ? `This question compares methods of time integration, and ${types.join(" and ")} ${types.length === 1 ? "has" : "have"} a solver of ${types.length === 1 ? "its" : "their"} own. Use a parameter sweep for this scene.` : "");
    const quantities = ["energy.total", ...(this.scene?.expect ?? []).map((expectation) => expectation.quantity)];
    const offers: Offers = { methods, quantities: [...new Set(quantities)], ...(this.scene ? { scene: this.scene } : {}) };
    this.form.show(kind.parameters, offers);
  }

  /** Says why this question cannot be asked of this scene; "" allows it to start. */
  private refuse(reason: string): void {
    const note = byId("not-offered");
    note.hidden = reason === "";
    note.textContent = reason;
    this.refused = reason !== "";
    byId<HTMLButtonElement>("start").disabled = this.refused || byId("outcome").getAttribute("aria-busy") === "true";
  }

  private kind(): StudyKind | undefined {
    const value = byId("kinds").querySelector<HTMLInputElement>("input:checked")?.value;
    return this.kinds.find((kind) => kind.kind === value);
  }

  private async begin(): Promise<void> {
    const kind = this.kind();
    if (!kind) return;
    clearProblems();
    this.form.mark([]);
    const scene = this.scenes.value === kOwn ? { scene: this.own } : { gallery: this.scenes.value };
    this.busy(true);
    try {
      this.follow(await this.service.startStudy({ kind: kind.kind, ...scene, ...readDraft(kind.parameters, this.draft) }));
    } catch (error) {
      this.busy(false);
      throw error;
    }
    byId("outcome").scrollIntoView({ block: "start" });
  }

  /** Shows an earlier study, with the form set to its kind and scene. */
  private async open(operation: Operation): Promise<void> {
    this.follow(operation);
    const radio = byId("kinds").querySelector<HTMLInputElement>(`input[value="${CSS.escape(operation.kind)}"]`);
    if (radio) radio.checked = true;
    const scene = String(operation.summary?.scene ?? "").replaceAll(" ", "_");
    if (this.gallery.some((entry) => entry.name === scene)) this.scenes.value = scene;
    await this.chooseScene();
  }

  private follow(operation: Operation): void {
    this.stop();
    this.current = operation;
    const query = new URLSearchParams(location.search);
    query.set("operation", operation.id);
    history.replaceState(null, "", `?${query}`);
    this.busy(true);
    this.outcome.show("progress");
    this.outcome.progress(operation);
    this.stop = watch(this.service, operation, {
      changed: (next) => void this.attempt(() => this.changed(next)),
      failed: (error) => {
        this.idle();
        this.fail(error);
      },
    });
  }

  private async changed(operation: Operation): Promise<void> {
    this.outcome.progress(operation);
    if (operation.status === "waiting" || operation.status === "running") return;
    if (operation.status === "done") {
      const result = await this.service.studyResult(operation.id).finally(() => this.busy(false));
      if (this.current?.id === operation.id) this.outcome.result(operation, result);
    } else {
      this.idle();
      if (operation.status === "failed") this.fail(new ProblemError(problemOfOperation(operation)));
    }
    await this.listEarlier();
  }

  private async cancel(): Promise<void> {
    if (this.current) await this.service.cancelOperation(this.current.id);
  }

  private idle(): void {
    this.busy(false);
    this.outcome.show("empty");
  }

  private busy(on: boolean): void {
    byId<HTMLButtonElement>("start").disabled = on || this.refused;
    byId("outcome").setAttribute("aria-busy", String(on));
  }

  /** The studies that the service remembers; those without a result have nothing to show. */
  private async listEarlier(): Promise<void> {
    const done = (await this.service.operations().catch(() => [])).filter((operation) => operation.status === "done" && operation.id !== this.current?.id);
    byId("earlier").hidden = done.length === 0;
    byId("earlier-list").replaceChildren(
      ...done.reverse().slice(0, kEarlier).map((operation) => make("li", {}, make("button", { type: "button", onclick: () => void this.attempt(() => this.open(operation)) }, make("b", {}, titleOf(operation.kind)), make("span", {}, String(operation.summary?.scene ?? "").replaceAll("_", " "))))),
    );
  }

  private async attempt(action: () => Promise<void> | void): Promise<void> {
    try {
      await action();
    } catch (error) {
      this.fail(error);
    }
  }

  private fail(error: unknown): void {
    if (!(error instanceof ProblemError)) console.error(error);
    const problem = problemOf(error);
    showProblem(problem);
    this.form.mark(problem.errors ?? []);
  }
}

/** A study that failed while running, in the form of a refused request. */
function problemOfOperation(operation: Operation): Problem {
  const { code = "study_failed", detail = "", errors = [] } = operation.error ?? {};
  return { title: "The study cannot be done", status: 0, code, detail, errors };
}
