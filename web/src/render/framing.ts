// The camera's position: everything seen of the scene so far is inside the uncovered part of the window. A scene
// that outgrows it moves the camera back once, with room to spare; a user who turns the camera keeps it until they
// ask for the whole scene again.
import { MOUSE, Vector3, type PerspectiveCamera } from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { Extent, type Frustum } from "./extent";
import { turned, upward } from "./upright";

const kFill = 0.9; // share of the free part that the scene may take
const kLabelled = 0.82; // with ticks and names around it
const kGrow = 1.22; // room for more when it outgrew its frame
const kMove = 550; // ms of a move of the camera
const kLargest = 12; // times the first extent: anything farther away has left the scene
const kAuthored = 0.8; // share of a scene's own frame that matters
const kPoint = 0.05; // m; stands for the size of a scene that is a single point
const kStill = 1e-5; // of the camera's distance: less is no movement
const kAspect = 4 / 3; // of the pictures that scenes' cameras are made for

export type Side = "scene" | "front" | "side" | "top";

export interface CameraPose {
  eye?: number[];
  target?: number[];
  /** Vertical, rad. */
  fov?: number;
}

export interface Inset {
  left: number;
  right: number;
  top: number;
  bottom: number;
}

/** Towards the camera, where y is up. */
const sides: Record<Exclude<Side, "scene">, [number, number, number]> = { front: [0, 0, 1], side: [1, 0, 0], top: [0, 1, 0.001] };

export class Framing {
  controls: OrbitControls;
  readonly seen = new Extent();
  /** The user has turned the camera and keeps it until asking for the scene's view again. */
  held = false;
  following = false;
  private side: Side = "scene";
  private pose: CameraPose | undefined;
  private facing: Vector3 | undefined;
  private readonly authored = new Extent();
  private first = 0;
  private fill = kFill;
  private inset: Inset = { left: 0, right: 0, top: 0, bottom: 0 };
  private readonly center = new Vector3();
  private centered = false;
  private readonly last = new Vector3();
  private motion: { since: number; eye: [Vector3, Vector3]; target: [Vector3, Vector3] } | undefined;

  constructor(
    private readonly camera: PerspectiveCamera,
    private readonly canvas: HTMLCanvasElement,
    private readonly changed: () => void,
  ) {
    this.controls = this.controlled();
    canvas.addEventListener("keydown", (event) => event.key.startsWith("Arrow") && this.take());
    this.put([3, 2, 4], [0, 0.8, 0]);
  }

  /** Controls that turn about what is up now: they keep the direction that they were made with. */
  private controlled(): OrbitControls {
    const controls = new OrbitControls(this.camera, this.canvas);
    Object.assign(controls, { enableDamping: true, dampingFactor: 0.12, zoomToCursor: true, maxPolarAngle: Math.PI * 0.55 });
    controls.mouseButtons = { LEFT: MOUSE.ROTATE, MIDDLE: MOUSE.DOLLY, RIGHT: MOUSE.PAN };
    controls.listenToKeyEvents(this.canvas);
    controls.addEventListener("change", this.changed);
    controls.addEventListener("start", () => this.take());
    return controls;
  }

  /** Forgets the last scene. `pose` is the scene's own camera; `facing` the side from which a flat scene is viewed. */
  clear(pose: CameraPose | undefined): void {
    this.fill = kFill;
    this.pose = pose;
    this.facing = undefined;
    this.side = "scene";
    this.held = this.following = this.centered = false;
    this.motion = undefined;
    this.seen.clear();
    this.authored.clear();
    this.first = 0;
    this.camera.fov = pose?.fov ? (pose.fov * 180) / Math.PI : 40;
    if (!this.camera.up.equals(upward)) {
      this.camera.up.copy(upward);
      this.controls.dispose();
      this.controls = this.controlled();
    }
    const { eye, target } = pose ?? {};
    if (!eye || !target) return;
    // The scene's author knew how far it will reach: the middle of that frame stays in the picture.
    const back = new Vector3().fromArray(eye).sub(new Vector3().fromArray(target));
    const { right, above } = this.axes(back.clone());
    const half = kAuthored * back.length() * Math.tan((this.camera.fov * Math.PI) / 360);
    for (const [u, v] of [[-1, -1], [-1, 1], [1, -1], [1, 1]] as const) {
      const corner = new Vector3().fromArray(target).addScaledVector(right, u * half * kAspect).addScaledVector(above, v * half);
      this.authored.add(corner.x, corner.y, corner.z);
    }
  }

  /** There are ticks and names around the scene. */
  leaveRoom(labelled: boolean): void {
    this.fill = labelled ? kLabelled : kFill;
  }

  /** The direction of view if the scene does not set one. */
  setFacing(facing: Vector3 | undefined): void {
    this.facing = facing;
  }

  setInset(inset: Inset): void {
    if ((Object.keys(inset) as (keyof Inset)[]).every((key) => inset[key] === this.inset[key])) return;
    this.inset = inset;
    this.project();
    if (!this.held && !this.seen.empty) this.aim(1, false);
  }

  /** The picture's size has changed. */
  project(): void {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (width === 0 || height === 0) return;
    const { left, right, top, bottom } = this.inset;
    this.camera.aspect = width / height;
    this.camera.setViewOffset(width, height, (right - left) / 2, (bottom - top) / 2, width, height);
    this.changed();
  }

  resized(): void {
    this.project();
    if (!this.held && !this.seen.empty) this.aim(1, false);
  }

  /** The first frame of a scene is known. */
  begin(now: Extent): void {
    this.seen.merge(now);
    this.first = Math.max(now.ball().radius, this.authored.ball().radius) || kPoint;
    if (!this.held) this.aim(1, false);
    this.ranges();
  }

  /** Takes the present extent; true when the frame had to grow. */
  grow(now: Extent): boolean {
    if (this.gone(now) > 0) return false;
    this.seen.merge(now);
    if (this.held || this.following || this.motion) return false;
    const { back, right, above } = this.cameraAxes();
    const [kx, ky] = this.tangents(1);
    if (this.seen.fits({ right, above, back, kx, ky }, this.camera.position.toArray())) return false;
    this.aim(kGrow, true);
    this.ranges();
    return true;
  }

  /** True when everything has left the scene. */
  lost(now: Extent): boolean {
    return this.gone(now) > 2 * now.ball().radius;
  }

  /** How far (m) the present extent reaches beyond what still counts as the scene. An emitter starts with nothing. */
  private gone(now: Extent): number {
    const { center, radius } = now.ball();
    const home = this.seen.ball();
    if (!(this.first > 0) || home.radius <= 0.3 * this.first) return 0;
    return Math.hypot(...center.map((c, k) => c - home.center[k]!)) + radius - kLargest * this.first;
  }

  /** Frames everything seen so far, from the scene's own side or another. */
  frameAll(side: Side = "scene"): void {
    this.side = side;
    this.held = this.following = false;
    this.aim(1, true);
    this.ranges();
  }

  /** Keeps the camera's distance from everything that moves. */
  follow(on: boolean): void {
    this.following = on;
    this.centered = false;
    if (!on) return;
    this.motion = undefined;
  }

  /** The centre of everything that moves is now at `center`. */
  track(center: Vector3): void {
    if (!this.following) return;
    if (this.centered) {
      const step = center.clone().sub(this.center);
      this.camera.position.add(step);
      this.controls.target.add(step);
    } else {
      const step = center.clone().sub(this.controls.target);
      this.camera.position.add(step);
      this.controls.target.copy(center);
    }
    this.centered = true;
    this.center.copy(center);
  }

  /** Advances the animation; true while the camera is moving. */
  update(now: number): void {
    if (this.motion) {
      if (this.motion.since < 0) this.motion.since = now;
      const t = Math.min(1, (now - this.motion.since) / kMove);
      const s = t * t * (3 - 2 * t);
      const { eye, target } = this.motion;
      this.camera.position.lerpVectors(eye[0], eye[1], s);
      this.controls.target.lerpVectors(target[0], target[1], s);
      if (t >= 1) this.motion = undefined;
      this.changed();
    }
    this.controls.update();
    // The controls themselves only report what moves by a millimetre.
    const { position } = this.camera;
    if (position.distanceTo(this.last) <= kStill * position.distanceTo(this.controls.target)) return;
    this.last.copy(position);
    this.changed();
  }

  /** The part kept in a shared address. */
  get view(): { eye: number[]; target: number[] } {
    return { eye: this.camera.position.toArray(), target: this.controls.target.toArray() };
  }

  set view({ eye, target }: { eye: number[]; target: number[] }) {
    this.held = true;
    this.motion = undefined;
    this.put(eye, target);
  }

  private take(): void {
    this.held = true;
    this.motion = undefined;
  }

  /** Points the camera so that everything seen, times `room`, is in the free part. */
  private aim(room: number, smooth: boolean): void {
    const { eye, target } = this.pose ?? {};
    const own = eye && target ? new Vector3().fromArray(eye).sub(new Vector3().fromArray(target)) : (this.facing?.clone() ?? turned(0.55, 0.38, 0.75));
    const direction = this.side === "scene" ? own : turned(...sides[this.side]);
    const { right, above, back } = this.axes(direction);
    const [kx, ky] = this.tangents(this.fill / room);
    const all = new Extent();
    all.merge(this.seen);
    if (this.side === "scene") all.merge(this.authored);
    const tuple = (v: Vector3): [number, number, number] => v.toArray();
    const place = all.fit({ right: tuple(right), above: tuple(above), back: tuple(back), kx, ky }, 0.3 * Math.min(this.first, 1));
    if (!smooth) {
      this.motion = undefined;
      return this.put(place.eye, place.target);
    }
    this.motion = {
      since: -1,
      eye: [this.camera.position.clone(), new Vector3().fromArray(place.eye)],
      target: [this.controls.target.clone(), new Vector3().fromArray(place.target)],
    };
    this.changed();
  }

  /** Near and far planes and distances of the wheel, for a scene of this size. */
  private ranges(): void {
    const radius = Math.max(this.seen.ball().radius, this.authored.ball().radius) || kPoint;
    this.camera.near = radius / 200;
    this.camera.far = radius * 80;
    Object.assign(this.controls, { minDistance: radius * 0.05, maxDistance: radius * 40 });
    this.camera.updateProjectionMatrix();
  }

  private axes(back: Vector3): { right: Vector3; above: Vector3; back: Vector3 } {
    back.normalize();
    const right = upward.clone().cross(back);
    if (right.lengthSq() < 1e-10) right.copy(turned(1, 0, 0));
    right.normalize();
    return { right, above: back.clone().cross(right), back };
  }

  private cameraAxes(): Omit<Frustum, "kx" | "ky"> {
    const { right, above, back } = this.axes(this.camera.position.clone().sub(this.controls.target));
    return { right: right.toArray(), above: above.toArray(), back: back.toArray() };
  }

  /** Tangents of half the angles of the free part, less a margin. */
  private tangents(fill: number): [number, number] {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const { left, right, top, bottom } = this.inset;
    const whole = Math.tan((this.camera.fov * Math.PI) / 360) / (height || 1);
    const free = (size: number, covered: number): number => Math.max(0.25 * size, size - covered) * whole * fill;
    return [free(width || 1, left + right), free(height || 1, top + bottom)];
  }

  private put(eye: number[], target: number[]): void {
    this.camera.position.fromArray(eye);
    this.controls.target.fromArray(target);
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.changed();
  }
}
