// The strict reader: what it accepts and refuses, what its errors name, and that many keys do no harm.
#include "engine/scene/json/json.h"

#include <gtest/gtest.h>

#include <boost/json.hpp>
#include <cmath>
#include <string>

#include "engine/base/errors.h"
#include "engine/base/text/utf8.h"
#include "engine/base/thread_clock.h"
#include "tests/support/patience.h"

namespace truestep {
namespace {

using namespace std::string_literals;

// Code of the issue, or "" when the text is accepted; `pointer` receives the issue's pointer.
std::string refusal(const std::string& text, std::string* pointer = nullptr) {
  try {
    parse_json(text);
    return "";
  } catch (const Error& e) {
    EXPECT_EQ(e.issues().size(), 1u);
    if (pointer) *pointer = e.issues().at(0).pointer;
    return e.issues().at(0).code;
  }
}

TEST(Json, AcceptsWhatTheStandardAllows) {
  for (const char* text :
       {"{}", "[]", " \t\r\n[1]\n", "0", "-0", "1E+2", "123.456e-78", "\"\\u0000\"", "\"\\uD83E\\uDDCA\"",
        "\"\x7f\"", "{\"\":0}", "[true,false,null]", "18446744073709551615", "1e-400", "5e-324"}) {
    EXPECT_EQ(refusal(text), "") << text;
  }
}

TEST(Json, RefusesWithTheReason) {
  const std::pair<std::string, const char*> cases[] = {
      {"", "syntax"},
      {"[1,]", "syntax"},
      {"[01]", "syntax"},
      {"[1]x", "syntax"},
      {"[NaN]", "syntax"},
      {"['a']", "syntax"},
      {"[\"a\nb\"]", "syntax"},
      {"[\"\\x41\"]", "syntax"},
      {"{\"a\":1 2}", "syntax"},
      {"[1]\0"s, "syntax"},
      {"[+1]", "syntax"},
      {"[1.]", "syntax"},
      {"[-]", "syntax"},
      {"{\"a\":1,\"a\":2}", "duplicate_key"},
      {"{\"a\":1,\"\\u0061\":2}", "duplicate_key"},
      {"[1e400]", "number_overflow"},
      {"[-1e99999999999999999999]", "number_overflow"},
      {"[\"\\uD800\"]", "lone_surrogate"},
      {"[\"\\uDC00\\uD800\"]", "lone_surrogate"},
      {"[\"\\uD800a\"]", "lone_surrogate"},
      {"[\"\xC0\xAF\"]", "bad_utf8"},
      {"[\"\xED\xA0\x80\"]", "bad_utf8"},
      {"{\"\xFF\":1}", "bad_utf8"},
      {std::string(33, '[') + std::string(33, ']'), "too_deep"},
      {std::string(100000, '['), "too_deep"}};
  for (const auto& [text, code] : cases) EXPECT_EQ(refusal(text), code) << text.substr(0, 40);
  EXPECT_EQ(refusal(std::string(32, '[') + std::string(32, ']')), "") << "the limit itself is allowed";
}

TEST(Json, SkipsAByteOrderMark) {
  EXPECT_EQ(refusal("\xEF\xBB\xBF[1]"), "");
  EXPECT_EQ(refusal("\xEF\xBB\xBF"), "syntax");
}

TEST(Json, NamesThePointer) {
  std::string pointer;
  refusal(R"({"a/b":[0,{"c~":1e999}]})", &pointer);
  EXPECT_EQ(pointer, "/a~1b/1/c~0");
  refusal(R"({"x":1,"y":{"k":1,"k":2}})", &pointer);
  EXPECT_EQ(pointer, "/y/k");
}

TEST(Json, TooMuchIsALimitAndNoSyntaxError) {
  const auto code = [](const std::string& text, JsonLimits limits) {
    try {
      parse_json(text, limits);
      return "accepted"s;
    } catch (const Error& e) {
      return e.code();
    }
  };
  EXPECT_EQ(code("[[1]]", {.max_bytes = 4}), "too_large");
  EXPECT_EQ(code("[[1]]", {.max_depth = 1}), "too_large");
  EXPECT_EQ(code("[[1]]", {.max_bytes = 5, .max_depth = 2}), "accepted");
  EXPECT_EQ(code("[[1]", {}), "bad_json");
}

TEST(Json, RoundsCorrectly) {
  // Each literal's nearest double, written exactly; a reader that multiplies by powers of ten misses some of
  // these.
  const std::pair<const char*, double> cases[] = {{"0.1", 0x1.999999999999ap-4},
                                                  {"9007199254740993.0", 0x1p53},
                                                  {"1.7976931348623157e308", 0x1.fffffffffffffp1023},
                                                  {"2.2250738585072011e-308", 0x0.fffffffffffffp-1022},
                                                  {"6.631236846766476e-316", 0x0.0000007ffffffp-1022}};
  for (const auto& [text, value] : cases)
    EXPECT_NEAR(parse_json(text).as_double() / value, 1, value < 1e-300 ? 1e-6 : 0) << text;
  for (const double v : {1.0 / 3, 2e-308, 1.2345678901234567e+300, 8.41e21}) {
    char text[40];
    std::snprintf(text, sizeof text, "%.17g", v);
    EXPECT_EQ(parse_json(text).to_number<double>(), v) << text;
  }
  EXPECT_EQ(parse_json("9223372036854775807").as_int64(), INT64_MAX);
  EXPECT_EQ(parse_json("18446744073709551615").as_uint64(), UINT64_MAX);
  EXPECT_EQ(parse_json("18446744073709551616").as_double(), 0x1p64);
  EXPECT_EQ(parse_json("1e-400").as_double(), 0);
  EXPECT_EQ(parse_json("0.000000001e-400").as_double(), 0);
}

TEST(Json, DecodesEscapes) {
  const auto v = parse_json(R"("a\"\\\/\b\f\n\r\t\u0041\u00e9\u20ac\uD83E\uDDCA")");
  EXPECT_EQ(v.as_string(), "a\"\\/\b\f\n\r\tA\xC3\xA9\xE2\x82\xAC\xF0\x9F\xA7\x8A");
}

TEST(Json, ManyKeysTakeNoTimeThatAPersonWouldNotice) {
  constexpr int kKeys = 400000;
  std::string text = "{";
  for (int k = 0; k < kKeys; ++k) text += (k ? ",\"k" : "\"k") + std::to_string(k) + "\":1";
  text += "}";
  // CPU time: excludes the load of other programs. A tenth of a second; the 8e10 comparisons of a quadratic
  // check for duplicates take minutes.
  const double begin = thread_cpu_seconds();
  EXPECT_EQ(parse_json(text).as_object().size(), static_cast<size_t>(kKeys));
  EXPECT_LT(thread_cpu_seconds() - begin, std::chrono::duration<double>(patience(5)).count());
}

TEST(Utf8, PiecesAndWholeAgree) {
  const std::pair<std::string, bool> cases[] = {{"\xCE\xBA\xE2\x82\xAC\xF0\x9F\xA7\x8A", true},
                                                {"\xF4\x8F\xBF\xBF", true},
                                                {"\xF4\x90\x80\x80", false},
                                                {"\xE0\x80\xAF", false},
                                                {"\xED\xA0\x80", false},
                                                {"\x80", false},
                                                {"a\xCE", false},
                                                {"\xC1\x81", false}};
  for (const auto& [text, valid] : cases) {
    EXPECT_EQ(valid_utf8(text), valid);
    EXPECT_EQ(find_invalid_utf8("abcdefgh" + text) == std::string::npos, valid);
    Utf8Validator v;
    bool going = true;
    for (const char c : text) going = going && v.feed({&c, 1});
    EXPECT_EQ(going && v.complete(), valid);
  }
}

}  // namespace
}  // namespace truestep
