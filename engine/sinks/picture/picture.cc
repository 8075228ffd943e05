#include "engine/sinks/picture/picture.h"

#include <algorithm>
#include <array>
#include <optional>

#include "engine/base/errors.h"
#include "engine/sinks/picture/geometry.h"
#include "engine/sinks/picture/gl/gl_context.h"
#include "engine/sinks/picture/gl/gl_objects.h"
#include "engine/sinks/picture/text/overlay.h"

namespace truestep {
namespace {

using namespace picture;

// Larger pictures are drawn in tiles of this side, which bounds the multisample buffers to 128 MB.
constexpr int kTile = 2048;

void check_size(int width, int height) {
  std::vector<Issue> issues;
  const std::pair<const char*, int> sides[] = {{"width", width}, {"height", height}};
  for (const auto& [name, side] : sides)
    if (side < PictureRenderer::kMinSide || side > PictureRenderer::kMaxSide)
      issues.push_back({std::string("/") + name, "out_of_range",
                        std::string(name) + " of a picture is out of range", std::to_string(side),
                        "16 to 4096", "", "pixels"});
  if (!issues.empty())
    throw Error("out_of_range",
                "a picture has 16 to 4096 pixels on a side, not " + std::to_string(width) + " x " +
                    std::to_string(height),
                issues);
}

constexpr Attribute kSphereLayout[] = {{4, GL_FLOAT, offsetof(SphereVertex, centre)},
                                       {4, GL_UNSIGNED_BYTE, offsetof(SphereVertex, color)}};
constexpr Attribute kMeshLayout[] = {{3, GL_FLOAT, offsetof(MeshVertex, position)},
                                     {3, GL_FLOAT, offsetof(MeshVertex, normal)},
                                     {4, GL_UNSIGNED_BYTE, offsetof(MeshVertex, color)}};
constexpr Attribute kLineLayout[] = {{3, GL_FLOAT, offsetof(LineVertex, from)},
                                     {3, GL_FLOAT, offsetof(LineVertex, to)},
                                     {1, GL_FLOAT, offsetof(LineVertex, radius)},
                                     {4, GL_UNSIGNED_BYTE, offsetof(LineVertex, color)}};

// Two triangles per four vertices, shared by spheres and lines.
GLuint make_quad_indices(const GlApi& gl) {
  GLuint buffer = 0;
  gl.GenBuffers(1, &buffer);
  return buffer;
}

// Objects in the context; created and used while it is current.
struct Scene {
  explicit Scene(const GlApi& g)
      : gl(g),
        quads(make_quad_indices(g)),
        spheres(g, sizeof(SphereVertex), kSphereLayout, quads),
        sprites(g, sizeof(SphereVertex), kSphereLayout, quads),
        lines(g, sizeof(LineVertex), kLineLayout, quads),
        marks(g, sizeof(LineVertex), kLineLayout, quads),
        mesh(g, sizeof(MeshVertex), kMeshLayout, 0),
        glass(g, sizeof(MeshVertex), kMeshLayout, 0),
        nothing(g, 4, {}, quads),
        shadow(g) {
    for (int i = 0; i < kShaderKinds; ++i)
      programs[i] = make_program(gl, shader_source(static_cast<ShaderKind>(i)));
    gl.GenBuffers(1, &uniforms);
    gl.PixelStorei(GL_PACK_ALIGNMENT, 1);
    gl.Enable(GL_PROGRAM_POINT_SIZE);
  }

  void use(ShaderKind kind) const { gl.UseProgram(programs[static_cast<int>(kind)]); }
  void draw_quads(const VertexStream& stream, size_t vertices) const {
    stream.bind(gl);
    gl.DrawElements(GL_TRIANGLES, static_cast<GLsizei>(vertices / 4 * 6), GL_UNSIGNED_INT, nullptr);
  }
  void upload(const Geometry& g, const Uniforms& u);
  void draw_shadow(const Geometry& g, int side);
  void draw_color(const Geometry& g) const;

  const GlApi& gl;
  GLuint quads;
  size_t quad_count = 0;
  VertexStream spheres, sprites, lines, marks, mesh, glass, nothing;
  ShadowTarget shadow;
  ColorTarget target;
  std::array<GLuint, kShaderKinds> programs{};
  GLuint uniforms = 0;
};

void Scene::upload(const Geometry& g, const Uniforms& u) {
  const size_t needed = std::max({g.spheres.size(), g.lines.size(), g.marks.size()}) / 4;
  if (needed > quad_count) {
    quad_count = std::max(needed, 2 * quad_count);
    std::vector<uint32_t> indices;
    indices.reserve(6 * quad_count);
    for (uint32_t q = 0; q < quad_count; ++q)
      for (uint32_t corner : {0u, 1u, 2u, 2u, 1u, 3u}) indices.push_back(4 * q + corner);
    nothing.bind(gl);  // the element binding belongs to the vertex array
    gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, quads);
    gl.BufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(4 * indices.size()), indices.data(),
                  GL_STATIC_DRAW);
  }
  spheres.upload(gl, g.spheres.data(), g.spheres.size() * sizeof(SphereVertex), {});
  sprites.upload(gl, g.sprites.data(), g.sprites.size() * sizeof(SphereVertex), {});
  lines.upload(gl, g.lines.data(), g.lines.size() * sizeof(LineVertex), {});
  marks.upload(gl, g.marks.data(), g.marks.size() * sizeof(LineVertex), {});
  mesh.upload(gl, g.mesh.data(), g.mesh.size() * sizeof(MeshVertex), g.triangles);
  glass.upload(gl, g.glass.data(), g.glass.size() * sizeof(MeshVertex), {});
  gl.BindBuffer(GL_UNIFORM_BUFFER, uniforms);
  gl.BufferData(GL_UNIFORM_BUFFER, sizeof(Uniforms), &u, GL_STREAM_DRAW);
  gl.BindBufferBase(GL_UNIFORM_BUFFER, 0, uniforms);
}

void Scene::draw_shadow(const Geometry& g, int side) {
  shadow.bind(gl, side);
  gl.Enable(GL_DEPTH_TEST);
  gl.DepthMask(GL_TRUE);
  gl.DepthFunc(GL_LEQUAL);
  gl.Clear(GL_DEPTH_BUFFER_BIT);
  use(ShaderKind::mesh_shadow);
  gl.Enable(GL_POLYGON_OFFSET_FILL);  // grows with the slope, against a surface that shades itself
  gl.PolygonOffset(2.0f, 2.0f);
  mesh.bind(gl);
  gl.DrawElements(GL_TRIANGLES, static_cast<GLsizei>(g.triangles.size()), GL_UNSIGNED_INT, nullptr);
  gl.Disable(GL_POLYGON_OFFSET_FILL);
  use(ShaderKind::sphere_shadow);
  draw_quads(spheres, g.spheres.size());
  use(ShaderKind::sprite_shadow);
  sprites.bind(gl);
  gl.DrawArrays(GL_POINTS, 0, static_cast<GLsizei>(g.sprites.size()));
  use(ShaderKind::line_shadow);
  draw_quads(lines, g.lines.size());
}

// Solid things first, then the ground over the background, then glass, far to near.
void Scene::draw_color(const Geometry& g) const {
  gl.Enable(GL_FRAMEBUFFER_SRGB);
  gl.Enable(GL_MULTISAMPLE);
  shadow.sample(gl);
  gl.Clear(GL_DEPTH_BUFFER_BIT);
  gl.Disable(GL_DEPTH_TEST);
  use(ShaderKind::background);
  nothing.bind(gl);
  gl.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  gl.DrawArrays(GL_TRIANGLES, 0, 3);
  gl.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_FALSE);  // keeps the background's opacity

  gl.Enable(GL_DEPTH_TEST);
  use(ShaderKind::mesh);
  mesh.bind(gl);
  gl.DrawElements(GL_TRIANGLES, static_cast<GLsizei>(g.triangles.size()), GL_UNSIGNED_INT, nullptr);
  use(ShaderKind::sphere);
  gl.Enable(GL_SAMPLE_ALPHA_TO_COVERAGE);
  draw_quads(spheres, g.spheres.size());
  use(ShaderKind::sprite);
  sprites.bind(gl);
  gl.DrawArrays(GL_POINTS, 0, static_cast<GLsizei>(g.sprites.size()));
  gl.Disable(GL_SAMPLE_ALPHA_TO_COVERAGE);
  use(ShaderKind::line);
  draw_quads(lines, g.lines.size());

  gl.Enable(GL_BLEND);
  gl.BlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  gl.DepthMask(GL_FALSE);
  if (g.ground_height) {
    use(ShaderKind::ground);
    nothing.bind(gl);
    gl.DrawArrays(GL_TRIANGLE_STRIP, 0, 4);
  }
  use(ShaderKind::glass);
  glass.bind(gl);
  gl.DrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(g.glass.size()));
  gl.DepthMask(GL_TRUE);
  gl.Disable(GL_BLEND);
  if (g.marks.empty()) return;
  gl.Clear(GL_DEPTH_BUFFER_BIT);  // marks hide each other, nothing else hides them
  use(ShaderKind::line);
  draw_quads(marks, g.marks.size());
}

}  // namespace

class PictureRenderer::Impl {
 public:
  Impl(int width, int height, Backend backend)
      : width_(width), height_(height), context_(create_context(backend)) {
    const GlCurrent current(*context_);
    scene_.emplace(context_->gl());
  }

  void resize(int width, int height) { width_ = width, height_ = height; }

  std::vector<uint8_t> render(const DrawList& list) {
    const View view(list, width_, height_);
    geometry_.build(list, view);
    const Uniforms uniforms =
        make_uniforms(list, view, geometry_.extent, geometry_.ground_height.value_or(0));
    std::vector<uint8_t> rgba(static_cast<size_t>(width_) * height_ * 4);
    {
      const GlCurrent current(*context_);
      const GlApi& gl = context_->gl();
      scene_->target.allocate(gl, std::min(width_, kTile), std::min(height_, kTile));
      scene_->upload(geometry_, uniforms);
      scene_->draw_shadow(geometry_, view.shadow_side);
      for (int y = 0; y < height_; y += kTile)
        for (int x = 0; x < width_; x += kTile) {
          scene_->target.bind(gl);
          gl.Viewport(-x, -y, width_, height_);
          scene_->draw_color(geometry_);
          scene_->target.read(gl, std::min(kTile, width_ - x), std::min(kTile, height_ - y), width_,
                              rgba.data() + 4 * (static_cast<size_t>(y) * width_ + x));
        }
      if (const GLenum error = gl.GetError(); error != GL_NO_ERROR)
        throw Error("render_unavailable", "OpenGL error " + std::to_string(error));
    }
    draw_overlay(list, view, {rgba.data(), width_, height_});
    return rgba;
  }

  int width() const { return width_; }
  int height() const { return height_; }
  std::string backend() const { return context_->backend(); }

 private:
  static std::unique_ptr<GlContext> create_context(Backend backend) {
    switch (backend) {
      case Backend::osmesa:
        return create_osmesa_context();
      case Backend::egl:
        return create_egl_context();
      case Backend::any:
        break;
    }
    return create_gl_context();
  }

  int width_, height_;
  std::unique_ptr<GlContext> context_;
  std::optional<Scene> scene_;
  Geometry geometry_;
};

PictureRenderer::PictureRenderer(int width, int height, Backend backend) {
  check_size(width, height);
  impl_ = std::make_unique<Impl>(width, height, backend);
}
PictureRenderer::~PictureRenderer() = default;
PictureRenderer::PictureRenderer(PictureRenderer&&) noexcept = default;
PictureRenderer& PictureRenderer::operator=(PictureRenderer&&) noexcept = default;

void PictureRenderer::resize(int width, int height) {
  check_size(width, height);
  impl_->resize(width, height);
}
std::vector<uint8_t> PictureRenderer::render_rgba(const DrawList& list) {
  return impl_->render(list);
}
std::string PictureRenderer::backend() const {
  return impl_->backend();
}
int PictureRenderer::width() const {
  return impl_->width();
}
int PictureRenderer::height() const {
  return impl_->height();
}

}  // namespace truestep
