// The picture: camera, ground, shapes and systems. Draws only when something changed: a frame, the camera,
// the size. A machine that cannot keep up gets fewer pixels first and no shadows second.
import { Box3, Mesh, PerspectiveCamera, Scene, Sphere, Vector3, WebGLRenderer, type IUniform, type Object3D } from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import type { ViewerSettings } from "../client/rest";
import type { DecodedFrame } from "../client/decode";
import type { Marks, Part, Shape, SystemTopology, Topology } from "../client/gen/truestep/v1/stream_pb";
import { Ground } from "./ground";
import { Handle } from "./handle";
import { GridView, type Scale } from "./grid_view";
import { MarkLines } from "./marks";
import { backgroundColor } from "./shading";
import { isGround, makeShape, placeShape } from "./shapes";
import { SystemView, type Has, type Visibility } from "./system_view";

const kMany = 20000; // points
const kCheckEvery = 20; // frames between two looks at whether the scene outgrew its frame

export interface CameraPose {
  eye?: number[];
  target?: number[];
  /** Vertical, rad. */
  fov?: number;
}

export class Stage {
  readonly camera = new PerspectiveCamera(40, 1, 0.05, 400);
  readonly controls: OrbitControls;
  readonly views = new Map<string, SystemView | GridView>();
  readonly handle = new Handle();
  readonly show: Visibility = { points: true, lines: true, surface: true, bySpeed: true, colorBy: "" };

  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly ground = new Ground();
  private readonly marks = new MarkLines();
  private parts = new Map<string, Part>();
  private settings: ViewerSettings = {};
  private readonly viewHeight: IUniform<number> = { value: 1 };
  /** In the order of the topology; undefined where nothing is drawn, as for the ground. */
  private shapes: (Object3D | undefined)[] = [];
  private topology: Topology | undefined;
  private pose: CameraPose | undefined;
  private framed = false;
  /** The person has turned the camera: it is theirs until they ask for the scene's again. */
  private moved = false;
  private growths = 4;
  private sinceCheck = 0;
  private extent = 1;
  private bounds = new Sphere(new Vector3(), 1);
  private dirty = true;
  private shadowsDirty = true;
  private scale = 1;
  private late = 0;
  private restores = 3;
  private last = 0;
  private drew = false;
  private presented: (() => void)[] = [];
  private inset = { left: 0, right: 0, top: 0, bottom: 0 };

  constructor(private readonly canvas: HTMLCanvasElement) {
    this.renderer = new WebGLRenderer({ canvas, context: contextOf(canvas) });
    this.renderer.setClearColor(backgroundColor, 1);
    this.scene.background = null;
    this.scene.add(this.ground.object, this.marks.object, this.handle.object);
    this.controls = new OrbitControls(this.camera, canvas);
    Object.assign(this.controls, { enableDamping: true, dampingFactor: 0.12, zoomToCursor: true, maxPolarAngle: Math.PI * 0.55 });
    this.controls.listenToKeyEvents(canvas);
    this.controls.addEventListener("change", () => this.invalidate());
    this.controls.addEventListener("start", () => (this.moved = true));
    this.lookAt([3, 2, 4], [0, 0.8, 0]);
    this.ground.fit(new Sphere(new Vector3(0, 0.8, 0), 2.5), 0);
    new ResizeObserver(() => this.resize()).observe(canvas);
    this.resize();
    this.renderer.setAnimationLoop((now) => this.tick(now));
  }

  /** Forgets the last session; the next scene's camera is in `settings`, without one what appears is framed. */
  clear(settings: ViewerSettings): void {
    const pose = settings.camera;
    this.settings = settings;
    for (const view of this.views.values()) view.dispose();
    this.views.clear();
    this.topology = undefined;
    this.setShapes([]);
    this.setMarks(undefined);
    this.pose = pose;
    this.framed = false;
    this.moved = false;
    this.growths = 4;
    this.handle.hide();
    this.invalidate(true);
  }

  /** Takes what there is to show; the topology comes after it. */
  setParts(parts: Map<string, Part>): void {
    this.parts = parts;
  }

  /** Takes a new topology; systems that are connected as before keep their place on the screen. */
  setTopology(topology: Topology): void {
    const before = this.topology;
    this.topology = topology;
    topology.systems.forEach((system, index) => {
      const old = before?.systems.find((other) => other.system === system.system);
      if (old && this.views.has(system.system) && sameTopology(old, system)) return;
      this.views.get(system.system)?.dispose();
      const part = this.parts.get(system.system);
      const view = part?.lattice
        ? new GridView(part, this.settings, index)
        : new SystemView(system.system, system, index, this.viewHeight, this.ground.shadowUniforms, part);
      this.views.set(view.id, view);
      this.scene.add(view.group);
    });
    for (const [id, view] of this.views) {
      if (topology.systems.some((system) => system.system === id)) continue;
      view.dispose();
      this.views.delete(id);
    }
    if (this.framed) this.drawShapes();
    this.invalidate(true);
  }

  /** Moves the shapes of the topology to where they are now. */
  moveShapes(shapes: Shape[]): void {
    if (this.topology) this.topology.shapes = shapes;
    shapes.forEach((shape, k) => {
      const object = this.shapes[k];
      if (object) placeShape(object, shape);
    });
    this.invalidate(true);
  }

  /** Contacts and joints to draw from now on. */
  setMarks(marks: Marks | undefined): void {
    this.marks.update(marks, 0.16 * this.bounds.radius);
    this.invalidate();
  }

  /** Views of parts whose rows can be taken hold of. */
  pointViews(): SystemView[] {
    return [...this.views.values()].filter((view) => view instanceof SystemView);
  }

  /** What the colours of the first grid mean. */
  get colorScale(): Scale | undefined {
    for (const view of this.views.values()) if (view instanceof GridView) return view.scale;
    return undefined;
  }

  /** Draws `frame` with the next picture; the promise ends when that picture is out. */
  present(frame: DecodedFrame): Promise<void> {
    for (const view of this.views.values()) {
      const fields = frame.fields.filter((field) => field.system === view.id);
      if (fields.length > 0) view.update(fields, this.show);
    }
    if (!this.framed && this.views.size > 0) this.frameScene();
    else if (++this.sinceCheck >= kCheckEvery) this.followGrowth();
    this.invalidate(true);
    return new Promise((resolve) => this.presented.push(resolve));
  }

  /** Applies `show` to everything on the screen. */
  applyVisibility(): void {
    for (const view of this.views.values()) view.apply(this.show);
    this.invalidate(true);
  }

  get has(): Has {
    const all = [...this.views.values()].map((view) => view.has);
    const some = (key: keyof Has): boolean => all.some((h) => h[key]);
    return { points: some("points"), lines: some("lines"), surface: some("surface"), bodies: some("bodies") };
  }

  /** Puts the camera back to where the scene wants it. */
  resetCamera(): void {
    this.moved = false;
    this.frameScene();
    this.invalidate(true);
  }

  /** Tells how much of the picture other things cover (CSS pixels); its middle moves to the middle of the rest. */
  setInset(inset: { left: number; right: number; top: number; bottom: number }): void {
    this.inset = inset;
    this.project();
  }

  invalidate(shadows = false): void {
    this.dirty = true;
    this.shadowsDirty ||= shadows;
  }

  /** Sizes ground, light and camera for what is on the screen. */
  private frameScene(): void {
    this.framed = true;
    this.sinceCheck = 0;
    const points = this.pointBounds();
    this.extent = Math.max(points.getBoundingSphere(new Sphere()).radius, 0.2);
    this.drawShapes();
    for (const object of this.shapes) if (object?.userData.solid) points.expandByObject(object);
    let lowest = Infinity;
    for (const view of this.views.values()) if (view.bodies) lowest = Math.min(lowest, view.bodies.frame(points));
    if (points.isEmpty()) points.set(new Vector3(-1, 0, -1), new Vector3(1, 1, 1));
    const bounds = points.getBoundingSphere(new Sphere());
    bounds.radius = Math.max(bounds.radius, 0.2);
    this.bounds = bounds;
    const plane = this.topology?.shapes.find(isGround);
    const floor = plane ? (plane.position[1] ?? 0) : floorUnder(Math.min(points.min.y, lowest), lowest < Infinity, bounds.radius);
    // What hangs far above the ground throws its shadow outside the light's view; include the floor below it.
    this.ground.fit(bounds.clone().expandByPoint(new Vector3(bounds.center.x, floor, bounds.center.z)), floor);
    this.camera.near = bounds.radius / 200;
    this.camera.far = bounds.radius * 80;
    Object.assign(this.controls, { minDistance: bounds.radius * 0.05, maxDistance: bounds.radius * 30 });
    this.camera.updateProjectionMatrix();
    if (!this.moved) this.aim(bounds);
  }

  /** Points the camera as the scene says, or so that `bounds` fills what is free of the picture. */
  private aim(bounds: Sphere): void {
    const { eye, target, fov } = this.pose ?? {};
    this.camera.fov = fov ? (fov * 180) / Math.PI : 40;
    const at = target ?? bounds.center.toArray();
    const centre = new Vector3().fromArray(at);
    const narrow = this.free();
    const away = (0.95 * bounds.radius) / Math.sin((this.camera.fov * Math.PI) / 360) / narrow;
    const from = eye ? new Vector3().fromArray(eye) : new Vector3(0.55, 0.38, 0.75).normalize().multiplyScalar(away).add(centre);
    // A camera made for a whole picture steps back where less of it is free.
    if (eye) from.sub(centre).multiplyScalar(1 / Math.min(1, 1.25 * narrow)).add(centre);
    this.lookAt(from.toArray(), at);
  }

  /** A scene that outgrows its frame (an emitter starts with nothing) gets a larger one, a few times at most. */
  private followGrowth(): void {
    this.sinceCheck = 0;
    if (this.growths <= 0) return;
    const radius = this.pointBounds().getBoundingSphere(new Sphere()).radius;
    if (radius < 1.5 * this.bounds.radius) return;
    --this.growths;
    this.frameScene();
  }

  private pointBounds(): Box3 {
    const box = new Box3();
    const point = new Vector3();
    for (const view of this.views.values()) {
      const reach = view.bodies?.reach;
      for (let k = 0; k < view.count; ++k) {
        if (reach && !((reach[k] ?? -1) >= 0)) continue;
        point.fromArray(view.positions, 3 * k);
        if (Number.isFinite(point.x + point.y + point.z)) box.expandByPoint(point);
      }
    }
    return box;
  }

  private drawShapes(): void {
    this.setShapes((this.topology?.shapes ?? []).map((shape) => makeShape(shape, 1.5 * this.extent)));
  }

  private lookAt(eye: number[], target: number[]): void {
    this.camera.position.fromArray(eye);
    this.controls.target.fromArray(target);
    this.camera.updateProjectionMatrix();
    this.controls.update();
  }

  private setShapes(shapes: (Object3D | undefined)[]): void {
    for (const object of this.shapes) {
      object?.traverse((child) => child instanceof Mesh && child.geometry.dispose());
      object?.removeFromParent();
    }
    this.shapes = shapes;
    for (const object of shapes) if (object) this.scene.add(object);
  }

  private resize(): void {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (width === 0 || height === 0) return;
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2) * this.scale);
    this.renderer.setSize(width, height, false);
    this.viewHeight.value = this.canvas.height;
    this.project();
  }

  private project(): void {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (width === 0 || height === 0) return;
    const { left, right, top, bottom } = this.inset;
    this.camera.aspect = width / height;
    this.camera.setViewOffset(width, height, (right - left) / 2, (bottom - top) / 2, width, height);
    this.invalidate();
  }

  /** The side of the largest square in the uncovered part, as a share of the picture's height. */
  private free(): number {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const { left, right, top, bottom } = this.inset;
    return Math.max(0.3, Math.min(1, Math.min(width - left - right, height - top - bottom) / (height || 1)));
  }

  private tick(now: number): void {
    // Time since the last turn counts as the cost of a picture only if that turn drew one.
    if (this.drew) this.adapt(now - this.last);
    this.last = now;
    this.controls.update();
    this.drew = this.dirty;
    if (!this.dirty) return this.release();
    this.dirty = false;
    if (this.shadowsDirty) {
      this.shadowsDirty = false;
      this.ground.castShadows(this.renderer, this.scene, this.viewHeight);
    }
    this.handle.face(this.camera, this.canvas.clientHeight);
    this.renderer.render(this.scene, this.camera);
    this.release();
  }

  private release(): void {
    for (const resolve of this.presented.splice(0)) resolve();
  }

  /** After a second of pictures slower than 24 a second: fewer pixels, then no shadows. Back after calm. */
  private adapt(elapsed: number): void {
    if (document.hidden || elapsed > 4000) return;
    this.late = elapsed > 42 ? Math.max(0, this.late) + elapsed : elapsed < 21 ? Math.min(0, this.late) - elapsed : 0;
    if (this.late > 1000) {
      this.late = 0;
      // With many points it is drawing them twice that costs, with few it is filling the picture.
      const many = [...this.views.values()].reduce((sum, view) => sum + view.count, 0) > kMany;
      if (this.ground.shadows && (many || this.scale < 1)) this.ground.shadows = false;
      else this.scale = Math.max(0.6, this.scale * 0.8);
    } else if (this.late < -4000 && this.restores > 0 && (this.scale < 1 || !this.ground.shadows)) {
      this.late = 0;
      --this.restores;
      if (this.ground.shadows) this.scale = Math.min(1, this.scale / 0.8);
      else this.ground.shadows = true;
    } else {
      return;
    }
    this.resize();
    this.invalidate(true);
  }
}

/** The ground's height: 0 where nothing is below, else well under it. Faces of bodies in its plane would flicker. */
function floorUnder(low: number, bodies: boolean, radius: number): number {
  if (bodies) return low - 0.02 * radius;
  return low >= -1e-3 * radius ? 0 : low - 0.15 * radius;
}

const sameBytes = (a: Uint8Array, b: Uint8Array): boolean => a.length === b.length && a.every((byte, k) => byte === b[k]);

function sameTopology(a: SystemTopology, b: SystemTopology): boolean {
  return a.pointRadius === b.pointRadius && sameBytes(a.lines, b.lines) && sameBytes(a.triangles, b.triangles) && sameBytes(a.instances, b.instances) && a.visuals.length === b.visuals.length && a.color.join() === b.color.join();
}

/** WebGL 2, smoothed where a graphics processor draws; a processor that draws by itself is spared that. */
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
