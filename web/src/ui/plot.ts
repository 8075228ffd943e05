// Observables over time. The past comes from the series that the service keeps, so that a plot begins where the run
// did; what streams in is added to it, and where frames are missing there is a gap, not a straight line. Keeps at
// most kPoints samples: when they are full every second one goes, so that the whole run stays visible.
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import type { History } from "../client/rest";
import type { Observables } from "../client/gen/truestep/v1/stream_pb";
import { quantity } from "../studies/numbers";
import { byId, make } from "./dom";
import { chooseAtFirst, gapsIn, relative, scaleOf, seriesLabel } from "./plot_model";
import { tickTexts } from "./time_text";

const kPoints = 3000;
const kSeries = 6;
const kNames = 400;
const colors = ["--series-1", "--series-2", "--series-3", "--series-4", "--series-5", "--series-6"];

type Column = (number | null)[];

export class Plot {
  /** Asks the service for earlier samples; undefined if it keeps none. */
  onGap: (() => void) | undefined;
  private readonly figure = byId("energy");
  private readonly host = byId("plot");
  private readonly legend = byId("legend");
  private readonly chooser = byId("choose-list");
  private readonly drift = byId("drift");
  private times: number[] = [];
  private readonly columns = new Map<string, Column>();
  private readonly units = new Map<string, string>();
  private chosen: string[] = [];
  private listed: readonly string[] = [];
  private title = "Observables";
  private touched = false;
  private readonly hidden = new Set<string>();
  private fromStart = false;
  private values: HTMLElement[] = [];
  private plot: uPlot | undefined;
  private pending = false;
  private exponent = 0;

  constructor() {
    new ResizeObserver(() => this.fit()).observe(this.host);
    this.drift.addEventListener("click", () => {
      this.fromStart = !this.fromStart;
      this.drift.setAttribute("aria-pressed", String(this.fromStart));
      this.build();
    });
  }

  /** Forgets the last run; `listed` are the observables that the scene names. */
  clear(listed: readonly string[]): void {
    this.listed = listed;
    this.plot?.destroy();
    this.plot = undefined;
    this.times = [];
    this.columns.clear();
    this.units.clear();
    this.chosen = [];
    this.hidden.clear();
    this.touched = false;
    this.figure.hidden = true;
    byId<HTMLDetailsElement>("choose").open = false;
    this.chooser.replaceChildren();
  }

  /** Call after the page's colours have changed. */
  restyle(): void {
    if (this.plot) this.build();
  }

  /** Takes earlier samples: they replace the samples up to their end, which were taken at frames. */
  fill({ series, units }: History): void {
    const { time, values } = series;
    const end = time.at(-1);
    if (end === undefined || time.length < 2) return;
    const later = this.times.findIndex((t) => t > end);
    const kept = later < 0 ? [] : this.times.slice(later);
    const rows = this.times.length;
    const names = new Set([...this.columns.keys(), ...Object.keys(values)]);
    for (const name of names) {
      const past = values[name] ?? this.sampled(name, time);
      const now = later < 0 ? [] : (this.columns.get(name) ?? new Array<null>(rows).fill(null)).slice(later);
      this.columns.set(name, [...past, ...now]);
      if (units[name] !== undefined) this.units.set(name, units[name]);
    }
    this.times = [...time, ...kept];
    this.thin();
    if (this.chosen.length === 0) this.choose();
    this.schedule();
  }

  add({ values, time }: Observables): void {
    if (values.length === 0) return;
    const last = this.times.at(-1);
    // The clock went back, by a reset or a seek: later samples are no longer valid.
    if (last !== undefined && time < last) {
      const keep = this.times.findIndex((t) => t >= time);
      this.times.length = keep;
      for (const column of this.columns.values()) column.length = keep;
    } else if (last === time) {
      return;
    }
    const rows = this.times.length;
    this.times.push(time);
    for (const { name, value, unit } of values) {
      let column = this.columns.get(name);
      if (!column) {
        if (this.columns.size >= kNames) continue;
        this.columns.set(name, (column = new Array<null>(rows).fill(null)));
        this.units.set(name, unit);
      }
      column.push(Number.isFinite(value) ? value : null);
    }
    for (const column of this.columns.values()) if (column.length < this.times.length) column.push(null);
    this.thin();
    if (this.chosen.length === 0) this.choose();
    if (gapsIn(this.times.slice(-40)).length > 0) this.onGap?.();
    this.schedule();
  }

  /** Places samples of a name for which the service keeps no series, at other times. */
  private sampled(name: string, times: number[]): Column {
    const old = this.columns.get(name);
    const out = new Array<number | null>(times.length).fill(null);
    if (!old) return out;
    let k = 0;
    this.times.forEach((t, row) => {
      while (k + 1 < times.length && times[k + 1]! <= t) ++k;
      if (k < times.length && times[k]! <= t && old[row] !== null) out[k] = old[row]!;
    });
    return out;
  }

  private thin(): void {
    while (this.times.length > kPoints) {
      const half = <T>(list: T[]): T[] => list.filter((_, k) => k % 2 === 0 || k === list.length - 1);
      this.times = half(this.times);
      for (const [name, column] of this.columns) this.columns.set(name, half(column));
    }
  }

  private choose(): void {
    const { title, names } = chooseAtFirst([...this.columns.keys()], this.listed, this.units);
    this.title = title;
    this.chosen = names.slice(0, kSeries);
    this.build();
    this.list();
  }

  /** The available names. */
  private list(): void {
    const boxes = [...this.columns.keys()].map((name) => {
      const box = make("input", { type: "checkbox", checked: this.chosen.includes(name), onchange: () => {
        this.chosen = box.checked ? [...this.chosen, name].slice(-kSeries) : this.chosen.filter((one) => one !== name);
        this.title = "Observables";
        this.touched = true;
        this.list();
        this.build();
      } });
      return make("label", {}, box, name);
    });
    const top = this.chooser.scrollTop;
    this.chooser.replaceChildren(...boxes);
    this.chooser.scrollTop = top;
  }

  private build(): void {
    this.plot?.destroy();
    this.plot = undefined;
    const units = [...new Set(this.chosen.map((name) => this.units.get(name) ?? ""))];
    const unit = units.length === 1 && units[0] !== "1" ? units[0] : "";
    byId("energy-title").textContent = this.title + (this.fromStart ? ", change since the start relative to the initial value" : unit ? ` [${unit}]` : "");
    this.figure.hidden = false;
    const ink = style("--soft");
    this.values = this.chosen.map(() => make("b", {}));
    this.legend.replaceChildren(
      ...this.chosen.map((name, k) => {
        const mark = this.hidden.has(name) ? "false" : "true";
        const button: HTMLElement = make("button", { "aria-pressed": mark, title: name, onclick: () => this.toggle(k, button) }, make("i", {}), make("span", {}, seriesLabel(name, this.title)), this.values[k]!);
        button.style.setProperty("--series", `var(${colors[k]!})`);
        return button;
      }),
    );
    const axis = { stroke: ink, grid: { stroke: style("--line"), width: 1 }, ticks: { show: false }, font: "11px system-ui" };
    this.plot = new uPlot(
      {
        width: Math.max(this.host.clientWidth, 120),
        height: Math.max(this.host.clientHeight, 80),
        legend: { show: false },
        cursor: { y: false, points: { size: 6 } },
        scales: { x: { time: false, range: (_, low, high) => [Math.min(low, 0.5 * high > low ? 0 : low), high > low ? high : low + 1e-9] } },
        axes: [
          { ...axis, size: 22, values: (_, ticks) => tickTexts(ticks), space: 60 },
          {
            ...axis, space: 26,
            size: (_self, labels) => 14 + 6.4 * Math.max(2, ...(labels ?? []).map((label) => label.length)),
            values: (_, ticks, _axis, _space, step) => {
              const { exponent, labels } = scaleOf(ticks, step);
              if (exponent !== this.exponent) {
                this.exponent = exponent;
                byId("plot-scale").textContent = exponent === 0 ? "" : `× ${quantity(10 ** exponent, 1)}`;
              }
              return labels;
            },
          },
        ],
        series: [{}, ...this.chosen.map((label, k) => ({ label, stroke: style(colors[k]!), width: 1.6, spanGaps: false, show: !this.hidden.has(label), points: { show: false } }))],
      },
      this.rows(),
      this.host,
    );
    this.write();
  }

  /** The chosen columns, with gaps where frames are missing. */
  private rows(): uPlot.AlignedData {
    const gaps = gapsIn(this.times);
    const columns = this.chosen.map((name) => {
      const column = this.columns.get(name) ?? [];
      return this.fromStart ? relative(column) : column;
    });
    if (gaps.length === 0) return [this.times, ...columns] as uPlot.AlignedData;
    const times: number[] = [];
    const out: Column[] = columns.map(() => []);
    let from = 0;
    for (const gap of [...gaps, this.times.length]) {
      times.push(...this.times.slice(from, gap));
      columns.forEach((column, k) => out[k]!.push(...column.slice(from, gap)));
      if (gap < this.times.length) {
        times.push(0.5 * (this.times[gap - 1]! + this.times[gap]!));
        for (const column of out) column.push(null);
      }
      from = gap;
    }
    return [times, ...out] as uPlot.AlignedData;
  }

  private toggle(k: number, button: HTMLElement): void {
    const on = button.getAttribute("aria-pressed") !== "true";
    button.setAttribute("aria-pressed", String(on));
    if (on) this.hidden.delete(this.chosen[k]!);
    else this.hidden.add(this.chosen[k]!);
    this.plot?.setSeries(k + 1, { show: on });
  }

  private schedule(): void {
    if (this.pending) return;
    this.pending = true;
    setTimeout(() => this.draw(), 90);
  }

  private draw(): void {
    this.pending = false;
    // Energies of parts that appear later belong to the initial selection.
    if (!this.touched && this.chosen.length > 0 && this.chooser.childElementCount !== this.columns.size) this.list();
    if (!this.plot || this.figure.offsetParent === null) return;
    this.plot.setData(this.rows());
    this.write();
  }

  private write(): void {
    this.values.forEach((element, k) => {
      const column = this.columns.get(this.chosen[k]!) ?? [];
      const shown = this.fromStart ? relative(column) : column;
      element.textContent = quantity(shown.at(-1) ?? Number.NaN, 6).replace("-", "−");
    });
  }

  private fit(): void {
    if (this.plot && this.host.clientWidth > 0) this.plot.setSize({ width: this.host.clientWidth, height: this.host.clientHeight });
  }
}

const style = (name: string): string => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
