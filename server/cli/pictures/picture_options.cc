#include "server/cli/pictures/picture_options.h"

#include <charconv>
#include <cmath>

#include "engine/base/errors.h"
#include "engine/sinks/picture/camera.h"
#include "engine/sinks/picture/picture.h"

namespace truestep {

namespace {

/// `count` numbers separated by `separator`; empty when the text is anything else.
template <class T>
std::optional<std::vector<T>> numbers(const std::string& text, size_t count, char separator) {
  std::vector<T> out;
  const char *at = text.data(), *end = at + text.size();
  while (out.size() < count) {
    T value{};
    const auto [next, error] = std::from_chars(at, end, value);
    if (error != std::errc() || (std::is_floating_point_v<T> && !std::isfinite(static_cast<double>(value))))
      return std::nullopt;
    out.push_back(value);
    if (out.size() == count) return next == end ? std::optional(out) : std::nullopt;
    if (next == end || *next != separator) return std::nullopt;
    at = next + 1;
  }
  return std::nullopt;
}

}  // namespace

void add_picture_options(Arguments command, PictureOptions& options) {
  command.add_option("--size", options.size, "width and height of a picture in pixels (default: 1280x720)");
  const Argument camera =
      command.add_option("--camera", options.camera,
                         "position and target of the camera, m: x,y,z,x,y,z (default: the "
                         "scene's, else one that shows everything)");
  command.add_option("--view", options.view, "side from which the camera shows everything")
      .one_of({"oblique", "front", "side", "top"})
      .excludes(camera);
  command.add_option("--show", options.show, "marks drawn over bodies: one, or both as contacts,joints")
      .one_of({"contacts", "joints", "contacts,joints"}, "{contacts | joints | contacts,joints}");
  command.add_option("--theme", options.theme, "background of the picture (default: light)")
      .one_of({"light", "dark"});
}

PictureSize picture_size(const PictureOptions& options) {
  if (options.size.empty()) return {};
  const auto sides = numbers<int>(options.size, 2, 'x');
  constexpr int kLeast = PictureRenderer::kMinSide, kMost = PictureRenderer::kMaxSide;
  const auto good = [](int side) { return side >= kLeast && side <= kMost; };
  if (!sides || !good((*sides)[0]) || !good((*sides)[1])) {
    throw Error("bad_request", "--size " + options.size + ": a size is WIDTHxHEIGHT, each " +
                                   std::to_string(kLeast) + " to " + std::to_string(kMost) +
                                   " pixels, such as 1280x720");
  }
  return {(*sides)[0], (*sides)[1]};
}

PictureLook picture_look(const PictureOptions& options) {
  const auto shown = [&](const char* name, Wish wish) {
    return options.show.find(name) != std::string::npos ? wish : Wish::none;
  };
  using Theme = PictureLook::Theme;
  return {.theme = options.theme == "dark" ? Theme::dark : Theme::light,
          .marks = shown("contacts", Wish::contacts) | shown("joints", Wish::joints)};
}

void aim(const PictureOptions& options, DrawList& list) {
  if (!options.camera.empty()) {
    const auto v = numbers<double>(options.camera, 6, ',');
    if (!v) {
      throw Error("bad_request",
                  "--camera " + options.camera +
                      ": a camera is six numbers, its position and its target, such as 3,2,4,0,1,0");
    }
    list.camera = DrawCamera{{(*v)[0], (*v)[1], (*v)[2]}, {(*v)[3], (*v)[4], (*v)[5]}, std::nullopt, 40};
  }
  if (options.view.empty()) return;
  list.camera.reset();
  const picture::Axes axes = picture::axes_of(list.up);
  if (options.view == "oblique") list.facing.reset();
  if (options.view == "front") list.facing = axes.front;
  if (options.view == "side") list.facing = axes.side;
  if (options.view == "top") list.facing = axes.up;
}

}  // namespace truestep
