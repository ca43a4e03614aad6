#ifndef TRILOBE_FIT_SCENE_CACHED_FITS_H_
#define TRILOBE_FIT_SCENE_CACHED_FITS_H_

#include <optional>
#include <string>

#include "fit/scene/fit_cache.h"
#include "fit/scene/material_fit.h"
#include "fit/scene/scene_file.h"

// Fits in the cache: their keys, and their content as JSON.
namespace trilobe {

// Key of a full fit: everything that it depends on. `source_hash`: ContentHash of the source.
// `purpose` separates fits that are timed separately.
std::string FullFitKey(const SceneMaterial& material, const SceneFitSettings& settings,
                       const std::string& source_hash, const std::string& purpose);
// Key of the fit pruned for the scene.
std::string MaterialFitKey(const SceneMaterial& material, const SceneFitSettings& settings,
                           const std::string& source_hash);

// The cached fit of a key. Nothing if there is none or it cannot be decoded; it is then made again.
// Another version of the program has other keys.
std::optional<FullFit> CachedFullFit(const FitCache& cache, const std::string& key);
std::optional<MaterialFit> CachedMaterialFit(const FitCache& cache, const std::string& key);

void KeepFit(const FullFit& fit, const std::string& key, const FitCache& cache);
void KeepFit(const MaterialFit& fit, const std::string& key, const FitCache& cache);

}  // namespace trilobe

#endif  // TRILOBE_FIT_SCENE_CACHED_FITS_H_
