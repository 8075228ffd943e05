// A plot as SVG at its actual size in pixels, with a read-out of the point nearest to the mouse or finger.
import { make } from "../ui/dom";
import { makeAxis, place, type Axis } from "./axis";
import type { Curve, Model } from "./model";

const kReach = 36; // px
const colors = ["var(--series-1)", "var(--series-2)", "var(--series-3)", "var(--series-4)", "var(--series-5)", "var(--series-6)", "#6fd8d8", "#f0a3d4", "#a9c46c", "#9aa8ff"];

export interface Figure {
  element: HTMLElement;
  /** Takes the read-out and the observers away. */
  close(): void;
}

type Attributes = Record<string, string | number>;

function shape(tag: string, attributes: Attributes, parent: Element, text?: string): SVGElement {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, typeof value === "number" ? String(+value.toFixed(2)) : value);
  if (text !== undefined) element.textContent = text;
  parent.append(element);
  return element;
}

/** `describe` gives the lines of the read-out. */
export function makeFigure(model: Model, describe: (curve: Curve, point: { x: number; y: number }) => [string, string][]): Figure {
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  svg.classList.add("chart");
  svg.setAttribute("role", "img");
  svg.setAttribute("aria-label", `${model.title}: ${model.yLabel || "steps"} against ${model.xLabel}, ${model.curves.length} curves; the table below holds the same numbers`);
  const readout = make("div", { class: "figure-readout", hidden: true });
  const stage = make("div", { class: "figure-stage" }, svg, readout);
  const legend = make("div", { class: "chips figure-legend", role: "group", "aria-label": "Curves" });
  const element = make("div", { class: "figure" }, stage, legend);

  const front = new Set(model.front);
  const colorOf = new Map<string, string>();
  let pointed: string | undefined;
  let dots: { curve: Curve; point: { x: number; y: number }; px: number; py: number }[] = [];

  const color = (name: string): string => {
    if (!colorOf.has(name)) colorOf.set(name, colors[colorOf.size % colors.length]!);
    return colorOf.get(name)!;
  };
  model.front.forEach(color);
  const chips = new Map<string, HTMLElement>();

  function paint(): void {
    for (const group of svg.querySelectorAll<SVGGElement>("g[data-curve]")) {
      const name = group.dataset.curve!;
      const shown = front.has(name) || name === pointed;
      group.classList.toggle("front", shown);
      group.classList.toggle("dim", pointed !== undefined && name !== pointed);
      group.style.setProperty("--series", name === pointed && !front.has(name) ? "var(--ink)" : front.has(name) ? color(name) : "var(--mute)");
    }
    for (const [name, chip] of chips) {
      chip.setAttribute("aria-pressed", String(front.has(name)));
      chip.style.setProperty("--series", front.has(name) ? color(name) : "var(--mute)");
    }
    raise();
  }

  /** What stands out is drawn last. */
  function raise(): void {
    const plane = svg.querySelector(".curves");
    if (!plane) return;
    const rank = (group: Element): number => ((group as SVGGElement).dataset.curve === pointed ? 2 : group.classList.contains("front") ? 1 : 0);
    const groups = [...plane.children];
    const sorted = [...groups].sort((a, b) => rank(a) - rank(b));
    if (sorted.some((group, k) => group !== groups[k])) plane.append(...sorted);
  }

  function draw(): void {
    const width = stage.clientWidth;
    if (width === 0) return;
    const narrow = width < 520;
    const named = model.categories.length > 0;
    const left = named ? (narrow ? 112 : 160) : narrow ? 52 : 68;
    const top = named || !model.yLabel ? 10 : 30;
    const height = named ? top + 52 + Math.max(2, model.categories.length) * 30 : Math.round(Math.min(500, Math.max(300, 0.6 * width)));
    const box = { left, top, right: width - 14, bottom: height - 48 };
    const x = makeAxis(model.curves.flatMap((curve) => curve.points.map((point) => point.x)), model.xScale, (box.right - box.left) / 80, model.xUnit);
    const y: Axis = named
      ? { scale: "linear", min: model.categories.length - 0.5, max: -0.5, ticks: model.categories.map((label, at) => ({ at, label })), minor: [] }
      : makeAxis(model.curves.flatMap((curve) => curve.points.map((point) => point.y)), model.yScale, (box.bottom - box.top) / 48, model.yUnit);
    const px = (value: number): number => box.left + place(x, value) * (box.right - box.left);
    const py = (value: number): number => box.bottom - place(y, value) * (box.bottom - box.top);
    const crisp = (value: number): number => Math.round(value) + 0.5;

    svg.replaceChildren();
    svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    svg.style.height = `${height}px`;
    const grid = shape("g", { class: "grid" }, svg);
    for (const at of x.minor) shape("path", { class: "minor", d: `M${crisp(px(at))} ${box.top}V${box.bottom}` }, grid);
    for (const at of y.minor) shape("path", { class: "minor", d: `M${box.left} ${crisp(py(at))}H${box.right}` }, grid);
    for (const tick of x.ticks) {
      shape("path", { d: `M${crisp(px(tick.at))} ${box.top}V${box.bottom}` }, grid);
      shape("text", { x: px(tick.at), y: box.bottom + 17, "text-anchor": "middle" }, grid, tick.label);
    }
    for (const tick of y.ticks) {
      shape("path", { d: `M${box.left} ${crisp(py(tick.at))}H${box.right}` }, grid);
      shape("text", { x: box.left - 9, y: py(tick.at) + 4, "text-anchor": "end" }, grid, tick.label);
    }
    shape("path", { class: "border", d: `M${crisp(box.left)} ${box.top}V${crisp(box.bottom)}H${box.right}` }, grid);
    shape("text", { class: "label", x: box.right, y: height - 8, "text-anchor": "end" }, grid, model.xLabel);
    if (model.yLabel && !named) shape("text", { class: "label", x: 6, y: 15 }, grid, model.yLabel);

    dots = [];
    const plane = shape("g", { class: "curves" }, svg);
    for (const curve of model.curves) {
      const group = shape("g", { "data-curve": curve.name, class: curve.manner }, plane);
      const places = curve.points.map((point) => ({ curve, point, px: px(point.x), py: py(point.y) }));
      const path = places.map((at, k) => `${k === 0 ? "M" : "L"}${at.px.toFixed(1)} ${at.py.toFixed(1)}`).join("");
      if (curve.manner !== "marks" && curve.manner !== "rings") shape("path", { d: path }, group);
      if (curve.manner !== "dashed") dots.push(...places);
      if (curve.manner === "line" || curve.manner === "dashed") continue;
      for (const at of places) shape("circle", { cx: at.px, cy: at.py, r: curve.manner === "rings" ? 7 : curve.manner === "marks" ? 4 : 3 }, group);
    }
    shape("circle", { class: "pointed", r: 6.5, visibility: "hidden" }, svg);
    paint();
  }

  function leave(): void {
    pointed = undefined;
    readout.hidden = true;
    svg.querySelector(".pointed")?.setAttribute("visibility", "hidden");
    paint();
  }

  function point(event: PointerEvent): void {
    const box = svg.getBoundingClientRect();
    const at = { x: event.clientX - box.left, y: event.clientY - box.top };
    // Curves in front attract from slightly farther away than the others.
    const distance = (dot: (typeof dots)[number]): number => Math.hypot(dot.px - at.x, dot.py - at.y) - (front.has(dot.curve.name) ? 5 : 0);
    const nearest = dots.reduce<(typeof dots)[number] | undefined>((best, dot) => (!best || distance(dot) < distance(best) ? dot : best), undefined);
    if (!nearest || distance(nearest) > kReach) return leave();
    if (pointed !== nearest.curve.name) {
      pointed = nearest.curve.name;
      paint();
    }
    const ring = svg.querySelector(".pointed");
    ring?.setAttribute("cx", String(nearest.px));
    ring?.setAttribute("cy", String(nearest.py));
    ring?.setAttribute("visibility", "visible");
    const lines = describe(nearest.curve, nearest.point).map(([name, value]) => make("div", {}, make("dt", {}, name), make("dd", {}, value)));
    const title = model.categories[nearest.point.y] ?? nearest.curve.name;
    readout.replaceChildren(make("b", {}, title), make("dl", {}, ...lines));
    readout.hidden = false;
    const beside = nearest.px + 16 + readout.offsetWidth > stage.clientWidth ? nearest.px - 16 - readout.offsetWidth : nearest.px + 16;
    const above = Math.min(Math.max(0, nearest.py - readout.offsetHeight / 2), Math.max(0, svg.clientHeight - readout.offsetHeight));
    readout.style.transform = `translate(${Math.round(Math.max(0, beside))}px, ${Math.round(above)}px)`;
  }

  if (model.curves.length > 1) {
    const names = model.curves.map((curve) => curve.name).sort((a, b) => Number(front.has(b)) - Number(front.has(a)) || (front.has(a) ? model.front.indexOf(a) - model.front.indexOf(b) : 0));
    for (const name of names) {
      const chip = make("button", {
        class: "chip", type: "button", "aria-pressed": "false",
        onclick: () => {
          if (!front.delete(name)) front.add(name);
          paint();
        },
        onpointerenter: () => {
          pointed = name;
          paint();
        },
        onpointerleave: leave,
        onfocus: () => {
          pointed = name;
          paint();
        },
        onblur: leave,
      }, make("i", {}), name);
      chips.set(name, chip);
      legend.append(chip);
    }
  }
  svg.addEventListener("pointermove", point);
  svg.addEventListener("pointerdown", point);
  svg.addEventListener("pointerleave", leave);
  const size = new ResizeObserver(draw);
  size.observe(stage);
  return { element, close: () => size.disconnect() };
}
