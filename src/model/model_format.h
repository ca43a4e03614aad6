#ifndef TRILOBE_MODEL_MODEL_FORMAT_H_
#define TRILOBE_MODEL_MODEL_FORMAT_H_

namespace trilobe {

// Shared by the reader and the writer of model files.

inline constexpr const char* kModelFormat = "trilobe-model";
inline constexpr int kModelVersion = 1;
// Version for models with stretched highlights, which readers of version 1 would evaluate wrongly.
inline constexpr int kStretchedVersion = 2;
// Version for spectral models, with or without such highlights.
inline constexpr int kSpectralVersion = 3;
inline constexpr const char* kIsotropicKind = "isotropic";
inline constexpr const char* kAnisotropicKind = "anisotropic";

// Calls visit(key, member) for every member.
template <typename Info, typename Visitor>
void VisitFitInfo(Info* fit, const Visitor& visit) {
  visit("solver", &fit->solver);
  visit("init", &fit->init);
  visit("weighting", &fit->weighting);
  visit("objective", &fit->objective);
  visit("solver_objective", &fit->solver_objective);
  visit("initial_objective", &fit->initial_objective);
  visit("stop_reason", &fit->stop_reason);
  visit("iterations", &fit->iterations);
  visit("seconds", &fit->seconds);
  visit("threads", &fit->threads);
  visit("source", &fit->source);
  visit("source_xxh128", &fit->source_xxh128);
  visit("valid_samples", &fit->valid_samples);
  visit("max_angle", &fit->max_angle);
  visit("program", &fit->program);
  visit("date", &fit->date);
  visit("run", &fit->run);
  visit("key", &fit->key);
}

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MODEL_FORMAT_H_
