// Builds the table of outputs of the systems of class S: one line a field, one line an observable.
//
//   OutputsOf<Flocking>("a member")
//       .part("", [](const Flocking& f) { return points_part(f.members()); })
//       .field({"position", "m", Scalar::f64, 3, Meaning::position}, column(Columns::position), "")
//       .field({"speed", "m/s"}, length_of(Columns::velocity), "magnitude of the velocity")
//       .measured(&Flocking::motion, {{"speed.mean", "m/s", &Motion::speed, "of all members"}})
//       .build();
//
// `motion` is a pass, a const member that makes a Motion of a state and a time; it runs once for all its
// rows. A row whose value is a Vec3 stands for name.x, name.y and name.z; one whose optional is empty is left
// out.
#pragma once
#include <algorithm>
#include <array>
#include <functional>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "engine/core/outputs/output_table.h"
#include "engine/core/state/real_column.h"

namespace truestep {

/// Where the value of a row lies in what its pass measured.
template <class M>
using MeasuredValue =
    std::variant<double M::*, std::optional<double> M::*, Vec3 M::*, std::optional<Vec3> M::*,
                 double (M::*)() const, Vec3 (M::*)() const, double (*)(const M&), Vec3 (*)(const M&)>;

template <class M>
struct Measured {
  const char* name;
  const char* unit;
  MeasuredValue<M> value;
  const char* sentence = "";
};

/// Of a pass that hands out a column of numbers: the k-th of them.
template <size_t k>
inline constexpr auto entry = [](const auto& numbers) { return static_cast<double>(numbers[k]); };

/// A pass that counts the rows of a column: its row is entry<0>.
inline auto count_rows(State::Column c) {
  return [c](const System&, const State& s, double) { return std::array{s.rows(c)}; };
}

/// The rows of a column that the part shows; of the type and width of the field.
inline auto column(State::Column c) {
  return [c](const State& s, const FieldAt& at) -> const void* {
    return s.bytes(c).data() + at.rows.first * at.info.width * scalar_size(at.info.type);
  };
}
/// The same of a column whose number the system keeps, which may be optional.
template <class S, class Column>
auto column(Column S::*kept) {
  return [kept](const S& system, const State& s, const FieldAt& at) {
    if constexpr (std::is_same_v<Column, State::Column>) {
      return column(system.*kept)(s, at);
    } else {
      return column(*(system.*kept))(s, at);
    }
  };
}
/// As many rows as the column has, of a part that grows and shrinks.
inline auto present_rows(State::Column c) {
  return [c](const System&, const State& s, size_t) { return ShownRows{0, s.rows(c)}; };
}
/// One number, or as many as the field is wide, per row: fill(state, rows, out).
template <class Fill>
auto computed(Fill fill) {
  return [fill](const State& s, const FieldAt& at) -> const void* {
    at.scratch.resize(at.rows.count * at.info.width);
    fill(s, at.rows, at.scratch.data());
    return at.scratch.data();
  };
}
/// The same of a system: fill(system, state, rows, out).
template <class S, class Fill>
auto computed_by(Fill fill) {
  return [fill](const S& system, const State& s, const FieldAt& at) -> const void* {
    at.scratch.resize(at.rows.count * at.info.width);
    std::invoke(fill, system, s, at.rows, at.scratch.data());
    return at.scratch.data();
  };
}
/// The magnitude of the vectors of a column.
inline auto length_of(State::Column c) {
  return computed([c](const State& s, ShownRows rows, double* out) {
    const RealColumn<const double> v(s, c);
    for (size_t i = 0; i < rows.count; ++i) out[i] = norm(v.vector(rows.first + i));
  });
}

template <class S>
class OutputsOf {
  template <class Pass>
  using Result = std::remove_cvref_t<std::invoke_result_t<Pass, const S&, const State&, double>>;
  template <class Pass>
  static constexpr bool by_member = std::is_invocable_v<Pass, const S&, const State&, double, size_t>;
  template <class Pass, bool = by_member<Pass>>
  struct OfEach {
    using Type = std::remove_cvref_t<std::invoke_result_t<Pass, const S&, const State&, double, size_t>>;
  };
  template <class Pass>
  struct OfEach<Pass, false> {
    using Type = typename Result<Pass>::value_type;
  };
  template <class Pass>
  using ResultEach = typename OfEach<Pass>::Type;

 public:
  explicit OutputsOf(const char* rows) { table_.rows = rows; }

  /// present(system): a PartInfo without fields, an optional one, or a list of them, which "group<k>" names.
  template <class Present>
  OutputsOf& part(const char* name, Present present) {
    table_.parts.push_back({.name = name, .present = [present](const System& s) {
                              return listed(std::invoke(present, of(s)));
                            }});
    return *this;
  }
  /// Rows of the columns that the last part shows: rows(system, state, number of the part in its list).
  template <class Rows>
  OutputsOf& rows(Rows rows) {
    table_.parts.back().rows = [rows](const System& s, const State& state, size_t k) {
      return rows(of(s), state, k);
    };
    return *this;
  }
  /// The last part has the fields of the main part, of the rows that the sentence names.
  OutputsOf& like_main(const char* sentence) {
    for (OutputTable::Field f : table_.parts.front().fields) {
      if (*sentence) f.info.name.insert(0, table_.parts.back().name + '.');
      add_field(std::move(f), std::exchange(sentence, ""));
    }
    return *this;
  }

  /// get(state, FieldAt) or get(system, state, FieldAt): column(...), length_of(...), computed(...). A field
  /// of another part may be written <part>.<field>, as descriptions then list it; one without a sentence is
  /// described by the main part's field of that name.
  template <class Get>
  OutputsOf& field(FieldInfo info, Get get, const char* sentence) {
    OutputTable::Field f{.info = std::move(info)};
    f.get = [get](const System& s, const State& state, const FieldAt& at) {
      if constexpr (std::is_invocable_v<Get, const State&, const FieldAt&>) {
        return get(state, at);
      } else {
        return get(of(s), state, at);
      }
    };
    add_field(std::move(f), sentence);
    return *this;
  }
  /// The last field is there only in scenes for which this is true.
  template <class When>
  OutputsOf& field_when(When when) {
    table_.parts.back().fields.back().when = [when](const System& s) { return std::invoke(when, of(s)); };
    return *this;
  }

  /// The last field is a family: names(system, k) stand for <...> in the k-th part of its row.
  template <class Names>
  OutputsOf& field_each(Names names) {
    table_.parts.back().fields.back().family = [names](const System& s, size_t k) { return names(of(s), k); };
    return *this;
  }

  /// The type of the last field in this scene.
  template <class Type>
  OutputsOf& field_type(Type type) {
    table_.parts.back().fields.back().type = [type](const System& s) { return std::invoke(type, of(s)); };
    return *this;
  }

  /// Observables of one pass, (system.*pass)(state, t) or pass(system, state, t).
  template <class Pass>
  OutputsOf& measured(Pass pass, std::initializer_list<Measured<Result<Pass>>> rows) {
    return add_measured(pass, std::span<const Measured<Result<Pass>>>(rows.begin(), rows.size()));
  }
  /// The same rows as those of other systems.
  template <class Pass, size_t N>
  OutputsOf& measured(Pass pass, const std::array<Measured<Result<Pass>>, N>& rows) {
    return add_measured(pass, std::span<const Measured<Result<Pass>>>(rows));
  }
  /// Observables of each member of a family, whose names stand for <...>: pass(system, state, t, member), or
  /// pass(system, state, t), which makes a list of all of them.
  template <class Family, class Pass>
  OutputsOf& measured_each(Family family, Pass pass, std::initializer_list<Measured<ResultEach<Pass>>> rows) {
    return add_family(family, pass, std::span<const Measured<ResultEach<Pass>>>(rows.begin(), rows.size()));
  }
  template <class Family, class Pass, size_t N>
  OutputsOf& measured_each(Family family, Pass pass, const std::array<Measured<ResultEach<Pass>>, N>& rows) {
    return add_family(family, pass, std::span<const Measured<ResultEach<Pass>>>(rows));
  }
  /// The last pass belongs only to scenes for which this is true.
  template <class When>
  OutputsOf& when(When when) {
    table_.passes.back().when = [when](const System& s) { return std::invoke(when, of(s)); };
    return *this;
  }

  /// The last pass is costly: it runs only when one of its rows is wanted.
  OutputsOf& when_wanted() {
    table_.passes.back().runs = OutputTable::Pass::Runs::when_wanted;
    return *this;
  }

  OutputTable build() { return std::move(table_); }

 private:
  static const S& of(const System& s) { return static_cast<const S&>(s); }
  static std::vector<PartInfo> listed(std::vector<PartInfo> parts) { return parts; }
  static std::vector<PartInfo> listed(PartInfo part) { return {std::move(part)}; }
  static std::vector<PartInfo> listed(std::optional<PartInfo> part) {
    return part ? listed(std::move(*part)) : std::vector<PartInfo>();
  }

  void add_field(OutputTable::Field field, const char* sentence) {
    OutputTable::Part& part = table_.parts.back();
    std::string& name = field.info.name;
    field.sentence = sentence, field.listed = name;
    if (!part.name.empty() && name.starts_with(part.name + '.')) name.erase(0, part.name.size() + 1);
    const auto same = [&](const OutputTable::Field& f) { return f.info.name == name; };
    // Not listed where the main part's row of that name says it.
    if (field.sentence.empty() && &part != &table_.parts[0] &&
        std::ranges::any_of(table_.parts[0].fields, same))
      field.listed.clear();
    part.fields.push_back(std::move(field));
  }

  template <class Pass, class M = Result<Pass>>
  OutputsOf& add_measured(Pass pass, std::span<const Measured<M>> rows) {
    add_pass<M>(rows, [pass](const System& s, const State& state, double t, std::span<const size_t>,
                             const auto& use) { use(0, std::invoke(pass, of(s), state, t)); });
    return *this;
  }

  template <class Family, class Pass, class M = ResultEach<Pass>>
  OutputsOf& add_family(Family family, Pass pass, std::span<const Measured<M>> rows) {
    add_pass<M>(rows, [pass](const System& s, const State& state, double t, std::span<const size_t> members,
                             const auto& use) {
      if constexpr (by_member<Pass>) {
        for (const size_t k : members) use(k, std::invoke(pass, of(s), state, t, k));
      } else {
        const auto all = std::invoke(pass, of(s), state, t);
        for (const size_t k : members) use(k, all[k]);
      }
    });
    table_.passes.back().family = [family](const System& s) { return std::invoke(family, of(s)); };
    return *this;
  }

  /// Hands over one row after the other.
  struct Writer {
    size_t member, row;
    const OutputTable::Pass::Found& found;
    void operator()(double value) { found(member, row++, value); }
    void operator()(const Vec3& v) { (*this)(v.x), (*this)(v.y), (*this)(v.z); }
    void operator()(const std::optional<double>& value) { value ? (*this)(*value) : void(++row); }
    void operator()(const std::optional<Vec3>& value) { value ? (*this)(*value) : void(row += 3); }
  };
  template <class M>
  static bool is_vector(const MeasuredValue<M>& value) {
    return std::visit(
        []<class At>(At) {
          using Value = std::remove_cvref_t<std::invoke_result_t<At, const M&>>;
          return std::is_same_v<Value, Vec3> || std::is_same_v<Value, std::optional<Vec3>>;
        },
        value);
  }

  /// each(system, state, t, members, use) calls use(member, M) for each of the members.
  template <class M, class Each>
  void add_pass(std::span<const Measured<M>> rows, Each each) {
    OutputTable::Pass pass;
    std::vector<MeasuredValue<M>> values;
    for (const Measured<M>& row : rows) {
      values.push_back(row.value);
      if (!is_vector<M>(row.value)) {
        pass.rows.push_back({row.name, row.unit, row.sentence});
        continue;
      }
      for (size_t k = 0; k < 3; ++k)
        pass.rows.push_back({row.name + std::string{'.', "xyz"[k]}, row.unit, k == 0 ? row.sentence : ""});
    }
    pass.run = [each, values = std::move(values)](const System& s, const State& state, double t,
                                                  std::span<const size_t> members,
                                                  const OutputTable::Pass::Found& found) {
      each(s, state, t, members, [&](size_t member, const M& measured) {
        Writer write{member, 0, found};
        for (const MeasuredValue<M>& value : values)
          std::visit([&](auto at) { write(std::invoke(at, measured)); }, value);
      });
    };
    table_.passes.push_back(std::move(pass));
  }

  OutputTable table_;
};

}  // namespace truestep
