// The ground: a disc that fades into the background, a one-metre grid, and the soft shadow of everything
// above it. The shadow needs no depth map: nothing lies below the ground, so a point of it is shaded exactly
// where something covers it as seen from the light. Coverage is the alpha of one small orthographic picture
// (layer 1), softened by its mipmaps and a few taps.
import {
  CircleGeometry, DataTexture, LinearFilter, LinearMipmapLinearFilter, Matrix4, Mesh, OrthographicCamera, ShaderMaterial,
  Vector3, WebGLRenderTarget, type IUniform, type Scene, type Sphere, type WebGLRenderer,
} from "three";
import { scenery } from "./shading";
import { heightOf, keyDirection, turnUp, turned, upward } from "./upright";

const kMapSize = 512;

const vertex = /* glsl */ `
uniform mat4 toLight;
uniform vec3 middle, across, along;
out vec2 vAway, vPlace;
out vec2 vLight;
void main() {
  vec4 w = modelMatrix * vec4(position, 1.0);
  vPlace = vec2(dot(w.xyz, across), dot(w.xyz, along));
  vAway = vPlace - vec2(dot(middle, across), dot(middle, along));
  vLight = (toLight * w).xy * 0.5 + 0.5;
  gl_Position = projectionMatrix * (viewMatrix * w);
}`;

const fragment = /* glsl */ `
uniform sampler2D coverage;
uniform vec3 background, floorColor, lineColor;
uniform float fade, cell, shadow;
in vec2 vAway, vPlace, vLight;
float grid(vec2 p, float size) {
  vec2 q = p / size;
  vec2 w = fwidth(q);
  vec2 d = abs(fract(q - 0.5) - 0.5) / max(w, vec2(1e-5));
  return (1.0 - min(min(d.x, d.y), 1.0)) * clamp(1.0 - 2.0 * max(w.x, w.y), 0.0, 1.0);
}
void main() {
  float near = exp(-dot(vAway, vAway) / (fade * fade));
  vec3 c = mix(background, floorColor, near);
  float lines = max(0.35 * grid(vPlace, cell), grid(vPlace, cell * 5.0));
  c = mix(c, lineColor, 0.75 * lines * near);
  if (shadow > 0.0 && all(greaterThan(vLight, vec2(0.0))) && all(lessThan(vLight, vec2(1.0)))) {
    float covered = 0.0;
    for (int k = 0; k < 8; ++k) {
      float a = 2.399963 * float(k);
      float r = 0.0045 * sqrt(float(k) + 0.5);
      covered += textureLod(coverage, vLight + r * vec2(cos(a), sin(a)), 1.5).a;
    }
    c *= 1.0 - shadow * covered / 8.0;
  }
  gl_FragColor = vec4(c, 1.0);
  #include <colorspace_fragment>
}`;

export class Ground {
  readonly object: Mesh;
  /** False if the machine is too slow for the second picture. */
  shadows = true;
  /** True for one picture that may take its time. */
  full = false;
  /** Bound to samplers while the coverage picture is drawn: a texture cannot be read and rendered to at once. */
  private readonly nothing = Object.assign(new DataTexture(new Uint8Array(4), 1, 1), { needsUpdate: true });
  private readonly target = new WebGLRenderTarget(kMapSize, kMapSize, {
    generateMipmaps: true, minFilter: LinearMipmapLinearFilter, magFilter: LinearFilter,
  });
  private readonly light = new OrthographicCamera();
  private readonly uniforms: Record<string, IUniform>;

  /** What another floor needs to receive the same shadows. */
  get shadowUniforms(): { coverage: IUniform; toLight: IUniform; shadow: IUniform } {
    const { coverage, toLight, shadow } = this.uniforms;
    return { coverage: coverage!, toLight: toLight!, shadow: shadow! };
  }

  constructor() {
    this.light.layers.set(1);
    this.uniforms = {
      coverage: { value: this.target.texture }, toLight: { value: new Matrix4() }, background: { value: scenery.background },
      floorColor: { value: scenery.ground }, lineColor: { value: scenery.lines },
      middle: { value: new Vector3() }, across: { value: new Vector3(1, 0, 0) }, along: { value: new Vector3(0, 0, 1) }, fade: { value: 6 }, cell: { value: 0.2 }, shadow: { value: 0 },
    };
    const geometry = new CircleGeometry(1, 64).rotateX(-Math.PI / 2);
    this.object = new Mesh(geometry, new ShaderMaterial({ uniforms: this.uniforms, vertexShader: vertex, fragmentShader: fragment }));
    this.object.frustumCulled = false;
    this.object.renderOrder = -1;
  }

  /** Puts the ground at this height and sizes disc, grid and light for a scene inside `bounds`. */
  fit(bounds: Sphere, height: number): void {
    const { center, radius } = bounds;
    const fade = 2.2 * radius;
    this.object.position.copy(center).addScaledVector(upward, height - heightOf(center.x, center.y, center.z));
    this.object.quaternion.copy(turnUp);
    this.uniforms.across!.value.copy(turned(1, 0, 0));
    this.uniforms.along!.value.copy(turned(0, 0, 1));
    this.object.scale.setScalar(2.6 * fade);
    this.uniforms.fade!.value = fade;
    this.uniforms.cell!.value = 10 ** Math.floor(Math.log10(radius)) * 0.2;
    this.uniforms.middle!.value.copy(center);
    const reach = 1.3 * radius;
    this.light.position.copy(center).addScaledVector(keyDirection, 4 * radius);
    this.light.up.copy(upward);
    this.light.lookAt(center);
    Object.assign(this.light, { left: -reach, right: reach, top: reach, bottom: -reach, near: 0.01 * radius, far: 8 * radius });
    this.light.updateProjectionMatrix();
    this.light.updateMatrixWorld();
    this.uniforms.toLight!.value.multiplyMatrices(this.light.projectionMatrix, this.light.matrixWorldInverse);
  }

  /** Draws the coverage picture; `viewHeight` tells point sprites how many pixels high it is. */
  castShadows(renderer: WebGLRenderer, scene: Scene, viewHeight: IUniform<number>): void {
    this.uniforms.shadow!.value = this.shadows || this.full ? scenery.shadow.value : 0;
    if (!this.shadows && !this.full) return;
    const height = viewHeight.value;
    viewHeight.value = kMapSize;
    const { coverage } = this.uniforms;
    coverage!.value = this.nothing;
    renderer.setRenderTarget(this.target);
    renderer.setClearColor(0x000000, 0);
    renderer.clear();
    renderer.render(scene, this.light);
    renderer.setRenderTarget(null);
    renderer.setClearColor(scenery.background, 1);
    coverage!.value = this.target.texture;
    viewHeight.value = height;
  }
}

/** The ground's height: 0 if the scene is near it, otherwise slightly below it. Faces in its plane would flicker. */
export function floorUnder(low: number, bodies: boolean, radius: number): number {
  if (bodies) return low - 0.02 * radius;
  return low >= -1e-3 * radius && low < 1.5 * radius ? 0 : low - 0.15 * radius;
}
