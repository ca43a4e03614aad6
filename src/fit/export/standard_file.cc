#include "fit/export/standard_file.h"

#include <filesystem>
#include <ostream>

#include "core/files/file.h"
#include "core/system/stopwatch.h"
#include "fit/open_pbr/material_files.h"
#include "fit/open_pbr/nearest_open_pbr.h"
#include "fit/open_pbr/open_pbr.h"
#include "fit/reports/print.h"
#include "io/formats/utia_file.h"
#include "io/pictures/plots.h"
#include "model/appearance/picture_data.h"
#include "model/appearance/verdict.h"
#include "trilobe/core/geometry/directions.h"
#include "trilobe/core/math/angles.h"
#include "trilobe/fit/as_measurement.h"
#include "trilobe/model/appearance/material.h"
#include "trilobe/model/factor_model.h"

namespace trilobe {
namespace {

// The two, side by side.
void DrawStandard(const FactorModel& model, const std::string& source, double max_angle,
                  const OpenPbrBrdf& brdf, const std::string& path, AppearanceOptions options) {
  options.size = 160;  // pixels of each sphere
  Measurement shown = AsMeasurement(model, source, options.num_threads, kUtiaGrid);
  LimitAngles(DegreesToRadians(max_angle), &shown);
  const Material material = {[&](const HalfDiffAngles& angles, const Cosines& /*cosines*/) {
                               return brdf(ToDirections(angles));
                             },
                             [&](const SphericalAngles& at) { return brdf(ToDirections(at)); }};
  WriteSpherePair(PictureDataOf(shown), material, path, options);
}

}  // namespace

std::vector<std::string> WriteStandard(const ModelFile& file, const std::string& source,
                                       const std::string& path, const ConvertOptions& options) {
  const bool materialx = EndingOf(path) == ".mtlx";
  const double max_angle = file.fit.max_angle > 0 ? file.fit.max_angle : 90;  // [degrees]
  Stopwatch stopwatch;
  const NearestOpenPbr nearest =
      FindNearestOpenPbr(file.model, DegreesToRadians(max_angle), options.appearance);
  const SphereError& error = nearest.error;
  const std::string name = std::filesystem::path(path).filename().string();
  const MaterialNotes notes = {
      .name = name.substr(0, name.size() - (materialx ? 5 : 16)),
      .made = "the nearest OpenPBR to " + source + ", found by " + options.program,
      .error = "beside it on a sphere Delta E is " + Text(error.mean_delta_e, 2) +
               " in the mean, below " + Text(error.delta_e_95, 2) + " for 95 %, PSNR " +
               Text(error.psnr_db, 3) + " dB",
      .lost = VerdictOf(error).visibility == Visibility::kNone
                  ? "lost against the model: nothing to be seen"
                  : "lost against the model, " + Words(VerdictOf(error))};
  const std::string text = materialx ? FormatMaterialX(nearest.material, notes)
                                     : FormatPrincipled(nearest.material, notes);
  WriteFile(path, [&](std::ostream& out) { out << text; });
  std::vector<std::string> lines = {
      "wrote " + path + ": " +
      (materialx ? "open_pbr_surface" : "inputs of Blender's Principled BSDF") + ", " +
      notes.error + "; " + notes.lost + " (" + Text(stopwatch.Lap(), 2) + " s)"};
  if (!options.picture.empty()) {
    DrawStandard(file.model, source, max_angle, OpenPbrBrdf(nearest.material), options.picture,
                 options.appearance);
    lines.push_back("wrote " + options.picture + ": the model, and what the file has");
  }
  return lines;
}

}  // namespace trilobe
