#include "server/cli/input.h"

#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>

#include "engine/base/errors.h"
#include "engine/base/text/encoding.h"
#include "engine/base/text/nearest_name.h"
#include "engine/scene/file_references.h"
#include "engine/scene/gallery.h"
#include "engine/scene/json/json.h"

namespace truestep {

namespace fs = std::filesystem;

boost::json::value load_scene_document(const std::string& path_or_name) {
  std::stringstream text;
  const GalleryScene* g = find_gallery_scene(path_or_name);
  if (path_or_name == "-") {
    text << std::cin.rdbuf();
  } else if (std::error_code none; g && !fs::is_regular_file(path_or_name, none)) {
    return parse_json(g->text);
  } else if (!fs::exists(path_or_name, none)) {
    throw Error("not_found", "there is no file and no gallery scene named " + path_or_name +
                                 did_you_mean_scene(path_or_name));
  } else {
    require_file(path_or_name);
    text << std::ifstream(path_or_name, std::ios::binary).rdbuf();
  }
  const std::string bytes = text.str();
  boost::json::value document = parse_json(without_byte_order_mark(bytes));
  const fs::path file = fs::absolute(path_or_name);  // "-": in the working directory
  resolve_paths(document, file.parent_path());
  return document;
}

std::string did_you_mean(const std::string& name, std::span<const std::string> names) {
  const std::string near = nearest_name(name, names);
  return near.empty() ? "" : "; did you mean \"" + near + "\"?";
}

std::string did_you_mean_scene(const std::string& name) {
  std::vector<std::string> names;
  for (const GalleryScene& scene : gallery()) names.emplace_back(scene.name);
  return did_you_mean(name, names);
}

void require_file(const std::string& path) {
  std::error_code none;
  if (fs::is_directory(path, none)) throw Error("not_found", path + " is a folder, not a file");
  if (!fs::exists(path, none)) throw Error("not_found", "there is no file " + path);
  if (!std::ifstream(path, std::ios::binary))
    throw Error("not_found", "the file " + path + " cannot be read");
}

std::vector<std::byte> load_bytes(const std::string& path) {
  constexpr std::streamoff kMost = std::streamoff{4} << 30;
  require_file(path);
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  const std::streamoff size = file ? std::streamoff(file.tellg()) : -1;
  if (size < 0) throw Error("not_found", "the file " + path + " cannot be read");
  if (size > kMost) throw Error("too_large", "the file " + path + " is larger than 4 GiB");
  std::vector<std::byte> out(static_cast<size_t>(size));
  file.seekg(0).read(reinterpret_cast<char*>(out.data()), size);
  if (!file) throw Error("not_found", "the file " + path + " cannot be read");
  return out;
}

void save_bytes(const std::string& path, std::span<const std::byte> bytes) {
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!file.flush()) throw Error("not_found", "the file " + path + " cannot be written");
}

void print_error(const Error& error) {
  std::cerr << "error: " << error.what() << '\n';
  for (const Issue& i : error.issues()) {
    std::cerr << "  " << (i.pointer.empty() ? "/" : i.pointer) << ": " << i.message;
    if (!i.value.empty()) std::cerr << " (got " << i.value << ")";
    if (!i.allowed.empty()) std::cerr << "; allowed: " << i.allowed << (i.unit.empty() ? "" : " " + i.unit);
    if (!i.did_you_mean.empty()) std::cerr << "; did you mean \"" << i.did_you_mean << "\"?";
    std::cerr << '\n';
  }
}

}  // namespace truestep
