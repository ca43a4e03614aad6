#ifndef TRILOBE_IO_FORMATS_MODEL_JSON_H_
#define TRILOBE_IO_FORMATS_MODEL_JSON_H_

#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include "trilobe/model/fit_info.h"

namespace trilobe {

// Functions shared by files of models of all kinds.

using OrderedJson = nlohmann::ordered_json;

// Throws Error, which names the key, unless all are finite and >= 0.
OrderedJson FiniteNumbers(std::span<const double> values, const char* key);

// "fit", with file names in the place of paths; numbers that are not known are left out.
OrderedJson ToJson(FitInfo fit);

// Indented by two, but arrays of numbers each on one line.
std::string TextOf(const OrderedJson& json);

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_MODEL_JSON_H_
