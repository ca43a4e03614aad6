#include <nlohmann/json.hpp>
#include <optional>
#include <span>

#include "app/describe.h"
#include "app/flags.h"
#include "app/inputs.h"
#include "fit/reports/bands_report.h"
#include "fit/reports/ggx_lobe.h"
#include "fit/reports/model_report.h"
#include "fit/reports/print.h"
#include "io/formats/stretch_json.h"
#include "model/objective/gauge.h"
#include "trilobe/io/formats/model_file.h"
#include "trilobe/model/appearance/material.h"

namespace trilobe {
namespace {

using Json = nlohmann::ordered_json;

// " (6 theta to 75 deg x 48 phi)", of tables of both.
std::string NodesText(const Axis& axis) {
  if (!axis.polar()) return "";
  return " (" + std::to_string(axis.theta.size()) + " theta to " + Text(axis.theta.back()) +
         " deg x " + std::to_string(axis.phi_nodes) + " phi)";
}

std::string SharingText(const ModelSpec& spec, Factor factor) {
  const TableSharing& sharing = spec.sharing(factor);
  const std::string tables = std::to_string(spec.num_tables(factor)) + " x " +
                             std::to_string(spec.table_size(factor)) +
                             NodesText(spec.axis(factor)) + ", ";
  if (sharing.per_lobe && sharing.per_channel) return tables + "one for each lobe and channel";
  if (sharing.per_lobe) return tables + "one for each lobe, shared by the channels";
  if (sharing.per_channel) return tables + "one for each channel, shared by the lobes";
  return tables + "shared by all";
}

// Parameters that the file stores of all tables of one factor.
int CountStored(const ModelFile& file, Factor factor) {
  int count = 0;
  for (const std::vector<int>& nodes : file.layout->nodes[static_cast<int>(factor)]) {
    count += static_cast<int>(nodes.size());
  }
  return count;
}

// Unobserved entries of all tables of one factor.
int CountUnobserved(const ModelFile& file, Factor factor) {
  const ModelSpec& spec = file.model.spec();
  int count = 0;
  for (int i = 0; i < spec.num_tables(factor) * spec.table_size(factor); ++i) {
    if (file.unobserved[file.model.TableOffset(factor, 0) + i]) ++count;
  }
  return count;
}

// BRDF for light along `phi_i` [rad].
BrdfFunction BrdfOf(const FactorModel& model, double phi_i) {
  return [brdf = MaterialOf(model).spherical, phi_i](const DirectionPair& pair) {
    SphericalAngles at = ToSphericalAngles(pair);
    at.phi_i += phi_i;
    at.phi_o += phi_i;
    return brdf(at);
  };
}

Rgb ToRgb(std::span<const double> values) { return {values[0], values[1], values[2]}; }

Json ToJson(const std::optional<GgxLobe>& lobe) {
  if (!lobe) return nullptr;
  return {{"alpha_x", lobe->alpha_x},
          {"alpha_y", lobe->alpha_y},
          {"turn_deg", RadiansToDegrees(lobe->turn)},
          {"f0", lobe->f0},
          {"elsewhere", lobe->elsewhere}};
}

}  // namespace

void DescribeModel(const std::string& path) {
  const ModelFile file = ModelOfSource(path);
  const FactorModel& model = file.model;
  const ModelSpec& spec = model.spec();
  const FitInfo& fit = file.fit;
  const AlbedoTable albedo = TabulateAlbedo(BrdfOf(model, 0), ThreadsFromFlags());
  std::optional<AlbedoTable> across;
  if (spec.anisotropic()) across = TabulateAlbedo(BrdfOf(model, kPi / 2), ThreadsFromFlags());
  const LobeLight light = ComputeLobeLight(ObservedEntries(file.unobserved), model);

  if (FLAGS_json) {
    Json json = {
        {"file", path},
        {"kind", "model"},
        {"anisotropic", spec.anisotropic()},
        {"lobes", spec.lobes},
        {"parameters", file.spectral ? file.spectral->num_parameters() : spec.num_parameters()},
        {"d", ToRgb(model.d())},
        {"s", Json::array()}};
    for (int m = 0; m < spec.lobes; ++m) json["s"].push_back(ToRgb(model.s(m)));
    json["ggx"] = Json::array();
    for (int m = 0; m < spec.lobes; ++m) json["ggx"].push_back(ToJson(NearestGgx(model, m)));
    json["wavelengths"] = file.spectral ? Json(file.spectral->wavelengths()) : Json();
    json["light"] = ToJson(light);
    for (const Factor factor : kFactors) {
      const TableSharing& sharing = spec.sharing(factor);
      json["tables"][FactorName(factor)] = {{"count", spec.num_tables(factor)},
                                            {"size", spec.table_size(factor)},
                                            {"per_lobe", sharing.per_lobe},
                                            {"per_channel", sharing.per_channel},
                                            {"unobserved", CountUnobserved(file, factor)}};
      if (file.layout) json["tables"][FactorName(factor)]["stored"] = CountStored(file, factor);
    }
    json["stored_parameters"] = file.layout.value_or(TableLayout::Full(spec)).num_parameters(spec);
    json["stretch"] = StretchesToJson<Json>(spec);
    json["fit"] = {{"source", fit.source},
                   {"source_xxh128", fit.source_xxh128},
                   {"solver", fit.solver},
                   {"init", fit.init},
                   {"weighting", fit.weighting},
                   {"objective", fit.objective},
                   {"initial_objective", fit.initial_objective},
                   {"iterations", fit.iterations},
                   {"seconds", fit.seconds},
                   {"stop_reason", fit.stop_reason},
                   {"valid_samples", fit.valid_samples},
                   {"max_angle", fit.max_angle},
                   {"program", fit.program},
                   {"date", fit.date}};
    json["albedo"] = ToJson(albedo);
    if (across) json["albedo_across"] = ToJson(*across);
    PrintJson(json);
    return;
  }
  PrintLine("file", path);
  PrintLine("kind", std::string(spec.anisotropic() ? "anisotropic " : "") + "model, " +
                        std::to_string(spec.lobes) + " lobes, " +
                        std::to_string(spec.num_parameters()) + " parameters");
  if (file.spectral) {
    PrintLine("wavelengths", WavelengthsText(*file.spectral) + ", by " +
                                 std::to_string(file.spectral->num_parameters()) +
                                 " parameters; what follows is " +
                                 (file.spectral->bands() > 1 ? "their colour, RGB" : "of it"));
  }
  if (file.layout) {
    PrintLine("stored", std::to_string(file.layout->num_parameters(spec)) + " parameters, and " +
                            std::to_string(file.layout->num_places(spec)) + " places of nodes");
  }
  if (spec.stretches.any()) {
    PrintLine("stretch", DescribeStretches(spec) + " (exponents of 1 / cos theta_d)");
  }
  for (const Factor factor : kFactors) {
    const int unobserved = CountUnobserved(file, factor);
    PrintLine(
        std::string("  ") + FactorName(factor),
        SharingText(spec, factor) +
            (file.layout ? "; " + std::to_string(CountStored(file, factor)) + " stored" : "") +
            (unobserved > 0 ? "; " + std::to_string(unobserved) + " entries without data" : ""));
  }
  PrintLine("d, RGB", Text(ToRgb(model.d())) + " /sr; reflects " +
                          Text(100 * light.DiffuseShare(), 3) + " % of the light, albedo " +
                          Text(light.diffuse));
  for (int m = 0; m < spec.lobes; ++m) {
    const Rgb s = ToRgb(model.s(m));
    PrintLine("s of lobe " + std::to_string(m + 1) + ", RGB",
              s == Rgb{} ? "0: absent"
                         : Text(s) + "; reflects " + Text(100 * light.Share(m), 3) +
                               " % of the light, albedo " + Text(light.lobes[m]) +
                               (light.nearly_diffuse[m] ? "; nearly diffuse" : ""));
    if (const std::optional<GgxLobe> ggx = NearestGgx(model, m)) {
      PrintLine("  as GGX", GgxText(*ggx));
    }
  }
  if (!fit.source.empty()) PrintLine("fitted to", fit.source);
  if (!fit.solver.empty()) {
    PrintLine("solver", fit.solver + ", init " + fit.init + ", " + std::to_string(fit.iterations) +
                            " iterations, " + Text(fit.seconds, 3) +
                            " s, stopped: " + fit.stop_reason);
    PrintLine("objective E", Text(fit.objective, 10) + ", weighting " + fit.weighting + ", " +
                                 std::to_string(fit.valid_samples) + " valid samples");
  }
  if (!fit.program.empty()) PrintLine("written by", fit.program + " " + fit.date);
  Print(albedo, across ? "directional albedo, light along x" : "directional albedo");
  if (across) Print(*across, "directional albedo, light along y");
}

}  // namespace trilobe
