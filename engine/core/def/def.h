// Parameter tables. A system's parameters are one plain struct and one table of rows: name, member, unit,
// bounds, sentence. The parser, the JSON Schema, the OpenAPI fragment, the recording's attributes and the
// printed help are all read off that table; defaults are the struct's own member initialisers.
//
//   struct Def { double stiffness = 1000; Vec3 wind; };
//   const DefTable& table() {
//     static const DefTable t = TableOf<Def>("one sentence")
//       .number("stiffness", &Def::stiffness, "N/m", at_least(0), "spring constant of every link")
//       .vector("wind", &Def::wind, "m/s", any(), "velocity of the air").build();
//     return t;
//   }
#pragma once
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "engine/math/vec3.h"

namespace truestep {

enum class ParamKind : uint8_t {
  number,
  integer,
  boolean,
  text,
  expression,  // text that may also be given as a number
  choice,
  vector,  // one value
  numbers,
  integers,
  vectors,
  texts,     // arrays of values
  object,    // a nested struct
  objects,   // an array of nested structs
  variants,  // an array of objects distinguished by their "type"
  named_numbers,
  named_texts,  // objects whose keys are the user's own names
};

/// Most elements of one entry of a named_numbers parameter.
inline constexpr size_t kMaxNamedNumbers = 100'000;

/// One entry of a `named_numbers` parameter: "x": 1 or "x": [1, 2, 3].
struct NamedNumbers {
  std::string name;
  std::vector<double> values;
  enum class Form : uint8_t { number, array } form = Form::number;
};
/// One entry of a `named_texts` parameter: "x": "-k * x"; a number stands for its text.
struct NamedText {
  std::string name, text;
};

/// Allowed range of a number, or of every element of a vector or array.
struct Limits {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  enum class Ends : uint8_t { closed, open_min, open_max, open } ends = Ends::closed;
};
constexpr Limits any() {
  return {};
}
constexpr Limits at_least(double min) {
  return {.min = min};
}
constexpr Limits above(double min) {
  return {.min = min, .ends = Limits::Ends::open_min};
}
constexpr Limits between(double min, double max) {
  return {.min = min, .max = max};
}

/// Number of elements of an array parameter.
struct Count {
  size_t min = 0;
  size_t max = 10'000'000;
};

using ParamValue = std::variant<std::monostate, double, int64_t, bool, std::string, Vec3, std::vector<double>,
                                std::vector<int64_t>, std::vector<Vec3>, std::vector<std::string>,
                                std::vector<NamedNumbers>, std::vector<NamedText>>;

struct DefTable;

/// One alternative of a `variants` parameter.
struct ParamVariant {
  std::string type;
  std::vector<std::string> also;  ///< synonyms, which are read but never written
  const DefTable* table = nullptr;
  std::function<void*(void* owner)> append;                    ///< new element's struct
  std::function<const void*(const void* owner, size_t i)> at;  ///< null when element i is another type
};

/// A "type" with its synonyms after bars, "revolute|hinge|pin", and the table of its struct.
struct NamedTable {
  const char* words;
  const DefTable* table;
};

/// Splits "revolute|hinge|pin" into "revolute" and {"hinge", "pin"}.
std::string first_word(const std::string& words);
std::vector<std::string> other_words(const std::string& words);

enum class Presence : uint8_t { optional, required };

struct ParamRow {
  std::string name;
  ParamKind kind = ParamKind::number;
  std::string unit;  ///< SI; empty where a unit makes no sense, "1" for a pure number
  Limits limits;
  Count count;
  std::string sentence;
  Presence presence = Presence::optional;
  std::vector<std::string> also;  ///< synonyms, which are read but never written
  std::vector<std::string> choices;
  const DefTable* nested = nullptr;
  std::vector<ParamVariant> variants;

  /// Plain values: monostate from `get` means "not set" (std::optional members).
  std::function<void(void* owner, ParamValue)> set;
  std::function<ParamValue(const void* owner)> get;
  /// Nested values: `append` returns the struct to fill (creating it for optional members and arrays).
  std::function<void*(void* owner)> append;
  std::function<size_t(const void* owner)> size;
  std::function<const void*(const void* owner, size_t i)> at;
};

struct DefTable {
  std::string sentence;
  std::vector<ParamRow> rows;
  std::function<std::shared_ptr<void>()> make;  ///< a struct with all defaults
  /// Extra checks across members, reported like the parser's own: (owner, report(pointer suffix, message)).
  using Report = std::function<void(const std::string& pointer, const std::string& message)>;
  std::function<void(const void* owner, const Report& report)> check;

  const ParamRow* find(std::string_view name) const;
};

/// How members of one type are written and read, wherever their struct lies: compiled once per type, not once
/// per table.
struct ValueAccess {
  void (*set)(void* member, ParamValue v);
  ParamValue (*get)(const void* member);
};
/// Access to a member of type M (or std::optional<M>) by values of type V.
template <class V, class M>
struct PlainMember {
  static void set(void* member, ParamValue v) {
    *static_cast<M*>(member) = static_cast<M>(std::get<V>(std::move(v)));
  }
  static ParamValue get(const void* member) {
    return ParamValue(static_cast<V>(*static_cast<const M*>(member)));
  }
};
template <class V, class M>
struct PlainMember<V, std::optional<M>> {
  static void set(void* member, ParamValue v) {
    *static_cast<std::optional<M>*>(member) = static_cast<M>(std::get<V>(std::move(v)));
  }
  static ParamValue get(const void* member) {
    const auto& m = *static_cast<const std::optional<M>*>(member);
    return m ? ParamValue(static_cast<V>(*m)) : ParamValue();
  }
};

struct ChoiceAccess {
  void (*set)(void* member, size_t i);
  size_t (*get)(const void* member);
};
struct VariantAccess {
  void* (*append)(void* member);
  const void* (*at)(const void* member, size_t i);
};
struct NestedAccess {
  void* (*append)(void* member);
  size_t (*size)(const void* member);
  const void* (*at)(const void* member, size_t i);
};

/// Adds rows to a table; the part that does not depend on the struct's type. `offset` is the member's offset
/// in its struct.
class TableBuilder {
 protected:
  TableBuilder(const char* sentence, void* (*make)(), void (*end)(void* owner));
  struct Words {
    const char *name, *unit, *sentence;
  };
  ParamRow& row(ParamKind kind, const Words& words, Limits limits);
  ParamRow& value(ParamKind kind, const Words& words, size_t offset, ValueAccess access, Limits limits);
  void choice(const Words& words, size_t offset, ChoiceAccess access,
              std::initializer_list<const char*> choices);
  void choice(const Words& words, size_t offset, ChoiceAccess access,
              const std::vector<std::string>& choices);
  ParamRow& nested(ParamKind kind, const Words& words, size_t offset, NestedAccess access,
                   const DefTable* nested);
  void variants(const Words& words, size_t offset, size_t (*size)(const void* member), Count count);
  void variant(const NamedTable& named, size_t offset, VariantAccess access);
  void append(const DefTable& base, size_t offset);
  void set_required();
  void add_synonym(const char* word);

  DefTable table_;
};

/// Builds the table of struct D; see the head of this file.
template <class D>
class TableOf : TableBuilder {
 public:
  explicit TableOf(const char* sentence)
      : TableBuilder(
            sentence, [] { return static_cast<void*>(new D()); },
            [](void* owner) { delete static_cast<D*>(owner); }) {}

  template <class M>  // double or std::optional<double>
  TableOf& number(const char* name, M D::*m, const char* unit, Limits limits, const char* sentence) {
    return plain<double>(ParamKind::number, {name, unit, sentence}, m, limits);
  }
  template <class M>  // any integer type, or std::optional of one
  TableOf& integer(const char* name, M D::*m, Limits limits, const char* sentence) {
    return plain<int64_t>(ParamKind::integer, {name, "1", sentence}, m, limits);
  }
  template <class M>
  TableOf& boolean(const char* name, M D::*m, const char* sentence) {
    return plain<bool>(ParamKind::boolean, {name, "", sentence}, m, any());
  }
  template <class M>
  TableOf& text(const char* name, M D::*m, const char* sentence) {
    return plain<std::string>(ParamKind::text, {name, "", sentence}, m, any());
  }
  template <class M>
  TableOf& expression(const char* name, M D::*m, const char* sentence) {
    return plain<std::string>(ParamKind::expression, {name, "", sentence}, m, any());
  }
  template <class M>
  TableOf& vector(const char* name, M D::*m, const char* unit, Limits limits, const char* sentence) {
    return plain<Vec3>(ParamKind::vector, {name, unit, sentence}, m, limits);
  }
  TableOf& numbers(const char* name, std::vector<double> D::*m, const char* unit, Limits limits, Count count,
                   const char* sentence) {
    return array(ParamKind::numbers, {name, unit, sentence}, m, limits, count);
  }
  TableOf& integers(const char* name, std::vector<int64_t> D::*m, Limits limits, Count count,
                    const char* sentence) {
    return array(ParamKind::integers, {name, "1", sentence}, m, limits, count);
  }
  TableOf& vectors(const char* name, std::vector<Vec3> D::*m, const char* unit, Limits limits, Count count,
                   const char* sentence) {
    return array(ParamKind::vectors, {name, unit, sentence}, m, limits, count);
  }
  TableOf& texts(const char* name, std::vector<std::string> D::*m, Count count, const char* sentence) {
    return array(ParamKind::texts, {name, "", sentence}, m, any(), count);
  }
  /// An object with user-chosen names and numbers or arrays of at most `count.max` numbers, in order.
  TableOf& named_numbers(const char* name, std::vector<NamedNumbers> D::*m, Limits limits, Count count,
                         const char* sentence) {
    return array(ParamKind::named_numbers, {name, "", sentence}, m, limits, count);
  }
  /// An object with user-chosen names and texts, in order.
  TableOf& named_texts(const char* name, std::vector<NamedText> D::*m, Count count, const char* sentence) {
    return array(ParamKind::named_texts, {name, "", sentence}, m, any(), count);
  }
  /// Enumeration E whose values 0, 1, 2 ... have the names in `choices`, in that order.
  template <class E>
  TableOf& choice(const char* name, E D::*m, std::initializer_list<const char*> choices,
                  const char* sentence) {
    TableBuilder::choice({name, "", sentence}, offset(m), access_choice<E>(), choices);
    return *this;
  }
  template <class E>
  TableOf& choice(const char* name, E D::*m, const std::vector<std::string>& choices, const char* sentence) {
    TableBuilder::choice({name, "", sentence}, offset(m), access_choice<E>(), choices);
    return *this;
  }
  /// A nested struct that is always present.
  template <class N>
  TableOf& object(const char* name, N D::*m, const DefTable& table, const char* sentence) {
    static constexpr NestedAccess access = {[](void* member) { return member; },
                                            [](const void*) -> size_t { return 1; },
                                            [](const void* member, size_t) { return member; }};
    nested(ParamKind::object, {name, "", sentence}, offset(m), access, &table);
    return *this;
  }
  /// A nested struct that may be absent.
  template <class N>
  TableOf& object(const char* name, std::optional<N> D::*m, const DefTable& table, const char* sentence) {
    using Member = std::optional<N>;
    static constexpr NestedAccess access = {
        [](void* member) -> void* { return &static_cast<Member*>(member)->emplace(); },
        [](const void* member) -> size_t { return static_cast<const Member*>(member)->has_value(); },
        [](const void* member, size_t) -> const void* { return &**static_cast<const Member*>(member); }};
    nested(ParamKind::object, {name, "", sentence}, offset(m), access, &table);
    return *this;
  }
  /// An array of one kind of struct.
  template <class N>
  TableOf& objects(const char* name, std::vector<N> D::*m, const DefTable& table, Count count,
                   const char* sentence) {
    using Member = std::vector<N>;
    static constexpr NestedAccess access = {
        [](void* member) -> void* { return &static_cast<Member*>(member)->emplace_back(); },
        [](const void* member) { return static_cast<const Member*>(member)->size(); },
        [](const void* member, size_t i) -> const void* {
          return &(*static_cast<const Member*>(member))[i];
        }};
    nested(ParamKind::objects, {name, "", sentence}, offset(m), access, &table).count = count;
    return *this;
  }
  /// An array of structs distinguished by "type"; types and tables in the order of the std::variant. Synonyms
  /// of a type follow it after bars: "revolute|hinge|pin".
  template <class... N>
  TableOf& variants(const char* name, std::vector<std::variant<N...>> D::*m,
                    const std::vector<NamedTable>& alternatives, Count count, const char* sentence) {
    using Member = std::vector<std::variant<N...>>;
    TableBuilder::variants(
        {name, "", sentence}, offset(m),
        [](const void* member) { return static_cast<const Member*>(member)->size(); }, count);
    add_variants<Member>(offset(m), alternatives, std::index_sequence_for<N...>{});
    return *this;
  }

  /// Adds the rows of `Base`, which D begins with: compiled once for all structs that share them.
  template <class Base>
  requires std::is_base_of_v<Base, D> TableOf& base(const DefTable& rows) {
    alignas(D) static const char room[sizeof(D)] = {};
    const Base* at = reinterpret_cast<const D*>(room);
    append(rows, static_cast<size_t>(reinterpret_cast<const char*>(at) - room));
    return *this;
  }

  /// Makes the last row mandatory.
  TableOf& required() {
    set_required();
    return *this;
  }
  /// A synonym for the last parameter: accepted, and echoed under the parameter's name.
  TableOf& also(const char* word) {
    add_synonym(word);
    return *this;
  }
  /// A check across members.
  template <class F>
  TableOf& check(F f) {
    table_.check = [f](const void* o, const DefTable::Report& report) {
      f(*static_cast<const D*>(o), report);
    };
    return *this;
  }
  DefTable build() { return std::move(table_); }

 private:
  /// Byte offset of the member in the struct. No D is constructed: only addresses are used.
  template <class M>
  static size_t offset(M D::*m) {
    alignas(D) static const char room[sizeof(D)] = {};
    return static_cast<size_t>(reinterpret_cast<const char*>(&(reinterpret_cast<const D*>(room)->*m)) - room);
  }
  template <class V, class M>
  TableOf& plain(ParamKind kind, const Words& words, M D::*m, Limits limits) {
    value(kind, words, offset(m), {&PlainMember<V, M>::set, &PlainMember<V, M>::get}, limits);
    return *this;
  }
  template <class V>
  TableOf& array(ParamKind kind, const Words& words, std::vector<V> D::*m, Limits limits, Count count) {
    value(kind, words, offset(m),
          {&PlainMember<std::vector<V>, std::vector<V>>::set,
           &PlainMember<std::vector<V>, std::vector<V>>::get},
          limits)
        .count = count;
    return *this;
  }
  template <class E>
  static constexpr ChoiceAccess access_choice() {
    return {[](void* member, size_t i) { *static_cast<E*>(member) = static_cast<E>(i); },
            [](const void* member) { return static_cast<size_t>(*static_cast<const E*>(member)); }};
  }
  template <class Member, size_t... I>
  void add_variants(size_t offset, const std::vector<NamedTable>& names, std::index_sequence<I...>) {
    (variant(names[I], offset,
             {[](void* member) -> void* {
                // Not by in_place_index: the vector's growth is compiled once, not for each alternative.
                return &static_cast<Member*>(member)->emplace_back().template emplace<I>();
              },
              [](const void* member, size_t i) -> const void* {
                return std::get_if<I>(&(*static_cast<const Member*>(member))[i]);
              }}),
     ...);
  }
};

}  // namespace truestep
