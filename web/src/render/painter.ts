// When a picture is drawn, and how well: only when something has changed (a frame, the camera, the size). A machine that cannot
// keep up gets fewer pixels first and no shadows second; once nothing moves any more, one picture in full quality.
import { WebGLRenderer, type IUniform, type PerspectiveCamera, type Scene } from "three";
import type { Ground } from "./ground";
import { scenery } from "./shading";

const kMany = 20000; // points
const kRest = 350; // ms without a new picture, after which one is drawn in full quality
const kSlow = 42; // ms from picture to picture; above this a machine does not keep up
const kFast = 21; // ms; below this it has time to spare

/** What is painted. */
export interface Subject {
  readonly scene: Scene;
  readonly camera: PerspectiveCamera;
  readonly ground: Ground;
  /** Rows on the screen. */
  rows(): number;
  /** Called at every turn, whether a picture is due or not. */
  turn(now: number): void;
  /** Called before and after a picture of this size (CSS pixels). */
  before(width: number, height: number): void;
  after(width: number, height: number): void;
  resized(): void;
}

export class Painter {
  private readonly renderer: WebGLRenderer;
  private dirty = true;
  private shadowsDirty = true;
  /** Fraction of the screen's pixels along a side. */
  private scale = 1;
  /** ms by which pictures were late in a row; below zero, ms in a row with time to spare. */
  private late = 0;
  private restores = 3;
  private last = 0;
  private drew = false;
  /** When the last picture was requested, and whether it was drawn in full quality. */
  private asked = 0;
  private best = false;
  private full = false;
  private presented: (() => void)[] = [];

  constructor(private readonly canvas: HTMLCanvasElement, private readonly viewHeight: IUniform<number>, private readonly subject: Subject) {
    this.renderer = new WebGLRenderer({ canvas, context: contextOf(canvas) });
    this.setTheme();
  }

  /** Begins to draw. */
  start(): void {
    new ResizeObserver(() => this.resize()).observe(this.canvas);
    this.resize();
    this.renderer.setAnimationLoop((now) => this.tick(now));
  }

  setTheme(): void {
    this.renderer.setClearColor(scenery.background, 1);
  }

  invalidate(shadows: boolean): void {
    this.dirty = true;
    this.best = false;
    this.asked = performance.now();
    this.shadowsDirty ||= shadows;
  }

  /** Resolves when the next picture has been drawn. */
  drawn(): Promise<void> {
    return new Promise((resolve) => this.presented.push(resolve));
  }

  private resize(): void {
    if (this.canvas.clientWidth === 0 || this.canvas.clientHeight === 0) return;
    this.setPixels(this.scale);
    this.subject.resized();
    this.invalidate(false);
  }

  private setPixels(scale: number): void {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2) * scale);
    this.renderer.setSize(width, height, false);
    this.viewHeight.value = this.canvas.height;
  }

  private tick(now: number): void {
    // Time since the last turn counts as the cost of a picture only if that turn drew one.
    if (this.drew) this.adapt(now - this.last);
    this.last = now;
    this.subject.turn(now);
    this.drew = this.dirty;
    if (!this.dirty) {
      this.finish();
      return this.release();
    }
    if (this.full) this.sharpen(false);
    this.dirty = false;
    this.draw();
    this.release();
  }

  private draw(): void {
    const { scene, camera, ground } = this.subject;
    if (this.shadowsDirty) {
      this.shadowsDirty = false;
      ground.castShadows(this.renderer, scene, this.viewHeight);
    }
    const { clientWidth, clientHeight } = this.canvas;
    this.subject.before(clientWidth, clientHeight);
    this.renderer.render(scene, camera);
    this.subject.after(clientWidth, clientHeight);
  }

  /** The final picture on a slow machine, once nothing moves any more: all pixels, and shadows. */
  private finish(): void {
    if (this.best || performance.now() - this.asked < kRest) return;
    this.best = true;
    if (this.scale >= 1 && this.subject.ground.shadows) return;
    this.sharpen(true);
    this.draw();
  }

  private sharpen(on: boolean): void {
    this.full = on;
    this.setPixels(on ? 1 : this.scale);
    this.subject.ground.full = on;
    this.shadowsDirty = true;
  }

  private release(): void {
    for (const resolve of this.presented.splice(0)) resolve();
  }

  /** After a second of slow pictures: fewer pixels, then no shadows. Back after calm. */
  private adapt(elapsed: number): void {
    if (document.hidden || elapsed > 4000) return;
    const { ground } = this.subject;
    this.late = elapsed > kSlow ? Math.max(0, this.late) + elapsed : elapsed < kFast ? Math.min(0, this.late) - elapsed : 0;
    if (this.late > 1000) {
      this.late = 0;
      // With many points the second pass is expensive, with few the fill rate is.
      if (ground.shadows && (this.subject.rows() > kMany || this.scale < 1)) ground.shadows = false;
      else this.scale = Math.max(0.6, this.scale * 0.8);
    } else if (this.late < -4000 && this.restores > 0 && (this.scale < 1 || !ground.shadows)) {
      this.late = 0;
      --this.restores;
      if (ground.shadows) this.scale = Math.min(1, this.scale / 0.8);
      else ground.shadows = true;
    } else {
      return;
    }
    this.resize();
    this.invalidate(true);
  }
}

/** WebGL 2, with anti-aliasing on a graphics processor but not with software rendering. */
function contextOf(canvas: HTMLCanvasElement): WebGL2RenderingContext {
  const probe = document.createElement("canvas").getContext("webgl2");
  const info = probe?.getExtension("WEBGL_debug_renderer_info");
  const name = String(info ? probe?.getParameter(info.UNMASKED_RENDERER_WEBGL) : "");
  probe?.getExtension("WEBGL_lose_context")?.loseContext();
  const software = /swiftshader|llvmpipe|softpipe|basic render/i.test(name);
  const context = canvas.getContext("webgl2", { antialias: !software, powerPreference: "high-performance" });
  if (!context) throw new Error("WebGL 2 is not available");
  return context;
}
