#ifndef TRILOBE_MODEL_LOAD_MODEL_H_
#define TRILOBE_MODEL_LOAD_MODEL_H_

#include <string>
#include <string_view>
#include <vector>

#include "trilobe/model/read_model.h"

namespace trilobe {

// Fitted models of measured materials come with the library (materials/README.md): "material:NAME"
// stands for one.
inline constexpr std::string_view kMaterialPrefix = "material:";
bool IsMaterial(std::string_view path);

// Names of the materials, in alphabetical order.
std::vector<std::string_view> MaterialNames();

// The text of the model file that material:NAME stands for. Throws Error for a name that there is
// none of, with one that is like it.
std::string_view MaterialText(std::string_view path);

// A model file, or the model of material:NAME. Throws Error, for a synthetic measurement, too.
ModelFile LoadModel(const std::string& path);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_LOAD_MODEL_H_
