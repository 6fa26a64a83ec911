#include "groundscale/core/hash.hpp"

#include <gtest/gtest.h>

namespace groundscale {
namespace {

std::string hash_of(std::string_view text) {
  Fnv1a hash;
  hash.add(text);
  return hash.text();
}

TEST(Fnv1a, HasThePublishedValues) {
  EXPECT_EQ(hash_of(""), "cbf29ce484222325");
  EXPECT_EQ(hash_of("a"), "af63dc4c8601ec8c");
  EXPECT_EQ(hash_of("foobar"), "85944171f73967e8");
}

TEST(Fnv1a, PiecesAreAsGoodAsTheWhole) {
  Fnv1a hash;
  hash.add("foo");
  hash.add("bar");
  EXPECT_EQ(hash.text(), hash_of("foobar"));
}

}  // namespace
}  // namespace groundscale
