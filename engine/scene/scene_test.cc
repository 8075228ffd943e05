#include "engine/scene/scene_test.h"

#include <algorithm>

#include "engine/core/def/def.h"
#include "engine/scene/json/json.h"
#include "engine/scene/json/json_write.h"
#include "engine/scene/params/params.h"
#include "engine/scene/params/params_text.h"

namespace truestep {

namespace json = boost::json;

namespace {

constexpr size_t kMostSteps = 1000, kMostCases = 1000, kMostCommands = 10000;
constexpr std::string_view kWords[] = {"precision", "sleeping", "dt", "threads", "resumed", "scratch"};

/// Members of a case that a test without cases has itself.
constexpr const char* kOfAnyCase[] = {"refused", "faults", "instability", "says", "plan"};

bool is_word(std::string_view name) {
  return std::find(std::begin(kWords), std::end(kWords), name) != std::end(kWords);
}

const DefTable& refusal_table() {
  static const DefTable t =
      TableOf<TestRefusal>("a scene or command that must be refused")
          .text("code", &TestRefusal::code, "of its faults, e.g. out_of_range; any when left out")
          .text("pointer", &TestRefusal::pointer, "JSON pointer of its faults; any when left out")
          .text("did_you_mean", &TestRefusal::did_you_mean, "what is suggested; anything when left out")
          .text("says", &TestRefusal::says, "part of its message, of the value or of what is allowed")
          .build();
  return t;
}

const DefTable& case_table() {
  static const DefTable t =
      TableOf<TestCase>("a scene to be tested for itself")
          .text("name", &TestCase::name, "name in reports")
          .object("refused", &TestCase::refused, refusal_table(),
                  "the scene must be refused, with this fault and no other")
          .objects("faults", &TestCase::faults, refusal_table(), {0, 64},
                   "the scene must be refused, with exactly these faults in any order")
          .choice("instability", &TestCase::instability, {"never", "allowed", "expected"},
                  "whether the run may or must end with an instability; what came before is then not judged")
          .text("says", &TestCase::says, "part of the sentence of the instability")
          .named_texts(
              "plan", &TestCase::plan, {0, 64},
              "stages of the plan that run, as integrate or rope.integrate, and a part of their reasons")
          .build();
  return t;
}

const DefTable& control_table() {
  static const DefTable t =
      TableOf<TestControl>("a change with which the test must fail")
          .text("why", &TestControl::why, "what it shows")
          .texts("fails", &TestControl::fails, {0, 64},
                 "quantities that are missed then, or: instability, refused, commands, plan, still, same, "
                 "agree; none: any")
          .text("case", &TestControl::of, "name of the case that is changed; the first when left out")
          .build();
  return t;
}

const DefTable& agreement_table() {
  static const DefTable t =
      TableOf<TestAgreement>("a quantity in which variations agree")
          .text("quantity", &TestAgreement::quantity, "as in `expect`; it must be one of its quantities")
          .required()
          .text("over", &TestAgreement::over, "name in `vary`: runs are compared that differ only in it")
          .required()
          .number(
              "order", &TestAgreement::order, "1", any(),
              "the quantity grows as this power of the numbers in `over`, from each to the next; absent: it "
              "is the same")
          .number("tolerance", &TestAgreement::tolerance, "", at_least(0),
                  "allowed difference of the largest and the least, in the quantity's unit, or of the order")
          .build();
  return t;
}

const DefTable& test_table() {
  static const DefTable t =
      TableOf<SceneTest>("how `truestep check` tests the scene; everything else ignores it")
          .text("why", &SceneTest::why, "what the test protects, in a sentence")
          .texts("same", &SceneTest::same, {0, 32},
                 "names in `vary` that change no bit of any state (threads, resumed and scratch never do)")
          .objects("agree", &SceneTest::agree, agreement_table(), {0, 64}, "quantities that variations share")
          .number("still", &SceneTest::still, "m", at_least(0),
                  "most that a sleeping row of the first system may move within 0.4 s of being woken")
          .build();
  return t;
}

class TestReader {
 public:
  TestReader(std::vector<Issue>& issues) : issues_(issues) {}

  SceneTest read(const json::object& o, const std::string& where) {
    SceneTest t;
    TestCase base;
    constexpr std::string_view kOwn[] = {"vary",   "cases",       "control", "commands", "refused",
                                         "faults", "instability", "says",    "plan"};
    read_params(test_table(), &t, o, where, kOwn, issues_);
    json::object ending;
    for (const char* key : kOfAnyCase) {
      if (const json::value* v = o.if_contains(key)) ending[key] = *v;
    }
    read_params(case_table(), &base, ending, where, {}, issues_);
    if (const json::object* vary = object(o, "vary", where)) {
      for (const auto& [name, values] : *vary) axis(std::string(name), values, where + "/vary/", t);
    }
    each(o, "cases", where, kMostCases, [&](const json::object& c, const std::string& at) {
      t.cases.push_back(base);
      constexpr std::string_view kOfCase[] = {"set", "expect"};
      read_params(case_table(), &t.cases.back(), c, at, kOfCase, issues_);
      t.cases.back().changes = changes(c, at);
      if (const json::value* e = c.if_contains("expect")) t.cases.back().expect = *e;
    });
    if (t.cases.empty()) t.cases.push_back(base);
    each(o, "control", where, kMostCases, [&](const json::object& c, const std::string& at) {
      TestControl& control = t.controls.emplace_back();
      constexpr std::string_view kOfControl[] = {"set"};
      read_params(control_table(), &control, c, at, kOfControl, issues_);
      control.changes = changes(c, at);
      const auto named = [&](const TestCase& k) { return k.name == control.of; };
      if (!control.of.empty() && std::none_of(t.cases.begin(), t.cases.end(), named))
        fault(at + "/case", "unknown_case", "no case has this name", control.of);
    });
    each(o, "commands", where, kMostCommands, [&](const json::object& c, const std::string& at) {
      read_test_command(c, at, issues_);
      t.commands.push_back(c);
    });
    for (size_t i = 0; i < t.same.size(); ++i)
      require_axis(t, t.same[i], where + "/same/" + std::to_string(i));
    for (size_t i = 0; i < t.agree.size(); ++i)
      require_axis(t, t.agree[i].over, where + "/agree/" + std::to_string(i) + "/over");
    return t;
  }

 private:
  void fault(const std::string& where, const char* code, const char* what, const std::string& value) {
    issues_.push_back({where, code, what, value, "", "", ""});
  }

  const json::object* object(const json::object& o, const char* key, const std::string& where) {
    const json::value* v = o.if_contains(key);
    if (v && !v->is_object())
      fault(where + '/' + key, "wrong_type", "expected an object of changes", shorten(*v));
    return v ? v->if_object() : nullptr;
  }

  /// Calls `f` for each object of the array `key`.
  template <class F>
  void each(const json::object& o, const char* key, const std::string& where, size_t most, F f) {
    const json::value* v = o.if_contains(key);
    if (!v) return;
    const std::string at = where + '/' + key;
    if (!v->is_array() || v->as_array().size() > most) {
      fault(at, "wrong_type", "expected an array of objects", shorten(*v));
      return;
    }
    for (size_t i = 0; i < v->as_array().size(); ++i) {
      const std::string element = at + '/' + std::to_string(i);
      if (const json::object* one = v->as_array()[i].if_object()) {
        f(*one, element);
      } else {
        fault(element, "wrong_type", "expected an object", shorten(v->as_array()[i]));
      }
    }
  }

  SceneChange change(const std::string& name, const json::value& value, const std::string& where) {
    if (!name.starts_with('/') && !is_word(name))
      fault(where, "bad_pointer",
            "expected a JSON pointer, precision, sleeping, dt, threads, resumed or scratch", name);
    return {name, value};
  }

  std::vector<SceneChange> changes(const json::object& o, const std::string& where) {
    std::vector<SceneChange> out;
    if (const json::object* set = object(o, "set", where)) {
      for (const auto& [name, value] : *set)
        out.push_back(change(std::string(name), value, where + "/set/" + pointer_token(name)));
    }
    return out;
  }

  void axis(const std::string& name, const json::value& values, const std::string& where, SceneTest& t) {
    const std::string at = where + pointer_token(name);
    if (!values.is_array() || values.as_array().empty() || values.as_array().size() > kMostSteps) {
      fault(at, "wrong_type", "expected a list of values", shorten(values));
      return;
    }
    TestAxis& a = t.vary.emplace_back(TestAxis{name, {}});
    for (size_t i = 0; i < values.as_array().size(); ++i) {
      const json::value& v = values.as_array()[i];
      TestAxis::Step& step = a.steps.emplace_back();
      step.value = v;
      if (name.starts_with('/') || is_word(name)) {
        step.label = name + " = " + shorten(v);
        step.changes = {change(name, v, at)};
      } else if (const json::object* o = v.if_object()) {
        step.label = name + ' ' + std::to_string(i);
        for (const auto& [inner, value] : *o)
          step.changes.push_back(change(std::string(inner), value, at + '/' + std::to_string(i)));
      } else {
        fault(at + '/' + std::to_string(i), "wrong_type",
              "a name that is no pointer stands for objects of changes", shorten(v));
      }
    }
  }

  void require_axis(const SceneTest& t, const std::string& name, const std::string& where) {
    if (std::none_of(t.vary.begin(), t.vary.end(), [&](const TestAxis& a) { return a.name == name; }))
      fault(where, "unknown_name", "no such name in `vary`", name);
  }

  std::vector<Issue>& issues_;
};

/// Adds members that hold a test's changes, by their sentence.
json::object with(const DefTable& table,
                  std::initializer_list<std::pair<const char*, json::object>> members) {
  json::object schema = schema_of(table);
  for (const auto& [name, member] : members) schema["properties"].as_object()[name] = member;
  return schema;
}

}  // namespace

SceneTest read_scene_test(const json::value& v, const std::string& pointer, std::vector<Issue>& issues) {
  if (const json::object* o = v.if_object()) return TestReader(issues).read(*o, pointer);
  issues.push_back({pointer, "wrong_type", "a test must be an object", shorten(v), "an object", "", ""});
  SceneTest none;
  none.cases.emplace_back();
  return none;
}

TestCommand read_test_command(const json::value& v, const std::string& pointer, std::vector<Issue>& issues) {
  TestCommand out;
  out.command = v.is_object() ? v.as_object() : json::object();
  const json::value* when = out.command.if_contains("at_time");
  if (when && when->is_number()) {
    out.at_time = when->to_number<double>();
  } else {
    issues.push_back({pointer + "/at_time", "missing", "the time of the command, in s", "", "", "", "s"});
  }
  if (const json::value* refused = out.command.if_contains("refused")) {
    out.refused.emplace();
    const json::object members = refused->is_object() ? refused->as_object() : json::object();
    read_params(refusal_table(), &*out.refused, members, pointer + "/refused", {}, issues);
  }
  out.command.erase("at_time");
  out.command.erase("refused");
  return out;
}

json::object scene_test_schema() {
  const json::object set{{"type", "object"},
                         {"description",
                          "changes: a JSON pointer (* stands for every element of an array) and the value "
                          "put there, null to remove it; or precision, sleeping, dt, threads, resumed, "
                          "scratch"}};
  const json::object ending = schema_of(case_table()).at("properties").as_object();
  const json::object vary{
      {"type", "object"},
      {"additionalProperties", json::object{{"type", "array"}, {"minItems", 1}}},
      {"description",
       "lists of values, of which every combination is run: by JSON pointer, by precision, sleeping, dt, "
       "threads, resumed or scratch, or by any word for values that are objects of changes"}};
  const auto list = [](json::object items, const char* sentence) {
    return json::object{{"type", "array"}, {"description", sentence}, {"items", std::move(items)}};
  };
  const json::object expect{{"type", "array"}, {"description", "replaces the scene's `expect`"}};
  const json::object at_time{{"type", "object"},
                             {"required", json::array{"at_time"}},
                             {"properties", json::object{{"refused", schema_of(refusal_table())}}}};
  json::object schema =
      with(test_table(),
           {{"vary", vary},
            {"cases", list(with(case_table(), {{"set", set}, {"expect", expect}}),
                           "scenes to be tested instead of the scene itself")},
            {"control", list(with(control_table(), {{"set", set}}), "changes with which the test must fail")},
            {"commands",
             list(at_time,
                  "commands as of a session, each before the step at its `at_time`; `refused`: it must "
                  "be, for this fault")}});
  for (const char* key : kOfAnyCase) schema["properties"].as_object()[key] = ending.at(key);
  return schema;
}

}  // namespace truestep
