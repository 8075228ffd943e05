// The contents of a picture as plain numbers: points with their lines and triangles, solid shapes, a camera,
// a ground and a caption. It knows no State and no system; it is filled from a frame. Lengths in metres,
// colours are sRGB in [0, 1], indices refer to the points of the same set.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/drawing.h"
#include "engine/math/vec3.h"

namespace truestep {

/// sRGB components in [0, 1] as a screen shows them.
struct Color {
  float r = 0, g = 0, b = 0;
};

inline Color mixed(const Color& a, const Color& b, float t) {
  return {a.r + (b.r - a.r) * t, a.g + (b.g - a.g) * t, a.b + (b.b - a.b) * t};
}

/// A name and its colour.
struct LegendRow {
  std::string text;
  Color color;
};

/// The points of one system and what connects them; every vector but `positions` may be empty.
struct DrawPoints {
  std::vector<float> positions;            ///< n x 3, m; points that are not finite are left out
  float radius = 0;                        ///< m; 0 = points are not drawn, only their lines and triangles
  std::vector<float> radii;                ///< n, m; overrides `radius`
  std::optional<Color> color;              ///< empty = the next one of the palette
  std::vector<float> scalar;               ///< n; colours points (and triangles) by `color_map`
  ColorMap color_map = ColorMap::viridis;  ///< used when `scalar` is given
  std::vector<LegendRow> kinds;            ///< of equal parts of the range, instead of `color_map`
  std::optional<float> scalar_min;         ///< empty = smallest finite value
  std::optional<float> scalar_max;         ///< empty = largest finite value
  std::string scalar_label;                ///< name and unit beside the colour bar; empty = no colour bar
  std::vector<uint32_t> lines;             ///< 2 per line
  std::vector<uint8_t> line_kinds;         ///< LineKind per line; empty = all structural
  std::optional<Color> line_color;         ///< empty = from `color`
  std::vector<float> line_scalar;          ///< one per line; colours lines instead of points
  float line_radius = 0;                   ///< m; lines are never thinner than about 1.5 pixels
  double line_pixels = 0;                  ///< minimum width of lines in a picture 720 pixels high
  double point_pixels = 0;                 ///< the same for the diameter of points
  bool exact_lines = false;                ///< no brighter on dark paper: they are faint, or over a surface
  std::vector<uint32_t> triangles;         ///< 3 per triangle, smooth, seen from both sides
  std::vector<float> triangle_scalar;      ///< one per triangle; colours triangles instead of points
  /// How triangles look: lit, in exactly the map's colours, or in those and more transparent the lower the
  /// value.
  enum class Surface : uint8_t { lit, plain, translucent } surface = Surface::lit;
};

/// A fixed or moving solid. Size: plane = its normal; box = half extents; sphere = (radius, -, -);
/// capsule = (radius, half length without the caps, -) along its own y, cylinder the same with flat ends.
struct DrawShape {
  using Kind = DrawnShape::Kind;
  Kind kind = Kind::sphere;
  Vec3 position;
  double orientation[4] = {1, 0, 0, 0};  ///< unit quaternion w x y z
  Vec3 size{1, 1, 1};
  bool container = false;  ///< things live inside: drawn as edges with a hint of glass
  std::optional<Color> color;
  std::shared_ptr<const DrawnMesh> mesh = {};  ///< for kind mesh
  /// Whether an automatically chosen camera frames it: a wide floor would make what stands on it small.
  enum class Framing : uint8_t { counts, ignored } framing = Framing::counts;
};

/// A straight mark on top of everything, visible through solids.
struct DrawMark {
  Vec3 from, to;  ///< m
  Color color;
  double radius = 0;    ///< m; never thinner than about 1.5 pixels
  bool framed = false;  ///< whether an automatic camera shows it
};

/// Text at a position in the scene, on top of everything.
struct DrawLabel {
  std::string text;
  Vec3 at;  ///< m
  /// Position of the text relative to the point: left or right of it, centred above or below it, one line
  /// farther below, above it and ending there, or on whatever side there is room.
  enum class Side : uint8_t { left, right, above, below, under, corner, beside } side = Side::right;
  std::optional<Color> color = {};  ///< empty = the theme's ink
  double radius = 0;                ///< m; of what is at the point, for a name beside it
};

/// Where the picture is taken from; `fov_degrees` is the vertical field of view, 1 to 160.
struct DrawCamera {
  Vec3 eye{3, 2, 4};
  Vec3 target;
  std::optional<Vec3> up;  ///< empty = the list's up
  double fov_degrees = 35;
};

/// What colours mean that no set of points explains.
struct DrawScale {
  std::string label;  ///< name and unit beside the colour bar
  ColorMap map = ColorMap::viridis;
  float low = 0, high = 1;
};

/// Everything one picture needs.
struct DrawList {
  std::vector<DrawPoints> points;
  std::vector<DrawShape> shapes;
  std::vector<DrawMark> marks;
  std::optional<DrawScale> scale;  ///< of the marks
  std::vector<DrawLabel> labels;
  std::vector<LegendRow> legend;        ///< top left
  std::vector<Vec3> framed;             ///< m; additional points that an automatic camera frames
  double fill = 0.9;                    ///< share of the picture's half that an automatic camera fills
  double fov_degrees = 35;              ///< of an automatic camera
  Vec3 up{0, 1, 0};                     ///< away from the ground; opposite to gravity
  std::optional<DrawCamera> camera;     ///< empty = chosen so that all points and shapes are in the picture
  std::optional<Vec3> facing;           ///< side from which an automatic camera looks; empty = obliquely from
                                        ///< above
  std::optional<double> ground_height;  ///< m along `up`; empty = no ground
  Color background_top{0.925f, 0.94f, 0.96f};
  Color background_bottom{0.80f, 0.83f, 0.87f};
  std::string caption;  ///< scene name and time, bottom left; ASCII, others become '?'
};

}  // namespace truestep
