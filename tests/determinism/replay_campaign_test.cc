// Random courses through sessions of gallery scenes, a few of thousands: the program courses runs the others.
#include <gtest/gtest.h>

#include "engine/scene/gallery.h"
#include "tests/determinism/campaign/course.h"

namespace truestep {
namespace {

// One scene of every way to remember something: an adaptive method, contacts that start warm, closed loops,
// points with springs, emitters, and the wrapped state of an equation.
constexpr const char* kScenes[] = {"four_bars", "dominoes_2d", "robertson_long", "lorenz_butterfly",
                                   "car_2d",    "wave_string", "free_top",       "rod_helix"};
constexpr uint64_t kCourses = 5;  // of each scene

TEST(ReplayCampaign, EveryWayToAStepGivesItsHash) {
  const CourseThreads threads{std::make_shared<const ThreadArena>(1), std::make_shared<const ThreadArena>(2)};
  size_t commands = 0, refused = 0, seeks = 0;
  for (const char* name : kScenes) {
    const GalleryScene* found = find_gallery_scene(name);
    ASSERT_NE(found, nullptr) << name;
    const CourseScene scene = course_scene(name, std::make_shared<const World>(parse_scene(found->text)));
    for (uint64_t seed = 0; seed < kCourses; ++seed) {
      const Course course = run_course(scene, seed, threads);
      std::string deeds;
      for (const std::string& deed : course.deeds) deeds += deed + "\n";
      EXPECT_EQ(course.fault, "") << name << ", seed " << seed << ":\n" << deeds;
      commands += course.commands, refused += course.refused, seeks += course.seeks;
    }
  }
  EXPECT_GT(commands, 50u);
  EXPECT_GT(refused, 50u);
  EXPECT_GT(seeks, 50u);
}

}  // namespace
}  // namespace truestep
