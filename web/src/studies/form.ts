// The form of a kind of study, made from its parameter table. It writes into a draft and reads nothing back.
import type { Issue } from "../client/problem";
import type { Scene } from "../client/rest";
import type { Method, Parameter } from "../client/studies";
import { make } from "../ui/dom";
import { countOf, fieldOf, isUseful, numberPointers, placeholderOf, systemsOf, type Draft } from "./form_model";
import { quantity } from "./numbers";

/** The choices offered by the scene. */
export interface Offers {
  scene?: Scene;
  methods: Method[];
  quantities: string[];
}

const labels: Record<string, string> = { a: "Way a", b: "Way b", axes: "What varies", measure: "What is measured", horizon: "Simulated time", budget: "Time budget", halvings: "Halvings of the step", integrators: "Methods", integrator: "Method", dt: "Step", pointer: "Where in the scene" };
const labelOf = (parameter: Parameter): string => labels[parameter.name] ?? parameter.name.replaceAll("_", " ").replace(/^./, (first) => first.toUpperCase());

let nextId = 0;

export class Form {
  constructor(
    private readonly host: HTMLElement,
    private readonly draft: Draft,
  ) {}

  private parameters: readonly Parameter[] = [];
  private offers: Offers = { methods: [], quantities: [] };
  private more = false;

  show(parameters: readonly Parameter[], offers: Offers): void {
    this.parameters = parameters;
    this.offers = offers;
    this.draw();
  }

  /** Marks the fields that the service complained about, and goes to the first. */
  mark(issues: readonly Issue[]): void {
    for (const note of this.host.querySelectorAll(".fault")) note.remove();
    for (const input of this.host.querySelectorAll("[aria-invalid]")) input.removeAttribute("aria-invalid");
    const fields = [...this.host.querySelectorAll<HTMLElement>("[data-pointer]")];
    const paths = fields.map((field) => field.dataset.pointer!);
    let first: HTMLElement | undefined;
    for (const issue of issues) {
      const path = fieldOf(issue.pointer, paths);
      const field = fields.find((one) => one.dataset.pointer === path);
      if (!field) continue;
      field.append(make("p", { class: "fault" }, issue.message ?? issue.code.replaceAll("_", " ")));
      const input = field.querySelector<HTMLElement>("input, select");
      input?.setAttribute("aria-invalid", "true");
      field.closest("details")?.setAttribute("open", "");
      first ??= input ?? undefined;
    }
    first?.focus();
  }

  private draw(): void {
    const fields = (some: Parameter[]): HTMLElement[] => some.map((parameter) => this.field(parameter, `/${parameter.name}`));
    const rest = this.parameters.filter((parameter) => !isUseful(parameter));
    this.host.replaceChildren(...fields(this.parameters.filter(isUseful)));
    if (rest.length === 0) return;
    const details = make("details", { class: "more", open: this.more }, make("summary", {}, "More"), ...fields(rest));
    details.addEventListener("toggle", () => (this.more = details.open));
    this.host.append(details);
  }

  private field(parameter: Parameter, path: string): HTMLElement {
    if (parameter.kind === "object") return this.group(parameter, path);
    if (parameter.kind === "objects") return this.groups(parameter, path);
    if (parameter.name === "integrators" && this.offers.methods.length > 0) return this.methodChips(parameter, path);
    const id = `field-${++nextId}`;
    const help = make("small", { id: `${id}-help` }, this.help(parameter));
    const input = this.input(parameter, path, id);
    input.setAttribute("aria-describedby", help.id);
    const unit = parameter.unit && parameter.unit !== "1" ? [make("span", { class: "unit", "aria-hidden": "true" }, parameter.unit)] : [];
    const field = make("div", { class: "field", "data-pointer": path }, make("label", { for: id }, labelOf(parameter)), make("span", { class: "control" }, input, ...unit), help);
    if (input.hasAttribute("list")) field.append(make("datalist", { id: `${id}-list` }, ...this.choices(parameter).map((choice) => make("option", { value: choice }))));
    return field;
  }

  private help(parameter: Parameter): string {
    const ends = /^\[(.+), (.+)\]$/.exec(parameter.allowed ?? "");
    const bounds = ends ? `, ${quantity(Number(ends[1]))} to ${quantity(Number(ends[2]))}` : "";
    const text = `${parameter.description ?? ""}${bounds}`;
    return text.toLowerCase() === labelOf(parameter).toLowerCase() ? "" : text;
  }

  private input(parameter: Parameter, path: string, id: string): HTMLElement {
    const value = this.draft.get(path) ?? "";
    const write = (event: Event): void => void this.draft.set(path, (event.target as HTMLInputElement).value);
    const choices = this.choices(parameter);
    if (parameter.kind === "choice" || (choices.length > 0 && ["system", "integrator"].includes(parameter.name))) {
      const none = parameter.kind === "choice" ? [] : [make("option", { value: "" }, parameter.name === "system" ? "the first that fits" : "the scene's own")];
      const select = make("select", { id, onchange: write }, ...none, ...choices.map((choice) => make("option", { value: choice }, choice)));
      select.value = value || (parameter.kind === "choice" ? String(parameter.default ?? choices[0] ?? "") : "");
      return select;
    }
    const single = parameter.kind === "number" || parameter.kind === "integer";
    const input = make("input", {
      id, type: "text", value, placeholder: placeholderOf(parameter, this.offers.scene), autocomplete: "off", autocapitalize: "off", spellcheck: "false",
      inputmode: parameter.kind === "integer" ? "numeric" : single ? "decimal" : "text", required: parameter.required === true, oninput: write,
    });
    if (choices.length === 0) return input;
    input.setAttribute("list", `${id}-list`);
    return input;
  }

  private choices(parameter: Parameter): string[] {
    if (parameter.choices) return parameter.choices;
    if (parameter.name === "system") return systemsOf(this.offers.scene).map((system) => system.id);
    if (parameter.name === "integrator") return this.offers.methods.map((method) => method.name);
    if (parameter.name === "pointer") return numberPointers(this.offers.scene);
    if (parameter.name === "quantity") return ["position", "velocity"];
    if (parameter.name === "measure") return this.offers.quantities;
    return [];
  }

  private group(parameter: Parameter, path: string): HTMLElement {
    return make("fieldset", { class: "group", "data-pointer": path }, make("legend", {}, labelOf(parameter)), ...(parameter.parameters ?? []).map((inner) => this.field(inner, `${path}/${inner.name}`)));
  }

  private groups(parameter: Parameter, path: string): HTMLElement {
    const count = countOf(parameter, this.draft, path);
    const resize = (next: number): void => {
      this.draft.set(`${path}#`, String(next));
      this.draw();
    };
    const one = (k: number): HTMLElement => this.group({ ...parameter, name: count > 1 ? `axis ${k + 1}` : parameter.name }, `${path}/${k}`);
    const buttons = make("div", { class: "row" }, make("button", { class: "button small", type: "button", onclick: () => resize(count + 1) }, "Add another"));
    if (count > 1) buttons.append(make("button", { class: "button small", type: "button", onclick: () => resize(count - 1) }, "Remove the last"));
    return make("div", { "data-pointer": path, class: "groups" }, ...Array.from({ length: count }, (_, k) => one(k)), buttons);
  }

  /** All methods of the system as switches; none pressed means all. */
  private methodChips(parameter: Parameter, path: string): HTMLElement {
    const offered = new Set(this.offers.methods.map((method) => method.name));
    const chosen = new Set((this.draft.get(path) ?? "").split(",").filter((name) => offered.has(name)));
    const help = make("small", {});
    const tell = (): void => {
      this.draft.set(path, [...chosen].join(","));
      help.textContent = chosen.size === 0 ? (parameter.description ?? "").replace(/^methods; (.*) when left out$/, "None chosen: $1") : `${chosen.size} chosen; press again to leave one out`;
    };
    const chips = this.offers.methods.map((method) => {
      const chip: HTMLElement = make("button", {
        class: "chip", type: "button", title: method.title ?? "", "aria-pressed": String(chosen.has(method.name)),
        onclick: () => {
          if (!chosen.delete(method.name)) chosen.add(method.name);
          chip.setAttribute("aria-pressed", String(chosen.has(method.name)));
          tell();
        },
      }, method.name);
      return chip;
    });
    tell();
    return make("fieldset", { class: "field plain", "data-pointer": path }, make("legend", {}, labelOf(parameter)), make("div", { class: "chips", tabindex: "-1" }, ...chips), help);
  }
}
