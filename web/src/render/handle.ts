// The mark on the point under the mouse: a ring of constant size on the screen, and while the point is
// dragged a line from it to where the mouse pulls.
import {
  BufferAttribute, BufferGeometry, Group, Line, LineBasicMaterial, Mesh, MeshBasicMaterial, RingGeometry, Vector3,
  type PerspectiveCamera,
} from "three";

const kRingPixels = 9;

export class Handle {
  readonly object = new Group();
  private readonly ring = new Mesh(
    new RingGeometry(0.78, 1, 40),
    new MeshBasicMaterial({ color: "#ffffff", transparent: true, opacity: 0.9, depthTest: false }),
  );
  private readonly ends = new BufferAttribute(new Float32Array(6), 3);
  private readonly line: Line;

  constructor() {
    const geometry = new BufferGeometry().setAttribute("position", this.ends);
    this.line = new Line(geometry, new LineBasicMaterial({ color: "#ffffff", transparent: true, opacity: 0.7, depthTest: false }));
    this.line.frustumCulled = false;
    this.object.add(this.ring, this.line);
    this.object.renderOrder = 10;
    this.hide();
  }

  /** Marks `point`; with `target` also the pull towards it. */
  mark(point: Vector3, target: Vector3 | undefined): void {
    this.object.visible = true;
    this.ring.position.copy(point);
    this.line.visible = target !== undefined;
    if (target) {
      point.toArray(this.ends.array, 0);
      target.toArray(this.ends.array, 3);
      this.ends.needsUpdate = true;
    }
  }

  hide(): void {
    this.object.visible = false;
  }

  /** Turns the ring to the camera of a view `height` pixels high and keeps its size on the screen. */
  face(camera: PerspectiveCamera, height: number): void {
    if (!this.object.visible) return;
    this.ring.quaternion.copy(camera.quaternion);
    const depth = this.ring.position.distanceTo(camera.position);
    this.ring.scale.setScalar((kRingPixels * 2 * depth * Math.tan((camera.fov * Math.PI) / 360)) / height);
  }
}
