#include "engine/geometry/read/bvh.h"

#include <charconv>
#include <cmath>
#include <string_view>

#include "engine/base/text/encoding.h"
#include "engine/geometry/read/text_lines.h"
#include "engine/math/trig.h"

namespace truestep {

namespace {

constexpr size_t kMostJoints = 10'000, kMostDepth = 1'000, kMostValues = 20'000'000;
constexpr double kMostValue = 1e9;
constexpr double kDegree = 0.017453292519943295;
constexpr const char* kChannelNames[] = {"Xposition", "Yposition", "Zposition",
                                         "Xrotation", "Yrotation", "Zrotation"};

class BvhReader {
 public:
  explicit BvhReader(std::span<const std::string> lines) : lines_(lines) {
    if (!lines.empty()) at_ = lines[0].size() - without_byte_order_mark(lines[0]).size();
    skip();
  }

  BvhMotion read() {
    expect("HIERARCHY");
    expect("ROOT");
    joint(-1, 0);
    if (!done() && same_word(peek(), "ROOT"))
      fail("there is a second ROOT; only one skeleton per file is read");
    expect("MOTION");
    label("Frames");
    const double frames = number("the number of frames");
    if (frames != std::floor(frames) || frames < 1)
      fail_before("the number of frames must be a whole number above 0");
    if (frames * static_cast<double>(m_.channels) > static_cast<double>(kMostValues)) {
      fail_before("more than twenty million values");
    }
    m_.frames = static_cast<size_t>(frames);
    expect("Frame");
    label("Time");
    m_.frame_time = number("the frame time");
    if (!(m_.frame_time > 0)) fail_before("the frame time is not above 0");
    // Announced data is not allocated before it is there.
    for (size_t f = 0; f < m_.frames; ++f) {
      for (size_t c = 0; c < m_.channels; ++c) {
        if (done()) {
          fail("the file ends in frame " + std::to_string(f + 1) + " of " + std::to_string(m_.frames));
        }
        m_.values.push_back(number("a channel's value"));
      }
    }
    if (!done())
      fail("there are more than " + std::to_string(m_.frames) + " frames of " + std::to_string(m_.channels) +
           " values");
    return std::move(m_);
  }

 private:
  [[noreturn]] void fail(const std::string& why) const {
    throw BvhFault(std::min(line_ + 1, lines_.size() + 1), why);
  }
  [[noreturn]] void fail_before(const std::string& why) const { throw BvhFault(last_line_ + 1, why); }
  static bool blank(char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\f' || c == '\v';
  }
  bool done() const { return line_ >= lines_.size(); }
  void skip() {
    while (line_ < lines_.size()) {
      const std::string& s = lines_[line_];
      while (at_ < s.size() && blank(s[at_])) ++at_;
      if (at_ < s.size()) return;
      ++line_, at_ = 0;
    }
  }
  std::string_view peek() const {
    if (done()) fail("the file ends here");
    const std::string_view s = lines_[line_];
    size_t end = at_;
    while (end < s.size() && !blank(s[end])) ++end;
    return s.substr(at_, end - at_);
  }
  std::string_view take() {
    const std::string_view word = peek();
    last_line_ = line_;
    at_ += word.size();
    skip();
    return word;
  }
  /// The rest of the line, which may contain blanks: a joint's name.
  std::string take_line() {
    const std::string& s = lines_[line_];
    size_t end = s.size();
    const size_t brace = s.find('{', at_);
    if (brace != std::string::npos) end = brace;
    while (end > at_ && blank(s[end - 1])) --end;
    std::string out = s.substr(at_, end - at_);
    last_line_ = line_, at_ = end;
    skip();
    return out;
  }
  void expect(std::string_view word) {
    if (done()) fail("the file ends where " + std::string(word) + " should be");
    if (!same_word(peek(), word)) {
      fail("\"" + std::string(peek().substr(0, 40)) + "\" instead of " + std::string(word));
    }
    take();
  }
  /// A word and its colon, which the number may touch.
  void label(std::string_view word) {
    const std::string whole = std::string(word) + ":";
    if (done()) fail("the file ends where " + whole + " should be");
    const std::string_view w = peek();
    if (!same_word(w.substr(0, word.size()), word)) fail(quoted(w) + " instead of " + whole);
    last_line_ = line_, at_ += word.size();
    skip();
    if (done() || lines_[line_][at_] != ':') fail_before(quoted(w) + " instead of " + whole);
    ++at_;
    skip();
  }
  double number(const char* what) {
    if (done()) fail(std::string("the file ends where ") + what + " should be");
    std::string_view word = peek();
    if (word.starts_with('+')) word.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size() || !(std::abs(value) <= kMostValue)) {
      fail("\"" + std::string(word.substr(0, 40)) + "\" is not " + what + ": a number of at most 1e9");
    }
    take();
    return value;
  }
  Vec3 vector() {
    const double x = number("an offset"), y = number("an offset"), z = number("an offset");
    return {x, y, z};
  }

  void joint(int32_t parent, size_t depth) {
    if (depth > kMostDepth) fail("joints are nested more than a thousand deep");
    if (m_.joints.size() >= kMostJoints) fail("more than ten thousand joints");
    if (done()) fail("the file ends where a joint's name should be");
    const auto me = static_cast<int32_t>(m_.joints.size());
    BvhJoint j;
    j.name = take_line(), j.parent = parent;
    if (j.name.empty()) j.name = "joint" + std::to_string(me);
    m_.joints.push_back(std::move(j));
    expect("{");
    bool offset = false, channels = false;
    for (;;) {
      if (done()) fail("the file ends inside joint \"" + m_.joints[static_cast<size_t>(me)].name + "\"");
      BvhJoint& joint_now = m_.joints[static_cast<size_t>(me)];
      const std::string_view word = peek();
      if (same_word(word, "}")) {
        if (!offset) fail("joint \"" + joint_now.name + "\" has no OFFSET");
        take();
        return;
      }
      if (same_word(word, "OFFSET")) {
        if (offset) fail("there is a second OFFSET");
        take();
        offset = true, joint_now.offset = vector();
      } else if (same_word(word, "CHANNELS")) {
        if (channels) fail("there is a second CHANNELS");
        take();
        channels = true, read_channels(joint_now);
      } else if (same_word(word, "JOINT")) {
        take();
        joint(me, depth + 1);
      } else if (same_word(word, "End")) {
        take();
        expect("Site");
        if (joint_now.end) fail_before("there is a second End Site");
        joint_now.end = end_site();
      } else {
        fail("\"" + std::string(word.substr(0, 40)) + "\" instead of OFFSET, CHANNELS, JOINT, End Site or }");
      }
    }
  }
  /// What is between its braces: an offset, and no channels.
  Vec3 end_site() {
    if (!done()) take_line();  // a name that some give it
    expect("{");
    std::optional<Vec3> offset;
    while (done() || !same_word(peek(), "}")) {
      if (!done() && same_word(peek(), "CHANNELS")) {
        take();
        if (number("the number of channels") != 0) fail_before("an End Site has no channels");
        continue;
      }
      expect("OFFSET");
      if (offset) fail_before("there is a second OFFSET");
      offset = vector();
    }
    if (!offset) fail("the End Site has no OFFSET");
    take();
    return *offset;
  }
  void read_channels(BvhJoint& j) {
    const double count = number("the number of channels");
    if (count != std::floor(count) || count < 0 || count > 6)
      fail_before("a joint must have 0 to 6 channels");
    j.first_channel = m_.channels;
    for (size_t k = 0; k < static_cast<size_t>(count); ++k) {
      const std::string_view word = peek();
      size_t which = 0;
      while (which < 6 && !same_word(word, kChannelNames[which])) ++which;
      if (which == 6)
        fail("\"" + std::string(word.substr(0, 40)) + "\" is not a channel: use Xposition to Zrotation");
      for (const BvhChannel c : j.channels) {
        if (static_cast<size_t>(c) == which) fail("channel " + std::string(word) + " is given twice");
      }
      take();
      j.channels.push_back(static_cast<BvhChannel>(which));
    }
    m_.channels += j.channels.size();
  }

  std::span<const std::string> lines_;
  size_t line_ = 0, at_ = 0, last_line_ = 0;
  BvhMotion m_;
};

std::string text_of(double value) {
  char buffer[32];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, value).ptr;
  return {buffer, end};
}
std::string text_of(const Vec3& v) {
  return text_of(v.x) + " " + text_of(v.y) + " " + text_of(v.z);
}

void write_joint(const BvhMotion& m, size_t j, size_t depth, std::string& out) {
  const BvhJoint& joint = m.joints[j];
  const std::string in(2 * depth, ' ');
  out += in + (joint.parent < 0 ? "ROOT " : "JOINT ") + joint.name + "\n" + in + "{\n";
  out += in + "  OFFSET " + text_of(joint.offset) + "\n";
  out += in + "  CHANNELS " + std::to_string(joint.channels.size());
  for (const BvhChannel c : joint.channels) out += std::string(" ") + kChannelNames[static_cast<size_t>(c)];
  out += "\n";
  for (size_t c = j + 1; c < m.joints.size(); ++c) {
    if (m.joints[c].parent == static_cast<int32_t>(j)) write_joint(m, c, depth + 1, out);
  }
  if (joint.end)
    out +=
        in + "  End Site\n" + in + "  {\n" + in + "    OFFSET " + text_of(*joint.end) + "\n" + in + "  }\n";
  out += in + "}\n";
}

}  // namespace

Pose BvhMotion::local(size_t frame, size_t joint) const {
  const BvhJoint& j = joints[joint];
  Pose out{j.offset, {}};
  const double* v = values.data() + frame * channels + j.first_channel;
  for (size_t k = 0; k < j.channels.size(); ++k) {
    const auto which = static_cast<size_t>(j.channels[k]);
    if (which < 3) {
      (&out.position.x)[which] = v[k];
      continue;
    }
    const auto [s, c] = trig::sincos(0.5 * kDegree * v[k]);
    out.orientation = out.orientation * Quat{c, which == 3 ? s : 0, which == 4 ? s : 0, which == 5 ? s : 0};
  }
  return out;
}

BvhMotion read_bvh(std::span<const std::string> lines) {
  return BvhReader(lines).read();
}

std::string write_bvh(const BvhMotion& m) {
  std::string out = "HIERARCHY\n";
  if (!m.joints.empty()) write_joint(m, 0, 0, out);
  out += "MOTION\nFrames: " + std::to_string(m.frames) + "\nFrame Time: " + text_of(m.frame_time) + "\n";
  for (size_t f = 0; f < m.frames; ++f) {
    for (size_t c = 0; c < m.channels; ++c) out += (c > 0 ? " " : "") + text_of(m.values[f * m.channels + c]);
    out += "\n";
  }
  return out;
}

}  // namespace truestep
