#ifndef TRILOBE_FIT_SCENE_CACHED_FITS_H_
#define TRILOBE_FIT_SCENE_CACHED_FITS_H_

#include <optional>
#include <string>

#include "fit/scene/fit_cache.h"
#include "fit/scene/material_fit.h"
#include "fit/scene/scene_file.h"

// Fits as entries of the cache: their keys, and what is kept, in JSON.
namespace trilobe {

// All that a fit with nothing left out depends on. `source_hash`: ContentHash of what the source
// holds. `purpose` keeps fits apart that are to be timed apart.
std::string FullFitKey(const SceneMaterial& material, const SceneFitSettings& settings,
                       const std::string& source_hash, const std::string& purpose);
// The same of the fit as it is pruned for the scene.
std::string MaterialFitKey(const SceneMaterial& material, const SceneFitSettings& settings,
                           const std::string& source_hash);

// What is under the key, if it can be decoded. Entries of another version of the program have other
// keys, so one that cannot is a defect, or somebody's work; it is made again.
std::optional<FullFit> CachedFullFit(const FitCache& cache, const std::string& key);
std::optional<MaterialFit> CachedMaterialFit(const FitCache& cache, const std::string& key);

void KeepFit(const FullFit& fit, const std::string& key, const FitCache& cache);
void KeepFit(const MaterialFit& fit, const std::string& key, const FitCache& cache);

}  // namespace trilobe

#endif  // TRILOBE_FIT_SCENE_CACHED_FITS_H_
