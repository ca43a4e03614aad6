#include "app/fit_name.h"

#include <filesystem>

#include "trilobe/io/formats/source.h"

namespace trilobe {

std::string FitNameOf(const std::string& source) {
  if (IsSynthetic(source)) return SynthSourceOf(source).material.name;
  const std::filesystem::path file = std::filesystem::path(source).filename();
  const std::string name = file.stem().string();
  // As "." is of "..csv": then the whole name will do.
  const bool taken = name == "." || name == ".." || name == kTableName || name == kPageName;
  return taken ? file.string() : name;
}

}  // namespace trilobe
