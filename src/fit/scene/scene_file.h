#ifndef TRILOBE_FIT_SCENE_SCENE_FILE_H_
#define TRILOBE_FIT_SCENE_SCENE_FILE_H_

#include <string>
#include <string_view>
#include <vector>

#include "fit/scene/directions.h"

namespace trilobe {

enum class SceneChannels { kRgb, kLuminance };

// What may be given up, in one of six units.
struct SceneBudget {
  enum class Unit {
    kRelativeRise,  // of E, over that of the fit with nothing left out; 0.01 is 1 %, and below 0
                    // E is to fall, by more lobes
    kPsnrDrop,      // [dB], below that of the fit with nothing left out; below 0 it is to rise
    kMeanDeltaE,    // of the sphere beside the measured one, at most (SphereError)
    kSpherePsnr,    // of the same [dB], at least
    kBytes,         // that the parameters of the model may take, 8 each
    kSeconds,       // of fitting and leaving out
  };
  Unit unit = Unit::kRelativeRise;
  double amount = 0.01;

  // Of how the model looks beside its measurement.
  bool of_appearance() const { return unit == Unit::kMeanDeltaE || unit == Unit::kSpherePsnr; }
};

// Which kinds of things may be left out.
struct SceneReductions {
  bool lobes = true;
  bool colour = true;
  bool shadowing = true;
  bool tables = true;
  bool samples = true;  // false: all samples are fitted, whatever directions occur
};

// A material with the scene's defaults filled in.
struct SceneMaterial {
  std::string name;  // unique, and fit to be the name of a file
  std::string
      source;  // a path that exists, of a measurement or of a model, synth: or material:NAME
  SceneDirections directions;
  SceneChannels channels = SceneChannels::kRgb;
  SceneBudget budget;
  SceneReductions reductions;
};

// The materials of a scene, in the order of its file; at least one.
struct Scene {
  std::string path;
  std::vector<SceneMaterial> materials;
};

// A scene file is JSON; docs/scene.md is its schema. Sources and histograms with a relative path
// are looked for beside the scene file. Throws Error "FILE: /JSON/POINTER: what is wrong and what
// to do", also for unknown and repeated keys, for sources that do not exist, and for bad
// histograms.
Scene ParseScene(std::string_view text, const std::string& path);
Scene ReadScene(const std::string& path);

// The files that a scene takes its content from: its own, sources and histograms.
std::vector<std::string> FilesOf(const Scene& scene);

}  // namespace trilobe

#endif  // TRILOBE_FIT_SCENE_SCENE_FILE_H_
