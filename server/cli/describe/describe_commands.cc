#include "server/cli/describe/describe_commands.h"

#include <iostream>

#include "engine/scene/gallery.h"
#include "engine/scene/json/json.h"
#include "engine/scene/json/json_write.h"
#include "engine/session/describe.h"
#include "server/cli/describe/describe_types.h"
#include "server/cli/exit_codes.h"
#include "server/cli/input.h"

namespace truestep {

namespace json = boost::json;

namespace {

struct Options {
  std::string name;
  bool json = false;
};

void print_issues(const json::array& issues, const char* kind) {
  for (const json::value& v : issues) {
    const json::object& i = v.as_object();
    const auto text = [&](const char* key) {
      return i.contains(key) ? std::string(i.at(key).as_string().c_str()) : "";
    };
    std::cout << kind << ' ' << (text("pointer").empty() ? "/" : text("pointer")) << ": " << text("message");
    if (!text("value").empty()) std::cout << " (got " << text("value") << ')';
    if (!text("allowed").empty()) std::cout << "; allowed: " << text("allowed");
    if (!text("unit").empty()) std::cout << ' ' << text("unit");
    if (!text("did_you_mean").empty()) std::cout << "; did you mean \"" << text("did_you_mean") << "\"?";
    std::cout << '\n';
  }
}

int validate(const Options& options) {
  const json::object report = validate_scene(load_scene_document(options.name), AdmissionLimits{});
  const bool valid = report.at("valid").as_bool();
  if (options.json) {
    std::cout << write_json(report) << '\n';
    return valid ? kExitOk : kExitInvalidScene;
  }
  print_issues(report.at("errors").as_array(), "error  ");
  print_issues(report.at("warnings").as_array(), "warning");
  if (const json::value* plan = report.if_contains("plan")) {
    for (const json::value& v : plan->as_array()) {
      const json::object& row = v.as_object();
      std::cout << (row.at("runs").as_bool() ? "runs    " : "skipped ")
                << row.at("system").as_string().c_str() << ": " << row.at("pass").as_string().c_str() << " ("
                << row.at("reason").as_string().c_str() << ")\n";
    }
  }
  if (const json::value* e = report.if_contains("estimate")) {
    std::cout << "estimate " << e->at("memory_bytes").to_number<double>() / 1e6 << " MB, "
              << e->at("seconds_per_step").to_number<double>() * 1e3 << " ms a step\n";
  }
  std::cout << (valid ? "valid\n" : "invalid\n");
  return valid ? kExitOk : kExitInvalidScene;
}

int show_gallery(const Options& options) {
  if (!options.name.empty()) {
    const GalleryScene* g = find_gallery_scene(options.name);
    if (!g)
      throw Error("not_found",
                  "there is no gallery scene " + options.name + did_you_mean_scene(options.name));
    std::cout << g->text;
    return kExitOk;
  }
  const json::array list = describe_gallery();
  if (options.json) {
    std::cout << write_json(list) << '\n';
    return kExitOk;
  }
  for (const json::value& v : list) {
    const json::object& o = v.as_object();
    std::cout << o.at("name").as_string().c_str() << '\t'
              << (o.contains("title") ? o.at("title").as_string().c_str() : "") << '\n';
  }
  return kExitOk;
}

}  // namespace

void add_describe_commands(Arguments app, int& exit_code) {
  auto options = std::make_shared<Options>();
  const auto add = [&](const char* name, const char* sentence, int (*run)(const Options&)) {
    Arguments c = app.add_subcommand(name, sentence);
    c.add_flag("--json", options->json, "JSON on standard output");
    c.callback([options, run, &exit_code] { exit_code = run(*options); });
    return c;
  };
  add("validate", "errors and warnings of a scene, its plan and its cost", validate)
      .add_option("scene", options->name, "scene file, gallery name, or - for standard input")
      .required();
  add_systems_command(app, exit_code);
  add("gallery", "the scenes that come with the program, or one scene's document", show_gallery)
      .add_option("name", options->name, "a gallery scene");
  add("schema", "the JSON Schema of a scene", [](const Options&) {
    std::cout << write_json(scene_schema()) << '\n';
    return static_cast<int>(kExitOk);
  });
}

}  // namespace truestep
