// The table of what a type of system gives out, the twin of its parameter table (core/def/def.h): parts with
// their fields, and observables. parts(), field(), observe(), the catalogue's description and with it GET
// /v1/systems, OpenAPI and the command line are read off its rows; outputs_of.h builds it, tabled.h is the
// system that answers from it. The functions of a row are given the system that the table was built for.
#pragma once
#include <functional>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/outputs.h"
#include "engine/core/system.h"

namespace truestep {

/// Rows of a state's columns that a part shows.
struct ShownRows {
  size_t first = 0, count = 0;
};

/// What the getter of a field is asked for.
struct FieldAt {
  const FieldInfo& info;
  ShownRows rows;
  std::vector<double>& scratch;  ///< for values that are computed
  size_t part = 0, member = 0;   ///< among the parts of its row, and in the family of the field
};

struct OutputTable {
  struct Field {
    FieldInfo info;
    std::string sentence;
    std::string listed;  ///< its name in descriptions; empty: the main part's field of this name is described
    std::function<bool(const System&)> when = {};    ///< null: in every scene
    std::function<Scalar(const System&)> type = {};  ///< null: info.type
    /// Names that stand for <...> in the k-th part of its row; null: one field.
    std::function<std::vector<std::string>(const System&, size_t k)> family = {};
    /// The first element: rows.count x info.width of them, of type info.type.
    std::function<const void*(const System&, const State&, const FieldAt&)> get = {};
  };

  struct Part {
    std::string name;  ///< empty: the main part; group<k>: a family
    /// The parts of this row in a scene, without fields; none where the scene has no such part. A name that
    /// is empty becomes that of the row.
    std::function<std::vector<PartInfo>(const System&)> present;
    /// Rows that the k-th of them shows; null: the first max_rows of the columns.
    std::function<ShownRows(const System&, const State&, size_t k)> rows = {};
    std::vector<Field> fields = {};
  };

  struct Observable {
    std::string name, unit, sentence;  ///< a member of a family is named by what stands in <...>
  };

  /// Observables that are computed together, by a pass over the state.
  struct Pass {
    /// A costly one runs only when one of its rows is wanted.
    enum class Runs : uint8_t { always, when_wanted } runs = Runs::always;
    std::vector<Observable> rows;
    std::function<bool(const System&)> when;                        ///< null: in every scene
    std::function<std::vector<std::string>(const System&)> family;  ///< null: one of each
    /// Of these members, each row that has a value in order; {0} where there is one of each.
    using Found = std::function<void(size_t member, size_t row, double value)>;
    std::function<void(const System&, const State&, double t, std::span<const size_t>, const Found&)> run;
  };

  std::string rows;  ///< what row k is
  std::vector<Part> parts;
  std::vector<Pass> passes;

  /// For people and programs; valid while the table lives.
  Outputs described() const;
  /// Of two classes of one type: what this one has, then what only the other has. Valid while both live.
  Outputs described_with(const OutputTable& other) const;
};

/// A part of that kind with at most so many rows.
PartInfo points_part(size_t max_rows);
PartInfo values_part(size_t max_rows, PartInfo::Elements elements = PartInfo::Elements::none);

/// The rows of the table that a built system has, in the order of its parts.
class ShownFields {
 public:
  /// The parts with their fields.
  std::vector<PartInfo> choose(const OutputTable& table, const System& system);
  FieldView field(const System& system, const State& state, size_t part, size_t field,
                  std::vector<double>& scratch) const;

 private:
  struct Shown {
    const OutputTable::Part* part;
    size_t member;  ///< of the parts that its row stands for
    struct Shows {
      const OutputTable::Field* row;
      size_t member;  ///< of its family
    };
    std::vector<Shows> fields;
  };
  std::vector<Shown> shown_;
};

/// The observables of the table that a built system has, by name.
class ShownObservables {
 public:
  void observe(const OutputTable& table, const System& system, const State& state, double t,
               Observables& out) const;

 private:
  struct Shown {
    const OutputTable::Pass* pass;
    std::vector<size_t> members;
    std::vector<std::string> names;  ///< of a member's rows, then of the next one's
  };
  void choose(const OutputTable& table, const System& system) const;

  mutable std::once_flag chosen_;
  mutable std::vector<Shown> shown_;  ///< chosen when first asked for: not every system is observed
};

}  // namespace truestep
