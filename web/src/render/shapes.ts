// The scene's solid shapes: planes, boxes, spheres, capsules and meshes. Containers are drawn as their edges and faint inner
// faces, so that what is inside stays visible. A plane that faces up is the ground.
import {
  BackSide, BoxGeometry, BufferAttribute, BufferGeometry, CapsuleGeometry, Color, DoubleSide, EdgesGeometry, FrontSide, Group, LineBasicMaterial,
  LineSegments, Mesh, PlaneGeometry, Quaternion, ShaderMaterial, SphereGeometry, Vector3, type Object3D,
} from "three";
import { floats, uints } from "../client/decode";
import type { Mesh as MeshData, Shape } from "../client/gen/truestep/v1/stream_pb";
import { shadeGlsl } from "./shading";
import { heightOf, lightUniforms } from "./upright";

const vertex = /* glsl */ `
out vec3 vNormal, vWorld;
void main() {
  vec4 w = modelMatrix * vec4(position, 1.0);
  vNormal = mat3(modelMatrix) * normal;
  vWorld = w.xyz;
  gl_Position = projectionMatrix * (viewMatrix * w);
}`;

const fragment = /* glsl */ `
uniform vec3 color;
uniform float opacity;
in vec3 vNormal, vWorld;
${shadeGlsl}
void main() {
  vec3 toEye = normalize(cameraPosition - vWorld);
  vec3 n = normalize(vNormal);
  if (dot(n, toEye) < 0.0) n = -n;
  gl_FragColor = vec4(shade(color, n, toEye), opacity);
  #include <colorspace_fragment>
}`;

const edgeColor = new Color("#7f8fa6");

/** True for a horizontal plane facing up, which is replaced by the viewer's ground. */
export function isGround(shape: Shape): boolean {
  const normal = planeNormal(shape);
  return shape.kind === "plane" && heightOf(normal.x, normal.y, normal.z) > 0.999;
}

function planeNormal(shape: Shape): Vector3 {
  const [x = 0, y = 1, z = 0] = shape.size;
  return new Vector3(x, y, z).normalize().applyQuaternion(orientation(shape));
}

function orientation(shape: Shape): Quaternion {
  const [w = 1, x = 0, y = 0, z = 0] = shape.orientation;
  return new Quaternion(x, y, z, w);
}

function geometryOf(shape: Shape, meshes: MeshData[], extent: number): BufferGeometry | undefined {
  const [a = 1, b = a, c = a] = shape.size;
  switch (shape.kind) {
    case "box":
      return new BoxGeometry(2 * a, 2 * b, 2 * c);
    case "sphere":
      return new SphereGeometry(a, 48, 32);
    case "capsule":
      return new CapsuleGeometry(a, 2 * (shape.size[1] ?? 0.5), 16, 32);
    case "plane":
      return new PlaneGeometry(2 * extent, 2 * extent);
    case "mesh": {
      const mesh = meshes[shape.mesh];
      return mesh && geometryOfMesh(mesh);
    }
    default:
      return undefined;
  }
}

export function geometryOfMesh(mesh: MeshData): BufferGeometry {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(floats(mesh.positions), 3));
  geometry.setAttribute("normal", new BufferAttribute(floats(mesh.normals), 3));
  return geometry.setIndex(new BufferAttribute(uints(mesh.triangles), 1));
}

/** A drawable for `shape`, or undefined for the ground and for kinds this viewer does not know. */
export function makeShape(shape: Shape, meshes: MeshData[], extent: number): Object3D | undefined {
  if (isGround(shape)) return undefined;
  const geometry = geometryOf(shape, meshes, extent);
  if (!geometry) return undefined;
  const open = shape.container || shape.kind === "plane";
  const material = new ShaderMaterial({
    uniforms: { ...lightUniforms, color: { value: new Color(open ? "#7d93b3" : "#8a96a8") }, opacity: { value: open ? 0.1 : 1 } },
    vertexShader: vertex,
    fragmentShader: fragment,
    transparent: open,
    depthWrite: !open,
    // A container's floor in the ground's plane would flicker.
    polygonOffset: open,
    polygonOffsetFactor: 2,
    polygonOffsetUnits: 4,
    side: shape.container ? BackSide : shape.kind === "plane" ? DoubleSide : FrontSide,
  });
  const mesh = new Mesh(geometry, material);
  const group = new Group();
  group.add(mesh);
  if (open) {
    const edges = new LineSegments(new EdgesGeometry(geometry, 30), new LineBasicMaterial({ color: edgeColor, transparent: true, opacity: 0.5 }));
    group.add(edges);
  } else {
    mesh.layers.enable(1);
  }
  group.userData.solid = shape.kind !== "plane";
  placeShape(group, shape);
  return group;
}

/** Moves a drawable to where `shape` is. */
export function placeShape(object: Object3D, shape: Shape): void {
  const [x = 0, y = 0, z = 0] = shape.position;
  object.position.set(x, y, z);
  if (shape.kind === "plane") object.quaternion.setFromUnitVectors(new Vector3(0, 0, 1), planeNormal(shape));
  else object.quaternion.copy(orientation(shape));
}
