#include "server/cli/describe/describe_types.h"

#include <iostream>
#include <optional>

#include "engine/scene/coupling_catalogue.h"
#include "engine/scene/json/json_write.h"
#include "engine/scene/params/params.h"
#include "engine/session/commands.h"
#include "engine/session/describe.h"
#include "server/cli/describe/examples.h"
#include "server/cli/describe/print_parameters.h"
#include "server/cli/exit_codes.h"
#include "server/cli/input.h"

namespace truestep {
namespace {

namespace json = boost::json;

struct SystemsOptions {
  std::string name;
  bool json = false, all = false, example = false;
};

/// What is no system and can be asked for in the same way.
struct Other {
  std::string name, kind, sentence;
  json::array parameters;
  std::span<const std::string_view> guarantees;
};

std::vector<Other> others() {
  std::vector<Other> out;
  for (const CouplingRow& c : coupling_catalogue())
    out.push_back(
        {std::string(c.type), "coupling", std::string(c.sentence), describe_params(*c.table), c.guarantees});
  json::array scene = describe_params(scene_table());
  for (const json::value& member : scene) {
    if (member.at("name") == "viewer")
      out.push_back(
          {"viewer", "document", "how viewers show the scene", member.at("parameters").as_array(), {}});
  }
  out.push_back({"scene", "document", "what a scene has beside systems and couplings", std::move(scene), {}});
  for (const CommandType& c : command_types())
    out.push_back(
        {std::string(c.name), "command", std::string(c.table->sentence), describe_params(*c.table), {}});
  return out;
}

int list(const SystemsOptions& options) {
  if (options.json) {
    std::cout << write_json(describe_systems()) << '\n';
    return kExitOk;
  }
  for (const CatalogueRow& row : catalogue()) std::cout << row.type << "\t" << row.sentence << '\n';
  std::string kind;
  for (const Other& o : others()) {
    if (kind != o.kind) std::cout << '\n' << (kind = o.kind) << "s\n";
    std::cout << o.name << "\t" << o.sentence << '\n';
  }
  return kExitOk;
}

[[noreturn]] void refuse(const std::string& name) {
  std::vector<std::string> names;
  for (const CatalogueRow& r : catalogue()) names.emplace_back(r.type);
  for (const Other& o : others()) names.push_back(o.name);
  std::string all;
  for (const std::string& n : names) all += (all.empty() ? "" : ", ") + n;
  throw Error("not_found", "there is no system, coupling or command " + name + "; there are: " + all +
                               did_you_mean(name, names));
}

void print_tail(std::string_view sentence) {
  if (!sentence.empty()) std::cout << ": " << sentence;
  std::cout << '\n';
}

/// The name without the component at its end: momentum.x, momentum.y and momentum.z are one quantity.
std::string_view without_axis(std::string_view name) {
  return name.ends_with(".x") || name.ends_with(".y") || name.ends_with(".z")
             ? name.substr(0, name.size() - 2)
             : std::string_view();
}

void print_outputs(const Outputs& out) {
  std::cout << "\nfields (of probes, recordings and streams; \"index\" of a probe is a row)\n  a row is "
            << out.rows << '\n';
  for (const FieldOutput& f : out.fields) {
    std::cout << "  " << f.name << " (" << f.unit << (f.width > 1 ? " x " + std::to_string(f.width) : "")
              << ')';
    print_tail(f.sentence);
  }
  std::cout << "\nobservables (as <id>.<name>; a scene's energy.* are sums over its systems)\n";
  const auto& rows = out.observables;
  for (size_t k = 0; k < rows.size(); ++k) {
    const auto whole = without_axis(rows[k].name);
    const bool all_axes = !whole.empty() && k + 2 < rows.size() && without_axis(rows[k + 1].name) == whole &&
                          without_axis(rows[k + 2].name) == whole;
    if (all_axes)
      std::cout << "  " << whole << ".x .y .z (" << rows[k].unit << ')';
    else
      std::cout << "  " << rows[k].name << " (" << rows[k].unit << ')';
    print_tail(rows[k].sentence);
    if (all_axes) k += 2;
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

template <class Names>
void print_guarantees(const Names& guarantees) {
  if (std::empty(guarantees)) return;
  std::cout << "\nguarantees\n";
  for (const std::string_view g : guarantees) std::cout << "  " << g << '\n';
}

void print_methods(const CatalogueRow& row, const json::array& methods, Detail detail) {
  if (methods.empty()) return;
  std::cout << "\nintegrators (default " << row.default_integrator << ")\n";
  if (detail == Detail::brief) std::cout << ' ';
  for (const json::value& m : methods) {
    if (detail == Detail::brief) {
      std::cout << ' ' << m.at("name").as_string().c_str();
      continue;
    }
    std::cout << "  " << m.at("name").as_string().c_str() << ": " << m.at("title").as_string().c_str()
              << ", order " << m.at("order").as_int64() << '\n';
  }
  if (detail == Detail::brief) std::cout << '\n';
  for (const std::string_view own : row.own_integrators)
    std::cout << "  " << own << ": of this system only\n";
}

int describe(const CatalogueRow& row, const SystemsOptions& options, Detail detail) {
  const json::object d = describe_system(row);
  if (options.json) {
    std::cout << write_json(d) << '\n';
    return kExitOk;
  }
  std::cout << row.type << ": " << row.sentence << "\n\nparameters"
            << (detail == Detail::brief ? " (--all: with those of their members, --example: a scene)" : "")
            << '\n';
  print_parameters(std::cout, d.at("parameters").as_array(), detail);
  print_methods(row, d.at("integrators").as_array(), detail);
  print_outputs(*row.outputs);
  print_settable(d.at("settable").as_array());
  print_guarantees(row.guarantees);
  return kExitOk;
}

int describe(const Other& other, const SystemsOptions& options) {
  if (options.json) {
    json::object o{{"type", other.name},
                   {"kind", other.kind},
                   {"description", other.sentence},
                   {"parameters", other.parameters}};
    std::cout << write_json(o) << '\n';
    return kExitOk;
  }
  std::cout << other.name << " (" << other.kind << "): " << other.sentence << "\n\nparameters\n";
  print_parameters(std::cout, other.parameters, options.all ? Detail::whole : Detail::brief);
  print_guarantees(other.guarantees);
  return kExitOk;
}

int systems(const SystemsOptions& options) {
  if (options.name.empty()) return list(options);
  if (options.example) {
    const std::string_view scene = example_of(options.name);
    if (!scene.empty()) {
      std::cout << scene;
      return kExitOk;
    }
  }
  const CatalogueRow* row = find_system_type(options.name);
  if (row) return describe(*row, options, options.all ? Detail::whole : Detail::brief);
  for (const Other& o : others()) {
    if (o.name != options.name && o.kind + 's' != options.name) continue;
    if (options.example)
      throw Error("not_found", "there are examples of systems and couplings; " + o.name + " is a " + o.kind);
    if (o.name == options.name) return describe(o, options);
  }
  for (const Other& o : others()) {
    if (o.kind + 's' == options.name) std::cout << o.name << "\t" << o.sentence << '\n';
  }
  if (options.name == "commands" || options.name == "couplings") return kExitOk;
  refuse(options.name);
}

}  // namespace

void add_systems_command(Arguments app, int& exit_code) {
  auto options = std::make_shared<SystemsOptions>();
  Arguments c = app.add_subcommand(
      "systems", "the kinds of systems, couplings and commands, or one kind with its parameters");
  c.add_option("type", options->name,
               "a system type, a coupling type, a command, scene, viewer, couplings or commands");
  c.add_flag("--all", options->all, "everything about members of members and methods");
  c.add_flag("--example", options->example, "the smallest scene that shows it, ready to run");
  c.add_flag("--json", options->json, "JSON on standard output");
  c.callback([options, &exit_code] { exit_code = systems(*options); });
}

}  // namespace truestep
