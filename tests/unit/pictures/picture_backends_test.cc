// OSMesa and EGL: two interfaces to one rasterizer.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <optional>

#include "engine/sinks/picture/camera.h"
#include "engine/sinks/picture/gl/gl_context.h"
#include "engine/sinks/picture/gl/gl_objects.h"
#include "engine/sinks/picture/picture.h"
#include "tests/unit/pictures/picture_lists.h"
#include "tests/unit/pictures/picture_pixels.h"

namespace truestep {
namespace {

using test::code_of;
using test::Pixels;

TEST(Picture, EglCanDoItTooOrSaysWhyNot) {
  std::unique_ptr<picture::GlContext> egl;
  const std::string code = code_of([&] { egl = picture::create_egl_context(); });
  EXPECT_EQ(code, egl ? "" : "render_unavailable");
  if (!egl) return;
  EXPECT_EQ(egl->backend(), "egl");
  const picture::GlCurrent current(*egl);
  const picture::GlApi& gl = egl->gl();
  for (int kind = 0; kind < picture::kShaderKinds; ++kind)
    EXPECT_NE(picture::make_program(gl, picture::shader_source(static_cast<picture::ShaderKind>(kind))), 0u);
  picture::ShadowTarget shadow(gl);
  shadow.bind(gl, 64);
  picture::ColorTarget target;
  target.allocate(gl, 32, 16);
  target.bind(gl);
  Pixels pixels(4 * 32 * 16, 77);
  gl.Clear(GL_COLOR_BUFFER_BIT);
  target.read(gl, 32, 16, 32, pixels.data());
  EXPECT_EQ(pixels, Pixels(pixels.size(), 0));
  EXPECT_EQ(gl.GetError(), static_cast<GLenum>(GL_NO_ERROR));
}

// Both use the same rasterizer (llvmpipe) through two interfaces, perhaps of two builds of Mesa: samples at
// edges may fall on the other side and shades may round differently, so nearly all pixels agree to 2 of 255
// and the mean to a tenth. Control: the same cloth from a slightly shifted viewpoint differs in far more.
TEST(Picture, EglDrawsWhatOsmesaDraws) {
  using Backend = PictureRenderer::Backend;
  std::optional<PictureRenderer> egl;
  const std::string code = code_of([&] { egl.emplace(320, 240, Backend::egl); });
  EXPECT_EQ(code, egl ? "" : "render_unavailable");
  if (!egl) return;
  PictureRenderer osmesa(320, 240, Backend::osmesa);
  EXPECT_EQ(osmesa.backend(), "osmesa");
  EXPECT_EQ(egl->backend(), "egl");
  struct Difference {
    double mean = 0, share = 0;
  };
  const auto difference = [](const Pixels& a, const Pixels& b) {
    Difference d;
    for (size_t i = 0; i < a.size(); ++i) {
      const int by = std::abs(a[i] - b[i]);
      d.mean += by, d.share += by > 2;
    }
    d.mean /= double(a.size()), d.share /= double(a.size());
    return d;
  };
  for (DrawList list :
       {test::draped_cloth(40), test::fountain(2000), test::spring_net(12), test::balls_in_box(40)}) {
    const Pixels here = osmesa.render_rgba(list);
    const Difference same = difference(here, egl->render_rgba(list));
    EXPECT_LT(same.mean, 0.1);
    EXPECT_LT(same.share, 0.002);
    list.camera = picture::camera_for(list, 320.0 / 240);
    list.camera->eye += Vec3{0.1, 0, 0};
    const Difference moved = difference(here, osmesa.render_rgba(list));
    EXPECT_GT(moved.mean, 0.1);
    EXPECT_GT(moved.share, 0.002);
  }
}

}  // namespace
}  // namespace truestep
