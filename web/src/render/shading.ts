// The one light of the viewer as GLSL, so that points, surfaces and shapes look alike: a sky and a floor
// colour by the normal's height (hemisphere), one key light with a Blinn-Phong highlight, and a soft rim.
import { Color, Vector3, type IUniform } from "three";
import { colorTable, type Theme } from "./fields/color_map";
import { paletteHex } from "./fields/color_stops";
import { kRampStops as kStops, schemeOf, type Scheme } from "./fields/scheme";
import { lightUniforms } from "./upright";

export type { Theme } from "./fields/color_map";

/** Colours of everything around the scene; all of them change in place with the theme. */
export const scenery = { theme: "dark" as Theme, background: new Color(), ground: new Color(), lines: new Color(), ink: new Color(), shadow: { value: 0.62 } };

// `least`, linear: what is darker is drawn as bright as this, so that black things keep their shape on a dark ground.
const themes: Record<Theme, { background: string; ground: string; lines: string; ink: string; shadow: number; least: number }> = {
  dark: { background: "#0f1319", ground: "#2c3340", lines: "#566072", ink: "#a3aebd", shadow: 0.68, least: 0.085 },
  light: { background: "#eef1f5", ground: "#dbe0e8", lines: "#b6bfcc", ink: "#4a5564", shadow: 0.34, least: 0.02 },
};

export function setTheme(theme: Theme): void {
  const { background, ground, lines, ink, shadow, least } = themes[theme];
  scenery.theme = theme;
  scenery.background.set(background);
  scenery.ground.set(ground);
  scenery.lines.set(lines);
  scenery.ink.set(ink);
  scenery.shadow.value = shadow;
  lightUniforms.least.value = least;
}
setTheme("dark");

export const shadeGlsl = /* glsl */ `
uniform vec3 upward, keyLight;
uniform float least;
vec3 shade(vec3 albedo, vec3 n, vec3 toEye) {
  albedo += max(0.0, least - max(albedo.r, max(albedo.g, albedo.b)));
  vec3 sky = mix(vec3(0.13, 0.12, 0.14), vec3(0.34, 0.39, 0.47), 0.5 + 0.5 * dot(n, upward));
  float key = max(dot(n, keyLight), 0.0);
  float gloss = pow(max(dot(n, normalize(keyLight + toEye)), 0.0), 36.0);
  float rim = pow(1.0 - max(dot(n, toEye), 0.0), 3.0);
  return albedo * (sky + vec3(0.80, 0.75, 0.68) * key) + vec3(0.10) * gloss + sky * rim * 0.12;
}
`;

/** A vertex shader that passes on the normal and the world position, plus the given declarations and statements. */
export function litVertexGlsl(declared = "", done = ""): string {
  return /* glsl */ `
${declared}
out vec3 vNormal, vWorld;
void main() {
  ${done}
  vNormal = normal;
  vWorld = position;
  gl_Position = projectionMatrix * (viewMatrix * vec4(position, 1.0));
}`;
}

/** The colour map in linear light, shared by everything coloured by a value. */
export const rampUniform: IUniform<Vector3[]> = { value: [] };

/** Kinds are the ramp's stops: the k-th is at k / 15. */
export function setRamp({ map, kinds }: Scheme): void {
  const table = colorTable(map, kStops, scenery.theme);
  const color = new Color();
  rampUniform.value = Array.from({ length: kStops }, (_, k) => {
    if (kinds.length > 0) color.set(kinds[k % kinds.length]!.color);
    else color.setRGB(table[3 * k]! / 255, table[3 * k + 1]! / 255, table[3 * k + 2]! / 255, "srgb");
    return new Vector3(color.r, color.g, color.b);
  });
}
setRamp(schemeOf({}, "", undefined));

export const rampGlsl = /* glsl */ `
uniform vec3 stops[${kStops}];
vec3 ramp(float t) {
  t = clamp(t, 0.0, 1.0) * ${kStops - 1}.0;
  int k = min(int(t), ${kStops - 2});
  return mix(stops[k], stops[k + 1], t - float(k));
}
`;

const palette = paletteHex.map((hex) => new Color(hex));

/** Colours of systems without their own, in the order of the scene; as in the service's pictures. */
export const paletteColor = (k: number): Color => palette[k % palette.length]!;

export const bodyVertex = /* glsl */ `
in vec3 center, size, tint;
in vec4 turn;
in float value;
#ifdef CAPSULE
in float cap;
#endif
out vec3 vNormal, vWorld, vTint, vOwn;
out float vValue;
vec3 turned(vec3 p) { return p + 2.0 * cross(turn.xyz, cross(turn.xyz, p) + turn.w * p); }
void main() {
#ifdef CAPSULE
  vec3 p = position * size.x + vec3(0.0, cap * size.y, 0.0);
  vNormal = turned(normal);
#else
  vec3 p = position * size;
  vNormal = turned(normal / size);
#endif
  vOwn = position;
  vWorld = turned(p) + center;
  vTint = tint;
  vValue = value;
  gl_Position = projectionMatrix * (viewMatrix * vec4(vWorld, 1.0));
}`;

/** Sleeping bodies are paler and darker; a faint pattern shows a sphere's rotation; floors receive the ground's shadow. */
export const bodyFragment = /* glsl */ `
uniform bool byValue, receives, stripes;
uniform float opacity, shadow;
uniform sampler2D coverage;
uniform mat4 toLight;
in vec3 vNormal, vWorld, vTint, vOwn;
in float vValue;
${shadeGlsl}
${rampGlsl}
void main() {
  vec3 toEye = normalize(cameraPosition - vWorld);
  vec3 n = normalize(vNormal);
  if (dot(n, toEye) < 0.0) n = -n;
  vec3 albedo = byValue ? ramp(vValue) : vTint;
  if (stripes) {
    float s = vOwn.x * vOwn.z;
    albedo *= 1.0 + 0.13 * clamp(s / max(fwidth(s), 1e-5), -1.0, 1.0);
  }
  if (!byValue && vValue > 0.5) albedo = mix(albedo, vec3(dot(albedo, vec3(0.21, 0.72, 0.07))), 0.4) * 0.6;
  vec3 c = shade(albedo, n, toEye);
  if (receives && dot(n, upward) > 0.2) {
    vec2 at = (toLight * vec4(vWorld, 1.0)).xy * 0.5 + 0.5;
    if (all(greaterThan(at, vec2(0.0))) && all(lessThan(at, vec2(1.0)))) {
      float covered = 0.0;
      for (int k = 0; k < 8; ++k) {
        float a = 2.399963 * float(k);
        covered += textureLod(coverage, at + 0.0045 * sqrt(float(k) + 0.5) * vec2(cos(a), sin(a)), 1.5).a;
      }
      c *= 1.0 - shadow * covered / 8.0;
    }
  }
  gl_FragColor = vec4(c, opacity);
  #include <colorspace_fragment>
}`;
