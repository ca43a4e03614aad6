#include "io/pictures/document.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>
#include <string>

#include "io/pictures/sha256.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using ::testing::HasSubstr;

class Document : public ::testing::TestWithParam<const char*> {};

TEST_P(Document, RunsItsOwnScriptsAlone) {
  const std::string page = FormatDocument(GetParam(), "a title", R"({"text": "<script>"})", "<p>");
  const std::regex meta(R"re(<meta http-equiv="Content-Security-Policy" content="([^"]*)">)re");
  std::smatch match;
  ASSERT_TRUE(std::regex_search(page, match, meta));
  const std::string policy = match[1];
  EXPECT_THAT(policy, HasSubstr("default-src 'none';"));
  EXPECT_THAT(policy, ::testing::Not(HasSubstr("unsafe")));
  EXPECT_THAT(policy, ::testing::Not(HasSubstr("http")));
  // It counts for what comes after it, all styles and scripts.
  int elements = 0;
  for (const std::string begin : {"<style>", "<script type=\"module\">"}) {
    const std::string end = begin[2] == 't' ? "</style>" : "</script>";
    for (size_t at = 0; (at = page.find(begin, at)) != std::string::npos; ++elements) {
      EXPECT_GT(at, static_cast<size_t>(match.position()));
      at += begin.size();
      const std::string text = page.substr(at, page.find(end, at) - at);
      EXPECT_THAT(policy, HasSubstr("'sha256-" + Base64(Sha256(text)) + "'"));
    }
  }
  EXPECT_GE(elements, 2);
}

INSTANTIATE_TEST_SUITE_P(Pages, Document, ::testing::Values("view.html", "catalogue.html"));

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
