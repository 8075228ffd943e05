// A liquid's particles as a smooth surface, recomputed from the positions of every frame.
import { BufferAttribute, BufferGeometry, Color, DoubleSide, Mesh, ShaderMaterial, type IUniform } from "three";
import { particleSurface } from "./particle_surface";
import { litVertexGlsl, rampGlsl, rampUniform, shadeGlsl } from "../shading";
import { lightUniforms } from "../upright";

const kCell = 0.75; // width of the lattice's cells, in spacings
const kMany = 30000; // from this many particles on, cells are one spacing wide

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
  gl_FragColor = vec4(shade(byValue ? ramp(vValue) : color, dot(n, toEye) < 0.0 ? -n : n, toEye), 1.0);
  #include <colorspace_fragment>
}`;

export class Liquid {
  readonly object: Mesh;
  private readonly uniforms: Record<string, IUniform>;

  constructor(
    private readonly spacing: number,
    color: Color,
  ) {
    this.uniforms = { ...lightUniforms, color: { value: color }, byValue: { value: false }, valueScale: { value: 1 }, valueStart: { value: 0 }, stops: rampUniform };
    const material = new ShaderMaterial({ uniforms: this.uniforms, vertexShader: vertex, fragmentShader: fragment, side: DoubleSide });
    this.object = new Mesh(new BufferGeometry(), material);
    this.object.frustumCulled = false;
  }

  /** Takes `count` positions and, for colouring, a value for each and the range of the colours. */
  update(positions: Float32Array, count: number, values: Float32Array | undefined, range: [number, number] | undefined): void {
    const found = particleSurface(positions, count, values, this.spacing, (count > kMany ? 1 : kCell) * this.spacing);
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(found.positions, 3));
    geometry.setAttribute("value", new BufferAttribute(found.values ?? new Float32Array(found.positions.length / 3), 1));
    geometry.setIndex(new BufferAttribute(found.triangles, 1));
    geometry.computeVertexNormals();
    this.object.geometry.dispose();
    this.object.geometry = geometry;
    const [low, high] = range ?? [0, 1];
    this.uniforms.byValue!.value = values !== undefined;
    this.uniforms.valueScale!.value = high > low ? 1 / (high - low) : 0;
    this.uniforms.valueStart!.value = low;
  }

  dispose(): void {
    this.object.geometry.dispose();
    (this.object.material as ShaderMaterial).dispose();
    this.object.removeFromParent();
  }
}
