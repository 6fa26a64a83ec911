#include "groundscale/io/iso_time_internal.hpp"

#include <gtest/gtest.h>

namespace groundscale::internal {
namespace {

TEST(IsoTime, IsSecondsSince1970) {
  // Numbers of `date -d ... +%s`.
  EXPECT_EQ(parse_iso_time("1970-01-01T00:00:00Z"), 0.0);
  EXPECT_EQ(parse_iso_time("2026-05-01T12:34:56Z"), 1777638896.0);
  EXPECT_EQ(parse_iso_time("2000-02-29T23:59:59Z"), 951868799.0);
  EXPECT_EQ(parse_iso_time("2026-05-01T12:34:56.25Z"), 1777638896.25);
  EXPECT_EQ(parse_iso_time("2026-05-01T12:34:56"), 1777638896.0);
  EXPECT_EQ(parse_iso_time("2026-05-01 12:34:56z"), 1777638896.0);
  EXPECT_EQ(parse_iso_time("2026-05-01T14:34:56+02:00"), 1777638896.0);
  EXPECT_EQ(parse_iso_time("2026-05-01T09:04:56-0330"), 1777638896.0);
  EXPECT_EQ(parse_iso_time("2026-05-01T14:34:56,5+02"), 1777638896.5);
}

TEST(IsoTime, IsNothingElse) {
  for (const char* text :
       {"", "noon", "2026-05-01", "2026-05-01T12:34", "2026-13-01T12:34:56Z", "2026-02-30T12:34:56Z",
        "2026-05-01T24:00:00Z", "2026-05-01T12:60:00Z", "2026-05-01T12:34:56.Z", "2026-05-01T12:34:56Zz",
        "2026-05-01T12:34:56+2", "26-05-01T12:34:56Z", "1777638896", "2026-05-01T12:34:56+25:00"}) {
    EXPECT_FALSE(parse_iso_time(text)) << text;
  }
}

}  // namespace
}  // namespace groundscale::internal
