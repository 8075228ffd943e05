// Mouse and touch on the picture: a point under the pointer is marked, dragging it pulls it by a spring of the service,
// a double click pins or releases it. Dragging the background turns the camera.
import { Vector3 } from "three";
import { dragTarget, pickPoint, pointOf, type Pick } from "../render/picker";
import type { Stage } from "../render/stage";
import { problemOf } from "../client/problem";
import { byId } from "./dom";

const kReachMouse = 14; // CSS pixels
const kReachTouch = 26;

export interface Commands {
  /** Sends a command of the session; failures are shown by the caller. */
  send(body: Record<string, unknown>): void;
  /** The same; resolves when the session has accepted it, throws when it has not. */
  ask(body: Record<string, unknown>): Promise<void>;
  /** The same for commands sent many times a second. */
  post(body: Record<string, unknown>): void;
  /** Shows a short sentence to the user. */
  say(text: string): void;
}

export class Interaction {
  private hovered: Pick | undefined;
  private dragged: Pick | undefined;
  private readonly anchor = new Vector3();
  private readonly target = new Vector3();
  private readonly at = new Vector3();
  private moved = false;
  /** Where the next drag command grabs, if not at the row's point. */
  private hold: number[] | undefined;
  private queued = false;
  /** What is held, with the command that releases it. */
  private pinned = new Map<string, "unpin" | "release">();
  private readonly probe = byId("probe");
  /** False: the picture is only looked at. */
  enabled = true;
  private pointer: { x: number; y: number; touch: boolean } | undefined;

  constructor(
    private readonly stage: Stage,
    private readonly canvas: HTMLCanvasElement,
    private readonly commands: Commands,
  ) {
    // Capture comes before OrbitControls, which then stays out of a drag.
    canvas.addEventListener("pointerdown", (event) => this.down(event), { capture: true });
    canvas.addEventListener("pointermove", (event) => this.move(event));
    canvas.addEventListener("pointerup", () => this.up());
    canvas.addEventListener("pointercancel", () => this.up());
    canvas.addEventListener("pointerleave", () => this.leave());
    canvas.addEventListener("dblclick", (event) => this.pin(event));
  }

  /** A new session: nothing is held any more. */
  clear(): void {
    this.dragged = this.hovered = this.pointer = undefined;
    this.pinned.clear();
    this.stage.controls.enabled = true;
    this.unmark();
  }

  /** Moves the mark with its point; call when a frame is on the screen. */
  follow(): void {
    if (this.dragged) this.mark(this.dragged, this.moved ? this.target : undefined);
    else if (this.pointer && !this.pointer.touch) this.hover();
  }

  private pick(event: MouseEvent, reach: number): Pick | undefined {
    const box = this.canvas.getBoundingClientRect();
    return pickPoint(this.stage.pointViews(), this.stage.camera, event.clientX - box.left, event.clientY - box.top, box.width, box.height, reach);
  }

  private down(event: PointerEvent): void {
    if (!this.enabled || event.button !== 0 || event.shiftKey || event.ctrlKey) return;
    const pick = this.pick(event, event.pointerType === "mouse" ? kReachMouse : kReachTouch);
    if (!pick) return;
    const box = this.canvas.getBoundingClientRect();
    this.pointer = { x: event.clientX - box.left, y: event.clientY - box.top, touch: event.pointerType !== "mouse" };
    this.dragged = pick;
    this.moved = false;
    pointOf(pick, this.anchor);
    // A body is held where the mouse grabbed it, not by its centre.
    this.hold = undefined;
    if (pick.view.bodies && dragTarget(this.stage.camera, this.anchor, (2 * this.pointer.x) / box.width - 1, 1 - (2 * this.pointer.y) / box.height, this.target)) {
      this.anchor.copy(this.target);
      this.hold = this.anchor.toArray();
    }
    this.stage.controls.enabled = false;
    this.canvas.setPointerCapture(event.pointerId);
    this.mark(pick, undefined);
  }

  private move(event: PointerEvent): void {
    const box = this.canvas.getBoundingClientRect();
    this.pointer = { x: event.clientX - box.left, y: event.clientY - box.top, touch: event.pointerType !== "mouse" };
    if (!this.dragged) {
      if (event.buttons === 0 && !this.pointer.touch) this.hover();
      return;
    }
    const hit = dragTarget(this.stage.camera, this.anchor, (2 * this.pointer.x) / box.width - 1, 1 - (2 * this.pointer.y) / box.height, this.target);
    if (!hit) return;
    this.moved = true;
    this.mark(this.dragged, this.target);
    // At most one command per picture.
    if (this.queued) return;
    this.queued = true;
    requestAnimationFrame(() => {
      this.queued = false;
      if (!this.dragged) return;
      this.commands.post({ type: "drag", system: this.dragged.view.id, index: this.dragged.index, target: this.target.toArray(), ...(this.hold && { at: this.hold }) });
      this.hold = undefined;
    });
  }

  private up(): void {
    const pick = this.dragged;
    if (!pick) return;
    this.dragged = undefined;
    this.stage.controls.enabled = true;
    if (this.moved) {
      this.commands.send({ type: "release", system: pick.view.id, index: pick.index });
      // A drag has replaced the spring that held this, and released it.
      if (this.pinned.get(`${pick.view.id} ${pick.index}`) === "release") this.pinned.delete(`${pick.view.id} ${pick.index}`);
    }
    this.unmark();
  }

  private leave(): void {
    this.pointer = undefined;
    this.hovered = undefined;
    if (!this.dragged) this.unmark();
  }

  private pin(event: MouseEvent): void {
    const pick = this.enabled ? this.pick(event, kReachMouse) : undefined;
    if (pick) void this.keep(pick, event);
  }

  /** Holds a row or releases it. Bodies in space cannot be pinned: a spring to the world holds them where they were grabbed. */
  private async keep({ view, index }: Pick, event: MouseEvent): Promise<void> {
    const key = `${view.id} ${index}`;
    const name = `${view.id}, ${view.bodies ? "body" : "point"} ${index}`;
    const row = { system: view.id, index };
    const held = this.pinned.get(key);
    try {
      if (held) {
        await this.commands.ask({ type: held, ...row });
        this.pinned.delete(key);
        return this.commands.say(`${name}: free`);
      }
      await this.commands.ask({ type: "pin", ...row });
      this.pinned.set(key, "unpin");
      this.commands.say(`${name}: pinned`);
    } catch (error) {
      const { code, detail, title, errors } = problemOf(error);
      if (code !== "bad_command") return this.commands.say(detail ?? title);
      const allowed = String(errors?.[0]?.allowed ?? detail ?? "");
      if (!view.bodies || !/drag/.test(allowed)) return this.commands.say(`${name}: ${detail ?? title}`);
      const box = this.canvas.getBoundingClientRect();
      const at = pointOf({ view, index }, new Vector3());
      const place = new Vector3();
      const hit = dragTarget(this.stage.camera, at, (2 * (event.clientX - box.left)) / box.width - 1, 1 - (2 * (event.clientY - box.top)) / box.height, place) ?? at;
      await this.commands.ask({ type: "drag", ...row, target: hit.toArray(), at: hit.toArray() }).then(
        () => {
          this.pinned.set(key, "release");
          this.commands.say(`${name}: held by a spring to the world`);
        },
        (refused: unknown) => this.commands.say(`${name}: ${problemOf(refused).detail ?? title}`),
      );
    }
  }

  private hover(): void {
    if (!this.pointer) return;
    const { x, y } = this.pointer;
    const { clientWidth, clientHeight } = this.canvas;
    const before = this.hovered;
    this.hovered = pickPoint(this.stage.pointViews(), this.stage.camera, x, y, clientWidth, clientHeight, kReachMouse);
    if (this.hovered) this.mark(this.hovered, undefined);
    else if (before) this.unmark();
  }

  private mark(pick: Pick, target: Vector3 | undefined): void {
    if (pick.index >= pick.view.count) return this.unmark();
    const { x, y, z } = pointOf(pick, this.at);
    this.stage.handle.mark(this.at, target);
    this.stage.invalidate();
    this.canvas.classList.toggle("grabbable", this.enabled);
    this.probe.hidden = false;
    this.probe.querySelector("b")!.textContent = `${pick.view.id} ${pick.index}`;
    this.probe.querySelector("span")!.textContent = [x, y, z].map((c) => c.toFixed(3)).join("  ");
    if (!this.pointer) return;
    const flip = this.pointer.x > this.canvas.clientWidth - 220;
    this.probe.style.transform = `translate(${this.pointer.x + (flip ? -18 : 18)}px, ${this.pointer.y + 14}px) translateX(${flip ? -100 : 0}%)`;
  }

  private unmark(): void {
    this.stage.handle.hide();
    this.stage.invalidate();
    this.canvas.classList.remove("grabbable");
    this.probe.hidden = true;
  }
}
