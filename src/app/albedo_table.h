#ifndef TRILOBE_APP_ALBEDO_TABLE_H_
#define TRILOBE_APP_ALBEDO_TABLE_H_

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "trilobe/model/albedo.h"

namespace trilobe {

// Directional albedo at every whole degree from 0 to 89.
struct AlbedoTable {
  std::vector<double> theta_i;  // [rad]
  std::vector<Rgb> albedo;
};

AlbedoTable TabulateAlbedo(const BrdfFunction& brdf, int num_threads);

// Some of its rows, and where each channel passes 1, on standard output.
void Print(const AlbedoTable& table);

// All of it: {"theta_i_deg": [...], "red": [...], ..., "passes_one_deg": {"red": null, ...}}.
nlohmann::ordered_json ToJson(const AlbedoTable& table);

}  // namespace trilobe

#endif  // TRILOBE_APP_ALBEDO_TABLE_H_
