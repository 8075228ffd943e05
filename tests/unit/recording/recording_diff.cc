#include "engine/sinks/recording/diff.h"

#include "tests/unit/recording/recording_test.h"

namespace truestep::fixture {
namespace {

class RecordingDiff : public RecordingTest {
 protected:
  // A recording of 20 frames whose cloth velocity has `offset` added to one number of frame 7.
  std::string with(const std::string& name, double offset, uint64_t frames) {
    RecordingWriter writer(thread, layout(path(name), 30));
    for (uint64_t i = 0; i < frames; ++i) {
      frame.make(writer.layout(), i);
      if (i == 7) frame.data[1][3 * 11 + 2] += offset;
      writer.append(static_cast<int64_t>(i), 0.004 * static_cast<double>(i), frame.systems,
                    frame.observables);
    }
    writer.finalize("");
    return path(name);
  }
  std::optional<RecordingDifference> compare(const std::string& a, const std::string& b, double tolerance) {
    RecordingReader x(thread, a), y(thread, b);
    return first_difference(x, y, tolerance);
  }
};

TEST_F(RecordingDiff, NamesTheFirstPlaceThatDiffers) {
  const std::string a = with("a", 0, 20), b = with("b", 0.5, 20);
  EXPECT_FALSE(compare(a, with("same", 0, 20), 0));
  const auto d = compare(a, b, 0);
  ASSERT_TRUE(d);
  EXPECT_EQ(d->kind, RecordingDifference::Kind::kField);
  EXPECT_EQ(d->frame, 7u);
  EXPECT_EQ(d->step, 7);
  EXPECT_EQ(d->system + "." + d->field, "cloth.velocity");
  EXPECT_EQ(d->row, 11u);
  EXPECT_EQ(d->component, 2u);
  EXPECT_EQ(d->largest, 0.5);
  EXPECT_FALSE(compare(a, b, 0.5));
}

TEST_F(RecordingDiff, ALongerRecordingAgreesUpToItsEnd) {
  const auto d = compare(with("a", 0, 20), with("b", 0, 25), 0);
  ASSERT_TRUE(d);
  EXPECT_EQ(d->kind, RecordingDifference::Kind::kLength);
  EXPECT_EQ(d->frame, 20u);
}

}  // namespace
}  // namespace truestep::fixture
