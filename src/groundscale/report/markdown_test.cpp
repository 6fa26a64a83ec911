#include "groundscale/report/markdown.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/io/files.hpp"
#include "groundscale/io/temp_folder_internal.hpp"
#include "groundscale/report/test_markup_internal.hpp"

namespace groundscale {
namespace {

using internal::TempFolder;
using internal::what_is_wrong;
using testing::HasSubstr;
using testing::Not;

std::string page_of(const std::string& markdown) {
  const std::string html = markdown_page(markdown, "/nonexistent");
  EXPECT_EQ(what_is_wrong(html), "") << markdown;
  return html;
}

TEST(MarkdownPage, HeadingsNameThePageAndItsParts) {
  const std::string html = page_of("# Experiment `drives`: a & b\n\n## Part\ntext\n### Sub\n# second\n#no heading\n");
  EXPECT_THAT(html, HasSubstr("<title>Experiment drives: a &amp; b</title>"));
  EXPECT_EQ(internal::occurrences(html, "<h1>"), 1);
  EXPECT_THAT(html, HasSubstr("<h2>Part</h2>\n<p>text</p>\n<h3>Sub</h3>\n<h2>second</h2>\n"));
  EXPECT_THAT(html, HasSubstr("<p>#no heading</p>"));
  EXPECT_THAT(page_of("no heading"), HasSubstr("<title>Report</title>"));
}

TEST(MarkdownPage, LinesOfAParagraphAreJoined) {
  EXPECT_THAT(page_of("one\ntwo\r\nthree\n\nfour\n"), HasSubstr("<p>one two three</p>\n<p>four</p>\n"));
}

TEST(MarkdownPage, CodeIsLeftAsItIs) {
  EXPECT_THAT(page_of("    a **b** <c>\n      d | `e`\n"), HasSubstr("<pre>a **b** &lt;c&gt;\n  d | `e`\n</pre>"));
  EXPECT_THAT(page_of("```sh\n# a\n- b\n```\nafter\n"), HasSubstr("<pre># a\n- b\n</pre>\n<p>after</p>"));
  EXPECT_THAT(page_of("```\nnever closed\n"), HasSubstr("<pre>never closed\n</pre>"));
}

TEST(MarkdownPage, TablesKeepTheirColumnsAndAlignNumbers) {
  const std::string html =
      page_of("| name | t_rel % |\n|---|---:|\n| a \\| b | 1.25 |\n| **mean** |\n| x | 1 | more |\n");
  EXPECT_THAT(html, HasSubstr("<thead><tr><th class=\"text\">name</th><th>t_rel %</th></tr>\n</thead>"));
  EXPECT_THAT(html, HasSubstr("<tr><td class=\"text\">a | b</td><td>1.25</td></tr>"));
  EXPECT_THAT(html, HasSubstr("<tr><td class=\"text\"><b>mean</b></td><td></td></tr>"));
  EXPECT_THAT(html, HasSubstr("<tr><td class=\"text\">x</td><td>1</td></tr>"));
  EXPECT_THAT(page_of("| no | rule |\nbelow\n"), HasSubstr("<p>| no | rule | below</p>"));
}

TEST(MarkdownPage, TableWithoutOuterHeadingKeepsEmptyCells) {
  EXPECT_THAT(page_of("|  | b |\n|---|---|\n|  | 2 |\n"),
              HasSubstr("<tr><td class=\"text\"></td><td class=\"text\">2</td>"));
}

TEST(MarkdownPage, ListsEndWhereOtherLinesBegin) {
  EXPECT_THAT(page_of("- one\n  more of one\n- `two`\ntext\n"),
              HasSubstr("<ul>\n<li>one more of one</li>\n<li><code>two</code></li>\n</ul>\n<p>text</p>"));
  EXPECT_THAT(page_of("text\n1. one\n2. two\n"), HasSubstr("<p>text</p>\n<ol>\n<li>one</li>\n<li>two</li>\n</ol>"));
}

TEST(MarkdownPage, MarksWithinALine) {
  EXPECT_THAT(page_of("**met:** `a*b` [words](docs/x.md) \\*kept\\*"),
              HasSubstr("<p><b>met:</b> <code>a*b</code> words (docs/x.md) *kept*</p>"));
  // What doesn't end is text.
  EXPECT_THAT(page_of("**a `b [c](d"), HasSubstr("<p>**a `b [c](d</p>"));
  EXPECT_THAT(page_of("2 * 3 * 4 and a_b_c"), HasSubstr("<p>2 * 3 * 4 and a_b_c</p>"));
}

TEST(MarkdownPage, MarkupOfOthersIsText) {
  const std::string html = page_of(
      "# <b>\n\n<script>alert('x')</script> &amp; **<i>** `<u>` [<s>](<q>)\n\n- <li>\n\n"
      "| <td> |\n|---|\n| \"> |\n\n![<a>\"](<b>\")\n");
  for (const char* tag : {"<script", "<i>", "<u>", "<s>", "<q>"}) EXPECT_THAT(html, Not(HasSubstr(tag)));
  EXPECT_THAT(html, HasSubstr("&amp;amp;"));
}

TEST(MarkdownPage, PicturesAreTakenIntoThePage) {
  const TempFolder folder;
  folder.file("figures/a.svg", "<svg/>");
  folder.file("b.png", "foo");
  const std::string html = markdown_page("![Figure A](figures/a.svg)\n\n![B](b.png)\ntext\n", folder.path());
  EXPECT_EQ(what_is_wrong(html), "");
  EXPECT_THAT(html, HasSubstr("<figure class=\"drawn\">\n<figcaption>Figure A</figcaption>\n<img alt=\"Figure A\" "
                              "src=\"data:image/svg+xml;base64,PHN2Zy8+\"/>\n</figure>"));
  EXPECT_THAT(html, HasSubstr("src=\"data:image/png;base64,Zm9v\"/> text</p>"));
}

TEST(MarkdownPage, PicturesElsewhereAndOfOtherKindsAreNotRead) {
  const TempFolder folder;
  folder.file("secret.png", "foo");
  folder.file("within/text.txt", "foo");
  const std::string within = folder / "within";
  for (const std::string& address : {std::string("../secret.png"), std::string("a/../../secret.png"),
                                     folder / "secret.png", std::string("text.txt"), std::string("none.svg")}) {
    const std::string html = markdown_page("![words](" + address + ")\n", within);
    EXPECT_EQ(what_is_wrong(html), "");
    EXPECT_THAT(html, HasSubstr("Not there: words, ")) << address;
    EXPECT_THAT(html, Not(HasSubstr("<img")));
  }
}

TEST(WriteMarkdownReport, WritesBothFiles) {
  const TempFolder folder;
  ASSERT_TRUE(write_markdown_report(folder / "drives.md", "# Title\n"));
  EXPECT_EQ(read_text(folder / "drives.md").value(), "# Title\n");
  EXPECT_EQ(read_text(folder / "report.html").value(), markdown_page("# Title\n", folder.path()));
  EXPECT_FALSE(write_markdown_report(folder / "none/drives.md", "# Title\n"));
}

}  // namespace
}  // namespace groundscale
