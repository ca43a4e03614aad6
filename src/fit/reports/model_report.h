#ifndef TRILOBE_FIT_REPORTS_MODEL_REPORT_H_
#define TRILOBE_FIT_REPORTS_MODEL_REPORT_H_

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "trilobe/model/measurement/albedo.h"
#include "trilobe/model/model_spec.h"
#include "trilobe/model/objective/lobe_light.h"

namespace trilobe {

// "along 0.5, across -0.2", or that for each lobe if they differ.
std::string DescribeStretches(const ModelSpec& spec);

// "lobe 1 62 %, lobe 2 20 %, diffuse 18 %".
std::string Describe(const LobeLight& light);

// "light" in report.json and of `info --json`: albedo and share of the diffuse term and of each
// lobe.
nlohmann::ordered_json ToJson(const LobeLight& light);

// Directional albedo at each degree from 0 to 89, or to the largest measured one.
struct AlbedoTable {
  std::vector<double> theta_i;  // [rad]
  std::vector<Rgb> albedo;
};

// `max_theta` [rad] is the largest theta_i of interest.
AlbedoTable TabulateAlbedo(const BrdfFunction& brdf, int num_threads, double max_theta = kPi / 2);

// Prints some rows, and where each channel passes 1, on standard output.
void Print(const AlbedoTable& table, const std::string& title = "directional albedo");

// {"theta_i_deg": [...], "red": [...], ..., "passes_one_deg": {"red": null, ...}}.
nlohmann::ordered_json ToJson(const AlbedoTable& table);

}  // namespace trilobe

#endif  // TRILOBE_FIT_REPORTS_MODEL_REPORT_H_
