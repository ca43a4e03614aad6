#ifndef TRILOBE_FIT_SCENE_CACHED_FITS_H_
#define TRILOBE_FIT_SCENE_CACHED_FITS_H_

#include <optional>
#include <string>

#include "fit/scene/fit_cache.h"
#include "fit/scene/material_fit.h"

// Fits as entries of the cache, in JSON.
namespace trilobe {

// What is under the key, if it can be decoded. Entries of another version of the program have other
// keys, so one that cannot is a defect, or somebody's work; it is made again.
std::optional<FullFit> CachedFullFit(const FitCache& cache, const std::string& key);
std::optional<MaterialFit> CachedMaterialFit(const FitCache& cache, const std::string& key);

void KeepFit(const FullFit& fit, const std::string& key, const FitCache& cache);
void KeepFit(const MaterialFit& fit, const std::string& key, const FitCache& cache);

}  // namespace trilobe

#endif  // TRILOBE_FIT_SCENE_CACHED_FITS_H_
