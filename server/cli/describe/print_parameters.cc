#include "server/cli/describe/print_parameters.h"

#include <algorithm>
#include <ostream>
#include <string>
#include <vector>

#include "engine/scene/json/json_write.h"

namespace truestep {
namespace {

namespace json = boost::json;

std::string text(const json::object& o, const char* key) {
  return o.at(key).as_string().c_str();
}

void print_line(std::ostream& out, const json::object& r, const std::string& indent) {
  out << indent << text(r, "name") << " (" << text(r, "kind");
  if (r.contains("unit")) out << ", " << text(r, "unit");
  if (r.contains("required")) out << ", required";
  if (r.contains("default")) out << ", default " << write_json(r.at("default"));
  if (r.contains("allowed")) out << ", " << text(r, "allowed");
  if (r.contains("choices")) out << ", one of " << write_json(r.at("choices"));
  out << "): " << text(r, "description") << '\n';
}

void print_whole(std::ostream& out, const json::array& rows, const std::string& indent) {
  for (const json::value& v : rows) {
    const json::object& r = v.as_object();
    print_line(out, r, indent);
    if (r.contains("parameters")) print_whole(out, r.at("parameters").as_array(), indent + "  ");
    if (!r.contains("types")) continue;
    for (const auto& [type, nested] : r.at("types").as_object()) {
      out << indent << "  type " << type << ":\n";
      print_whole(out, nested.as_array(), indent + "    ");
    }
  }
}

/// The names, after `head`, in lines of at most a hundred letters.
void print_names(std::ostream& out, const std::string& head, const std::vector<std::string>& names) {
  constexpr size_t kWidth = 100;
  std::string line = head;
  for (size_t k = 0; k < names.size(); ++k) {
    const std::string word = names[k] + (k + 1 < names.size() ? "," : "");
    if (line.size() + 1 + word.size() > kWidth) {
      out << line << '\n';
      line = std::string(head.find_first_not_of(' ') + 2, ' ');
    } else {
      line += ' ';
    }
    line += word;
  }
  out << line << '\n';
}

std::vector<std::string> names_of(const json::array& rows) {
  std::vector<std::string> out;
  for (const json::value& v : rows) out.push_back(text(v.as_object(), "name"));
  return out;
}

bool takes(const json::value& rows, const std::string& name) {
  const auto names = names_of(rows.as_array());
  return std::find(names.begin(), names.end(), name) != names.end();
}

void print_variants(std::ostream& out, const json::object& types) {
  const auto shared = [&](const std::string& name) {
    return std::ranges::all_of(types, [&](const auto& type) { return takes(type.value(), name); });
  };
  std::vector<std::string> common;
  for (const std::string& name : names_of(types.begin()->value().as_array())) {
    if (shared(name)) common.push_back(name);
  }
  for (const auto& [type, rows] : types) {
    std::vector<std::string> own;
    for (const std::string& name : names_of(rows.as_array())) {
      if (!shared(name)) own.push_back(name);
    }
    print_names(out, "    type " + std::string(type) + ":", own);
  }
  print_names(out, "    all of them:", common);
}

}  // namespace

void print_parameters(std::ostream& out, const json::array& rows, Detail detail) {
  if (detail == Detail::whole) return print_whole(out, rows, "  ");
  for (const json::value& v : rows) {
    const json::object& r = v.as_object();
    print_line(out, r, "  ");
    if (r.contains("parameters")) print_names(out, "    of", names_of(r.at("parameters").as_array()));
    if (r.contains("types")) print_variants(out, r.at("types").as_object());
  }
}

}  // namespace truestep
