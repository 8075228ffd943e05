// Text in XML: what would end an element or an attribute is written as an entity.
#include "engine/base/text/xml.h"

#include <gtest/gtest.h>

namespace truestep {
namespace {

TEST(Xml, EscapesWhatEndsTextAndAttributes) {
  EXPECT_EQ(escaped_xml("a < b && \"c\" > d"), "a &lt; b &amp;&amp; &quot;c&quot; &gt; d");
  EXPECT_EQ(escaped_xml("&amp;"), "&amp;amp;");
  EXPECT_EQ(escaped_xml("Zürich, 10\u2212\u00b3"), "Zürich, 10\u2212\u00b3");
}

TEST(Xml, LeavesOutWhatXmlForbids) {
  EXPECT_EQ(escaped_xml(std::string_view("a\0b\x1f\tc\r\n", 8)), "ab\tc\r\n");
}

}  // namespace
}  // namespace truestep
