// All errors of a scene are reported at once, with pointer, allowed values and nearest name: fields, rows and
// ids of probes, observables, expectations, recordings; and an unknown key hides none of them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "engine/base/text/nearest_name.h"
#include "engine/scene/gallery.h"
#include "engine/scene/json/json.h"
#include "engine/scene/json/json_write.h"
#include "engine/session/describe.h"

namespace truestep {
namespace {

using ::testing::HasSubstr;

/// Faults by pointer.
std::map<std::string, boost::json::object> faults(const std::string& text) {
  const boost::json::object report = validate_scene(parse_json(text), AdmissionLimits{});
  std::map<std::string, boost::json::object> out;
  for (const auto& e : report.at("errors").as_array())
    out[e.at("pointer").as_string().c_str()] = e.as_object();
  EXPECT_EQ(report.at("valid").as_bool(), out.empty());
  return out;
}

std::string text_of(const boost::json::object& issue, const char* key) {
  const auto* v = issue.if_contains(key);
  return v ? v->as_string().c_str() : "";
}

// Three points, rows 0 to 2.
std::string rope(const std::string& more, const std::string& own = "") {
  return R"({"time": {"dt": 0.01}, "systems": [{"type": "mass_spring", "id": "r", "pinned": ["first"],
    "rope": {"from": [0, 0, 0], "to": [1, 0, 0], "links": 2})" +
         own + "}]" + (more.empty() ? "" : ", " + more) + "}";
}

TEST(SceneFaults, ProbesNameFieldsAndRowsThatThereAre) {
  const auto found = faults(rope(R"("probes": [
    {"id": "a", "system": "r", "fields": ["postion", "velocity"]},
    {"id": "b", "system": "r", "index": 3},
    {"id": "c", "system": "r", "index": -4},
    {"id": "a", "system": "r", "index": -3},
    {"id": "d", "system": "r", "index": 2}])"));
  ASSERT_EQ(found.size(), 4u);
  const auto& field = found.at("/probes/0/fields/0");
  EXPECT_EQ(text_of(field, "did_you_mean"), "position");
  EXPECT_THAT(text_of(field, "allowed"), HasSubstr("position, velocity, force, strain"));
  EXPECT_EQ(text_of(found.at("/probes/1/index"), "allowed"), "[-3, 2]");
  EXPECT_TRUE(found.contains("/probes/2/index"));
  EXPECT_EQ(text_of(found.at("/probes/3/id"), "code"), "duplicate_id");
}

TEST(SceneFaults, ObservablesAndQuantitiesAreOnesThatThereAre) {
  const auto found = faults(rope(R"s("observables": ["energy", "r.strian", "r.momentum.x"], "expect": [
    {"quantity": "max(r.strain.max)", "min": 0}, {"quantity": "max(r.strain.mix)", "min": 0},
    {"quantity": "2 * mean(energy.totl)", "min": 0}, {"quantity": "energy.drift", "max": 1}])s"));
  ASSERT_EQ(found.size(), 3u);
  EXPECT_EQ(text_of(found.at("/observables/1"), "did_you_mean"), "r.strain");
  EXPECT_EQ(text_of(found.at("/expect/1/quantity"), "did_you_mean"), "max(r.strain.max)");
  EXPECT_EQ(text_of(found.at("/expect/2/quantity"), "did_you_mean"), "2 * mean(energy.total)");
  EXPECT_THAT(text_of(found.at("/expect/2/quantity"), "allowed"),
              HasSubstr("min(...), max(...), drift(...)"));
}

TEST(SceneFaults, ExpressionsMayBeNumbersAndNothingElse) {
  const auto rod = [](const char* diffusivity) {
    return std::string(R"({"systems": [{"type": "heat", "id": "rod", "cells": [8], "diffusivity": )") +
           diffusivity + "}]}";
  };
  const auto canonical = [&](const char* diffusivity) {
    return parse_scene(rod(diffusivity))
        .canonical()
        .at("systems")
        .as_array()[0]
        .at("diffusivity")
        .as_string();
  };
  EXPECT_EQ(canonical("0.25"), "0.25");
  EXPECT_EQ(canonical(R"("0.25")"), "0.25");
  EXPECT_TRUE(faults(rod(R"("1 + x")")).empty());
  EXPECT_TRUE(faults(rod("true")).contains("/systems/0/diffusivity"));
  EXPECT_TRUE(faults(rod(R"("1 + (")")).contains("/systems/0/diffusivity"));
}

TEST(SceneFaults, RecordingsNameFieldsThatThereAre) {
  const auto found = faults(rope(R"("recording": {"fields": ["position", "speeed"]})"));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_TRUE(found.contains("/recording/fields/1"));
  // Fields of other lengths belong to other parts, which are recorded separately.
  EXPECT_TRUE(faults(R"({"systems": [{"type": "pendulum", "id": "p"}],
    "recording": {"fields": ["position", "angle"]}})")
                  .empty());
}

TEST(SceneFaults, AnUnknownKeyHidesNoOtherFault) {
  const auto found =
      faults(rope(R"("gravty": [0, 0, 0], "probes": [{"id": "a", "system": "r", "fields": ["x"]}],
    "observables": ["nothing"])",
                  R"(, "stifness": 3, "pins": [7], "integrator": "rk5")"));
  EXPECT_TRUE(found.contains("/gravty"));
  EXPECT_TRUE(found.contains("/systems/0/stifness"));
  EXPECT_TRUE(found.contains("/systems/0/pins/0"));
  // The rope's own error keeps it from being built: nothing is reported about its fields.
  EXPECT_FALSE(found.contains("/probes/0/fields/0"));
  EXPECT_TRUE(found.contains("/observables/0"));
  const auto built =
      faults(rope(R"("gravty": [0, 0, 0], "probes": [{"id": "a", "system": "r", "fields": ["x"]}])",
                  R"(, "stifness": 3)"));
  EXPECT_EQ(built.size(), 3u);
  EXPECT_TRUE(built.contains("/probes/0/fields/0"));
  const auto method = faults(rope(R"("gravty": [0, 0, 0])", R"(, "integrator": "rk5")"));
  EXPECT_TRUE(method.contains("/systems/0/integrator") && method.contains("/gravty"));
}

// There was a second choice, "stop", that nothing read.
TEST(SceneFaults, AnInstabilityPausesTheSession) {
  EXPECT_TRUE(faults(rope(R"("on_instability": "stop")")).contains("/on_instability"));
  EXPECT_TRUE(faults(rope(R"("on_instability": "pause")")).empty());
}

TEST(SceneFaults, OfASystemOfUnknownTypeNothingElseIsSaid) {
  const auto found = faults(R"({"systems": [{"type": "rope", "id": "r"}, {"type": "pendulum", "id": "p"}],
    "couplings": [{"type": "contact", "a": "r", "b": "p"}], "observables": ["r.energy", "energy.total", "q"],
    "probes": [{"id": "a", "system": "r"}, {"id": "b", "system": "p", "index": 9}]})");
  EXPECT_EQ(found.size(), 3u);
  EXPECT_TRUE(found.contains("/systems/0/type") && found.contains("/observables/2") &&
              found.contains("/probes/1/index"));
}

TEST(SceneFaults, EmittersFillRowsThatProbesMayName) {
  const std::string scene = R"({"systems": [{"type": "particles", "id": "p", "max_particles": 50,
    "emitters": [{"rate": 10}]}], "probes": [{"id": "a", "system": "p", "index": INDEX}],
    "expect": [{"quantity": "a.position.y", "min": 0}]})";
  const auto with = [&](const std::string& index) {
    std::string s = scene;
    return faults(s.replace(s.find("INDEX"), 5, index));
  };
  EXPECT_TRUE(with("49").empty());
  EXPECT_EQ(with("50").size(), 1u);
  // Bodies that only a command could create do not exist yet.
  const auto ball = faults(R"({"systems": [{"type": "rigid3d", "id": "r", "bodies": [{"type": "sphere"}]}],
    "probes": [{"id": "a", "system": "r", "index": 1}]})");
  EXPECT_EQ(ball.size(), 1u);
}

TEST(SceneFaults, ValuesAreShownWhereThereAreAny) {
  const auto found = faults(R"({"systems": [{"type": "particles", "id": "p",
    "emitters": [{"rate": 10, "bursts": [1]}, {"lifetime": 1, "lifetime_spread": 2}]},
    {"type": "oscillator", "mass": null}]})");
  EXPECT_EQ(text_of(found.at("/systems/0/emitters/0/bursts"), "value"), "[1 elements]");
  EXPECT_EQ(text_of(found.at("/systems/0/emitters/1/lifetime_spread"), "value"), "2");
  EXPECT_EQ(text_of(found.at("/systems/1/mass"), "value"), "null");
  const auto missing = faults(R"({"systems": [{"type": "mass_spring", "rope": {"from": [0, 0, 0]}}]})");
  EXPECT_EQ(text_of(missing.at("/systems/0/rope/to"), "value"), "");
}

TEST(SceneFaults, GalleryHasNone) {
  for (const GalleryScene& g : gallery()) EXPECT_TRUE(faults(std::string(g.text)).empty()) << g.name;
}

TEST(NearestName, OnlyNamesThatAreNear) {
  const std::vector<std::string> names{"s", "mass", "stiffness", "gravity", "angular_velocity"};
  EXPECT_EQ(nearest_name("zz", names), "");
  EXPECT_EQ(nearest_name("q", names), "");
  EXPECT_EQ(nearest_name("mas", names), "mass");
  EXPECT_EQ(nearest_name("msas", names), "mass");
  EXPECT_EQ(nearest_name("stifness", names), "stiffness");
  EXPECT_EQ(nearest_name("grvty", names), "gravity");
  EXPECT_EQ(nearest_name("stiff", names), "stiffness");
  EXPECT_EQ(nearest_name("velocity", names), "angular_velocity");
  EXPECT_EQ(nearest_name("temperature", names), "");
}

TEST(SceneFaults, ColorOfAFieldThatNothingHasIsNamed) {
  const auto found = faults(rope(R"("viewer": {"color_by": "strian"})"));
  ASSERT_TRUE(found.contains("/viewer/color_by"));
  EXPECT_EQ(text_of(found.at("/viewer/color_by"), "did_you_mean"), "strain");
  for (const char* known : {"speed", "strain", "velocity"}) {
    EXPECT_TRUE(faults(rope(R"("viewer": {"color_by": ")" + std::string(known) + R"("})")).empty()) << known;
  }
}

TEST(SceneFaults, WhatOnlyGridsShowIsRefusedWithoutThem) {
  const auto plate = [](const std::string& viewer) {
    return faults(R"({"viewer": {)" + viewer +
                  R"(}, "systems": [{"type": "grid_fluid", "size": [1, 1], "cells": [16, 16]}]})");
  };
  // Streamlines follow the field that is shown.
  EXPECT_TRUE(plate(R"("color_by": "velocity", "streamlines": 20)").empty());
  EXPECT_TRUE(plate(R"("color_by": "vorticity", "streamlines": 20)").contains("/viewer/streamlines"));
  // A cut is one through space; a line or a plane is raised.
  EXPECT_TRUE(plate(R"("slice": {"axis": "z"})").contains("/viewer/slice"));
  EXPECT_TRUE(plate(R"("color_by": "vorticity", "height": 0.1)").empty());
  for (const char* view : {R"("contours": 5)", R"("height": 1)", R"("streamlines": 9)"}) {
    EXPECT_EQ(faults(rope(R"("viewer": {)" + std::string(view) + "}")).size(), 1u) << view;
  }
}

}  // namespace
}  // namespace truestep
