// Cloth and other triangles over the system's shared positions, lit from both sides. Vertex normals are the
// sum of the adjacent triangles' area vectors, n_i = sum (b - a) x (c - a), normalised in the shader. Values colour
// them by vertex or by triangle; for these every triangle has corners of its own.
import { BufferAttribute, BufferGeometry, Color, DoubleSide, DynamicDrawUsage, Mesh, ShaderMaterial, type IUniform } from "three";
import { litVertexGlsl, rampGlsl, rampUniform, shadeGlsl } from "../shading";
import { lightUniforms } from "../upright";

const vertex = litVertexGlsl(
  `uniform float valueScale, valueStart;
in float value;
out float vValue;`,
  "vValue = (value - valueStart) * valueScale;",
);

const fragment = /* glsl */ `
uniform vec3 color;
uniform bool byValue;
in float vValue;
in vec3 vNormal, vWorld;
${shadeGlsl}
${rampGlsl}
void main() {
  vec3 toEye = normalize(cameraPosition - vWorld);
  vec3 n = normalize(vNormal);
  bool back = dot(n, toEye) < 0.0;
  vec3 albedo = byValue ? ramp(vValue) : back ? color * vec3(0.62, 0.60, 0.66) : color;
  gl_FragColor = vec4(shade(albedo, back ? -n : n, toEye), 1.0);
  #include <colorspace_fragment>
}`;

const room = (count: number, width: number): BufferAttribute => new BufferAttribute(new Float32Array(count * width), width).setUsage(DynamicDrawUsage);

/** Triangles between rows of `positions`, three rows each. */
export class Surface {
  readonly object: Mesh;
  private readonly normal: BufferAttribute;
  private readonly value: BufferAttribute;
  private readonly uniforms: Record<string, IUniform>;
  private readonly shared = new BufferGeometry();
  /** With three corners for every triangle; made when triangles get values. */
  private facets: BufferGeometry | undefined;

  constructor(
    private readonly positions: BufferAttribute,
    private readonly triangles: Uint32Array,
    color: Color,
  ) {
    this.normal = new BufferAttribute(new Float32Array(positions.array.length), 3).setUsage(DynamicDrawUsage);
    this.value = room(positions.array.length / 3, 1);
    this.shared.setAttribute("position", positions).setAttribute("normal", this.normal).setAttribute("value", this.value);
    this.shared.setIndex(new BufferAttribute(triangles, 1));
    this.uniforms = { ...lightUniforms, color: { value: color }, byValue: { value: false }, valueScale: { value: 1 }, valueStart: { value: 0 }, stops: rampUniform };
    const material = new ShaderMaterial({ uniforms: this.uniforms, vertexShader: vertex, fragmentShader: fragment, side: DoubleSide });
    this.object = new Mesh(this.shared, material);
    this.object.frustumCulled = false;
  }

  /** Colours by a value per vertex or per triangle over `range`; without values it has its own colour. */
  color(vertices: Float32Array | undefined, triangles: Float32Array | undefined, [low, high]: [number, number]): void {
    this.uniforms.byValue!.value = vertices !== undefined || triangles !== undefined;
    this.uniforms.valueScale!.value = high > low ? 1 / (high - low) : 0;
    this.uniforms.valueStart!.value = low;
    const one = (value: number): number => (Number.isFinite(value) ? value : low);
    if (triangles) {
      this.facets ??= this.split();
      const value = this.facets.getAttribute("value") as BufferAttribute;
      for (let k = 0; k < 3 * triangles.length; ++k) value.array[k] = one(triangles[Math.floor(k / 3)]!);
      value.needsUpdate = true;
    } else if (vertices) {
      for (let k = 0; k < Math.min(vertices.length, this.value.array.length); ++k) this.value.array[k] = one(vertices[k]!);
      this.value.needsUpdate = true;
    }
    this.object.geometry = triangles ? this.facets! : this.shared;
  }

  /** Computes the normals of the positions as they are now. */
  update(): void {
    const x = this.positions.array as Float32Array;
    const n = this.normal.array as Float32Array;
    const t = this.triangles;
    n.fill(0);
    for (let k = 0; k < t.length; k += 3) {
      const a = 3 * t[k]!;
      const b = 3 * t[k + 1]!;
      const c = 3 * t[k + 2]!;
      const ax = x[a]!, ay = x[a + 1]!, az = x[a + 2]!;
      const ux = x[b]! - ax, uy = x[b + 1]! - ay, uz = x[b + 2]! - az;
      const vx = x[c]! - ax, vy = x[c + 1]! - ay, vz = x[c + 2]! - az;
      const nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
      n[a]! += nx; n[a + 1]! += ny; n[a + 2]! += nz;
      n[b]! += nx; n[b + 1]! += ny; n[b + 2]! += nz;
      n[c]! += nx; n[c + 1]! += ny; n[c + 2]! += nz;
    }
    this.normal.needsUpdate = true;
    if (this.facets && this.object.geometry === this.facets) this.spread(this.facets);
  }

  private split(): BufferGeometry {
    const corners = this.triangles.length;
    return new BufferGeometry().setAttribute("position", room(corners, 3)).setAttribute("normal", room(corners, 3)).setAttribute("value", room(corners, 1));
  }

  /** Copies positions and normals to the triangles' own corners. */
  private spread(facets: BufferGeometry): void {
    for (const [name, from] of [["position", this.positions], ["normal", this.normal]] as const) {
      const to = facets.getAttribute(name) as BufferAttribute;
      for (let k = 0; k < this.triangles.length; ++k) for (let c = 0; c < 3; ++c) to.array[3 * k + c] = from.array[3 * this.triangles[k]! + c]!;
      to.needsUpdate = true;
    }
  }

  dispose(): void {
    this.shared.dispose();
    this.facets?.dispose();
    (this.object.material as ShaderMaterial).dispose();
    this.object.removeFromParent();
  }
}
