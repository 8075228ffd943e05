// GLSL 3.30 sources. Shadow casters are compiled twice: with SHADOW defined, the same vertices are drawn from
// the light and only depth is kept.
#pragma once
#include <string>

namespace truestep::picture {

struct ShaderPair {
  std::string vertex, fragment;
};

enum class ShaderKind {
  background,
  ground,
  sphere,
  sphere_shadow,
  sprite,
  sprite_shadow,
  mesh,
  mesh_shadow,
  line,
  line_shadow,
  glass
};
constexpr int kShaderKinds = 11;

/// Complete sources, ready to compile.
ShaderPair shader_source(ShaderKind kind);

}  // namespace truestep::picture
