// The gallery by chapters: one card per scene, with the server's picture of it or, without one, a drawing of its kind.
// A card under the mouse plays: a session of its own is stepped and drawn by the service until the mouse leaves.
import type { GalleryEntry } from "../client/rest";
import { byId, make } from "./dom";
import { preview } from "./preview";

const drawings: [RegExp, string][] = [
  [/cloth|flag|sheet/, "M20 22q20-10 40 0t40 0v34q-20 10-40 0t-40 0zM20 33q20-10 40 0t40 0M20 45q20-10 40 0t40 0M40 18v36M60 22v36M80 26v36"],
  [/rope|chain|hair|spring|bridge|catenary/, "M14 22q8 40 46 40t46-40M14 22h.1M29 47h.1M46 58h.1M60 62h.1M74 58h.1M91 47h.1M106 22h.1"],
  [/particle|fountain|drop|ball|bounc|rain|smoke/, "M60 66v.1M60 52v.1M52 40v.1M68 40v.1M42 30v.1M78 30v.1M60 26v.1M32 38v.1M88 38v.1M26 52v.1M94 52v.1M50 20v.1M70 20v.1"],
  [/pendulum/, "M60 14 84 40 70 64M60 14h.1M84 40h.1M70 64h.1M44 14h32"],
  [/orbit|body|planet|kepler/, "M60 40h.1M20 40a40 18 0 1 0 80 0a40 18 0 1 0-80 0M92 29h.1"],
  [/oscill|ode|wave|euler|damp|integrat/, "M10 40c10-44 20-44 30 0s20 44 30 0 20-30 24-12 10 12 16 12"],
];

/** Chapters in order, and the types of the systems that they are about. */
const chapters: [string, string[]][] = [
  ["Things that meet", []],
  ["Animation", ["keyframes", "skeleton", "ik", "blend_shapes", "motion_capture"]],
  ["Elastic bodies", ["fem"]],
  ["Snow, sand, water and jelly", ["mpm"]],
  ["Cloth, ropes, hair and soft bodies", ["mass_spring", "xpbd", "oscillator"]],
  ["Rigid bodies", ["rigid3d", "articulation", "rod_chain", "pendulum"]],
  ["Rigid bodies in the plane", ["rigid2d"]],
  ["Stars and planets", ["nbody"]],
  ["Flocks and crowds", ["flocking", "crowd"]],
  ["Atoms and molecules", ["molecular"]],
  ["Particles", ["particles"]],
  ["Fluids", ["sph", "grid_fluid", "heightfield_wave"]],
  ["Heat and waves", ["heat", "wave"]],
  ["Equations", ["ode"]],
];

const chapterOfType = (type: string): string | undefined => chapters.find(([, types]) => types.includes(type))?.[0];

/** The chapter of a scene with systems of these types, in its order. Systems of several chapters meet; what follows an animation belongs to it. */
export function chapterOf(types: readonly string[]): string {
  const found = [...new Set(types.map((type) => chapterOfType(type) ?? "More"))];
  if (found.length <= 1) return found[0] ?? "More";
  return found[0] === "Animation" ? "Animation" : "Things that meet";
}

const wordsOf = (text: string): string[] => text.toLowerCase().split(/[^\p{L}\p{N}]+/u).filter((word) => word !== "");

/** True when every word of `query` begins a word of the entry, or is what it begins with in the plural. */
export function matches(entry: GalleryEntry, query: string): boolean {
  const words = [entry.name, entry.title, entry.teaches, entry.description, ...(entry.tags ?? []), ...(entry.systems ?? [])].flatMap((text) => wordsOf(text ?? ""));
  return wordsOf(query).every((asked) => words.some((word) => word === asked || (asked.length > 3 && word.startsWith(asked)) || word === `${asked}s`));
}

function drawing(entry: GalleryEntry): SVGSVGElement {
  const text = `${entry.tags?.join(" ") ?? ""} ${entry.name} ${entry.title}`.toLowerCase();
  const path = drawings.find(([pattern]) => pattern.test(text))?.[1] ?? drawings[5]![1];
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  svg.setAttribute("viewBox", "0 0 120 80");
  const line = document.createElementNS("http://www.w3.org/2000/svg", "path");
  line.setAttribute("d", path);
  svg.append(line);
  return svg;
}

function cardOf(entry: GalleryEntry, open: (name: string) => void, edit: (name: string) => void): HTMLElement {
  const picture = make("span", { class: "thumbnail" });
  if (entry.thumbnail) {
    // Made in advance by scripts/thumbnails.mjs; newer scenes use the service's picture.
    const image = make("img", { src: `/thumbnails/${encodeURIComponent(entry.name)}.webp`, alt: "", loading: "lazy", decoding: "async" });
    const drawn = entry.thumbnail;
    image.addEventListener("error", () => {
      image.addEventListener("error", () => image.replaceWith(drawing(entry)), { once: true });
      image.src = drawn;
    }, { once: true });
    picture.append(image);
  } else {
    picture.append(drawing(entry));
  }
  const run = make("button", { class: "run", "data-scene": entry.name, onclick: () => open(entry.name) }, picture, make("strong", {}, entry.title || entry.name), make("span", { class: "teaches" }, entry.teaches ?? entry.description ?? ""));
  preview(run, picture, entry.name);
  const change = make("button", { class: "edit", "aria-label": `Edit ${entry.title || entry.name}`, onclick: () => edit(entry.name) }, "Edit");
  const study = make("a", { class: "edit study", href: `/studies.html?gallery=${encodeURIComponent(entry.name)}`, "aria-label": `Study ${entry.title || entry.name}` }, "Study");
  return make("article", { class: "scene", "data-scene": entry.name }, run, study, change);
}

/** Fills the gallery; `open` runs a scene, `edit` puts it into the editor; a link leads to its studies. */
export function showGallery(entries: GalleryEntry[], open: (name: string) => void, edit: (name: string) => void): void {
  const names = [...chapters.map(([name]) => name), "More"];
  const groups = names.map((name) => {
    const cards = entries.filter((entry) => chapterOf(entry.systems ?? []) === name).map((entry) => ({ entry, card: cardOf(entry, open, edit) }));
    const section = make("section", { class: "chapter", "aria-label": name }, make("h2", {}, name), ...cards.map(({ card }) => card));
    return { section, cards };
  });
  const empty = make("p", { class: "empty" }, entries.length > 0 ? "No scene matches." : "The gallery is empty. The scene editor takes any scene.");
  const search = byId<HTMLInputElement>("search");
  const filter = (): void => {
    let any = false;
    for (const { section, cards } of groups) {
      for (const { entry, card } of cards) card.hidden = !matches(entry, search.value.trim());
      section.hidden = cards.every(({ card }) => card.hidden);
      any ||= !section.hidden;
    }
    empty.hidden = any;
  };
  search.oninput = filter;
  byId("cards").replaceChildren(...groups.map(({ section }) => section), empty);
  filter();
}

/** Marks the card of the running scene. */
export function markScene(name: string | undefined): void {
  for (const card of byId("gallery").querySelectorAll<HTMLElement>("article")) card.toggleAttribute("data-current", card.dataset.scene === name);
}
