// The key file: which lines are keys, and that no part of a file ever makes one that nobody gave out.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <set>

#include "engine/base/errors.h"
#include "engine/base/random.h"
#include "server/net/access/digest.h"
#include "server/net/access/keys.h"

namespace truestep::net {
namespace {

const std::string kKey(24, 'k');

std::string fault_of(const std::string& text) {
  try {
    KeyRing::read(text, "the file");
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

TEST(KeyFileText, LinesThatAreNoKeysAreRefusedByTheirNumber) {
  const std::string digest = sha256_hex("x"), good = "alice " + kKey + "\n";
  const std::vector<std::string> lines = {"bob b",
                                          "x",
                                          "hello",
                                          "bob " + kKey + " king",
                                          "bob " + kKey + " admin more",
                                          "bob admin",
                                          "bob sha256:abc",
                                          "bob sha256:",
                                          "bob sha256:" + digest + "0",
                                          "bob sha256:" + digest.substr(1),
                                          "bob sha256:" + digest.substr(1) + "g",
                                          "bob md5:" + digest,
                                          "bob SHA256:" + digest,
                                          "bob " + kKey.substr(5),
                                          "bob " + kKey,
                                          "bob \xc3\xa9" + kKey,
                                          "bob " + std::string(1, '\0') + kKey + "1"};
  for (const std::string& line : lines) {
    const std::string fault = fault_of("# keys\n" + good + line + "\n");
    EXPECT_TRUE(fault.starts_with("line 3 of the file: ")) << line << ": " << fault;
  }
  EXPECT_EQ(fault_of("# nobody\n"), "the file holds no key");
}

TEST(KeyFileText, KeysAndDigestsAreKeys) {
  std::string upper = sha256_hex("second");
  for (char& c : upper) c = static_cast<char>(std::toupper(c));
  const KeyRing ring = KeyRing::read(
      "# keys\nalice " + kKey + "  # hers\n\nroot sha256:" + upper + " admin\n" + kKey + kKey + "\n", "f");
  ASSERT_NE(ring.find(sha256_hex(kKey)), nullptr);
  EXPECT_EQ(ring.find(sha256_hex(kKey))->name, "alice");
  ASSERT_NE(ring.find(sha256_hex("second")), nullptr);
  EXPECT_EQ(ring.find(sha256_hex("second"))->scope, Caller::Scope::all);
  ASSERT_NE(ring.find(sha256_hex(kKey + kKey)), nullptr);
  // What has 64 digits is whole, whether or not its line is.
  EXPECT_EQ(fault_of("alice sha256:" + sha256_hex("x")), "");
}

// Files of every kind of line, cut at every byte: what is read is keys that were given out, or nothing.
TEST(KeyFileText, NoCutOfAFileMakesAKey) {
  size_t cuts = 0, refused = 0;
  for (uint64_t n = 0; n < 100; ++n) {
    std::string text;
    std::set<std::string> given;
    for (uint64_t k = 0; k < 4; ++k) {
      const auto dice = uniform4(19, n, k);
      const std::string name = "name" + std::to_string(k);
      std::string key;
      for (uint64_t c = 0; c < 20 + static_cast<uint64_t>(dice[0] * 60); ++c)
        key += static_cast<char>('!' + 2 + static_cast<int>(uniform4(20, n * 4 + k, c)[0] * 91));
      std::erase(key, '#');
      key += std::string(20, 'a');
      const bool digest = dice[1] < 0.3, nameless = dice[2] < 0.2;
      given.insert(sha256_hex(key));
      text += (nameless ? "" : name + " ") + (digest ? "sha256:" + sha256_hex(key) : key) +
              (!nameless && dice[3] < 0.3 ? " admin" : "") + "\n";
    }
    for (size_t cut = 0; cut <= text.size(); ++cut, ++cuts) {
      const std::string part = text.substr(0, cut);
      try {
        const KeyRing ring = KeyRing::read(part, "f");
        size_t found = 0;
        for (const std::string& digest : given) found += ring.find(digest) != nullptr;
        EXPECT_EQ(found, ring.size()) << part;
      } catch (const Error&) {
        ++refused;
      }
    }
  }
  EXPECT_GT(cuts, 10000u);
  EXPECT_GT(refused, cuts / 2);
}

TEST(KeyFileText, OnlyRegularFilesAreReadAndNeverWaitedFor) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("truestep-keys-" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  ASSERT_EQ(::mkfifo((folder / "fifo").c_str(), 0600), 0);
  std::ofstream(folder / "keys") << "alice " << kKey << "\n";
  std::filesystem::create_symlink("keys", folder / "link");  // as mounted secrets are
  EXPECT_THROW(KeyRing::load((folder / "fifo").string()), Error);
  EXPECT_THROW(KeyRing::load(folder.string()), Error);
  EXPECT_THROW(KeyRing::load("/dev/zero"), Error);
  EXPECT_EQ(KeyRing::load((folder / "link").string()).size(), 1u);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace truestep::net
