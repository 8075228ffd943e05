#include "scaled_scene.h"

#include <array>
#include <cmath>
#include <string>

namespace truestep {
namespace {

namespace json = boost::json;

// Everything that can be scaled, by the names of the numbers that give its amount; a grid has two of them.
struct Amount {
  const char *object, *number;
  double power = 1;
};
constexpr std::array<Amount, 7> kAmounts = {{{"rope", "links"},
                                             {"cloth_grid", "nx", 0.5},
                                             {"cloth_grid", "ny", 0.5},
                                             {"hair", "strands"},
                                             {"fill", "count"},
                                             {"emitters", "rate"},
                                             {"tracers", "count"}}};

void multiply(json::value& number, double factor) {
  const double v = number.to_number<double>() * factor;
  if (number.is_double()) {
    number = v;
  } else {
    number = static_cast<int64_t>(std::lround(v));
  }
}

// Scales the system's amount if it has one; false otherwise.
bool grow(json::object& system, int times) {
  bool any = false;
  for (const Amount& a : kAmounts) {
    json::value* object = system.if_contains(a.object);
    if (!object) continue;
    const auto change = [&](json::value& holder) {
      json::value* number = holder.is_object() ? holder.as_object().if_contains(a.number) : nullptr;
      if (!number || !number->is_number()) return;
      multiply(*number, std::pow(times, a.power));
      any = true;
    };
    if (object->is_array()) {
      for (json::value& one : object->as_array()) change(one);
    } else {
      change(*object);
    }
  }
  if (json::value* most = any ? system.if_contains("max_particles") : nullptr) multiply(*most, times);
  // A self-colliding cloth must not be thicker than its links are long.
  json::value* thick = any && system.contains("self_collision") ? system.if_contains("thickness") : nullptr;
  if (thick) multiply(*thick, 1 / std::sqrt(times));
  return any;
}

std::string id_of(const json::object& system, size_t place) {
  const json::value* id = system.if_contains("id");
  return id ? std::string(id->as_string())
            : std::string(system.at("type").as_string()) + std::to_string(place);
}

}  // namespace

json::value scaled_scene(const json::value& document, int times) {
  json::value scaled = document;
  if (times == 1) return scaled;
  json::object& scene = scaled.as_object();
  for (const char* judged : {"expect", "probes", "observables", "recording", "accuracy"}) scene.erase(judged);
  bool all = !scene.contains("couplings");
  for (json::value& system : scene["systems"].as_array()) all = grow(system.as_object(), times) && all;
  if (all) return scaled;
  scaled = document;
  json::object& repeated = scaled.as_object();
  for (const char* judged : {"expect", "probes", "observables", "recording", "accuracy"})
    repeated.erase(judged);
  for (const char* list : {"systems", "couplings"}) {
    const json::value* found = repeated.if_contains(list);
    if (!found) continue;
    const json::array once = found->as_array();
    json::array& many = repeated[list].as_array();
    many.clear();
    for (int k = 0; k < times; ++k) {
      for (size_t i = 0; i < once.size(); ++i) {
        json::object copy = once[i].as_object();
        const std::string suffix = "_" + std::to_string(k);
        if (copy.contains("id") || list[0] == 's') copy["id"] = id_of(copy, i) + suffix;
        for (const char* end : {"a", "b"}) {
          if (list[0] == 'c') copy[end] = std::string(copy.at(end).as_string()) + suffix;
        }
        many.push_back(std::move(copy));
      }
    }
  }
  return scaled;
}

}  // namespace truestep
