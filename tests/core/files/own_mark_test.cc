#include "core/files/own_mark.h"

#include <gtest/gtest.h>

#include <string>

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using std::string_literals::operator""s;

TEST(MarkedPicture, IsAPictureThatSaysWhoseItIs) {
  const std::string end = "\0\0\0\0IEND\xAE\x42\x60\x82"s;
  const std::string png = "\x89PNG\r\n\x1A\n\0\0\0\rIHDR"s + end;
  const std::string svg = "<?xml version=\"1.0\"?>\n<svg></svg>\n", pdf = "%PDF-1.5\n%%EOF\n";
  for (const std::string& picture : {png, svg, pdf}) {
    EXPECT_FALSE(SaysOwn(picture));
    EXPECT_TRUE(SaysOwn(MarkedPicture(picture)));
  }
  // PNG has nothing behind its last chunk.
  EXPECT_TRUE(MarkedPicture(png).ends_with(end));
  EXPECT_TRUE(MarkedPicture(svg).starts_with(svg));
}

TEST(SaysOwn, JsonByItsFormat) {
  for (const char* const json :
       {R"({"format": "trilobe-model"})", R"({"a": 1, "format": "trilobe-plan"})",
        R"({"run": "0", "files": [], "key": ""})",
        R"({"run": "0", "files": [], "unfinished": true})",
        R"({"format": "blender-principled", "made": "..., found by trilobe 0.2.0"})",
        R"({"asset": {"version": "2.0", "generator": "..., found by trilobe 0.2.0"}})"}) {
    EXPECT_TRUE(SaysOwn(json)) << json;
  }
  // Files that a user writes for the program are the user's.
  for (const char* const json : {"{}", R"({"tool": "other"})", R"({"format": "trilobe-scene"})",
                                 R"({"format": "trilobe-model")", R"({"run": 1, "files": []})",
                                 R"({"format": "blender-principled", "made": "by hand"})",
                                 R"({"asset": {"version": "2.0", "generator": "by hand"}})",
                                 R"({"note": "written by Trilobe"})"}) {
    EXPECT_FALSE(SaysOwn(json)) << json;
  }
}

TEST(SaysOwn, TextsByTheirBeginnings) {
  EXPECT_TRUE(SaysOwn("iteration,seconds,objective,filtered\n"));
  EXPECT_TRUE(SaysOwn("# BRDF [1/sr] of 4 pairs of directions [degrees]\ntheta_i\n"));
  EXPECT_FALSE(SaysOwn("theta_i,phi_i,theta_o,phi_o,r,g,b\n"));
  EXPECT_FALSE(SaysOwn("iteration,loss\n"));
  EXPECT_FALSE(SaysOwn(""));
  EXPECT_FALSE(SaysOwn("mine"));
  EXPECT_TRUE(SaysOwn("<!DOCTYPE html>\n<meta name=\"generator\" content=\"trilobe view\">"));
  EXPECT_FALSE(SaysOwn("<!doctype html>\n<p>written by Trilobe</p>"));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
