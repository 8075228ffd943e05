#include "server/cli/input.h"

#include <fstream>
#include <iostream>
#include <sstream>

#include "engine/base/errors.h"
#include "engine/scene/gallery.h"
#include "engine/scene/json.h"

namespace truestep {

boost::json::value load_scene_document(const std::string& path_or_name) {
  std::stringstream text;
  if (path_or_name == "-") {
    text << std::cin.rdbuf();
  } else if (std::ifstream file(path_or_name, std::ios::binary); file) {
    text << file.rdbuf();
  } else if (const GalleryScene* g = find_gallery_scene(path_or_name)) {
    return parse_json(g->text);
  } else {
    throw Error("not_found", "there is no file and no gallery scene named " + path_or_name);
  }
  return parse_json(text.str());
}

std::vector<std::byte> load_bytes(const std::string& path) {
  constexpr std::streamoff kMost = std::streamoff{4} << 30;
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
