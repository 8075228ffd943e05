// Files as other programs write them (tests/files): what has one meaning is read with the counts and values
// that table.json says, what has none is refused with the line and the reason that stand there.
#include <gtest/gtest.h>

#include <boost/json.hpp>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "tests/unit/files/measured_file.h"

namespace truestep {
namespace {

namespace fs = std::filesystem;
using testing_files::MeasuredFile;

const fs::path kFolder = fs::path(TRUESTEP_SOURCE_DIR) / "tests/files";

std::string bytes_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

boost::json::array table() {
  return boost::json::parse(bytes_of(kFolder / "table.json")).as_array();
}

/// What a file is not as it should be; empty: it is. Coordinates of f32 are exact to 1e-7.
std::string difference(const boost::json::object& row, const MeasuredFile& file) {
  const auto* refused = row.if_contains("refused");
  const std::string reason = refused ? std::string(refused->as_string()) : "";
  if (file.refused != reason) return "refused: \"" + file.refused + "\" instead of \"" + reason + '"';
  std::string out;
  if (refused) return out;
  for (const auto& [key, want] : row.at("read").as_object()) {
    const std::string name(key);
    if (want.is_string()) {
      const auto at = file.words.find(name);
      const std::string have = at == file.words.end() ? "" : at->second;
      if (have != want.as_string()) out += name + " is \"" + have + "\"; ";
      continue;
    }
    const auto at = file.numbers.find(name);
    const double value = want.to_number<double>();
    if (at == file.numbers.end() || !(std::abs(at->second - value) <= 1e-6 * std::max(1.0, std::abs(value))))
      out += name + " is " + (at == file.numbers.end() ? "not there" : std::to_string(at->second)) + "; ";
  }
  return out;
}

MeasuredFile measured(const boost::json::object& row) {
  const fs::path path = kFolder / std::string(row.at("file").as_string());
  const auto* use = row.if_contains("as");
  return testing_files::measure_file(path.extension().string(), bytes_of(path),
                                     use ? std::string(use->as_string()) : "");
}

TEST(Quirks, FilesOfOtherProgramsAreReadByTheirMeaningOrRefused) {
  for (const auto& row : table()) {
    const auto& o = row.as_object();
    EXPECT_EQ(difference(o, measured(o)), "") << o.at("file") << ": " << o.at("why");
  }
}

TEST(Quirks, TheTableNamesEveryFileOnce) {
  std::set<std::string> named, there;
  for (const auto& row : table()) {
    const std::string name(row.at("file").as_string());
    EXPECT_TRUE(named.insert(name).second) << name;
    EXPECT_NE(row.as_object().contains("read"), row.as_object().contains("refused")) << name;
  }
  for (const auto& entry : fs::recursive_directory_iterator(kFolder)) {
    if (!entry.is_regular_file() || entry.path().filename() == "table.json") continue;
    there.insert(fs::relative(entry.path(), kFolder).string());
    EXPECT_LE(entry.file_size(), 1500u) << entry.path() << ": a quirk fits in less";
  }
  EXPECT_EQ(named, there);
  EXPECT_GE(there.size(), 100u);
}

TEST(Quirks, ADifferenceIsSeen) {
  for (auto& row : table()) {
    auto& o = row.as_object();
    const MeasuredFile file = measured(o);
    if (auto* refused = o.if_contains("refused")) {
      *refused = "for another reason";
    } else {
      auto& value = o.at("read").as_object().begin()->value();
      value =
          value.is_string() ? boost::json::value("other") : boost::json::value(value.to_number<double>() + 1);
    }
    EXPECT_NE(difference(o, file), "") << o.at("file");
  }
}

}  // namespace
}  // namespace truestep
