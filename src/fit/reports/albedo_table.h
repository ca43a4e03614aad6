#ifndef TRILOBE_FIT_REPORTS_ALBEDO_TABLE_H_
#define TRILOBE_FIT_REPORTS_ALBEDO_TABLE_H_

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "trilobe/model/measurement/albedo.h"

namespace trilobe {

// Directional albedo at every whole degree from 0 to 89, or to the last one that was measured.
struct AlbedoTable {
  std::vector<double> theta_i;  // [rad]
  std::vector<Rgb> albedo;
};

// `max_theta` [rad] is the largest theta_i of interest.
AlbedoTable TabulateAlbedo(const BrdfFunction& brdf, int num_threads, double max_theta = kPi / 2);

// Some of its rows, and where each channel passes 1, on standard output.
void Print(const AlbedoTable& table, const std::string& title = "directional albedo");

// All of it: {"theta_i_deg": [...], "red": [...], ..., "passes_one_deg": {"red": null, ...}}.
nlohmann::ordered_json ToJson(const AlbedoTable& table);

}  // namespace trilobe

#endif  // TRILOBE_FIT_REPORTS_ALBEDO_TABLE_H_
