// Light: one warm key light with a shadow map (percentage-closer filtering; on the ground with a blocker
// search, Fernando 2005), a cool sky and a warm bounce from below (hemisphere ambient), a weak fill from the
// camera. All in linear light; the framebuffer encodes sRGB. Spheres are ray-cast in their billboard;
// silhouettes become sample coverage.
#include "engine/sinks/picture/gl/shaders.h"

namespace truestep::picture {
namespace {

constexpr const char* kBlock = R"(
layout(std140) uniform Scene {
  mat4 view_projection, light_matrix;
  vec4 eye, forward, camera_up, light, up, depth, viewport;
  vec4 ground_centre, ground_side, ground_front, background_top, background_bottom;
};
float luminance(vec3 c) { return dot(c, vec3(0.2126, 0.7152, 0.0722)); }
vec3 linear(vec3 srgb) { return srgb * (srgb * (srgb * 0.305306011 + 0.682171111) + 0.012522878); }
)";

constexpr const char* kLight = R"(
uniform sampler2DShadow shadow_map;  // compared and filtered
uniform sampler2D shadow_depth;      // the same texture, read as numbers
// A Vogel disc: r ~ sqrt(i), golden angle.
const vec2 disc[24] = vec2[](
  vec2(0.144, 0.000), vec2(-0.184, 0.169), vec2(0.028, -0.322), vec2(0.232, 0.303), vec2(-0.426, -0.075),
  vec2(0.404, -0.257), vec2(-0.135, 0.503), vec2(-0.258, -0.496), vec2(0.559, 0.204), vec2(-0.582, 0.240),
  vec2(0.280, -0.599), vec2(0.207, 0.660), vec2(-0.624, -0.362), vec2(0.733, -0.161), vec2(-0.447, 0.636),
  vec2(-0.103, -0.797), vec2(0.634, 0.534), vec2(-0.853, 0.035), vec2(0.622, -0.619), vec2(-0.042, 0.900),
  vec2(-0.592, -0.710), vec2(0.938, 0.126), vec2(-0.795, 0.553), vec2(0.217, -0.965));
vec3 in_light(vec3 p, vec3 n, float spread) { return (light_matrix * vec4(p + n * (light.w * (1.0 + spread)), 1.0)).xyz; }
bool outside(vec3 q) { return any(lessThan(q.xy, vec2(0.0))) || any(greaterThan(q.xy, vec2(1.0))); }
float filtered(vec3 q, int taps, float spread) {
  float z = clamp(q.z - 0.0008, 0.0, 1.0), sum = 0.0;
  for (int i = 0; i < taps; ++i) sum += texture(shadow_map, vec3(q.xy + disc[i] * (spread / depth.z), z));
  return sum / float(taps);
}
// Fraction of the key light that reaches p, whose lit side faces n; the edge is `spread` texels soft.
float lit(vec3 p, vec3 n, int taps, float spread) {
  vec3 q = in_light(p, n, spread);
  return outside(q) ? 1.0 : filtered(q, taps, spread);
}
// The same with an edge that widens with the distance from the caster, as under a lamp of finite size.
float lit_softly(vec3 p, vec3 n) {
  const float widest = 7.0, lamp = 0.03;
  vec3 q = in_light(p, n, 1.5);
  if (outside(q)) return 1.0;
  float blockers = 0.0, sum = 0.0;
  for (int i = 0; i < 24; i += 2) {
    float z = texture(shadow_depth, q.xy + disc[i] * (widest / depth.z)).r;
    float blocks = z < min(q.z - 0.0008, 0.99999) ? 1.0 : 0.0;
    blockers += blocks;
    sum += blocks * z;
  }
  if (blockers == 0.0) return 1.0;
  float gap = (q.z - sum / blockers) * depth.w;  // in texels
  return filtered(q, 24, clamp(lamp * gap, 1.2, widest));
}
// 1 on dark paper, where an unlit side would be lost.
float night() { return 1.0 - smoothstep(0.03, 0.18, luminance(background_bottom.rgb)); }
// Black things keep their shape on dark paper.
vec3 visible(vec3 albedo) { return albedo + night() * max(0.0, 0.085 - max(albedo.r, max(albedo.g, albedo.b))); }
vec3 shade(vec3 albedo, vec3 n, vec3 v, float share, float gloss, float sharpness) {
  float key = max(dot(n, light.xyz), 0.0) * share;
  vec3 sky = mix(vec3(0.25, 0.235, 0.225), vec3(0.44, 0.47, 0.52), 0.5 + 0.5 * dot(n, up.xyz));
  float fill = 0.10 * max(dot(n, v), 0.0);
  vec3 h = normalize(light.xyz + v);
  float shine = gloss * share * pow(max(dot(n, h), 0.0), sharpness);
  return albedo * (sky + fill + vec3(0.80, 0.765, 0.71) * key) + vec3(shine);
}
// What is only a few pixels thick shows no shape: on dark paper it has its own colour, bright enough to be told from the
// paper (3 : 1), whatever light falls on it.
vec3 seen(vec3 shaded, vec3 albedo, float radius) {
  float l = luminance(albedo);
  vec3 own = mix(albedo, vec3(1.0), clamp((0.17 - l) / (1.0 - l), 0.0, 1.0));
  return mix(shaded, max(shaded, own), night() * (1.0 - smoothstep(2.0, 10.0, radius)));
}
)";

constexpr const char* kBackgroundVertex = R"(
out float v_down;
void main() {
  vec2 p = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  v_down = 0.5 + 0.5 * p.y;
  gl_Position = vec4(p, 1.0, 1.0);
}
)";
constexpr const char* kBackgroundFragment = R"(
in float v_down;
out vec4 color;
void main() { color = vec4(mix(background_top.rgb, background_bottom.rgb, clamp(v_down, 0.0, 1.0)), 1.0); }
)";

constexpr const char* kGroundVertex = R"(
out vec2 v_at;
out vec3 v_point;
void main() {
  v_at = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0;
  v_at *= ground_centre.w;
  v_point = ground_centre.xyz + ground_side.xyz * v_at.x + ground_front.xyz * v_at.y;
  gl_Position = view_projection * vec4(v_point, 1.0);
}
)";
constexpr const char* kGroundFragment = R"(
in vec2 v_at;
in vec3 v_point;
out vec4 color;
// Coverage of lines `step` apart and about `pixels` wide; fades out when they get denser than pixels.
float lines(float step, float pixels) {
  vec2 cell = v_at / step;
  vec2 width = fwidth(cell);
  vec2 line = clamp(0.5 + 0.5 * pixels - abs(fract(cell - 0.5) - 0.5) / width, 0.0, 1.0);
  vec2 fade = 1.0 - smoothstep(0.08, 0.35, width);
  return max(line.x * fade.x, line.y * fade.y);
}
void main() {
  vec3 base = background_bottom.rgb * 1.06;
  float dark = step(luminance(base), 0.18);
  float share = lit_softly(v_point, up.xyz);
  base *= mix(0.46, 1.0, share);
  float grid = max(0.45 * lines(ground_side.w, 0.2), lines(ground_front.w, 0.6));
  base = mix(base, mix(base * 0.62, base * 1.9 + 0.02, dark), 0.75 * grid);
  float r = length(v_at) / ground_centre.w;
  color = vec4(base, (1.0 - smoothstep(0.25, 1.0, r)) * mix(0.25, 1.0, up.w));
}
)";

constexpr const char* kSphereVertex = R"(
layout(location = 0) in vec4 a_sphere;
layout(location = 1) in vec4 a_color;
flat out vec3 v_albedo;
flat out vec4 v_sphere;  // centre relative to the eye (to the centre itself in the shadow pass), radius
out vec3 v_ray;
void main() {
  vec2 corner = vec2(gl_VertexID & 1, (gl_VertexID >> 1) & 1) * 2.0 - 1.0;
  v_albedo = linear(a_color.rgb);
#ifdef SHADOW
  // A disc through the centre, across the light: a sphere's lit half lies before it, so it never shades itself.
  vec4 c = light_matrix * vec4(a_sphere.xyz, 1.0);
  float radius = max(a_sphere.w / light.w, 0.75) / depth.z;
  v_sphere = vec4(0.0, 0.0, 0.0, 1.0);
  v_ray = vec3(corner, 0.0);
  gl_Position = vec4((c.xy + corner * radius) * 2.0 - 1.0, c.z * 2.0 - 1.0, 1.0);
#else
  vec3 c = a_sphere.xyz - eye.xyz;
  float d = length(c);
  float r = max(a_sphere.w, 0.8 * eye.w * dot(c, forward.xyz));  // never thinner than a pixel and a half
  vec3 axis = c / d;
  vec3 right = normalize(cross(axis, camera_up.xyz));
  vec3 above = cross(right, axis);
  float half_side = r * d / sqrt(max(d * d - r * r, 1e-12)) + eye.w * d;
  v_sphere = vec4(c, r);
  v_ray = c + (right * corner.x + above * corner.y) * half_side;
  gl_Position = d > 1.001 * r ? view_projection * vec4(eye.xyz + v_ray, 1.0) : vec4(0.0, 0.0, 2.0, 1.0);
#endif
}
)";
constexpr const char* kSphereShadowFragment = R"(
in vec3 v_ray;
void main() { if (dot(v_ray.xy, v_ray.xy) > 1.0) discard; }
)";
constexpr const char* kSphereFragment = R"(
flat in vec3 v_albedo;
flat in vec4 v_sphere;
in vec3 v_ray;
out vec4 color;
void main() {
  vec3 w = normalize(v_ray);
  float along = dot(w, v_sphere.xyz);
  vec3 off = along * w - v_sphere.xyz;  // from the centre to the ray, perpendicular to it: no cancellation
  float r = v_sphere.w, miss = length(off), pixel = along * eye.w;
  float coverage = (r - miss) / pixel + 0.5;
  float depth_in = sqrt(max(r * r - miss * miss, 0.0));
  vec3 n = normalize(off - depth_in * w), hit = (along - depth_in) * w;
  float share = dot(n, light.xyz) > 0.0 ? lit(eye.xyz + hit, n, 4, 1.6) : 0.0;
  float small = clamp(r / pixel / 6.0, 0.0, 1.0);  // highlights of tiny spheres would only sparkle
  vec3 shaded = shade(visible(v_albedo), n, -w, share, 0.22 * small, 40.0);
  color = vec4(seen(shaded, v_albedo, r / pixel), min(coverage, 1.0));
  float z = dot(hit, forward.xyz);
  gl_FragDepth = clamp(0.5 * (depth.x + depth.y / z) + 0.5, 0.0, 1.0);
}
)";

// A sphere of a few pixels: one depth, one shadow test (at its point nearest the light), shading per pixel.
constexpr const char* kSpriteVertex = R"(
layout(location = 0) in vec4 a_sphere;
layout(location = 1) in vec4 a_color;
flat out vec3 v_albedo, v_right, v_above, v_toward;
flat out vec3 v_pixels;  // radius, side of the square, share of the key light
void main() {
#ifdef SHADOW
  vec4 c = light_matrix * vec4(a_sphere.xyz, 1.0);
  gl_Position = vec4(c.xyz * 2.0 - 1.0, 1.0);
  gl_PointSize = 2.0 * max(a_sphere.w / light.w, 0.75);
#else
  vec3 c = a_sphere.xyz - eye.xyz;
  float radius = max(a_sphere.w / (eye.w * dot(c, forward.xyz)), 0.8);
  v_albedo = linear(a_color.rgb);
  v_toward = -normalize(c);
  v_right = normalize(cross(camera_up.xyz, v_toward));
  v_above = cross(v_toward, v_right);
  v_pixels = vec3(radius, 2.0 * radius + 1.5, lit(a_sphere.xyz + light.xyz * a_sphere.w, light.xyz, 4, 1.6));
  gl_Position = view_projection * vec4(a_sphere.xyz, 1.0);
  gl_PointSize = v_pixels.y;
#endif
}
)";
constexpr const char* kSpriteShadowFragment = R"(
void main() {
  vec2 q = gl_PointCoord * 2.0 - 1.0;
  if (dot(q, q) > 1.0) discard;
}
)";
constexpr const char* kSpriteFragment = R"(
flat in vec3 v_albedo, v_right, v_above, v_toward, v_pixels;
out vec4 color;
void main() {
  vec2 q = (gl_PointCoord - 0.5) * v_pixels.y;
  float miss = length(q), radius = v_pixels.x;
  float coverage = radius - miss + 0.5;
  q *= min(1.0, radius / miss) / radius;
  vec3 n = v_right * q.x + v_above * q.y + v_toward * sqrt(max(1.0 - dot(q, q), 0.0));
  vec3 shaded = shade(visible(v_albedo), n, v_toward, v_pixels.z, 0.03 * radius, 40.0);
  color = vec4(seen(shaded, v_albedo, radius), min(coverage, 1.0));
}
)";

constexpr const char* kMeshVertex = R"(
layout(location = 0) in vec3 a_position;
layout(location = 1) in vec3 a_normal;
layout(location = 2) in vec4 a_color;
out vec3 v_point, v_normal, v_albedo;
out float v_opacity;
void main() {
#ifdef SHADOW
  gl_Position = vec4((light_matrix * vec4(a_position, 1.0)).xyz * 2.0 - 1.0, 1.0);
#else
  v_point = a_position;
  v_normal = a_normal;
  v_opacity = a_color.a;
  v_albedo = linear(a_color.rgb);
  gl_Position = view_projection * vec4(a_position, 1.0);
#endif
}
)";
constexpr const char* kEmptyFragment = "void main() {}\n";
// Two-sided: the smooth normal is flipped to the side that the flat one shows to the viewer. A sheet lit from
// behind transmits a third of the light. Vertices without a normal show their plain colour.
constexpr const char* kMeshFragment = R"(
in vec3 v_point, v_normal, v_albedo;
out vec4 color;
void main() {
  if (dot(v_normal, v_normal) == 0.0) {
    color = vec4(v_albedo, 1.0);
    return;
  }
  vec3 v = normalize(eye.xyz - v_point);
  vec3 flat_normal = cross(dFdx(v_point), dFdy(v_point));
  flat_normal *= sign(dot(flat_normal, v));
  vec3 n = normalize(v_normal);
  n *= dot(n, flat_normal) < 0.0 ? -1.0 : 1.0;
  float facing = dot(n, light.xyz);
  float share = lit(v_point, facing < 0.0 ? -n : n, 8, 2.5);
  vec3 through = v_albedo * vec3(0.80, 0.765, 0.71) * (0.33 * max(-facing, 0.0) * share);
  color = vec4(shade(visible(v_albedo), n, v, share, 0.05, 12.0) + through, 1.0);
}
)";
constexpr const char* kGlassFragment = R"(
in vec3 v_point, v_normal, v_albedo;
in float v_opacity;
out vec4 color;
void main() {
  if (dot(v_normal, v_normal) == 0.0) {
    color = vec4(v_albedo, v_opacity);
    return;
  }
  float facing = abs(dot(normalize(v_normal), normalize(eye.xyz - v_point)));
  // A film adds light: on dark paper as much of it would be milk.
  float paper = luminance(background_bottom.rgb);
  color = vec4(v_albedo, mix(0.32, 0.05, pow(facing, 0.6)) * mix(0.15, 1.0, smoothstep(0.0, 0.4, paper)));
}
)";

constexpr const char* kLineVertex = R"(
layout(location = 0) in vec3 a_from;
layout(location = 1) in vec3 a_to;
layout(location = 2) in float a_radius;
layout(location = 3) in vec4 a_color;
out vec3 v_point;
out float v_across, v_pixels;
flat out vec3 v_albedo, v_along;
flat out float v_own;  // 0: no brighter on dark paper
void main() {
  v_own = a_color.a;
  bool end = (gl_VertexID & 2) != 0;
  v_across = float(gl_VertexID & 1) * 2.0 - 1.0;
  v_albedo = linear(a_color.rgb);
  v_along = normalize(a_to - a_from + vec3(1e-20, 0.0, 0.0));
#ifdef SHADOW
  vec4 a = vec4((light_matrix * vec4(a_from, 1.0)).xyz * 2.0 - 1.0, 1.0);
  vec4 b = vec4((light_matrix * vec4(a_to, 1.0)).xyz * 2.0 - 1.0, 1.0);
  vec2 size = vec2(depth.z);
  float unit = light.w, least = 0.8;
#else
  vec4 a = view_projection * vec4(a_from, 1.0), b = view_projection * vec4(a_to, 1.0);
  vec2 size = viewport.xy;
  float unit = eye.w, least = 0.85;
  float near = forward.w;
  if (max(a.w, b.w) <= near) { gl_Position = vec4(0.0, 0.0, 2.0, 1.0); return; }
  if (a.w < near) a = mix(a, b, (near - a.w) / (b.w - a.w));
  if (b.w < near) b = mix(b, a, (near - b.w) / (a.w - b.w));
#endif
  vec2 d = (b.xy / b.w - a.xy / a.w) * size;
  float len = length(d);
  d = len > 1e-6 ? d / len : vec2(1.0, 0.0);
  vec4 c = end ? b : a;
  float half_width = max(a_radius / (c.w * unit), least);  // pixels
  v_pixels = half_width;
  vec2 shift = vec2(-d.y, d.x) * v_across + d * (end ? 0.5 : -0.5);
  v_point = end ? a_to : a_from;
  c.xy += shift * (2.0 * half_width * c.w) / size;
#ifndef SHADOW
  c.z = (depth.x + depth.y / (c.w * 0.997)) * c.w;  // slightly nearer, so that a net stays visible on its
                                                    // cloth
#endif
  gl_Position = c;
}
)";
// The quad is lit as the tube it stands for.
constexpr const char* kLineFragment = R"(
in vec3 v_point;
in float v_across, v_pixels;
flat in vec3 v_albedo, v_along;
flat in float v_own;
out vec4 color;
void main() {
  vec3 v = normalize(eye.xyz - v_point);
  vec3 side = normalize(cross(v_along, v) + vec3(1e-12, 0.0, 0.0));
  float s = clamp(v_across, -1.0, 1.0) * 0.9;
  vec3 n = side * s + normalize(cross(side, v_along)) * sqrt(1.0 - s * s);
  n *= dot(n, v) < 0.0 ? -1.0 : 1.0;
  vec3 albedo = mix(v_albedo, visible(v_albedo), v_own);
  vec3 shaded = shade(albedo, n, v, lit(v_point, n, 1, 1.0), 0.08, 40.0);
  color = vec4(mix(shaded, seen(shaded, v_albedo, v_pixels), v_own), 1.0);
}
)";

}  // namespace

ShaderPair shader_source(ShaderKind kind) {
  const std::string head = std::string("#version 330 core\n") + kBlock;
  const std::string shadow_head = std::string("#version 330 core\n#define SHADOW\n") + kBlock;
  switch (kind) {
    case ShaderKind::background:
      return {head + kBackgroundVertex, head + kBackgroundFragment};
    case ShaderKind::ground:
      return {head + kGroundVertex, head + kLight + kGroundFragment};
    case ShaderKind::sphere:
      return {head + kSphereVertex, head + kLight + kSphereFragment};
    case ShaderKind::sphere_shadow:
      return {shadow_head + kSphereVertex, head + kSphereShadowFragment};
    case ShaderKind::sprite:
      return {head + kLight + kSpriteVertex, head + kLight + kSpriteFragment};
    case ShaderKind::sprite_shadow:
      return {shadow_head + kSpriteVertex, head + kSpriteShadowFragment};
    case ShaderKind::mesh:
      return {head + kMeshVertex, head + kLight + kMeshFragment};
    case ShaderKind::mesh_shadow:
      return {shadow_head + kMeshVertex, head + kEmptyFragment};
    case ShaderKind::line:
      return {head + kLineVertex, head + kLight + kLineFragment};
    case ShaderKind::line_shadow:
      return {shadow_head + kLineVertex, head + kEmptyFragment};
    case ShaderKind::glass:
      break;
  }
  return {head + kMeshVertex, head + kGlassFragment};
}

}  // namespace truestep::picture
