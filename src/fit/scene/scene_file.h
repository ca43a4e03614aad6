#ifndef TRILOBE_FIT_SCENE_SCENE_FILE_H_
#define TRILOBE_FIT_SCENE_SCENE_FILE_H_

#include <map>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "fit/scene/directions.h"
#include "trilobe/fit/fit_options.h"
#include "trilobe/io/formats/measurement_format.h"

namespace trilobe {

enum class SceneChannels { kRgb, kLuminance };

// Error or cost that a pruned model may have, in one of six units.
struct SceneBudget {
  enum class Unit {
    kRelativeRise,  // of E over the full fit, 0.01 for 1 %; below 0, E must fall, by more lobes
    kPsnrDrop,      // below the full fit [dB]; below 0, PSNR must rise
    kMeanDeltaE,    // largest, of the sphere (SphereError)
    kSpherePsnr,    // least, of the sphere [dB]
    kBytes,         // of the model's parameters, 8 each
    kSeconds,       // of fitting and pruning
  };
  Unit unit = Unit::kRelativeRise;
  double amount = 0.01;

  // Whether the unit is one of the sphere.
  bool of_appearance() const { return unit == Unit::kMeanDeltaE || unit == Unit::kSpherePsnr; }
};

// Permitted reductions.
struct SceneReductions {
  bool lobes = true;
  bool colour = true;
  bool shadowing = true;
  bool tables = true;
  bool samples = true;  // false: all samples are fitted, whatever directions occur
};

// A material with the scene's defaults filled in.
struct SceneMaterial {
  std::string name;  // unique and valid as a file name
  std::string
      source;  // a path that exists, of a measurement or of a model, synth: or material:NAME
  SceneDirections directions;
  SceneChannels channels = SceneChannels::kRgb;
  SceneBudget budget;
  SceneReductions reductions;
  // Options that replace those of the command: name of a SourceOption or, for scenes, of a
  // FitOption, and text.
  std::map<std::string, std::string> options;

  // Whether single places of the measurement are read, by a list or a histogram.
  bool reads_places() const {
    return reductions.samples && (std::holds_alternative<DirectionList>(directions) ||
                                  std::holds_alternative<DirectionHistogram>(directions));
  }
};

// The options by which a material's measurement is read, and those by which it is fitted.
SourceOptions WithOptionsOf(const SceneMaterial& material, SourceOptions options);
FitOptions WithOptionsOf(const SceneMaterial& material, FitOptions options);

// The materials of a scene, in the order of its file; at least one.
struct Scene {
  std::string path;
  std::vector<SceneMaterial> materials;
};

// Parse a scene file: JSON by the schema of docs/scene.md. Relative paths of sources and histograms
// start at the folder of the scene file. Throw Error "FILE: /JSON/POINTER: what is wrong and what
// to do", also for unknown and repeated keys, missing sources, and bad histograms.
Scene ParseScene(std::string_view text, const std::string& path);
Scene ReadScene(const std::string& path);

// All input files of a scene: its own, sources and histograms.
std::vector<std::string> FilesOf(const Scene& scene);

}  // namespace trilobe

#endif  // TRILOBE_FIT_SCENE_SCENE_FILE_H_
