// Cloth and other triangles over the system's shared positions, lit from both sides. Vertex normals are the
// sum of the adjacent triangles' area vectors, n_i = sum (b - a) x (c - a), normalised in the shader.
import { BufferAttribute, BufferGeometry, Color, DoubleSide, DynamicDrawUsage, Mesh, ShaderMaterial } from "three";
import { litVertexGlsl, shadeGlsl } from "../shading";
import { lightUniforms } from "../upright";

const vertex = litVertexGlsl();

const fragment = /* glsl */ `
uniform vec3 color;
in vec3 vNormal, vWorld;
${shadeGlsl}
void main() {
  vec3 toEye = normalize(cameraPosition - vWorld);
  vec3 n = normalize(vNormal);
  bool back = dot(n, toEye) < 0.0;
  vec3 albedo = back ? color * vec3(0.62, 0.60, 0.66) : color;
  gl_FragColor = vec4(shade(albedo, back ? -n : n, toEye), 1.0);
  #include <colorspace_fragment>
}`;

/** Triangles between rows of `positions`, three rows each. */
export class Surface {
  readonly object: Mesh;
  private readonly normal: BufferAttribute;

  constructor(
    private readonly positions: BufferAttribute,
    private readonly triangles: Uint32Array,
    color: Color,
  ) {
    this.normal = new BufferAttribute(new Float32Array(positions.array.length), 3).setUsage(DynamicDrawUsage);
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", positions);
    geometry.setAttribute("normal", this.normal);
    geometry.setIndex(new BufferAttribute(triangles, 1));
    const material = new ShaderMaterial({ uniforms: { ...lightUniforms, color: { value: color } }, vertexShader: vertex, fragmentShader: fragment, side: DoubleSide });
    this.object = new Mesh(geometry, material);
    this.object.frustumCulled = false;
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
  }

  dispose(): void {
    this.object.geometry.dispose();
    (this.object.material as ShaderMaterial).dispose();
    this.object.removeFromParent();
  }
}
