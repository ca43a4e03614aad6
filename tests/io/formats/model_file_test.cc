#include "trilobe/io/formats/model_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <functional>
#include <limits>
#include <locale>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/files/json_value.h"
#include "tests/error_of.h"
#include "tests/test_directory.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using nlohmann::json;
using testing::AnyOf;

// Numbers over the whole range of a double, uneven to the last bit.
ModelFile RandomModel(const ModelSpec& spec) {
  ModelFile file{FactorModel(spec), std::vector<bool>(spec.num_parameters(), false), {}};
  uint64_t state = 1;
  for (double& value : file.model.parameters()) {
    state = state * 6364136223846793005U + 1442695040888963407U;
    const uint64_t bits = (state >> 1U) % 0x7ff0000000000000U;  // any finite number >= 0
    std::memcpy(&value, &bits, sizeof(value));
  }
  const double extremes[] = {0.0, -0.0, 5e-324, 2.2250738585072011e-308, 1e308, 0.1, 1.0 / 3};
  std::copy_n(extremes, std::min<size_t>(7, file.model.parameters().size()),
              file.model.parameters().begin());
  return file;
}

bool SameBits(const FactorModel& a, const FactorModel& b) {
  return a.spec() == b.spec() && std::memcmp(a.parameters().data(), b.parameters().data(),
                                             a.parameters().size_bytes()) == 0;
}

TEST(ModelFile, HasTheShapeOfThePapersModel) {
  const ModelFile file = RandomModel(ModelSpec::SharedFactors(3));
  const json document = json::parse(FormatModel(file));
  EXPECT_EQ(document["format"], "trilobe-model");
  EXPECT_EQ(document["version"], 1);
  EXPECT_EQ(document["kind"], "isotropic");
  EXPECT_EQ(document["lobes"], 3);
  EXPECT_EQ(document["d"].size(), 3);
  EXPECT_EQ(document["s"].size(), 3);
  for (const auto& [key, count] : {std::pair{"D", 3}, {"F", 3}, {"G", 3}}) {
    ASSERT_EQ(document[key].size(), count);
    for (const json& row : document[key]) EXPECT_EQ(row.size(), 90);
  }
  EXPECT_EQ(document["s"][1][2], file.model.s(1)[2]);
  EXPECT_EQ(document["D"][2][17], file.model.D(2, 0)[17]);
  EXPECT_EQ(document["F"][1][89], file.model.F(0, 1)[89]);
  EXPECT_EQ(document["G"][0][3], file.model.G(0, 2)[3]);
}

TEST(ModelFile, ReadsBackTheSameBits) {
  const MerlGrid small{.theta_h = 5, .theta_d = 7, .phi_d = 4};
  std::vector<ModelSpec> specs = {ModelSpec::SharedFactors(3), ModelSpec::IndependentG(),
                                  ModelSpec::SharedFactors(0), ModelSpec::SharedFactors(8, small),
                                  ModelSpec::IndependentG(small)};
  for (const bool per_lobe : {false, true}) {
    for (const bool per_channel : {false, true}) {
      ModelSpec spec = ModelSpec::SharedFactors(2, small);
      spec.D = {per_lobe, per_channel};
      spec.F = {per_channel, !per_lobe};
      spec.G = {!per_lobe, per_channel};
      specs.push_back(spec);
      spec = ModelSpec::SharedFactors(0);
      spec.D = spec.F = spec.G = {per_lobe, per_channel};
      specs.push_back(spec);
    }
  }
  ASSERT_EQ(specs[0].num_parameters(), 822);
  ASSERT_EQ(specs[1].num_parameters(), 816);
  const TestDirectory directory;
  for (const ModelSpec& spec : specs) {
    const ModelFile file = RandomModel(spec);
    WriteModel(file, directory.Path("model.json"));
    EXPECT_TRUE(SameBits(ReadModel(directory.Path("model.json")).model, file.model))
        << FormatModel(file);
  }
}

TEST(ModelFile, KeepsUnobservedBinsAndTheStoryOfTheFit) {
  ModelFile file = RandomModel(ModelSpec::IndependentG());
  for (const Factor factor : kFactors) {
    const int offset = file.model.TableOffset(factor, 2);
    file.unobserved[offset] = file.unobserved[offset + 89] = true;
  }
  file.fit = {.solver = "awls",
              .init = "random",
              .weighting = "log",
              .objective = 0.1 + 0.2,
              .initial_objective = 1e300,
              .stop_reason = "converged",
              .iterations = 17,
              .seconds = 1.0 / 3,
              .threads = 2,
              .source = "a \"quoted\"\npath/\xc3\xa9.binary",
              .valid_samples = 1096216,
              .max_angle = 78.5,
              .program = "trilobe 0.1.0",
              .date = "2024-01-31T12:00:00Z"};
  const ModelFile read = ParseModel(FormatModel(file), "model.json");
  EXPECT_EQ(read.unobserved, file.unobserved);
  EXPECT_EQ(FormatModel(read), FormatModel(file));
  EXPECT_EQ(read.fit.solver, "awls");
  EXPECT_EQ(read.fit.objective, 0.1 + 0.2);
  EXPECT_EQ(read.fit.iterations, 17);
  // The stored source is the file's name, without its path.
  EXPECT_EQ(read.fit.source, "\xc3\xa9.binary");
  EXPECT_EQ(read.fit.valid_samples, 1096216);
  EXPECT_EQ(read.fit.max_angle, 78.5);
  EXPECT_EQ(read.fit.date, file.fit.date);
}

// One of which some parameters are left out.
ModelFile CompactModel(const ModelSpec& spec) {
  ModelFile file{FactorModel(spec), std::vector<bool>(spec.num_parameters(), false), {}};
  for (size_t k = 0; k < file.model.parameters().size(); ++k) {
    file.model.parameters()[k] = 1 / (1.0 + static_cast<double>(k));
  }
  file.layout = TableLayout::Full(spec);
  file.layout->coloured_d = false;
  file.layout->coloured_s = spec.lobes == 0;
  for (auto& tables : file.layout->nodes) {
    if (!tables.empty()) tables.front() = {1, 3};
    if (tables.size() > 1) tables.back() = {2};
  }
  ExpandStored(*file.layout, &file.model);
  return file;
}

TEST(ModelFile, ACompactOneReadsBackTheSameBitsAtFullSize) {
  const MerlGrid small{.theta_h = 5, .theta_d = 7, .phi_d = 4};
  ModelSpec shared = ModelSpec::SharedFactors(2, small);
  shared.D = shared.F = shared.G = {.per_lobe = false, .per_channel = false};
  for (const ModelSpec& spec : {ModelSpec::SharedFactors(3), ModelSpec::IndependentG(small),
                                ModelSpec::SharedFactors(0), shared}) {
    const ModelFile file = CompactModel(spec);
    const ModelFile read = ParseModel(FormatModel(file), "model.json");
    EXPECT_TRUE(SameBits(read.model, file.model)) << FormatModel(file);
    ASSERT_TRUE(read.layout.has_value());
    EXPECT_EQ(*read.layout, *file.layout);
    EXPECT_EQ(FormatModel(read), FormatModel(file));
  }
  const std::string compact = FormatModel(CompactModel(ModelSpec::SharedFactors(3)));
  EXPECT_FALSE(ParseModel(FormatModel(RandomModel(ModelSpec::SharedFactors(3))), "").layout);
  const json D = json::parse(compact)["D"];
  EXPECT_EQ(D[0]["nodes"], json({1, 3}));
  EXPECT_EQ(D[0]["values"].size(), 2);
  EXPECT_EQ(D[0]["size"], 90);
  EXPECT_TRUE(D[1].is_array());
}

TEST(ModelFile, ASourceNameNeedNotBeUtf8) {
  ModelFile file = RandomModel(ModelSpec::SharedFactors(1));
  file.fit.source = "caf\xe9.binary";
  EXPECT_THAT(ParseModel(FormatModel(file), "").fit.source, testing::StrEq("caf\\xe9.binary"));
}

TEST(ModelFile, DoesNotDependOnTheLocale) {
  struct Comma : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
  };
  const ModelFile file = RandomModel(ModelSpec::SharedFactors(3));
  const std::string text = FormatModel(file);
  const std::locale before = std::locale::global({std::locale::classic(), new Comma});
  const std::string text_in_locale = FormatModel(file);
  const ModelFile read = ParseModel(text, "");
  std::locale::global(before);
  EXPECT_EQ(text_in_locale, text);
  EXPECT_TRUE(SameBits(read.model, file.model));
}

// The document of a good file, after `change`, as ParseModel takes it.
std::optional<Error> ErrorAfter(const std::function<void(json*)>& change) {
  json document = json::parse(FormatModel(RandomModel(ModelSpec::SharedFactors(3))));
  change(&document);
  return ErrorOf([&] { ParseModel(document.dump(), "model.json"); });
}

std::optional<Error> ErrorOfText(const std::string& text) {
  return ErrorOf([&] { ParseModel(text, "model.json"); });
}

TEST(ModelFile, NamesWhatIsWrongInACompactOne) {
  const auto error_after = [](const std::function<void(json*)>& change) {
    json document = json::parse(FormatModel(CompactModel(ModelSpec::SharedFactors(3))));
    change(&document);
    return ErrorOf([&] { ParseModel(document.dump(), "model.json"); });
  };
  struct Case {
    std::function<void(json*)> change;
    const char* key;
    ErrorKind kind;
    const char* value;
  };
  const Case cases[] = {
      {[](json* d) { (*d)["D"][0].erase("size"); }, "D[0].size", ErrorKind::kMissing, ""},
      {[](json* d) { (*d)["D"][0]["size"] = 1e9; }, "D[0].size", ErrorKind::kRange, "1000000000.0"},
      {[](json* d) { (*d)["D"][0]["size"] = 3; }, "D[0]", ErrorKind::kRange, ""},
      {[](json* d) { (*d)["D"][2]["size"] = 89; }, "D[2].size", ErrorKind::kMismatch, ""},
      {[](json* d) { (*d)["F"][0].erase("nodes"); }, "F[0].nodes", ErrorKind::kMissing, ""},
      {[](json* d) { (*d)["F"][0]["nodes"] = json::array(); }, "F[0].nodes", ErrorKind::kRange,
       "0"},
      {[](json* d) { (*d)["F"][0]["nodes"][1] = 90; }, "F[0].nodes[1]", ErrorKind::kRange, "90"},
      {[](json* d) { (*d)["F"][0]["nodes"][1] = 1; }, "F[0].nodes[1]", ErrorKind::kRange, ""},
      {[](json* d) { (*d)["F"][0]["nodes"][0] = 0.5; }, "F[0].nodes[0]", ErrorKind::kRange, "0.5"},
      {[](json* d) { (*d)["G"][0]["values"].erase(0); }, "G[0].values", ErrorKind::kMismatch, "1"},
      {[](json* d) { (*d)["G"][0]["values"][0] = -1; }, "G[0].values[0]", ErrorKind::kRange, "-1"},
      {[](json* d) { (*d)["d"] = json::array(); }, "d", ErrorKind::kMismatch, "0"},
      {[](json* d) {
         (*d)["s"][1] = {1, 2, 3};
       },
       "s[1]", ErrorKind::kMismatch, ""},
  };
  for (const Case& bad : cases) {
    EXPECT_THAT(error_after(bad.change),
                IsError(bad.kind, {.file = "model.json", .key = bad.key, .value = bad.value}));
  }
}

TEST(ModelFile, IgnoresUnknownKeysAndTakesDefaultsForOptionalOnes) {
  const ModelFile file = RandomModel(ModelSpec::SharedFactors(3));
  json document = json::parse(FormatModel(file));
  document["comment"] = {{"D", "mine"}};
  document["fit"]["machine"] = nullptr;
  for (const char* key : {"sharing", "unobserved", "fit"}) {
    ParseModel(document.dump(), "model.json");
    document.erase(key);
  }
  const ModelFile read = ParseModel(document.dump(), "model.json");
  EXPECT_TRUE(SameBits(read.model, file.model));
  EXPECT_EQ(read.unobserved, file.unobserved);
  EXPECT_EQ(read.fit.solver, "");
  EXPECT_EQ(read.fit.iterations, 0);
}

TEST(ModelFile, ReadsTheFormerNameOfUnobserved) {
  ModelFile file = RandomModel(ModelSpec::SharedFactors(3));
  file.unobserved[file.unobserved.size() - 2] = true;
  json document = json::parse(FormatModel(file));
  document["dead"] = document["unobserved"];
  document.erase("unobserved");
  EXPECT_EQ(ParseModel(document.dump(), "model.json").unobserved, file.unobserved);
}

TEST(ModelFile, NamesEachMissingKey) {
  for (const char* key : {"format", "version", "kind", "lobes", "d", "s", "D", "F", "G"}) {
    EXPECT_THAT(ErrorAfter([&](json* document) { document->erase(key); }),
                IsError(ErrorKind::kMissing, {.file = "model.json", .key = key}));
  }
  EXPECT_THAT(ErrorAfter([](json* document) { (*document)["sharing"].erase("F"); }),
              IsError(ErrorKind::kMissing, {.key = "sharing.F"}));
  EXPECT_THAT(ErrorAfter([](json* document) { (*document)["sharing"]["G"].erase("per_lobe"); }),
              IsError(ErrorKind::kMissing, {.key = "sharing.G.per_lobe"}));
  EXPECT_THAT(ErrorAfter([](json* document) { (*document)["unobserved"].erase("D"); }),
              IsError(ErrorKind::kMissing, {.key = "unobserved.D"}));
}

TEST(ModelFile, NamesEachKeyOfTheWrongType) {
  for (const char* key : {"format", "version", "kind", "lobes", "d", "s", "D", "F", "G", "sharing",
                          "unobserved", "fit"}) {
    for (const json& value : {json(nullptr), json(true), json(-1.5)}) {
      EXPECT_THAT(
          ErrorAfter([&](json* document) { (*document)[key] = value; }),
          AnyOf(IsError(ErrorKind::kFormat, {.file = "model.json", .key = key}),
                IsError(ErrorKind::kRange, {.file = "model.json", .key = key, .value = "-1.5"})))
          << value;
    }
  }
}

TEST(ModelFile, NamesTheKeyOfAWrongShape) {
  const auto error_of = [](const char* pointer, const json& value) {
    return ErrorAfter([&](json* document) { (*document)[json::json_pointer(pointer)] = value; });
  };
  const std::vector<double> short_row(89, 1.0);
  EXPECT_THAT(error_of("/d", {1, 2}), IsError(ErrorKind::kMismatch, {.key = "d", .value = "2"}));
  EXPECT_THAT(error_of("/s/1", {1, 2, 3, 4}),
              IsError(ErrorKind::kMismatch, {.key = "s[1]", .value = "4"}));
  EXPECT_THAT(error_of("/D/2", short_row),
              IsError(ErrorKind::kMismatch, {.key = "D[2]", .value = "89"}));
  EXPECT_THAT(error_of("/F/0", {1, 2, 3}), IsError(ErrorKind::kRange, {.key = "F[0]"}));
  EXPECT_THAT(error_of("/G", json::array()),
              IsError(ErrorKind::kMismatch, {.key = "G", .value = "0"}));
  EXPECT_THAT(error_of("/G", short_row),
              IsError(ErrorKind::kMismatch, {.key = "G", .value = "89"}));
  EXPECT_THAT(error_of("/D/0/5", {1}),
              IsError(ErrorKind::kFormat, {.key = "D[0][5]", .value = "array"}));
  EXPECT_THAT(error_of("/lobes", 2), IsError(ErrorKind::kMismatch, {.key = "D", .value = "3"}));
  EXPECT_THAT(error_of("/sharing/D/per_channel", true),
              IsError(ErrorKind::kMismatch, {.key = "D[0]", .value = "90"}));
  EXPECT_THAT(error_of("/unobserved/F/2", {90}),
              IsError(ErrorKind::kRange, {.key = "unobserved.F[2][0]", .value = "90"}));
  EXPECT_THAT(error_of("/unobserved/F", {{1}}),
              IsError(ErrorKind::kMismatch, {.key = "unobserved.F", .value = "1"}));
  EXPECT_THAT(error_of("/fit/iterations", 1e10),
              IsError(ErrorKind::kRange, {.key = "fit.iterations", .value = "10000000000.0"}));
  EXPECT_THAT(error_of("/fit/solver", 1),
              IsError(ErrorKind::kFormat, {.key = "fit.solver", .value = "number"}));
}

TEST(ModelFile, BoundsTheLobesBeforeAnythingElse) {
  for (const json& lobes : {json(9), json(-1), json(2.5), json(4000000000U), json(1e300)}) {
    EXPECT_THAT(ErrorAfter([&](json* document) { (*document)["lobes"] = lobes; }),
                IsError(ErrorKind::kRange, {.key = "lobes"}))
        << lobes;
  }
}

TEST(ModelFile, RefusesNumbersThatAreNoneOrNegative) {
  for (const char* key : {"d", "s", "D", "F", "G"}) {
    const std::string entry_key = std::string(key) + (key[0] == 'd' ? "[2]" : "[0][2]");
    for (const json& value : {json(nullptr), json(-1e-300), json(-1), json("1"), json(true)}) {
      EXPECT_THAT(ErrorAfter([&](json* document) {
                    json* entry = &(*document)[key];
                    while ((*entry)[0].is_array()) entry = &(*entry)[0];
                    (*entry)[2] = value;
                  }),
                  AnyOf(IsError(ErrorKind::kFormat, {.key = entry_key}),
                        IsError(ErrorKind::kRange, {.key = entry_key})))
          << value;
    }
  }
  // Numbers that JSON cannot say, or a double cannot hold.
  const std::string text = FormatModel(RandomModel(ModelSpec::SharedFactors(3)));
  const size_t number = text.find("\"d\": [") + 6;
  for (const char* literal :
       {"NaN", "nan", "Infinity", "-Infinity", "1e999", "-1e999", "0x1", ""}) {
    std::string spoilt = text;
    spoilt.replace(number, spoilt.find(',', number) - number, literal);
    const ErrorKind kind =
        spoilt.find("e999") == std::string::npos ? ErrorKind::kFormat : ErrorKind::kRange;
    EXPECT_THAT(ErrorOfText(spoilt), IsError(kind, {.file = "model.json", .key = "column"}))
        << literal;
  }
}

TEST(ModelFile, AnAnisotropicModelHasRingsOfAzimuths) {
  ModelSpec finer = ModelSpec::Anisotropic(2);
  finer.d_axis = Axis::Polar({0, 2.5, 10, 40, 80}, 60);
  ModelSpec independent = ModelSpec::IndependentG();
  independent.d_axis = independent.g_axis = Axis::Polar({5, 50}, 3);
  for (const ModelSpec& spec :
       {ModelSpec::Anisotropic(3), ModelSpec::Anisotropic(0), finer, independent}) {
    const ModelFile file = RandomModel(spec);
    const std::string text = FormatModel(file);
    EXPECT_TRUE(SameBits(ParseModel(text, "model.json").model, file.model));
  }
  json document = json::parse(FormatModel(RandomModel(ModelSpec::Anisotropic(3))));
  EXPECT_EQ(document["kind"], "anisotropic");
  for (const char* const factor : {"D", "G"}) {
    ASSERT_EQ(document[factor].size(), 3);
    ASSERT_EQ(document[factor][2].size(), 6);
    EXPECT_EQ(document[factor][2][5].size(), 48);
    EXPECT_EQ(document["theta_nodes"][factor], json({0, 15, 30, 45, 60, 75}));
    EXPECT_EQ(document["phi_nodes"][factor][47], 352.5);
  }
  // A file that does not say its nodes has UTIA's.
  document.erase("theta_nodes");
  document.erase("phi_nodes");
  EXPECT_EQ(ParseModel(document.dump(), "model.json").model.spec(), ModelSpec::Anisotropic(3));
}

TEST(ModelFile, RefusesAnisotropicTablesThatHaveOtherNodes) {
  const auto error_after = [](const std::function<void(json*)>& change) {
    json document = json::parse(FormatModel(RandomModel(ModelSpec::Anisotropic(3))));
    change(&document);
    return ErrorOfText(document.dump());
  };
  EXPECT_THAT(error_after([](json* d) { (*d)["D"][1].erase(5); }),
              IsError(ErrorKind::kMismatch, {.key = "D[1]", .value = "5"}));
  EXPECT_THAT(error_after([](json* d) { (*d)["G"][2][3].push_back(1); }),
              IsError(ErrorKind::kMismatch, {.key = "G[2][3]", .value = "49"}));
  EXPECT_THAT(error_after([](json* d) { (*d)["theta_nodes"]["D"][3] = 15; }),
              IsError(ErrorKind::kRange, {.key = "theta_nodes.D[3]"}));
  EXPECT_THAT(error_after([](json* d) { (*d)["theta_nodes"]["D"][5] = 90; }),
              IsError(ErrorKind::kRange, {.key = "theta_nodes.D[5]"}));
  EXPECT_THAT(error_after([](json* d) { (*d)["phi_nodes"]["G"][1] = 8; }),
              IsError(ErrorKind::kRange, {.key = "phi_nodes.G[1]"}));
  EXPECT_THAT(error_after([](json* d) { (*d)["theta_nodes"]["G"] = json::array({0}); }),
              IsError(ErrorKind::kMismatch, {.key = "G[0]", .value = "6"}));
}

TEST(ModelFile, KeepsAStretch) {
  ModelSpec spec = ModelSpec::SharedFactors(2);
  spec.stretches = Stretch{.along = -0.35, .across = 0.15};
  const ModelFile file = RandomModel(spec);
  const json document = json::parse(FormatModel(file));
  EXPECT_EQ(document["version"], 2);  // readers of version 1 would evaluate it wrongly
  EXPECT_EQ(document["stretch"], (json{{"along", -0.35}, {"across", 0.15}}));
  EXPECT_TRUE(SameBits(ParseModel(FormatModel(file), "model.json").model, file.model));
  const json plain = json::parse(FormatModel(RandomModel(ModelSpec::SharedFactors(2))));
  EXPECT_FALSE(plain.contains("stretch"));

  spec.stretches = Stretches({{.along = -0.35, .across = 0.15}, {.along = 1, .across = 0}});
  const ModelFile each = RandomModel(spec);
  const json list = json::parse(FormatModel(each));
  EXPECT_EQ(list["stretch"],
            (json{{{"along", -0.35}, {"across", 0.15}}, {{"along", 1.0}, {"across", 0.0}}}));
  const ModelFile read = ParseModel(FormatModel(each), "model.json");
  EXPECT_EQ(read.model.spec(), spec);
  EXPECT_TRUE(SameBits(read.model, each.model));

  const auto error_of = [&](const json& stretch) {
    json changed = document;
    changed["stretch"] = stretch;
    return ErrorOfText(changed.dump());
  };
  EXPECT_THAT(error_of("wide"), IsError(ErrorKind::kFormat, {.key = "stretch"}));
  EXPECT_THAT(error_of(json::array({{{"along", 0}, {"across", 0}}})),
              IsError(ErrorKind::kMismatch, {.key = "stretch", .value = "1"}));
  EXPECT_THAT(error_of(json::array({{{"along", 0}, {"across", 0}}, {{"along", 3}}})),
              IsError(ErrorKind::kRange, {.key = "stretch[1].along", .value = "3"}));
  EXPECT_THAT(error_of({{"along", 0}}), IsError(ErrorKind::kMissing, {.key = "stretch.across"}));
  EXPECT_THAT(error_of({{"along", -2.5}, {"across", 0}}),
              IsError(ErrorKind::kRange, {.key = "stretch.along", .value = "-2.5"}));
  json without = document;
  without.erase("stretch");
  EXPECT_THAT(ErrorOfText(without.dump()), IsError(ErrorKind::kMissing, {.key = "stretch"}));
  json older = document;
  older["version"] = 1;
  EXPECT_THAT(ErrorOfText(older.dump()), IsError(ErrorKind::kRange, {.key = "stretch"}));
}

TEST(ModelFile, RefusesOtherFormatsKindsAndVersions) {
  const auto error_of = [](const char* key, const json& value) {
    return ErrorAfter([&](json* document) { (*document)[key] = value; });
  };
  EXPECT_THAT(error_of("format", "other"),
              IsError(ErrorKind::kFormat, {.key = "format", .value = "other"}));
  EXPECT_THAT(error_of("kind", "bivariate"),
              IsError(ErrorKind::kUnknown, {.key = "kind", .value = "bivariate"}));
  EXPECT_THAT(error_of("version", 4),
              IsError(ErrorKind::kUnsupported, {.key = "version", .value = "4"}));
  EXPECT_THAT(error_of("version", 0),
              IsError(ErrorKind::kUnsupported, {.key = "version", .value = "0"}));
}

TEST(ModelFile, RefusesWhatIsNoJsonObject) {
  const std::string text = FormatModel(RandomModel(ModelSpec::SharedFactors(3)));
  for (const std::string& bad :
       {std::string(), std::string("\0", 1), std::string("[1, 2]"), std::string("17"),
        std::string("null"), std::string("Z\0\0\0", 4), text + "x", text + text,
        text + std::string(1, '\0'), text.substr(0, text.size() / 2),
        std::string("{\"format\": \"\xff\"}"), std::string(100000, '[')}) {
    EXPECT_THAT(ErrorOfText(bad),
                AnyOf(IsError(ErrorKind::kFormat, {.file = "model.json"}),
                      IsError(ErrorKind::kLimit, {.file = "model.json", .key = "column"})));
  }
}

TEST(ModelFile, RefusesAFileThatIsTooLarge) {
  const TestDirectory directory;
  const std::string path = directory.Make("model.json", FormatModel(ModelFile()));
  std::filesystem::resize_file(path, kMaxJsonBytes + 1);
  EXPECT_THAT(ErrorOf([&] { ReadModel(path); }),
              IsError(ErrorKind::kLimit, {.file = path, .key = "bytes", .value = "16777217"}));
}

// The largest model that there is, with a number on a line each.
TEST(ModelFile, TheLimitsHoldTheLargestModel) {
  ModelSpec spec{.lobes = kMaxLobes};
  spec.f_axis.size = kMaxBins;
  spec.d_axis = spec.g_axis = Axis::Polar({0, 15, 30, 45, 60, 65, 70, 75}, kMaxTableSize / 8);
  spec.D = spec.F = spec.G = {.per_lobe = true, .per_channel = true};
  ModelFile file{FactorModel(spec), std::vector<bool>(spec.num_parameters(), true), {}};
  for (double& x : file.model.parameters()) x = 0.12345678901234567;
  const std::string text = json::parse(FormatModel(file)).dump(4);
  EXPECT_GT(text.size(), 4 << 20);
  EXPECT_EQ(ParseModel(text, "model.json").model.spec(), spec);
}

TEST(ModelFile, EveryTruncationIsAnError) {
  const MerlGrid small{.theta_h = 4, .theta_d = 4, .phi_d = 4};
  const std::string text = FormatModel(RandomModel(ModelSpec::SharedFactors(1, small)));
  for (size_t length = 0; length + 2 < text.size(); ++length) {  // the last two: "}\n"
    EXPECT_THAT(ErrorOfText(text.substr(0, length)),
                IsError(ErrorKind::kFormat, {.file = "model.json", .key = "column"}));
  }
}

TEST(ModelFile, WritesNothingThatItCouldNotRead) {
  const TestDirectory directory;
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), -1.0}) {
    ModelFile file = RandomModel(ModelSpec::SharedFactors(1));
    file.model.parameters()[50] = bad;
    EXPECT_THAT(ErrorOf([&] { WriteModel(file, directory.Path("model.json")); }),
                IsError(ErrorKind::kData, {.key = "D"}));
  }
  EXPECT_THAT(directory.Names(), testing::IsEmpty());
  ModelFile file = RandomModel(ModelSpec::SharedFactors(1));
  file.fit.objective = std::numeric_limits<double>::infinity();
  EXPECT_EQ(ParseModel(FormatModel(file), "").fit.objective, 0);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
