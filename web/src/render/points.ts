// Points as lit spheres without sphere geometry: one sprite per point, its normal computed per pixel.
// Up to kQuadLimit points every sprite is an instanced quad that writes the sphere's own depth, so large
// balls meet the ground and each other correctly; beyond it a sprite is a GL point (one vertex instead of four).
import {
  BufferAttribute, BufferGeometry, Color, DynamicDrawUsage, InstancedBufferAttribute, InstancedBufferGeometry,
  Mesh, Points, ShaderMaterial, type IUniform, type Object3D,
} from "three";
import { rampGlsl, rampUniform, shadeGlsl } from "./shading";
import { lightUniforms } from "./upright";

const kQuadLimit = 12000;

const vertexHead = /* glsl */ `
uniform float radius, valueScale, valueStart;
in float value;
out float vValue;
out vec3 vCenter;
`;

const quadVertex = /* glsl */ `${vertexHead}
in vec3 center;
out vec2 vCorner;
void main() {
  vValue = (value - valueStart) * valueScale;
  vec4 c = modelViewMatrix * vec4(center, 1.0);
  vCenter = c.xyz;
  vCorner = position.xy;
  gl_Position = projectionMatrix * (c + vec4(position.xy * radius, 0.0, 0.0));
}`;

const pointVertex = /* glsl */ `${vertexHead}
uniform float viewHeight;
void main() {
  vValue = (value - valueStart) * valueScale;
  vec4 c = modelViewMatrix * vec4(position, 1.0);
  vCenter = c.xyz;
  gl_Position = projectionMatrix * c;
  gl_PointSize = max(1.5, radius * projectionMatrix[1][1] * viewHeight / gl_Position.w);
}`;

const fragment = /* glsl */ `
uniform float radius;
uniform vec3 color;
uniform bool byValue;
uniform mat4 projectionMatrix;
in float vValue;
in vec3 vCenter;
#ifdef QUADS
in vec2 vCorner;
#endif
${shadeGlsl}
${rampGlsl}
void main() {
#ifdef QUADS
  vec2 p = vCorner;
#else
  vec2 p = vec2(2.0, -2.0) * (gl_PointCoord - 0.5);
#endif
  float r2 = dot(p, p);
  if (r2 > 1.0) discard;
  vec3 n = vec3(p, sqrt(1.0 - r2));
#ifdef QUADS
  vec4 clip = projectionMatrix * vec4(vCenter + n * radius, 1.0);
  gl_FragDepth = 0.5 + 0.5 * clip.z / clip.w;
#endif
  vec3 albedo = byValue ? ramp(vValue) : color;
  vec3 world = transpose(mat3(viewMatrix)) * n;
  vec3 toEye = transpose(mat3(viewMatrix)) * normalize(-vCenter);
  gl_FragColor = vec4(shade(albedo, world, toEye), 1.0);
  #include <colorspace_fragment>
}`;

/** The points of one system. `object` is replaced when the number of points crosses kQuadLimit. */
export class PointCloud {
  object: Object3D | undefined;
  private readonly uniforms: Record<string, IUniform>;
  private capacity = 0;
  private quads = true;
  private center: BufferAttribute = new BufferAttribute(new Float32Array(0), 3);
  private value: BufferAttribute = new BufferAttribute(new Float32Array(0), 1);
  private shown: [number, number] | undefined;

  constructor(radius: number, color: Color, viewHeight: IUniform<number>) {
    this.uniforms = {
      ...lightUniforms,
      radius: { value: radius }, color: { value: color }, viewHeight,
      valueScale: { value: 1 }, valueStart: { value: 0 }, byValue: { value: false }, stops: rampUniform,
    };
  }

  /** Takes `count` positions and, if the server sends it, a value per point to colour by, with the range of the colours. */
  update(positions: Float32Array, count: number, values: Float32Array | undefined, range: readonly [number, number] = [0, 1]): void {
    if (count > this.capacity || !this.object) this.allocate(Math.max(16, Math.ceil(count * 1.25)));
    (this.center.array as Float32Array).set(positions.subarray(0, 3 * count));
    upload(this.center, 3 * count);
    this.uniforms.byValue!.value = values !== undefined;
    if (values) {
      (this.value.array as Float32Array).set(values.subarray(0, count));
      upload(this.value, count);
      const [low, high] = range;
      this.uniforms.valueScale!.value = high > low ? 1 / (high - low) : 0;
      this.uniforms.valueStart!.value = low;
      this.shown = [low, high];
    } else {
      this.shown = undefined;
    }
    const geometry = (this.object as Mesh).geometry as InstancedBufferGeometry;
    if (this.quads) geometry.instanceCount = count;
    else geometry.setDrawRange(0, count);
  }

  /** Lowest and highest value of the colours. */
  get range(): [number, number] | undefined {
    return this.shown;
  }

  dispose(): void {
    if (!this.object) return;
    (this.object as Mesh).geometry.dispose();
    ((this.object as Mesh).material as ShaderMaterial).dispose();
    this.object.removeFromParent();
  }

  private allocate(capacity: number): void {
    const parent = this.object?.parent;
    const layers = this.object?.layers.mask;
    this.dispose();
    this.capacity = capacity;
    this.quads = capacity <= kQuadLimit;
    const Attribute = this.quads ? InstancedBufferAttribute : BufferAttribute;
    this.center = new Attribute(new Float32Array(3 * capacity), 3).setUsage(DynamicDrawUsage);
    this.value = new Attribute(new Float32Array(capacity), 1).setUsage(DynamicDrawUsage);
    const geometry = this.quads ? new InstancedBufferGeometry() : new BufferGeometry();
    geometry.setAttribute("value", this.value);
    const material = new ShaderMaterial({
      uniforms: this.uniforms,
      vertexShader: this.quads ? quadVertex : pointVertex,
      fragmentShader: fragment,
      defines: this.quads ? { QUADS: "" } : {},
    });
    if (this.quads) {
      geometry.setAttribute("position", new BufferAttribute(Float32Array.of(-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0), 3));
      geometry.setAttribute("center", this.center);
      geometry.setIndex([0, 1, 2, 0, 2, 3]);
      this.object = new Mesh(geometry, material);
    } else {
      geometry.setAttribute("position", this.center);
      this.object = new Points(geometry, material);
    }
    this.object.frustumCulled = false;
    if (layers !== undefined) this.object.layers.mask = layers;
    parent?.add(this.object);
  }
}

function upload(attribute: BufferAttribute, length: number): void {
  attribute.clearUpdateRanges();
  attribute.addUpdateRange(0, length);
  attribute.needsUpdate = true;
}
