#include <gflags/gflags.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>
#include <numeric>

#include "app/command.h"
#include "app/flags.h"
#include "app/inputs.h"
#include "app/interrupt.h"
#include "app/result_folder.h"
#include "app/scene_plan.h"
#include "app/scene_run.h"
#include "app/solver_flags.h"
#include "core/files/json_value.h"
#include "fit/reports/print.h"
#include "io/pictures/plots.h"
#include "trilobe/core/base/error.h"
#include "trilobe/core/base/printable.h"

namespace trilobe {
namespace {

using Json = nlohmann::ordered_json;

// One model of a material, judged on the directions that the scene uses.
struct Side {
  int num_parameters = 0;
  int threads = 0;
  double seconds = 0;  // on so many threads
  SceneScore score;
};

struct Row {
  std::string name;
  Side full, pruned;

  double Rise() const { return RelativeRise(full.score, pruned.score); }
};

struct Comparison {
  int threads = 0;
  double full_seconds = 0;    // of the full fits, one after another
  double pruned_seconds = 0;  // of the scene, its materials side by side
  bool reckoned = false;      // the latter from what its parts took when they were made
  std::vector<Row> rows = {};
};

// The pruned models of a scene, as they come out of a run or lie in a folder.
struct PrunedScene {
  Scene scene = {};
  SceneFitSettings settings;
  std::vector<ModelFile> files = {};  // of each material
  std::vector<int> num_parameters = {};
  std::vector<double> material_seconds = {};
  double seconds = 0;
  bool reckoned = false;
};

// Checks that the picture will not replace a file that is read.
void CheckOut(const Scene& scene, std::vector<std::string> others) {
  if (FLAGS_out.empty()) return;
  for (const std::string& file : FilesOf(scene)) others.push_back(file);
  Inputs(others).CheckOutput(FLAGS_out);
  CheckPictureOut();
}

PrunedScene PruneScene(const std::string& path) {
  PrunedScene pruned{.settings = SceneSettingsFromFlags()};
  Scene scene = ReadScene(path);
  CheckOut(scene, {});
  const InterruptGuard guard;
  SceneRun run = RunScene(std::move(scene), pruned.settings, [](const MaterialFit&) {});
  if (run.interrupted != 0) {
    throw Error(ErrorKind::kLimit, "interrupted; the same command goes on from the cache")
        .About("interrupted");
  }
  if (!run.failures.empty()) {
    throw Error(ErrorKind::kData,
                "material '" + run.failures[0].name + "': " + run.failures[0].error)
        .About("material", run.failures[0].name);
  }
  pruned.scene = std::move(run.scene);
  for (MaterialFit& fit : run.fits) {
    pruned.num_parameters.push_back(fit.num_parameters);
    pruned.material_seconds.push_back(fit.fit_seconds + fit.prune_seconds);
    pruned.files.push_back(std::move(fit.file));
  }
  pruned.seconds = run.seconds;
  pruned.reckoned = run.reused > 0;
  return pruned;
}

// Fits the same way as the command that made the folder did, unless other flags are given.
void TakeFlags(const Json& flags) {
  for (const auto& [flag, value] : flags.items()) {
    const std::vector<std::string> known = SceneModelFlags();
    if (std::ranges::find(known, flag) != known.end() && IsDefault(flag)) {
      gflags::SetCommandLineOption(flag.c_str(), value.get<std::string>().c_str());
    }
  }
}

PrunedScene ReadPrunedScene(const std::string& folder) {
  const std::string path = folder + "/plan.json";
  try {
    const Json plan = Json::parse(ReadJsonText(path, "not a plan"));
    if (plan.contains("unfinished")) {
      throw ErrorIn(ErrorKind::kData, path,
                    "its run was cut off; make the folder again with `trilobe fit --scene`")
          .About("unfinished");
    }
    TakeFlags(plan.at("flags"));
    PrunedScene pruned{.scene = ReadScene(plan.at("scene").get<std::string>()),
                       .settings = SceneSettingsFromFlags()};
    std::vector<std::string> read = {path};
    for (const SceneMaterial& material : pruned.scene.materials) {
      read.push_back(folder + "/" + material.name + ".json");
    }
    CheckOut(pruned.scene, read);
    for (const SceneMaterial& material : pruned.scene.materials) {
      const auto& planned = plan.at("materials");
      const auto found = std::ranges::find_if(
          planned, [&](const Json& entry) { return entry.at("name") == material.name; });
      if (found == planned.end()) {
        throw ErrorIn(ErrorKind::kMissing, path,
                      "material '" + material.name +
                          "' is missing; make the folder again with `trilobe fit --scene`")
            .About("material", material.name);
      }
      pruned.files.push_back(ReadModel(folder + "/" + material.name + ".json"));
      pruned.num_parameters.push_back(
          found->at(found->contains("parameters") ? "parameters" : "numbers").at("pruned"));
      pruned.material_seconds.push_back(found->at("seconds").at("fit").get<double>() +
                                        found->at("seconds").at("prune").get<double>());
    }
    pruned.seconds = plan.at("seconds");
    pruned.reckoned = plan.at("reused").get<int>() > 0;
    return pruned;
  } catch (const Json::exception& exception) {
    throw ErrorIn(ErrorKind::kFormat, path,
                  std::string("not a plan of `trilobe fit --scene`: ") + exception.what());
  }
}

Comparison Compare(const PrunedScene& pruned) {
  Comparison comparison{
      .threads = ThreadsFromFlags(), .pruned_seconds = pruned.seconds, .reckoned = pruned.reckoned};
  const InterruptGuard guard;
  for (size_t k = 0; k < pruned.scene.materials.size(); ++k) {
    const SceneMaterial& material = pruned.scene.materials[k];
    const std::optional<FullFit> full = FitWhole(material, pruned.settings, comparison.threads);
    if (!full) {
      throw Error(ErrorKind::kLimit, "interrupted; the same command goes on from the cache")
          .About("interrupted");
    }
    comparison.full_seconds += full->seconds;
    const std::vector<SceneScore> scores =
        ScoreOnScene(std::vector{full->file.model, pruned.files[k].model}, material,
                     pruned.settings, comparison.threads);
    comparison.rows.push_back({material.name,
                               {full->file.model.spec().num_parameters(), full->file.fit.threads,
                                full->seconds, scores[0]},
                               {pruned.num_parameters[k], pruned.files[k].fit.threads,
                                pruned.material_seconds[k], scores[1]}});
  }
  return comparison;
}

template <typename Value>
auto SumOver(const Comparison& comparison, const Value& value) {
  decltype(value(comparison.rows[0])) sum = 0;
  for (const Row& row : comparison.rows) sum += value(row);
  return sum;
}

Json SideToJson(const Side& side) {
  return {{"parameters", side.num_parameters}, {"bytes", BytesOf(side.num_parameters)},
          {"threads", side.threads},           {"seconds", side.seconds},
          {"objective", side.score.objective}, {"psnr_db", side.score.psnr_db}};
}

Json ToJson(const Comparison& comparison) {
  Json materials = Json::array();
  for (const Row& row : comparison.rows) {
    materials.push_back({{"name", row.name},
                         {"full", SideToJson(row.full)},
                         {"pruned", SideToJson(row.pruned)},
                         {"relative_rise", row.Rise()}});
  }
  const int full = SumOver(comparison, [](const Row& row) { return row.full.num_parameters; });
  const int pruned = SumOver(comparison, [](const Row& row) { return row.pruned.num_parameters; });
  const auto count = static_cast<double>(comparison.rows.size());
  return {{"threads", comparison.threads},
          {"materials", materials},
          {"all",
           {{"parameters", {{"full", full}, {"pruned", pruned}}},
            {"bytes", {{"full", BytesOf(full)}, {"pruned", BytesOf(pruned)}}},
            {"seconds",
             {{"full", comparison.full_seconds},
              {"pruned", comparison.pruned_seconds},
              {"pruned_reckoned", comparison.reckoned}}},
            {"mean_relative_rise",
             SumOver(comparison, [](const Row& row) { return row.Rise(); }) / count},
            {"mean_psnr_db",
             {{"full",
               SumOver(comparison, [](const Row& row) { return row.full.score.psnr_db; }) / count},
              {"pruned", SumOver(comparison, [](const Row& row) {
                           return row.pruned.score.psnr_db;
                         }) / count}}}}}};
}

void Print(const Comparison& comparison) {
  size_t width = 10;
  for (const Row& row : comparison.rows) width = std::max(width, row.name.size() + 2);
  const auto line = [width](const std::string& material, int full, int pruned, double full_seconds,
                            double pruned_seconds, const std::string& full_E,
                            const std::string& pruned_E, double rise, double full_psnr,
                            double pruned_psnr) {
    const std::string name = Printable(material);
    std::cout << name << std::string(name.size() < width ? width - name.size() : 1, ' ')
              << AlignRight(std::to_string(full), 7) << AlignRight(std::to_string(pruned), 8)
              << AlignRight(std::to_string(BytesOf(full)), 9)
              << AlignRight(std::to_string(BytesOf(pruned)), 8)
              << AlignRight(Text(full_seconds, 3), 8) << AlignRight(Text(pruned_seconds, 3), 8)
              << AlignRight(full_E, 11) << AlignRight(pruned_E, 11)
              << AlignRight(Text(100 * rise, 3), 9) << AlignRight(Text(full_psnr), 8)
              << AlignRight(Text(pruned_psnr), 8) << "\n";
  };
  std::cout << std::string(width, ' ')
            << "  parameters            bytes          seconds              E          E rises     "
               "PSNR [dB]\n"
            << std::string(width, ' ')
            << "   full  pruned     full  pruned    full  pruned       full     pruned     by %    "
               "full  pruned\n";
  for (const Row& row : comparison.rows) {
    line(row.name, row.full.num_parameters, row.pruned.num_parameters, row.full.seconds,
         row.pruned.seconds, Text(row.full.score.objective, 5), Text(row.pruned.score.objective, 5),
         row.Rise(), row.full.score.psnr_db, row.pruned.score.psnr_db);
  }
  const auto mean = [&](const auto& value) {
    return SumOver(comparison, value) / static_cast<double>(comparison.rows.size());
  };
  line("all", SumOver(comparison, [](const Row& row) { return row.full.num_parameters; }),
       SumOver(comparison, [](const Row& row) { return row.pruned.num_parameters; }),
       comparison.full_seconds, comparison.pruned_seconds, "", "",
       mean([](const Row& row) { return row.Rise(); }),
       mean([](const Row& row) { return row.full.score.psnr_db; }),
       mean([](const Row& row) { return row.pruned.score.psnr_db; }));
  std::cout << "\nE and PSNR are on the directions and channels that the scene uses; of all: sums, "
               "and means of the\nlast three columns. Seconds of the full fits: one after another "
               "on "
            << comparison.threads << " threads each; of the pruned ones:\nside by side"
            << (comparison.reckoned ? ", the total reckoned from when the parts were made" : "")
            << ".\n";
}

void Draw(const Comparison& comparison, const std::string& path) {
  std::vector<TradeOff> rows;
  const auto end = [](const Side& side) {
    return TradeOff::End{static_cast<double>(BytesOf(side.num_parameters)),
                         side.seconds * side.threads, side.score.psnr_db};
  };
  for (const Row& row : comparison.rows) rows.push_back({row.name, end(row.full), end(row.pruned)});
  DrawTradeOff(rows, path);
}

int RunCompare(std::span<const std::string> arguments) {
  std::error_code ignored;
  const bool is_folder = std::filesystem::is_directory(arguments[0], ignored);
  const Comparison comparison =
      Compare(is_folder ? ReadPrunedScene(arguments[0]) : PruneScene(arguments[0]));
  if (FLAGS_json) {
    PrintJson(ToJson(comparison));
  } else {
    Print(comparison);
  }
  if (!FLAGS_out.empty()) Draw(comparison, FLAGS_out);
  return 0;
}

}  // namespace

Command CompareCommand() {
  std::vector<std::string> flags = SceneFlags();
  flags.insert(flags.begin(), {"json", "out"});
  return {
      .name = "compare",
      .summary = "compare the full with the pruned models of a scene",
      .arguments = "SCENE|DIR",
      .min_arguments = 1,
      .max_arguments = 1,
      .details =
          "For each material: parameters, bytes, seconds, E and PSNR of a full fit, as `trilobe "
          "fit SOURCE` makes\nit, and of the pruned model; E and PSNR on the directions and "
          "channels\nthat the scene uses. Of a scene file the "
          "pruned models are made, or taken from the cache; of a folder\nthat `trilobe fit "
          "--scene` wrote they are read. With --out=FILE.png, draws it.",
      .flags = flags,
      .particular_flags = ParticularSolverFlags(),
      .run = RunCompare};
}

}  // namespace trilobe
