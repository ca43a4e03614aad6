#ifndef TRILOBE_FIT_FORM_H_
#define TRILOBE_FIT_FORM_H_

#include <optional>
#include <string>
#include <vector>

#include "trilobe/fit/prior/node_choice.h"
#include "trilobe/model/axis.h"
#include "trilobe/model/measurement/measurement.h"
#include "trilobe/model/model_spec.h"
#include "trilobe/model/stretch.h"

namespace trilobe {

// Which form a model of a measurement is to have, where it is not the default. Errors call a member
// by the flag of `trilobe fit` that sets it.
struct FormOptions {
  enum class Kind {
    kShared,       // D and G shared by the channels, F by the lobes; anisotropic where the
                   // measurement is (Peng et al.)
    kIsotropic,    // the same, though the measurement is anisotropic
    kAnisotropic,  // on the nodes of the paper
    kIndependent,  // one lobe, nothing shared by the channels (Bagher et al.)
  };
  Kind kind = Kind::kShared;
  std::optional<int> lobes = {};  // 3 without it; of kIndependent 1
  // Of isotropic models:
  Stretches stretches = {};
  // Of anisotropic ones, in the place of those that the data can tell apart:
  std::optional<Axis> d_nodes = {}, g_nodes = {};
  std::optional<int> f_bins = {};
  bool nodes_by_held_out = false;  // D's and G's, as ChooseNodes finds them
};

// Throws Error for what contradicts itself, whatever the measurement is.
void CheckForm(const FormOptions& options);

// The form for this measurement, of which so many samples count: the paper's isotropic one by
// default, or where azimuths were measured and matter an anisotropic one, on nodes that the data
// can tell apart; with smaller tables for few scattered samples. Throws Error for options that
// contradict each other or the measurement.
ModelSpec SpecFor(const Measurement& measurement, const FormOptions& options, int num_samples);

// The value of --model that stands for a spec, which a model file may have brought: "shared",
// "independent", "anisotropic" or "other".
std::string ModelName(const ModelSpec& spec);

// Nodes to choose from for this form; empty without nodes_by_held_out. Throws Error for an
// isotropic spec.
std::vector<NodeCandidate> NodesToTry(const Measurement& measurement, const FormOptions& options,
                                      const ModelSpec& spec);

}  // namespace trilobe

#endif  // TRILOBE_FIT_FORM_H_
