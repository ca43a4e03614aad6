#include "core/files/own_mark.h"

#include <algorithm>
#include <array>
#include <string>

#include "core/files/json_value.h"
#include "trilobe/core/base/error.h"

namespace trilobe {
namespace {

using namespace std::string_view_literals;  // NOLINT(google-build-using-namespace): of ""sv

constexpr std::string_view kPng = "\x89PNG\r\n\x1A\n"sv;
// A chunk of PNG: its length, its name, "Software", "Trilobe", and the checksum of these.
constexpr std::string_view kPngMark = "\0\0\0\x10tEXtSoftware\0Trilobe\xE8\x34\x95\x18"sv;
constexpr std::string_view kPngEnd = "\0\0\0\0IEND\xAE\x42\x60\x82"sv;

// How the tables begin that this program writes, whatever columns a version adds at the end.
constexpr std::array kTables = {
    "iteration,seconds,objective,"sv,  // traces, convergence
    "name,source,state,verdict,"sv,    // fits
    "problem,method,"sv,               // studies
    "profile,method,"sv,
    "theta_i,phi_i,theta_o,phi_o,measured_r,measured_g,measured_b,fitted_r"sv,  // convert --at
    "# BRDF [1/sr] of "sv};                                                     // measurements

// Files for renderers have one of these near their beginnings.
constexpr std::array kPhrases = {kOwnMark, "<Manufacturer>Trilobe</Manufacturer>"sv,
                                 ": a model of Trilobe, for "sv, "found by trilobe "sv};

// The same of a plan for people, whose first column is as wide as its names are long.
constexpr std::string_view kPlanBegins = "material ", kPlanColumns = " lobes   stored  of full ";

bool Has(std::string_view text, std::string_view part) {
  return text.find(part) != std::string_view::npos;
}

// The value of a member, if it is a string.
std::string StringIn(const JsonValue& json, std::string_view member) {
  const JsonValue* const found = json.Find(member);
  return found != nullptr && found->type() == JsonValue::Type::kString ? found->string() : "";
}

bool IsOwnObject(const JsonValue& json, std::string_view bytes) {
  if (json.type() != JsonValue::Type::kObject) return false;
  const std::string format = StringIn(json, "format");
  constexpr std::array kFormats = {"trilobe-model", "trilobe-report", kPlanFormat, kStudyFormat};
  if (std::ranges::find(kFormats, format) != kFormats.end()) return true;
  if (format == "blender-principled") return Has(StringIn(json, "made"), "found by trilobe ");
  if (!format.empty()) return false;
  if (const JsonValue* const asset = json.Find("asset"); asset != nullptr) {  // of glTF
    return asset->type() == JsonValue::Type::kObject &&
           Has(StringIn(*asset, "generator"), "found by trilobe ");
  }
  const auto has = [&](std::string_view member) { return json.Find(member) != nullptr; };
  if (has("metadata")) return Has(bytes, kOwnMark);  // of OpenMATERIAL
  // Reports and plans by earlier versions.
  return (has("run") && has("files") && (has("key") || has("unfinished"))) ||
         (has("scene") && has("materials") && has("threads"));
}

bool IsOwnJson(std::string_view bytes) {
  constexpr size_t kMostValues = 8 * kMaxJsonValues;
  try {
    return IsOwnObject(JsonValue::Parse(bytes, "", "", {bytes.size(), kMostValues}), bytes);
  } catch (const Error&) {
    return false;
  }
}

// Directions to measure: once somebody has written values beside them, the file is theirs.
bool IsUnfilledPlan(std::string_view bytes) {
  constexpr std::string_view kColumns = "theta_i,phi_i,theta_o,phi_o\n";
  const size_t first = bytes.find('\n');
  const bool begins = bytes.starts_with("# Directions to measure ");
  if (!begins || first == std::string_view::npos) return false;
  const std::string_view table = bytes.substr(first + 1);
  if (!table.starts_with(kColumns)) return false;
  const auto lines = std::ranges::count(table, '\n'), commas = std::ranges::count(table, ',');
  return table.ends_with('\n') && commas == 3 * lines;
}

bool IsOwnPage(std::string_view bytes) {
  constexpr size_t kHead = 4096;
  return Has(bytes.substr(0, kHead), R"(<meta name="generator" content="trilobe )") ||
         // Pages of earlier versions.
         Has(bytes, R"(<body class="catalogue">)") || Has(bytes, R"(<body class="study">)");
}

bool BeginsWithTag(std::string_view bytes) {
  constexpr std::string_view kTag = "<!doctype html";
  return bytes.size() >= kTag.size() &&
         std::ranges::equal(bytes.substr(0, kTag.size()), kTag, [](char a, char b) {
           return (a >= 'A' && a <= 'Z' ? a - 'A' + 'a' : a) == b;
         });
}

}  // namespace

std::string MarkedPicture(std::string picture) {
  if (SaysOwn(picture)) return picture;
  if (picture.starts_with(kPng)) {
    picture.insert(picture.size() - kPngEnd.size(), kPngMark);
  } else if (picture.starts_with("%PDF-")) {
    picture.append("% ").append(kOwnMark).append("\n");
  } else {
    picture.append("<!-- ").append(kOwnMark).append(" -->\n");
  }
  return picture;
}

bool SaysOwn(std::string_view bytes) {
  constexpr size_t kHead = 4096, kTail = 256;
  if (bytes.starts_with(kPng)) {
    return bytes.ends_with(kPngEnd) &&
           bytes.substr(0, bytes.size() - kPngEnd.size()).ends_with(kPngMark);
  }
  const size_t begin = bytes.find_first_not_of(" \t\r\n");
  if (begin != std::string_view::npos && bytes[begin] == '{') return IsOwnJson(bytes);
  if (BeginsWithTag(bytes)) return IsOwnPage(bytes);
  if (bytes.starts_with("tensor_file")) {
    return Has(bytes, "fitted by Trilobe") || Has(bytes, "that Trilobe fitted");
  }
  if (bytes.starts_with(kPlanBegins) && Has(bytes.substr(0, bytes.find('\n')), kPlanColumns)) {
    return true;
  }
  if (IsUnfilledPlan(bytes)) return true;
  if (std::ranges::any_of(kTables, [&](auto head) { return bytes.starts_with(head); })) return true;
  const std::string_view head = bytes.substr(0, kHead),
                         tail = bytes.substr(bytes.size() - std::min(kTail, bytes.size()));
  return Has(tail, kOwnMark) ||
         std::ranges::any_of(kPhrases, [&](auto phrase) { return Has(head, phrase); });
}

}  // namespace trilobe
