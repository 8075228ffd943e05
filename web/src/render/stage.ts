// The picture: camera, ground, shapes and systems. The painter says when it is drawn.
import { PerspectiveCamera, Scene, Sphere, Vector3, type IUniform } from "three";
import { meaning } from "../client/parts";
import type { ViewerSettings } from "../client/rest";
import type { DecodedFrame, FieldArray } from "../client/decode";
import type { Marks, Part, Shape, Topology } from "../client/gen/truestep/v1/stream_pb";
import { Extent } from "./extent";
import { Framing, type Inset, type Side } from "./framing";
import { floorUnder, Ground } from "./ground";
import { Handle } from "./handle";
import { GridView, type Scale } from "./fields/grid_view";
import { schemeOf } from "./fields/scheme";
import { Labels, type Label } from "./labels";
import { JointMarks } from "./fields/joint_marks";
import { namesOf, probeLabels } from "./names";
import { Painter } from "./painter";
import { PlotAxes } from "./plot_axes";
import { infoOf, type SceneInfo } from "./scene_info";
import { scaleLabel } from "./fields/scale_label";
import { setRamp, setTheme, type Theme } from "./shading";
import { ShapeGroup, reachOfShape } from "./shape_group";
import { isGround } from "./shapes";
import { Strings } from "./strings";
import { SystemView, type Has, type Visibility } from "./system_view";
import { sameTopology } from "./topologies";
import { Trails } from "./trails";
import { heightOf, setUpright, upOf, upward } from "./upright";
import { widest } from "./value_range";

const kCheckEvery = 200; // ms between two checks whether the scene has outgrown its frame
const kSmall = 4000; // rows whose names follow them with every frame
const kFlatFov = 12; // degrees: a plane scene shows its faces, not its sides

export class Stage {
  readonly camera = new PerspectiveCamera(40, 1, 0.05, 400);
  readonly framing: Framing;
  readonly views = new Map<string, SystemView | GridView>();
  readonly handle = new Handle();
  readonly show: Visibility = { points: true, lines: true, surface: true, bySpeed: true, colorBy: "", scheme: schemeOf({}, "", undefined) };

  private readonly viewHeight: IUniform<number> = { value: 1 };
  private readonly painter: Painter;
  private readonly scene = new Scene();
  private readonly ground = new Ground();
  private readonly joints = new JointMarks();
  private parts = new Map<string, Part>();
  private settings: ViewerSettings = {};
  private readonly shapes = new ShapeGroup();
  private topology: Topology | undefined;
  private framed = false;
  /** With all bodies. */
  private complete = false;
  private sinceCheck = 0;
  private extent = 1;
  private bounds = new Sphere(new Vector3(), 1);
  private info: SceneInfo = infoOf(undefined);
  private readonly labels: Labels;
  private labelled = false;
  private readonly strings = new Strings(this.viewHeight);
  private readonly trails = new Trails(this.viewHeight);
  private axes: PlotAxes[] = [];
  private flat = false;
  /** Floors of bodies and points are determined once; a plane has a position of its own. */
  private floor = 0;
  /** s; of the frame on the screen. */
  private time = 0;

  constructor(canvas: HTMLCanvasElement) {
    this.painter = new Painter(canvas, this.viewHeight, {
      scene: this.scene,
      camera: this.camera,
      ground: this.ground,
      rows: () => this.rows(),
      turn: (now) => this.framing.update(now),
      before: (_, height) => this.handle.face(this.camera, height),
      after: (width, height) => this.labels.place(this.camera, width, height),
      resized: () => this.framing.resized(),
    });
    this.scene.background = null;
    this.scene.add(this.ground.object, this.shapes.object, this.joints.object, this.handle.object, this.strings.object, this.trails.object);
    this.framing = new Framing(this.camera, canvas, () => this.invalidate());
    this.labels = new Labels(canvas);
    this.ground.fit(new Sphere(new Vector3(0, 0.8, 0), 2.5), 0);
    this.painter.start();
  }

  get controls(): Framing["controls"] {
    return this.framing.controls;
  }

  /** Forgets the last session; the next scene's camera is in `settings`, otherwise whatever appears is framed. */
  clear(settings: ViewerSettings, info: SceneInfo): void {
    this.settings = settings;
    this.info = info;
    for (const view of this.views.values()) view.dispose();
    this.views.clear();
    this.topology = undefined;
    this.shapes.set([], [], 1);
    this.setMarks(undefined);
    setUpright(upOf(info.gravity, settings.camera?.up));
    this.framing.clear(settings.camera);
    this.trails.clear(settings.trail ?? 0);
    this.colorAs();
    for (const axes of this.axes) axes.dispose();
    this.axes = [];
    this.flat = false;
    this.strings.set([]);
    this.labels.set([]);
    this.framed = this.complete = false;
    this.handle.hide();
    this.invalidate(true);
  }

  /** Settles what colours mean: by the scene's settings, or by the field if another one is shown. */
  private colorAs(): void {
    const { colorBy } = this.show;
    const field = [...this.parts.values()].flatMap((part) => part.fields).find((one) => one.name === colorBy);
    this.show.scheme = schemeOf(this.settings, colorBy, field);
    this.show.range = this.settings.range;
    setRamp(this.show.scheme);
  }

  setTheme(theme: Theme): void {
    setTheme(theme);
    setRamp(this.show.scheme);
    this.painter.setTheme();
    if (this.framed) this.fitAxes();
    for (const view of this.views.values()) view.apply(this.show);
    this.invalidate(true);
  }

  /** Takes the parts; the topology follows. */
  setParts(parts: Map<string, Part>): void {
    this.parts = parts;
    this.colorAs();
  }

  /** Takes a new topology; systems with unchanged connectivity keep their views. */
  setTopology(topology: Topology): void {
    const before = this.topology;
    this.topology = topology;
    topology.systems.forEach((system, index) => {
      const old = before?.systems.find((other) => other.system === system.system);
      if (old && this.views.has(system.system) && sameTopology(old, system)) return;
      this.views.get(system.system)?.dispose();
      const part = this.parts.get(system.system);
      const view = part?.lattice
        ? new GridView(part, this.settings, this.viewHeight)
        : new SystemView(system.system, system, index, this.viewHeight, this.ground.shadowUniforms, part, system.plot.length > 0, this.settings.liquid === "surface", (id) => this.elementsOf(id));
      this.views.set(view.id, view);
      this.scene.add(view.group);
    });
    for (const [id, view] of this.views) {
      if (topology.systems.some((system) => system.system === id)) continue;
      view.dispose();
      this.views.delete(id);
    }
    this.strings.set(topology.strings);
    if (this.framed) this.drawShapes();
    else this.lieDown(topology);
    this.invalidate(true);
  }

  /** A plane scene is seen from its front, a plot has axes around it. */
  private lieDown(topology: Topology): void {
    for (const axes of this.axes) axes.dispose();
    this.axes = topology.systems.filter(({ plot }) => plot.length > 1).map(({ plot }) => new PlotAxes(plot, this.info.duration, this.viewHeight));
    for (const axes of this.axes) this.scene.add(axes.object);
    this.flat = topology.systems.length > 0 && topology.systems.every(({ plane }) => plane);
    if (this.flat) this.camera.fov = kFlatFov;
    this.framing.leaveRoom(this.axes.length > 0);
  }

  /** Something is drawn as a plot. */
  get plotted(): boolean {
    return this.axes.length > 0;
  }

  /** Moves the shapes of the topology to where they are now. */
  moveShapes(shapes: Shape[]): void {
    if (this.topology) this.topology.shapes = shapes;
    this.shapes.move(shapes);
    this.invalidate(true);
  }

  /** Contacts and joints to draw from now on. */
  setMarks(marks: Marks | undefined): void {
    this.joints.mark(marks);
    this.joints.draw(this.show, this.bounds.radius);
    this.invalidate();
  }

  /** What shows the values of a part by its colour; "" or undefined: nothing. */
  private elementsOf(id: string): string | undefined {
    return this.parts.get(id)?.elements;
  }

  /** Views of parts whose rows can be grabbed. */
  pointViews(): SystemView[] {
    return [...this.views.values()].filter((view) => view instanceof SystemView);
  }

  /** The meaning of the colours: of a grid, otherwise of points, bodies and lines coloured by a value. */
  get colorScale(): Scale | undefined {
    for (const view of this.views.values()) if (view instanceof GridView) return view.scale;
    let low = Infinity;
    let high = -Infinity;
    for (const range of [...[...this.views.values()].map((view) => view.range), this.joints.shownRange(this.show)]) {
      if (!range) continue;
      low = Math.min(low, range[0]);
      high = Math.max(high, range[1]);
    }
    if (low > high) return undefined;
    const name = this.show.colorBy || "speed";
    const field = [...this.parts.values()].flatMap((part) => part.fields).find((one) => one.name === name);
    const unit = field?.unit ?? (name === "speed" ? "m/s" : "");
    const { map, kinds } = this.show.scheme;
    const present = new Set(this.pointViews().flatMap((view) => [...view.present]));
    return { label: scaleLabel(this.settings, name, unit), map, low, high, kinds: kinds.filter((_, k) => present.has(k)) };
  }

  /** Draws `frame` with the next picture; the promise resolves when that picture has been drawn. */
  present(frame: DecodedFrame): Promise<void> {
    const fieldsOf = (view: SystemView | GridView): FieldArray[] =>
      // Values of a system's lines and triangles travel as a part of their own.
      frame.fields.filter((field) => field.system === view.id || (this.elementsOf(field.system) && this.parts.get(field.system)?.system === view.id));
    const update = (view: SystemView | GridView): void => {
      const fields = fieldsOf(view);
      if (fields.length > 0) view.update(fields, this.show);
    };
    // Going back in time begins the range of the colours anew.
    if (frame.time < this.time) for (const colored of [...this.pointViews(), this.joints]) colored.forgetRange();
    this.time = frame.time;
    this.joints.take(frame.fields, this.parts, this.show.bySpeed ? this.show.colorBy : "");
    const common = (): [number, number] | undefined => widest([...this.pointViews(), this.joints].map((colored) => colored.ownRange));
    const before = (this.show.common = common());
    for (const view of this.views.values()) update(view);
    // One colour bar explains all systems: what does not reach as far takes its colours from what does.
    const now = (this.show.common = common());
    if (now && (!before || now[0] < before[0] || now[1] > before[1])) for (const view of this.pointViews()) if (view.ownRange) update(view);
    for (const view of this.pointViews()) this.trails.take(view.id, view.positions, view.count, frame.time, this.show.bySpeed && this.show.colorBy ? undefined : view.tint);
    if (this.joints.tells) this.joints.draw(this.show, this.bounds.radius);
    this.strings.update((id) => {
      const view = this.views.get(id);
      return view instanceof SystemView ? view : undefined;
    });
    // The first frame may come before orientations have been asked for: bodies are where they belong one frame later.
    const placed = this.pointViews().every((view) => view.placed);
    if ((!this.framed || (placed && !this.complete)) && this.views.size > 0) {
      this.complete = placed;
      this.frameScene();
    } else if (performance.now() - this.sinceCheck >= kCheckEvery) this.followGrowth();
    else if (this.labelled && this.rows() < kSmall) this.nameSystems();
    if (this.framing.following) this.track();
    this.invalidate(true);
    return this.painter.drawn();
  }

  /** Applies `show` to everything on the screen. */
  applyVisibility(): void {
    for (const view of this.views.values()) view.apply(this.show);
    this.invalidate(true);
  }

  /** Something on the screen has the field that colours would show. */
  get colorable(): boolean {
    const name = this.show.colorBy || "speed";
    const has = (part: Part): boolean => part.fields.some((field) => field.name === name) || (name === "speed" && meaning(part, "velocity") !== undefined);
    return [...this.parts].some(([id, part]) => !part.lattice && (this.views.has(id) || part.elements !== "") && has(part));
  }

  /** Only grids are on the screen. */
  get onlyGrids(): boolean {
    return this.views.size > 0 && [...this.views.values()].every((view) => view instanceof GridView);
  }

  get has(): Has {
    const all = [...this.views.values()].map((view) => view.has);
    const some = (key: keyof Has): boolean => all.some((h) => h[key]);
    return { points: some("points"), lines: some("lines"), surface: some("surface"), bodies: some("bodies") };
  }

  /** Frames everything seen so far in the free part of the picture, from the scene's own side or another. */
  frameAll(side: Side = "scene"): void {
    this.framing.frameAll(side);
    this.invalidate(true);
  }

  /** Sets how much of the picture is covered (CSS pixels); the scene is framed in the rest. */
  setInset(inset: Inset): void {
    this.framing.setInset(inset);
  }

  invalidate(shadows = false): void {
    this.painter.invalidate(shadows);
  }

  /** Rows on the screen. */
  private rows(): number {
    return [...this.views.values()].reduce((sum, view) => sum + view.count, 0);
  }

  /** The present extent. */
  private reach(): Extent {
    const now = new Extent();
    for (const view of this.views.values()) view.reachOf(now);
    for (const shape of this.topology?.shapes ?? []) reachOfShape(now, shape, this.topology?.meshes ?? []);
    this.axes.forEach((axes) => axes.reachOf(now));
    if (this.joints.tells) this.joints.eachEnd((x, y, z) => now.add(x, y, z));
    return now;
  }

  /** Sizes ground, light and camera for what is on the screen. */
  private frameScene(): void {
    this.framed = true;
    this.sinceCheck = performance.now();
    const now = this.reach();
    const { radius: size } = now.ball();
    this.extent = Math.max(size, Math.min(0.2, 20 * size)) || 0.2;
    this.drawShapes();
    this.strings.reachOf((x, y, z) => now.add(x, y, z));
    let lowest = Infinity;
    for (const view of this.views.values()) if (view.bodies) lowest = Math.min(lowest, view.bodies.frame(now));
    if (now.empty) for (const x of [-1, 1]) now.add(x, 0.5, x);
    this.framing.setFacing(this.facing());
    this.framing.begin(now);
    const plane = this.topology?.shapes.find(isGround);
    const radius = now.ball().radius;
    this.floor = plane ? heightOf(plane.position[0] ?? 0, plane.position[1] ?? 0, plane.position[2] ?? 0) : floorUnder(Math.min(now.bottom(upward.toArray()), lowest), lowest < Infinity, radius);
    // A grid has its own ground, and troughs of a height surface lie below any other.
    this.ground.object.visible = !this.onlyGrids && ((this.info.pulled && !this.topology?.systems.every(({ plot }) => plot.length > 0)) || plane !== undefined) && !this.facing();
    this.fitGround();
    this.fitAxes();
  }

  /** The side from which a flat scene is viewed. */
  private facing(): Vector3 | undefined {
    if (this.flat) return new Vector3(0, 0, 1);
    const sides = [...this.views.values()].map((view) => (view instanceof GridView ? view.facing : undefined));
    return sides.length > 0 && sides.every((side) => side !== undefined) ? new Vector3().fromArray(sides[0]!) : undefined;
  }

  private fitGround(): void {
    const { center, radius } = this.framing.seen.ball();
    this.bounds = new Sphere(new Vector3().fromArray(center), radius || 0.05);
    const plane = this.topology?.shapes.some(isGround);
    // Anything that swings below the guessed floor lowers it.
    const low = this.framing.seen.bottom(upward.toArray());
    if (!plane && low < this.floor) this.floor = low - 0.02 * radius;
    // Objects far above the ground cast their shadow outside the light's view; include the floor below them.
    this.ground.fit(this.bounds.clone().expandByPoint(this.bounds.center.clone().addScaledVector(upward, this.floor - heightOf(...center))), this.floor);
  }

  private fitAxes(): void {
    for (const axes of this.axes) axes.fit(this.framing.seen);
    this.nameSystems();
  }

  /** Ticks and names of axes, and names next to systems if there are only a few. */
  private nameSystems(): void {
    const labels: Label[] = this.axes.flatMap((axes) => axes.labels);
    const views = this.pointViews();
    if (this.axes.length === 0 && this.settings.labels !== false) labels.push(...namesOf(views));
    for (const view of views) labels.push(...view.curves());
    if (this.settings.probe_labels) labels.push(...probeLabels(this.info.probes, this.views));
    this.labelled = labels.some(({ kind }) => kind === "name" || kind === "row");
    this.labels.set(labels);
  }

  /** A scene that outgrows its frame gets a larger one. */
  private followGrowth(): void {
    this.sinceCheck = performance.now();
    const before = this.framing.seen.ball().radius;
    const now = this.reach();
    // Follow what has left for good: an empty picture shows nothing.
    if (this.framing.lost(now) && !this.framing.held && !this.framing.following) this.framing.follow(true);
    if (this.framing.grow(now) || this.framing.seen.ball().radius > 1.1 * before) {
      this.fitGround();
      this.fitAxes();
    } else {
      if (this.framing.seen.ball().radius > before) for (const axes of this.axes) axes.fit(this.framing.seen);
      this.nameSystems();
    }
  }

  /** Keeps the centre of everything that moves at its place on the screen. */
  private track(): void {
    const middles = [...this.views.values()].flatMap((view) => (view instanceof SystemView ? [view.middle()] : [])).filter((middle) => middle !== undefined);
    if (middles.length === 0) return;
    this.framing.track(middles.reduce((sum, middle) => sum.add(middle), new Vector3()).divideScalar(middles.length));
  }

  private drawShapes(): void {
    this.shapes.set(this.topology?.shapes ?? [], this.topology?.meshes ?? [], 1.5 * this.extent);
  }
}
