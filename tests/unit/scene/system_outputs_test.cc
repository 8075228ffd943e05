// The outputs that the catalogue lists for systems are the actual ones: every field and observable of every
// gallery scene is listed with its unit, and each plain name listed occurs somewhere.
#include <gtest/gtest.h>

#include <regex>
#include <set>

#include "engine/scene/gallery.h"
#include "engine/scene/json/json.h"
#include "engine/session/world/world.h"

namespace truestep {
namespace {

/// "joint.<id>.force" as a pattern.
std::regex pattern(std::string_view name) {
  std::string out;
  for (size_t i = 0; i < name.size(); ++i) {
    if (name[i] == '<') {
      out += ".+";
      i = name.find('>', i);
    } else if (name[i] == '.') {
      out += "\\.";
    } else {
      out += name[i];
    }
  }
  return std::regex(out);
}

TEST(SystemOutputs, WhatGalleryScenesGiveOutIsListed) {
  // By table: kinds that are one system under several names share theirs.
  std::set<std::pair<const Outputs*, std::string>> seen;
  // Outputs that occur in no gallery scene.
  std::vector<std::string> texts{
      R"({"systems": [{"type": "pendulum"}, {"type": "oscillator"}, {"type": "rigid2d", "bodies": [
    {"motion": "fixed", "sensor": true, "shapes": [{"type": "circle"}]}]},
    {"type": "grid_fluid", "cells": [8, 8], "viscosity": 0.1, "stepping": "steady"},
    {"type": "grid_fluid", "cells": [8, 8], "viscosity": 0.1, "second_fluid": {"where": "y - 0.5", "density": 10}},
    {"type": "grid_fluid", "cells": [16, 16], "viscosity": 0.01, "obstacles": [
    {"center": [0.5, 0.5, 0], "radius": 0.2, "angle": "t"}]},
    {"type": "grid_fluid", "cells": [8, 8], "advection": "apic", "sides": {"x_max": {"kind": "outflow"}},
    "bodies": [{"center": [0.5, 0, 0], "half_extents": [0.5, 0.5, 1], "dye": 1}]}]})"};
  for (const GalleryScene& g : gallery()) texts.emplace_back(g.text);
  for (const std::string& text : texts) {
    const World world(parse_scene(text));
    for (size_t i = 0; i < world.size(); ++i) {
      const CatalogueRow& row = *world.scene().systems[i].row;
      for (const PartInfo& part : world.system(i).parts()) {
        for (const FieldInfo& f : part.fields) {
          bool listed = false;
          for (const FieldOutput& o : row.outputs->fields) {
            // An output of a part other than the main one is listed with the part's name.
            const bool same = std::regex_match(f.name, pattern(o.name));
            if (!same && part.name + "." + f.name != o.name) continue;
            listed = true;
            if (o.name.find('<') != std::string_view::npos) continue;
            EXPECT_EQ(f.unit, o.unit) << row.type << ' ' << f.name;
            EXPECT_EQ(f.width, o.width) << row.type << ' ' << f.name;
            seen.insert({row.outputs, std::string(o.name)});
          }
          EXPECT_TRUE(listed) << row.type << ' ' << part.name << ' ' << f.name;
        }
      }
      Observables values;
      world.system(i).observe(world.system(i).initial_state(), 0, values);
      for (const Observation& v : values.rows()) {
        bool listed = false;
        for (const OutputInfo& o : row.outputs->observables) {
          if (!std::regex_match(v.name, pattern(o.name))) continue;
          listed = true;
          if (o.name == v.name) {
            EXPECT_EQ(v.unit, o.unit) << row.type << ' ' << v.name;
            seen.insert({row.outputs, v.name});
          }
        }
        EXPECT_TRUE(listed) << row.type << ' ' << v.name;
      }
    }
  }
  for (const CatalogueRow& row : catalogue()) {
    EXPECT_FALSE(row.outputs->rows.empty()) << row.type;
    const auto expect_seen = [&](std::string_view name) {
      // One method counts its steps, constant forces have tests of their own, and nothing has stopped at the
      // start: these need not be in the gallery.
      if (name.find('<') != std::string_view::npos || name == "integrator.held_steps" ||
          name == "power.applied" || name == "stopped.time") {
        return;
      }
      EXPECT_TRUE(seen.contains({row.outputs, std::string(name)})) << row.type << ' ' << name;
    };
    for (const FieldOutput& f : row.outputs->fields) expect_seen(f.name);
    for (const OutputInfo& o : row.outputs->observables) expect_seen(o.name);
  }
}

}  // namespace
}  // namespace truestep
