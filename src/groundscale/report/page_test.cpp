#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/report/page_internal.hpp"
#include "groundscale/report/test_markup_internal.hpp"

namespace groundscale::internal {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(MarkupCheck, SeesWhatIsWrong) {
  const std::string doctype = "<!DOCTYPE html>\n";
  EXPECT_EQ(what_is_wrong(doctype + "<p class=\"a\">1 &lt; 2<br/></p>\n"), "");
  for (const char* wrong : {"<p>", "</p>", "<p><b></p></b>", "<p>1 & 2</p>", "<p>a > b</p>", "<p a=b></p>",
                            "<p a=\"1\" a=\"2\"></p>", "<p a=\"<\"></p>", "<p></p>text", "< p></p>"}) {
    EXPECT_NE(what_is_wrong(doctype + wrong), "") << wrong;
  }
  EXPECT_NE(what_is_wrong("<p></p>"), "");
}

TEST(DataAddress, IsBase64AsInRfc4648) {
  const std::string begin = "data:a/b;base64,";
  const std::pair<const char*, const char*> vectors[] = {{"", ""},
                                                         {"f", "Zg=="},
                                                         {"fo", "Zm8="},
                                                         {"foo", "Zm9v"},
                                                         {"foob", "Zm9vYg=="},
                                                         {"fooba", "Zm9vYmE="},
                                                         {"foobar", "Zm9vYmFy"}};
  for (const auto& [bytes, text] : vectors) EXPECT_EQ(data_address("a/b", bytes), begin + text);
  EXPECT_EQ(data_address("a/b", "\xFB\xFF\xFE"), begin + "+//+");
}

TEST(Page, IsWellFormedAndEscapesItsTitle) {
  const std::string html = page("<b> & \"c\"", section("Here", "<p>content</p>\n"));
  EXPECT_EQ(what_is_wrong(html), "");
  EXPECT_THAT(html, HasSubstr("<title>&lt;b&gt; &amp; &quot;c&quot;</title>"));
  EXPECT_THAT(html, HasSubstr("@media print"));
  EXPECT_EQ(section("Here", ""), "");
}

TEST(TableAndLists, TakeTextAndNoMarkup) {
  const std::string nasty = "<i>&\"'";
  const std::string html = page("t", table_html({{nasty, nasty}, {{nasty, nasty}}, Cells::kWords}) +
                                         list_html({nasty}) + definitions({{nasty, nasty}}));
  EXPECT_EQ(what_is_wrong(html), "");
  EXPECT_THAT(html, Not(HasSubstr("<i>")));
  EXPECT_EQ(table_html({{"a"}, {}}), "");
  EXPECT_EQ(list_html({}), "");
}

}  // namespace
}  // namespace groundscale::internal
