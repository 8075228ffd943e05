// Commands as users write them: rows by id, and what set_parameter and spawn take of each type of system. The
// journal holds rows only, so that replaying needs no names.
#include <algorithm>

#include "engine/core/commands/command_checks.h"
#include "engine/core/ports/ports.h"
#include "engine/scene/params/params_text.h"
#include "engine/scene/row_names.h"
#include "engine/scene/settable.h"
#include "engine/session/commands.h"
#include "engine/session/world/world.h"

namespace truestep {

namespace json = boost::json;

namespace {

using Parameter = SettableParameter;

std::string text_member(const json::object& o, std::string_view name) {
  const json::value* v = o.if_contains(name);
  return v && v->is_string() ? std::string(v->as_string().c_str()) : "";
}

// A joint with several motors takes "turn.motor_speed".
const Parameter* find_settable(std::string_view type, std::string_view name) {
  const auto all = settable_parameters(type);
  const std::string_view last = name.substr(name.rfind('.') + 1);
  const auto at = std::find_if(all.begin(), all.end(), [&](const Parameter& p) {
    return p.name == (p.of == Parameter::Of::joint ? last : name);
  });
  return at == all.end() ? nullptr : &*at;
}

size_t joint_rows(const System& system) {
  for (const PartInfo& p : system.parts()) {
    if (p.name == "joints") return p.max_rows;
  }
  return 0;
}

// The row that the scene's id stands for now.
int64_t row_of(const World& world, const WorldState& state, size_t system, Parameter::Of of,
               const std::string& id) {
  const System& owner = world.system(system);
  const RowNames names = row_names(world.scene().systems[system], joint_rows(owner));
  const bool joint = of == Parameter::Of::joint;
  const std::string noun(name_of(joint ? Parameter::Of::joint : Parameter::Of::body));
  std::vector<std::string> ids;
  std::vector<size_t> rows;
  for (const NamedRow& n : joint ? names.joints : names.bodies) {
    ids.push_back(n.id);
    if (n.id != id) continue;
    const Ports ports = owner.ports();
    if (joint || names.bodies_are == RowNames::BodiesAre::rows || !ports.bodies) {
      rows.push_back(n.row);
      continue;
    }
    const ConstBodies bodies(state.systems[system], *ports.bodies);
    for (size_t k = 0; k < bodies.count(); ++k) {
      if (bodies.form_index(k) == n.row) rows.push_back(k);
    }
  }
  if (rows.size() == 1) return static_cast<int64_t>(rows[0]);
  const bool known = std::find(ids.begin(), ids.end(), id) != ids.end();
  std::string why = "no " + noun + " of this system has this id",
              allowed = ids.empty() ? "a row" : join_names(ids);
  if (known) {
    why = rows.empty() ? "the " + noun + " of this id has been removed"
                       : "this id stands for " + std::to_string(rows.size()) + " rows";
    allowed = rows.empty() ? "the id or row of another " + noun : "a row";
  }
  throw Error("bad_command", known ? why : why + "; there are: " + allowed.substr(0, 400),
              {"/index", known ? "ambiguous" : "unknown_name", why, '"' + id.substr(0, 64) + '"', allowed,
               known ? "" : nearest_name(id, ids), ""});
}

void check_value(const json::object& command, const Parameter& p) {
  const bool number = command.contains("value"), vector = command.contains("vector");
  const std::string name(p.name);
  if (number == vector)
    refuse_command(
        p.form == Parameter::Form::vector ? "vector" : "value", number ? "contradiction" : "missing",
        number ? "give either value or vector" : name + " needs its new value",
        p.form == Parameter::Form::vector ? "three numbers in \"vector\"" : "a number in \"value\"");
  if (p.form == Parameter::Form::vector && number)
    refuse_command("value", "wrong_type", name + " is a vector", "three numbers in \"vector\"");
  if (p.form == Parameter::Form::number && vector)
    refuse_command("vector", "wrong_type", name + " is a number", "a number in \"value\"");
  const bool row = command.contains("index");
  if (p.of == Parameter::Of::system && row)
    refuse_command("index", "not_of_a_row", name + " belongs to the whole system", "absent");
  if (p.of != Parameter::Of::system && !row)
    refuse_command("index", "missing", name + " belongs to a " + std::string(name_of(p.of)),
                   "the row or id of a " + std::string(name_of(p.of)));
}

}  // namespace

Command read_command_for(const World& world, const WorldState& state, const json::value& document) {
  if (!document.is_object()) return read_command(document);
  json::object command = document.as_object();
  const std::string type = text_member(command, "type"), name = text_member(command, "name");
  std::optional<size_t> system;
  for (size_t i = 0; i < world.size() && !system; ++i) {
    if (world.id(i) == text_member(command, "system")) system = i;
  }
  Parameter::Of of = Parameter::Of::body;
  const Parameter* settable = nullptr;
  if (system && type == "set_parameter") {
    settable = find_settable(world.scene().systems[*system].row->type, name);
    if (settable) of = settable->of;
  }
  if (json::value* index = command.if_contains("index"); system && index && index->is_string())
    *index = row_of(world, state, *system, of, std::string(index->as_string().c_str()));
  Command c = read_command(command);
  if (settable) check_value(command, *settable);
  if (type == "spawn" && system && !c.name.empty()) {
    const auto has_bodies = world.scene().systems[*system].row->table->find("bodies");
    if (!has_bodies)
      refuse_command("name", "not_a_choice", "the elements of this system are all of one kind", "absent");
  }
  return c;
}

}  // namespace truestep
