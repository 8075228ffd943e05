// A table of outputs says once what a system gives out: types that the scene decides, columns that only some
// scenes have, families measured at once, rows that are left out, passes that only those who ask pay for, and
// two tables described as one.
#include <gtest/gtest.h>

#include "engine/core/outputs/outputs_of.h"
#include "engine/core/outputs/tabled.h"

namespace truestep {
namespace {

struct Setting {
  Scalar real = Scalar::f64;
  bool marked = false;
  std::vector<std::string> doors;
};

class Toy final : public Tabled<Toy, System> {
 public:
  explicit Toy(Setting setting) : setting_(std::move(setting)) {
    start_.add({"position", "m", setting_.real, 3, Role::position}, 2);
    if (setting_.marked) mark_ = start_.add({"mark", "1"}, 2);
    if (mark_) start_.f64(*mark_)[1] = 7;
    show();
  }
  static const OutputTable& outputs();
  State initial_state() const override { return start_; }
  void step(State&, const StepInput&) const override {}
  void apply(State&, const Command&) const override {}
  std::vector<PlanRow> plan() const override { return {}; }

  mutable int costly_runs = 0, door_runs = 0;

 private:
  struct Whole {
    std::optional<double> absent;
    std::optional<Vec3> nowhere;
    Vec3 place{1, 2, 3};
    double half() const { return 0.5 * place.x; }
  };
  Setting setting_;
  std::optional<State::Column> mark_;
  State start_;
};

const OutputTable& Toy::outputs() {
  const auto doors = [](const Toy& toy, const State&, double) {
    ++toy.door_runs;
    return std::vector<std::array<double, 2>>(toy.setting_.doors.size(), {3, 4});
  };
  static const OutputTable kTable =
      OutputsOf<Toy>("a row")
          .part("", [](const Toy&) { return points_part(2); })
          .field({"position", "m", Scalar::f64, 3, Meaning::position}, column(State::Column{0}), "where")
          .field_type([](const Toy& toy) { return toy.setting_.real; })
          .field({"mark", "1"}, column(&Toy::mark_), "of marked rows")
          .field_when([](const Toy& toy) { return toy.mark_.has_value(); })
          .measured([](const Toy&, const State&, double) { return Whole{}; },
                    {{"absent", "1", &Whole::absent},
                     {"nowhere", "m", &Whole::nowhere},
                     {"place", "m", &Whole::place, "of it"},
                     {"half", "m", &Whole::half}})
          .measured_each([](const Toy& toy) { return toy.setting_.doors; }, doors,
                         {{"door.<id>.in", "1", entry<0>}, {"door.<id>.out", "1", entry<1>}})
          .measured(
              [](const Toy& toy, const State&, double) {
                ++toy.costly_runs;
                return std::array{5.0};
              },
              {{"costly", "1", entry<0>, "takes a pass"}})
          .when_wanted()
          .build();
  return kTable;
}

std::string names(const Observables& all) {
  std::string out;
  for (const Observation& o : all.rows()) out += o.name + ' ';
  return out;
}

TEST(OutputTable, FieldsAreThoseOfTheScene) {
  const Toy single({.real = Scalar::f32}), marked({.marked = true});
  ASSERT_EQ(single.parts()[0].fields.size(), 1u);
  EXPECT_EQ(single.parts()[0].fields[0].type, Scalar::f32);
  std::vector<double> scratch;
  EXPECT_EQ(single.field(single.initial_state(), 0, 0, scratch).type, Scalar::f32);
  ASSERT_EQ(marked.parts()[0].fields.size(), 2u);
  EXPECT_EQ(marked.parts()[0].fields[0].type, Scalar::f64);
  const State s = marked.initial_state();
  const FieldView mark = marked.field(s, 0, 1, scratch);
  ASSERT_EQ(mark.rows, 2u);
  EXPECT_EQ(static_cast<const double*>(mark.data)[1], 7);
}

TEST(OutputTable, ObservablesAreListedInTheOrderOfTheRowsWithoutThoseThatAreEmpty) {
  const Toy toy({.doors = {"a", "b"}});
  Observables all;
  toy.observe(toy.initial_state(), 0, all);
  EXPECT_EQ(names(all), "place.x place.y place.z half door.a.in door.a.out door.b.in door.b.out costly ");
  EXPECT_EQ(all.find("half"), 0.5);
  EXPECT_EQ(all.find("door.b.out"), 4);
  EXPECT_EQ(toy.door_runs, 1) << "all of a family at once";
}

TEST(OutputTable, OnlyThoseWhoAskPayForACostlyPass) {
  const Toy toy({});
  Observables cheap([](std::string_view name) { return name == "half"; });
  toy.observe(toy.initial_state(), 0, cheap);
  EXPECT_EQ(toy.costly_runs, 0);
  EXPECT_EQ(toy.door_runs, 0) << "nobody is in the family";
  Observables asked([](std::string_view name) { return name == "costly"; });
  toy.observe(toy.initial_state(), 0, asked);
  EXPECT_EQ(toy.costly_runs, 1);
  EXPECT_EQ(asked.find("costly"), 5);
}

TEST(OutputTable, TwoTablesAreDescribedAsOne) {
  const OutputTable other =
      OutputsOf<Toy>("another row")
          .part("", [](const Toy&) { return points_part(2); })
          .field({"position", "m", Scalar::f64, 3}, column(State::Column{0}), "said twice")
          .field({"colour", "1"}, column(State::Column{0}), "only here")
          .part("links", [](const Toy&) { return values_part(1); })
          .field({"links.strain", "1"}, column(State::Column{0}), "of a link")
          .field({"position", "m", Scalar::f64, 3}, column(State::Column{0}), "")
          .build();
  const Outputs both = Toy::outputs().described_with(other);
  EXPECT_EQ(both.rows, "a row");
  std::string fields;
  for (const FieldOutput& f : both.fields)
    fields += std::string(f.name) + ": " + std::string(f.sentence) + '\n';
  EXPECT_EQ(fields, "position: where\nmark: of marked rows\ncolour: only here\nlinks.strain: of a link\n");
}

}  // namespace
}  // namespace truestep
