// The one light of the viewer as GLSL, so that points, surfaces and shapes look alike: a sky and a floor
// colour by the normal's height (hemisphere), one key light with a Blinn-Phong highlight, and a soft rim.
import { Color, Vector3 } from "three";

export const keyDirection = new Vector3(0.42, 0.8, 0.43).normalize();
export const backgroundColor = new Color("#0f1319");

export const shadeGlsl = /* glsl */ `
const vec3 kKey = vec3(${keyDirection.toArray().map((c) => c.toFixed(4)).join(",")});
vec3 shade(vec3 albedo, vec3 n, vec3 toEye) {
  vec3 sky = mix(vec3(0.13, 0.12, 0.14), vec3(0.34, 0.39, 0.47), 0.5 + 0.5 * n.y);
  float key = max(dot(n, kKey), 0.0);
  float gloss = pow(max(dot(n, normalize(kKey + toEye)), 0.0), 36.0);
  float rim = pow(1.0 - max(dot(n, toEye), 0.0), 3.0);
  return albedo * (sky + vec3(0.80, 0.75, 0.68) * key) + vec3(0.10) * gloss + sky * rim * 0.12;
}
`;

/** Five stops from still to fast: blue, teal, green, amber, coral. */
export const rampGlsl = /* glsl */ `
vec3 ramp(float t) {
  t = clamp(t, 0.0, 1.0) * 4.0;
  vec3 c = mix(vec3(0.06, 0.14, 0.48), vec3(0.03, 0.37, 0.62), clamp(t, 0.0, 1.0));
  c = mix(c, vec3(0.06, 0.56, 0.46), clamp(t - 1.0, 0.0, 1.0));
  c = mix(c, vec3(0.92, 0.56, 0.12), clamp(t - 2.0, 0.0, 1.0));
  return mix(c, vec3(0.90, 0.20, 0.13), clamp(t - 3.0, 0.0, 1.0));
}
`;

/** Colours for systems that bring none, in the order of the scene: those of the service's pictures, for a dark ground. */
export const palette = ["#3f86d6", "#e8873f", "#45b085", "#dc5f5f", "#9a7ad0", "#dcb23c", "#3fb4c2", "#cf6fa4"].map((hex) => new Color(hex));

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

/** Sleepers are paler and darker; a faint pattern shows how a sphere turns; floors take the ground's shadow. */
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
  if (receives && n.y > 0.2) {
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
