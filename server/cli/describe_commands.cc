#include "server/cli/describe_commands.h"

#include <iostream>

#include "engine/scene/gallery.h"
#include "engine/scene/json/json.h"
#include "engine/scene/json/json_write.h"
#include "engine/session/describe.h"
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

void print_parameters(const json::array& rows, const std::string& indent) {
  for (const json::value& v : rows) {
    const json::object& r = v.as_object();
    std::cout << indent << r.at("name").as_string().c_str() << " (" << r.at("kind").as_string().c_str();
    if (r.contains("unit")) std::cout << ", " << r.at("unit").as_string().c_str();
    if (r.contains("required")) std::cout << ", required";
    if (r.contains("default")) std::cout << ", default " << write_json(r.at("default"));
    if (r.contains("allowed")) std::cout << ", " << r.at("allowed").as_string().c_str();
    if (r.contains("choices")) std::cout << ", one of " << write_json(r.at("choices"));
    std::cout << "): " << r.at("description").as_string().c_str() << '\n';
    if (r.contains("parameters")) print_parameters(r.at("parameters").as_array(), indent + "  ");
    if (r.contains("types")) {
      for (const auto& [type, nested] : r.at("types").as_object()) {
        std::cout << indent << "  type " << type << ":\n";
        print_parameters(nested.as_array(), indent + "    ");
      }
    }
  }
}

void print_outputs(const Outputs& out) {
  const auto tail = [](std::string_view sentence) {
    if (!sentence.empty()) std::cout << ": " << sentence;
    std::cout << '\n';
  };
  std::cout << "\nfields (of probes, recordings and streams; \"index\" of a probe is a row)\n  a row is "
            << out.rows << '\n';
  for (const FieldOutput& f : out.fields) {
    std::cout << "  " << f.name << " (" << f.unit << (f.width > 1 ? " x " + std::to_string(f.width) : "")
              << ')';
    tail(f.sentence);
  }
  std::cout << "\nobservables (as <id>.<name>; a scene's energy.* are sums over its systems)\n";
  for (const OutputInfo& o : out.observables) {
    std::cout << "  " << o.name << " (" << o.unit << ')';
    tail(o.sentence);
  }
}

void print_settable(const json::array& settable) {
  if (settable.empty()) return;
  std::cout << "\nset_parameter (POST /v1/sessions/{id}/commands, while the scene runs) takes\n";
  for (const json::value& v : settable) {
    const json::object& p = v.as_object();
    const std::string_view unit = p.at("unit").as_string(), of = p.at("of").as_string(),
                           sentence = p.at("description").as_string();
    std::cout << "  " << p.at("name").as_string().c_str() << " (" << p.at("takes").as_string().c_str();
    if (!unit.empty()) std::cout << ", " << unit;
    std::cout << ')';
    if (of != "system") std::cout << ", index: the row or id of a " << of;
    if (!sentence.empty()) std::cout << ": " << sentence;
    std::cout << '\n';
  }
}

int systems(const Options& options) {
  if (options.name.empty()) {
    if (options.json) {
      std::cout << write_json(describe_systems()) << '\n';
    } else {
      for (const CatalogueRow& row : catalogue()) std::cout << row.type << "\t" << row.sentence << '\n';
    }
    return kExitOk;
  }
  const CatalogueRow* row = find_system_type(options.name);
  if (!row) {
    std::string all;
    for (const CatalogueRow& r : catalogue()) all += (all.empty() ? "" : ", ") + std::string(r.type);
    std::vector<std::string> names;
    for (const CatalogueRow& r : catalogue()) names.emplace_back(r.type);
    throw Error("not_found", "there is no system type " + options.name + "; there are: " + all +
                                 did_you_mean(options.name, names));
  }
  const json::object d = describe_system(*row);
  if (options.json) {
    std::cout << write_json(d) << '\n';
    return kExitOk;
  }
  std::cout << row->type << ": " << row->sentence << "\n\nparameters\n";
  print_parameters(d.at("parameters").as_array(), "  ");
  if (!d.at("integrators").as_array().empty()) {
    std::cout << "\nintegrators (default " << row->default_integrator << ")\n";
    for (const json::value& m : d.at("integrators").as_array()) {
      std::cout << "  " << m.at("name").as_string().c_str() << ": " << m.at("title").as_string().c_str()
                << ", order " << m.at("order").as_int64() << '\n';
    }
    for (const std::string_view own : row->own_integrators)
      std::cout << "  " << own << ": of this system only\n";
  }
  print_outputs(*row->outputs);
  print_settable(d.at("settable").as_array());
  std::cout << "\nguarantees\n";
  for (const std::string_view g : row->guarantees) std::cout << "  " << g << '\n';
  return kExitOk;
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
  add("systems", "the kinds of systems, or one kind with its parameters", systems)
      .add_option("type", options->name, "a system type");
  add("gallery", "the scenes that come with the program, or one scene's document", show_gallery)
      .add_option("name", options->name, "a gallery scene");
  add("schema", "the JSON Schema of a scene", [](const Options&) {
    std::cout << write_json(scene_schema()) << '\n';
    return static_cast<int>(kExitOk);
  });
}

}  // namespace truestep
