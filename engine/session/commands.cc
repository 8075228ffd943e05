#include "engine/session/commands.h"

#include "engine/scene/params/params.h"

namespace truestep {

namespace json = boost::json;

namespace {

using C = Command;
constexpr Limits kIndex{-1, 9e15};

// All tables describe the same struct; a command type exposes the members that it uses.
DefTable push_table() {
  return TableOf<C>("a force for some time")
      .text("system", &C::system, "id of the system")
      .required()
      .integer("index", &C::index, at_least(0), "row")
      .required()
      .vector("force", &C::vector, "N", any(), "force")
      .required()
      .vector("at", &C::at, "m", any(), "point of application on a body; its centre of mass if absent")
      .number("duration", &C::duration, "s", between(0, 1e6), "duration; 0: one step")
      .build();
}
DefTable impulse_table() {
  return TableOf<C>("an instantaneous change of momentum")
      .text("system", &C::system, "id of the system")
      .required()
      .integer("index", &C::index, at_least(0), "row")
      .required()
      .vector("impulse", &C::vector, "N s", any(), "impulse")
      .required()
      .vector("at", &C::at, "m", any(), "point of application on a body; its centre of mass if absent")
      .build();
}
DefTable drag_table() {
  return TableOf<C>("a spring from a row to a point in space, until it is released")
      .text("system", &C::system, "id of the system")
      .required()
      .integer("index", &C::index, at_least(0), "row")
      .required()
      .vector("target", &C::vector, "m", any(), "fixed end of the spring")
      .required()
      .vector("at", &C::at, "m", any(), "point of application on a body; its centre of mass if absent")
      .number("stiffness", &C::value, "N/m", at_least(0), "of the spring; 0: chosen by the system")
      .build();
}
DefTable release_table() {
  return TableOf<C>("ends the drag of a row, or of all rows")
      .text("system", &C::system, "id of the system")
      .required()
      .integer("index", &C::index, kIndex, "row; -1: all")
      .build();
}
DefTable pin_table() {
  return TableOf<C>("fixes a row at its position, or releases it")
      .text("system", &C::system, "id of the system")
      .required()
      .integer("index", &C::index, at_least(0), "row")
      .required()
      .build();
}
DefTable parameter_table() {
  return TableOf<C>("changes a parameter while the session runs")
      .text("system", &C::system, "id of the system")
      .required()
      .text("name", &C::name, "the parameter")
      .required()
      .integer("index", &C::index, kIndex, "row, of parameters that belong to a body or joint")
      .number("value", &C::value, "", any(), "new value in SI")
      .vector("vector", &C::vector, "", any(), "new value of a vector parameter in SI")
      .build();
}
DefTable spawn_table() {
  return TableOf<C>("a new element")
      .text("system", &C::system, "id of the system")
      .required()
      .vector("position", &C::vector, "m", any(), "where")
      .required()
      .vector("velocity", &C::velocity, "m/s", any(), "how fast")
      .text("name", &C::name, "id of the entry of bodies to repeat; absent: the last dynamic one")
      .build();
}
DefTable remove_table() {
  return TableOf<C>("removes an element")
      .text("system", &C::system, "id of the system")
      .required()
      .integer("index", &C::index, at_least(0), "row")
      .required()
      .build();
}

}  // namespace

std::span<const CommandType> command_types() {
  static const DefTable kPush = push_table(), kImpulse = impulse_table(), kDrag = drag_table(),
                        kRelease = release_table(), kPin = pin_table(), kParameter = parameter_table(),
                        kSpawn = spawn_table(), kRemove = remove_table();
  static const CommandType kTypes[] = {
      {"push", CommandKind::push, &kPush},
      {"impulse", CommandKind::impulse, &kImpulse},
      {"drag", CommandKind::drag, &kDrag},
      {"release", CommandKind::release, &kRelease},
      {"pin", CommandKind::pin, &kPin},
      {"unpin", CommandKind::unpin, &kPin},
      {"set_parameter", CommandKind::set_parameter, &kParameter},
      {"spawn", CommandKind::spawn, &kSpawn},
      {"remove", CommandKind::remove, &kRemove},
  };
  return kTypes;
}

std::string written_name(CommandKind kind, std::string_view member) {
  using K = CommandKind;
  struct Word {
    CommandKind kind;
    std::string_view member, written;
  };
  static constexpr Word kWords[] = {{K::push, "vector", "force"},
                                    {K::impulse, "vector", "impulse"},
                                    {K::drag, "vector", "target"},
                                    {K::drag, "value", "stiffness"},
                                    {K::spawn, "vector", "position"}};
  for (const Word& w : kWords) {
    if (w.kind == kind && w.member == member) return std::string(w.written);
  }
  return std::string(member);
}

Error as_written(const Error& refused, CommandKind kind) {
  std::vector<Issue> issues = refused.issues();
  for (Issue& i : issues) {
    if (i.pointer.starts_with('/'))
      i.pointer.replace(1, std::string::npos, written_name(kind, i.pointer.substr(1)));
  }
  return {refused.code(), refused.what(), std::move(issues)};
}

Command read_command(const json::value& document) {
  std::vector<Issue> issues;
  std::vector<std::string> names;
  for (const CommandType& t : command_types()) names.emplace_back(t.name);
  std::string all;
  for (const std::string& n : names) all += (all.empty() ? "" : ", ") + n;
  if (!document.is_object()) {
    throw Error("bad_command", "a command must be an object",
                {"", "wrong_type", "a command must be an object", shorten(document), "an object", "", ""});
  }
  const json::value* type = document.as_object().if_contains("type");
  const std::string name = type && type->is_string() ? std::string(type->as_string().c_str()) : "";
  for (const CommandType& t : command_types()) {
    if (t.name != name) continue;
    Command command;
    constexpr std::string_view kOwn[] = {"type"};
    read_params(*t.table, &command, document.as_object(), "", kOwn, issues);
    if (!issues.empty()) throw Error("bad_command", "the command has faults", std::move(issues));
    command.kind = t.kind;
    return command;
  }
  throw Error("bad_command", "no command has this type",
              {"/type", type ? "unknown_choice" : "missing", "no command has this type",
               type ? shorten(*type) : "", all, nearest_name(name, names), ""});
}

json::object write_command(const Command& command) {
  for (const CommandType& t : command_types()) {
    if (t.kind != command.kind) continue;
    json::object o{{"type", t.name}};
    for (auto& [key, value] : write_params(*t.table, &command)) o[key] = std::move(value);
    return o;
  }
  return {};
}

}  // namespace truestep
