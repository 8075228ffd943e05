// The viewer's files inside the executable: reachable by path, with type and tag, and compressed where
// worthwhile.
#include "server/assets/assets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

namespace truestep {
namespace {

TEST(Assets, RootIsThePage) {
  const Asset* page = find_asset("/");
  ASSERT_NE(page, nullptr);
  EXPECT_EQ(page, find_asset("/index.html"));
  EXPECT_EQ(page->mime, "text/html; charset=utf-8");
  EXPECT_EQ(page->cache_control, "no-cache");
  EXPECT_EQ(page->bytes.substr(0, 15), "<!doctype html>");
}

TEST(Assets, UnknownPathsAreAbsent) {
  for (const char* path : {"", "index.html", "/index.htm", "/index.html/", "/../index.html", "/zzz"})
    EXPECT_EQ(find_asset(path), nullptr) << path;
}

TEST(Assets, EveryFileIsFoundTaggedAndTyped) {
  for (const Asset& asset : all_assets()) {
    SCOPED_TRACE(std::string(asset.path));
    EXPECT_EQ(find_asset(asset.path), &asset);
    EXPECT_FALSE(asset.bytes.empty());
    EXPECT_NE(asset.mime, "application/octet-stream");
    EXPECT_EQ(asset.etag.front(), '"');
    EXPECT_EQ(asset.etag.back(), '"');
    EXPECT_NE(asset.etag, asset.gzip_etag);
    // Only a name that changes with the content may be cached forever.
    const bool hashed = asset.path.starts_with("/assets/");
    EXPECT_EQ(asset.cache_control.find("immutable") != std::string_view::npos, hashed);
  }
}

TEST(Assets, CompressedCopiesAreSmallerGzipStreams) {
  for (const Asset& asset : all_assets()) {
    if (asset.gzip.empty()) continue;
    SCOPED_TRACE(std::string(asset.path));
    EXPECT_LT(asset.gzip.size(), asset.bytes.size());
    EXPECT_EQ(asset.gzip.substr(0, 3), "\x1f\x8b\x08");
    // The last four bytes of a gzip stream are the length of its content (RFC 1952, 2.3.1).
    unsigned length = 0;
    for (int k = 3; k >= 0; --k)
      length = length << 8 | static_cast<unsigned char>(asset.gzip[asset.gzip.size() - 4 + k]);
    EXPECT_EQ(length, asset.bytes.size());
  }
}

}  // namespace
}  // namespace truestep
