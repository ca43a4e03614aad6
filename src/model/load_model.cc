#include "trilobe/model/load_model.h"

#include "core/base/names.h"
#include "model/material_files.h"
#include "trilobe/core/base/error.h"

namespace trilobe {
namespace {

constexpr std::string_view kAbout = "materials.json", kEnding = ".json";

}  // namespace

bool IsMaterial(std::string_view path) { return path.starts_with(kMaterialPrefix); }

std::vector<std::string_view> MaterialNames() {
  std::vector<std::string_view> names;
  for (const EmbeddedFile& file : MaterialFiles()) {
    if (file.name != kAbout && file.name.ends_with(kEnding)) {
      names.push_back(file.name.substr(0, file.name.size() - kEnding.size()));
    }
  }
  return names;
}

std::string_view MaterialText(std::string_view path) {
  const std::string name(path.substr(kMaterialPrefix.size()));
  for (const EmbeddedFile& file : MaterialFiles()) {
    if (file.name == name + std::string(kEnding) && file.name != kAbout) return file.text;
  }
  const std::vector<std::string_view> known = MaterialNames();
  if (known.empty()) {
    throw Error(ErrorKind::kMissing, std::string(path) + ": this was built without materials")
        .At(path)
        .About("materials");
  }
  const std::string meant = MeantName(name, known);
  throw Error(
      ErrorKind::kUnknown,
      std::string(path) + ": there is no material of this name; " +
          (meant.empty() ? "" : "did you mean '" + std::string(kMaterialPrefix) + meant + "'? ") +
          "`trilobe materials` lists all")
      .At(path)
      .About("material", name);
}

ModelFile LoadModel(const std::string& path) {
  if (path.starts_with("synth:")) {
    throw ErrorIn(ErrorKind::kUnsupported, path,
                  "this is a measurement; a model is a model.json that `trilobe fit` "
                  "wrote, or material:NAME");
  }
  if (IsMaterial(path)) return ParseModel(MaterialText(path), path);
  return ReadModel(path);
}

}  // namespace trilobe
