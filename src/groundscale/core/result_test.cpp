#include "groundscale/core/result.hpp"

#include <memory>
#include <string>

#include <gtest/gtest.h>

namespace groundscale {
namespace {

Result<int> positive(int number) {
  if (number <= 0) return Error{ErrorCode::kBadInput, "not above 0"};
  return number;
}

Result<void> check_positive(int number) {
  if (const auto result = positive(number); !result) return result.error();
  return {};
}

TEST(Result, HoldsAValueOrTheReasonWhyThereIsNone) {
  const Result<int> three = positive(3);
  ASSERT_TRUE(three);
  EXPECT_TRUE(three.has_value());
  EXPECT_EQ(three.value(), 3);
  EXPECT_EQ(*three, 3);

  const Result<int> none = positive(-3);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ErrorCode::kBadInput);
  EXPECT_EQ(none.error().message, "not above 0");
}

TEST(Result, WithoutAValueIsDoneOrFailed) {
  EXPECT_TRUE(check_positive(1));
  const Result<void> failed = check_positive(0);
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().message, "not above 0");
}

TEST(Result, AValueThatCanNotBeCopiedIsMovedOut) {
  Result<std::unique_ptr<std::string>> result = std::make_unique<std::string>("kept");
  EXPECT_EQ((*result)->size(), 4U);
  const std::unique_ptr<std::string> taken = *std::move(result);
  EXPECT_EQ(*taken, "kept");
}

TEST(Result, AValueThatIsAnErrorMessageStaysAValue) {
  const Result<std::string> text = std::string("not above 0");
  ASSERT_TRUE(text);
  EXPECT_EQ(text->size(), 11U);
}

TEST(ResultDeathTest, AskingForWhatIsNotThereEndsTheProgram) {
  EXPECT_DEATH((void)positive(-1).value(), "value\\(\\) of a Result that holds an error");
  EXPECT_DEATH((void)positive(1).error(), "error\\(\\) of a Result that holds a value");
  EXPECT_DEATH((void)check_positive(1).error(), "error\\(\\) of a Result that holds a value");
}

}  // namespace
}  // namespace groundscale
