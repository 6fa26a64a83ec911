#pragma once

#include <cctype>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/io/files.hpp"

namespace groundscale {

/// That docs/bad-input.md has a row of that name and status, which quotes the message.
inline void expect_in_bad_input_docs(const std::string& name, int status, const std::string& message) {
  const auto docs = read_text(std::string(GROUNDSCALE_SOURCE_FOLDER) + "/docs/bad-input.md");
  ASSERT_TRUE(docs) << docs.error().message;
  const std::string begin = fmt::format("| {} | {} | ", name, status);
  const std::size_t at = docs->find(begin);
  ASSERT_NE(at, std::string::npos) << "no row '" << begin << "' in docs/bad-input.md";
  EXPECT_THAT(docs->substr(at, docs->find('\n', at) - at), testing::HasSubstr(message));
}

/// A row's name as that of a test.
inline std::string test_name_of(const std::string& row_name) {
  std::string name;
  for (const char c : row_name) name += std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
  return name;
}

}  // namespace groundscale
