// Lines that can be seen: every line is a quad that faces the eye, at least a few pixels wide however far away it
// is, and shaded as a tube. A line has one colour, or one by its value.
import { Color, DynamicDrawUsage, InstancedBufferAttribute, InstancedBufferGeometry, BufferAttribute, Mesh, ShaderMaterial, type IUniform } from "three";
import { rampGlsl, rampUniform } from "./shading";

const vertex = /* glsl */ `
in vec3 from, to;
in vec4 tint;
uniform float viewHeight, pixels, radius;
out vec4 vTint;
out float vSide;
void main() {
  vTint = tint;
  vSide = position.y;
  vec4 a = modelViewMatrix * vec4(from, 1.0);
  vec4 b = modelViewMatrix * vec4(to, 1.0);
  bool perspective = projectionMatrix[3][3] == 0.0;
  // Points behind the eye have no position on the screen: the line ends in front of it.
  if (perspective) {
    float near = -0.001 - 0.5 * abs(projectionMatrix[3][2] / projectionMatrix[2][2]);
    if (a.z > near && b.z > near) { gl_Position = vec4(2.0, 2.0, 2.0, 1.0); return; }
    if (a.z > near) a = mix(b, a, (near - b.z) / (a.z - b.z));
    if (b.z > near) b = mix(a, b, (near - a.z) / (b.z - a.z));
  }
  vec4 p = projectionMatrix * a;
  vec4 q = projectionMatrix * b;
  vec2 aspect = vec2(projectionMatrix[1][1] / projectionMatrix[0][0], 1.0);
  vec2 along = (q.xy / q.w - p.xy / p.w) * aspect;
  along = dot(along, along) > 1e-12 ? normalize(along) : vec2(1.0, 0.0);
  vec2 across = vec2(-along.y, along.x);
  vec4 at = position.x < 0.0 ? p : q;
  float half_ = max(pixels / viewHeight, radius * projectionMatrix[1][1] / at.w);
  // Half a width beyond the ends: pieces of a curve meet without gaps.
  at.xy += (across * position.y + along * position.x * 0.5) * half_ * at.w / aspect;
  gl_Position = at;
}`;

const fragment = /* glsl */ `
in vec4 vTint;
in float vSide;
uniform bool byValue, tube;
uniform float opacity;
${rampGlsl}
void main() {
  vec3 c = byValue && vTint.a >= 0.0 ? ramp(vTint.a) : vTint.rgb;
  if (tube) c *= 1.08 - 0.5 * vSide * vSide;
  gl_FragColor = vec4(c, opacity);
  #include <colorspace_fragment>
}`;

export interface LineLook {
  /** Minimum width of a line on the screen, CSS pixels. */
  pixels: number;
  /** m; 0 for lines of constant width on the screen. */
  radius: number;
  opacity: number;
  /** Shaded as tubes. */
  tube: boolean;
  /** Visible through everything. */
  above?: boolean;
}

export class WideLines {
  readonly object: Mesh<InstancedBufferGeometry, ShaderMaterial>;
  private from!: InstancedBufferAttribute;
  private to!: InstancedBufferAttribute;
  private tint!: InstancedBufferAttribute;
  private capacity = 0;

  constructor(viewHeight: IUniform<number>, look: LineLook) {
    const geometry = new InstancedBufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(Float32Array.of(-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0), 3));
    geometry.setIndex([0, 1, 2, 0, 2, 3]);
    const ratio = Math.min(globalThis.devicePixelRatio ?? 1, 2);
    const material = new ShaderMaterial({
      uniforms: { viewHeight, pixels: { value: look.pixels * ratio }, radius: { value: look.radius }, opacity: { value: look.opacity }, byValue: { value: false }, stops: rampUniform, tube: { value: look.tube } },
      vertexShader: vertex, fragmentShader: fragment, transparent: look.opacity < 1, depthWrite: look.opacity >= 1, depthTest: !look.above, side: 2,
    });
    this.object = new Mesh(geometry, material);
    this.object.frustumCulled = false;
    if (look.above) this.object.renderOrder = 5;
    this.reserve(16);
  }

  /** Ensures room for `count` lines; growing discards the contents. */
  reserve(count: number): void {
    if (count <= this.capacity) return;
    this.capacity = Math.max(count, Math.ceil(1.5 * this.capacity));
    const { geometry } = this.object;
    geometry.dispose(); // buffers of another length
    const make = (width: number): InstancedBufferAttribute => new InstancedBufferAttribute(new Float32Array(width * this.capacity), width).setUsage(DynamicDrawUsage);
    this.from = make(3);
    this.to = make(3);
    this.tint = make(4);
    geometry.setAttribute("from", this.from).setAttribute("to", this.to).setAttribute("tint", this.tint);
  }

  /** Line k from row a to row b of `positions`. */
  connect(positions: ArrayLike<number>, pairs: Uint32Array): void {
    const count = pairs.length / 2;
    const from = this.from.array as Float32Array;
    const to = this.to.array as Float32Array;
    for (let k = 0; k < count; ++k) {
      const a = 3 * pairs[2 * k]!, b = 3 * pairs[2 * k + 1]!;
      from[3 * k] = positions[a]!; from[3 * k + 1] = positions[a + 1]!; from[3 * k + 2] = positions[a + 2]!;
      to[3 * k] = positions[b]!; to[3 * k + 1] = positions[b + 1]!; to[3 * k + 2] = positions[b + 2]!;
    }
    this.show(count);
  }

  /** Lines between ends of six numbers each. */
  set(ends: ArrayLike<number>): void {
    const count = Math.floor(ends.length / 6);
    this.reserve(count);
    for (let k = 0; k < count; ++k) {
      for (let c = 0; c < 3; ++c) {
        this.from.array[3 * k + c] = ends[6 * k + c]!;
        this.to.array[3 * k + c] = ends[6 * k + 3 + c]!;
      }
    }
    this.show(count);
  }

  color(k: number, color: Color): void {
    this.tint.setXYZW(k, color.r, color.g, color.b, -1);
    this.tint.needsUpdate = true;
  }

  colorAll(color: Color): void {
    for (let k = 0; k < this.capacity; ++k) this.color(k, color);
  }

  /** Colours lines by their values, 0 to 1; undefined restores their own colours. */
  values(values: ArrayLike<number> | undefined): void {
    this.object.material.uniforms.byValue!.value = values !== undefined;
    if (!values) return;
    for (let k = 0; k < Math.min(values.length, this.capacity); ++k) this.tint.array[4 * k + 3] = Math.max(0, values[k]!);
    this.tint.needsUpdate = true;
  }

  dispose(): void {
    this.object.geometry.dispose();
    this.object.material.dispose();
    this.object.removeFromParent();
  }

  private show(count: number): void {
    this.object.geometry.instanceCount = count;
    this.from.needsUpdate = this.to.needsUpdate = true;
  }
}

/** Colours of a system's lines by kind (structural, shear, bending, other): the first is the system's own. */
export function kindColors(base: Color): Color[] {
  const toward = (hex: string, share: number): Color => base.clone().lerp(new Color(hex), share);
  return [base.clone(), toward("#ffffff", 0.35), toward("#9ea3ad", 0.7), toward("#808080", 0.3)];
}
