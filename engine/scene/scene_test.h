// How a scene is tested: its key "test", which `truestep check` reads and everything else ignores.
//   "test": {
//     "why": "a light ball between heavy ones is not pushed through the floor",
//     "vary": {"precision": ["f32", "f64"], "/systems/0/bodies/1/restitution": [0, 0.5, 1],
//              "drop": [{"/systems/0/bodies/2/position": [0, 2, 0]}, {...}]},
//     "control": [{"set": {"/systems/0/bodies/0/mask": 0}, "fails": ["min(light.position.y)"]}]
//   }
// `vary` is a cartesian product: each combination must meet the scene's `expect`. A change puts a value at a
// JSON pointer, in which * stands for every element of an array; null removes what is there. A name of `vary`
// is such a pointer; or precision or sleeping (of every system that has it), dt, threads, resumed (the run is
// saved halfway and continued by another session); or any word for values that are objects of changes. Runs
// that differ only in threads or resumed must end with the same bits, those that differ in a name of `same`,
// too.
#pragma once
#include <boost/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/errors.h"
#include "engine/core/def/def.h"

namespace truestep {

/// A value at a JSON pointer, or of a word: precision, sleeping, dt.
struct SceneChange {
  std::string where;
  boost::json::value value;
};

/// One entry of `vary`.
struct TestAxis {
  struct Step {
    std::string label;  ///< "dt = 0.01"
    std::vector<SceneChange> changes;
    boost::json::value value;
  };
  std::string name;
  std::vector<Step> steps;
};

/// What becomes of the run.
enum class TestEnding : uint8_t { runs, may_fail, fails };

/// A fault that is to be found: its code, pointer and suggestion, and what its texts contain (empty: any).
struct TestRefusal {
  std::string code, pointer, did_you_mean, says;
};

/// A command as of a session. It may have to be refused.
struct TestCommand {
  double at_time = 0;  ///< s
  boost::json::object command;
  std::optional<TestRefusal> refused;
};

/// A scene to be run for itself, beside others of the same file; `expect` replaces that of the scene.
struct TestCase {
  std::string name;
  std::vector<SceneChange> changes;
  std::optional<boost::json::value> expect;
  std::optional<TestRefusal> refused;  ///< all faults are this one
  std::vector<TestRefusal> faults;     ///< or exactly these
  TestEnding instability = TestEnding::runs;
  std::string says;             ///< what the sentence of the instability contains
  std::string warns;            ///< what a warning contains, of the scene or of the run; empty: any or none
  std::vector<NamedText> plan;  ///< "integrate" or "rope.integrate", and what its reason contains
  bool is_refused() const { return refused || !faults.empty(); }
};

/// A change after which the named quantities are missed; none named: anything.
struct TestControl {
  std::string why;
  std::vector<SceneChange> changes;
  std::vector<std::string> fails;
  std::string of;  ///< the case that it changes; empty: the first
};

/// A quantity that runs share which differ only in `over`, or that grows as a power of it.
struct TestAgreement {
  std::string quantity, over;
  std::optional<double> order;  ///< of the power; empty: they share it
  double tolerance = 0;         ///< largest minus least, in the quantity's unit; or of the order
};

struct SceneTest {
  std::string why;
  std::vector<TestAxis> vary;
  std::vector<std::string> same;
  std::vector<TestAgreement> agree;
  std::vector<TestCase> cases;  ///< at least one
  std::vector<TestControl> controls;
  boost::json::array commands;  ///< changes reach them at /test/commands
  /// m that a sleeping row may move within 0.4 s of being woken; empty: not looked at.
  std::optional<double> still;
};

/// Reads the value of "test". Faults go to `issues`, with pointers below `pointer`.
SceneTest read_scene_test(const boost::json::value& v, const std::string& pointer,
                          std::vector<Issue>& issues);

/// An entry of `commands`.
TestCommand read_test_command(const boost::json::value& v, const std::string& pointer,
                              std::vector<Issue>& issues);

boost::json::object scene_test_schema();

}  // namespace truestep
