// Energies (or, in a scene without them, the first observables) over time. Keeps at most kPoints samples:
// when they are full every second one goes, so that the whole run stays visible at a falling resolution.
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import type { Observables, Observation } from "../client/gen/truestep/v1/stream_pb";
import { byId, make } from "./dom";

const kPoints = 3000;
const kSeries = 5;
const colors = ["#7cc0ff", "#ffb36b", "#79d6a3", "#c9a2f2", "#f2919b"];
const ink = "#94a0b0";

export class Plot {
  private readonly figure = byId("energy");
  private readonly host = byId("plot");
  private readonly legend = byId("legend");
  private names: string[] = [];
  private data: number[][] = [[]];
  private values: HTMLElement[] = [];
  private plot: uPlot | undefined;
  private pending = false;

  constructor() {
    new ResizeObserver(() => this.fit()).observe(this.host);
  }

  clear(): void {
    this.plot?.destroy();
    this.plot = undefined;
    this.names = [];
    this.data = [[]];
    this.figure.hidden = true;
  }

  add(observables: Observables): void {
    const { values, time } = observables;
    if (values.length === 0) return;
    if (this.names.length === 0) this.begin(observables);
    const times = this.data[0]!;
    const last = times.at(-1);
    // The clock went back: a reset or a seek. What was after it is no longer true.
    if (last !== undefined && time < last) {
      const keep = times.findIndex((t) => t >= time);
      for (const column of this.data) column.length = keep;
    } else if (last === time) {
      return;
    }
    times.push(time);
    const byName = new Map(values.map((value) => [value.name, value.value]));
    this.names.forEach((name, k) => this.data[k + 1]!.push(byName.get(name) ?? Number.NaN));
    if (times.length > kPoints) this.data = this.data.map((column) => column.filter((_, k) => k % 2 === 0));
    if (!this.pending) {
      this.pending = true;
      setTimeout(() => this.draw(), 90);
    }
  }

  private begin({ values }: Observables): void {
    const { title, chosen } = choose(values);
    this.names = chosen.map((value) => value.name);
    this.data = [[], ...this.names.map(() => [])];
    const unit = chosen[0]?.unit;
    byId("energy-title").textContent = title + (unit ? ` [${unit}]` : "");
    this.figure.hidden = false;
    this.values = this.names.map(() => make("b", {}));
    this.legend.replaceChildren(
      ...this.names.map((name, k) => {
        const label = name.replace(/\.energy\.(total|kinetic)$|^energy\./, "") || name;
        const button: HTMLElement = make("button", { "aria-pressed": "true", title: "Show or hide", onclick: () => this.toggle(k, button) }, make("i", {}), make("span", {}, label), this.values[k]!);
        button.style.setProperty("--series", colors[k]!);
        return button;
      }),
    );
    const axis = { stroke: ink, grid: { stroke: "rgba(255,255,255,.06)", width: 1 }, ticks: { show: false }, font: "11px system-ui" };
    this.plot = new uPlot(
      {
        width: Math.max(this.host.clientWidth, 120),
        height: Math.max(this.host.clientHeight, 80),
        legend: { show: false },
        cursor: { y: false, points: { size: 6 } },
        scales: { x: { time: false } },
        axes: [
          { ...axis, size: 22, values: (_, ticks) => ticks.map((t) => `${+t.toPrecision(4)} s`), space: 60 },
          { ...axis, size: 46, values: (_, ticks) => ticks.map(short), space: 26 },
        ],
        series: [{}, ...this.names.map((label, k) => ({ label, stroke: colors[k]!, width: 1.6, points: { show: false } }))],
      },
      this.data as uPlot.AlignedData,
      this.host,
    );
  }

  private toggle(k: number, button: HTMLElement): void {
    const on = button.getAttribute("aria-pressed") !== "true";
    button.setAttribute("aria-pressed", String(on));
    this.plot?.setSeries(k + 1, { show: on });
  }

  private draw(): void {
    this.pending = false;
    if (!this.plot || this.figure.offsetParent === null) return;
    this.plot.setData(this.data as uPlot.AlignedData);
    this.values.forEach((element, k) => (element.textContent = short(this.data[k + 1]!.at(-1) ?? Number.NaN)));
  }

  private fit(): void {
    if (this.plot && this.host.clientWidth > 0) this.plot.setSize({ width: this.host.clientWidth, height: this.host.clientHeight });
  }
}

/** One system: its kinetic, potential and total energy. Several: the energy of each, to compare them. */
function choose(values: Observation[]): { title: string; chosen: Observation[] } {
  const of = (pattern: RegExp): Observation[] => values.filter((value) => pattern.test(value.name)).slice(0, kSeries);
  const totals = of(/^.+\.energy\.total$/);
  if (totals.length > 1) return { title: "Total energy", chosen: totals };
  const kinetic = of(/^.+\.energy\.kinetic$/);
  if (kinetic.length > 1) return { title: "Kinetic energy", chosen: kinetic };
  const whole = of(/^energy\.(kinetic|potential|total)$/);
  if (whole.length > 0) return { title: "Energy", chosen: whole };
  return { title: "Observables", chosen: values.slice(0, 3) };
}

function short(value: number): string {
  if (!Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  return size !== 0 && (size >= 1e5 || size < 1e-3) ? value.toExponential(1) : String(+value.toPrecision(4));
}
