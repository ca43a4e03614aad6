#ifndef TRILOBE_FIT_FORM_H_
#define TRILOBE_FIT_FORM_H_

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "trilobe/fit/finish/node_choice.h"
#include "trilobe/model/axis.h"
#include "trilobe/model/measurement/measurement.h"
#include "trilobe/model/model_spec.h"
#include "trilobe/model/stretch.h"

namespace trilobe {

// The form of a model. Errors name a member by its flag of `trilobe fit`.
struct FormOptions {
  enum class Kind {
    kShared,       // channels share D and G, lobes share F; anisotropic if the measurement is (Peng
                   // et al.)
    kIsotropic,    // the same, isotropic for any measurement
    kAnisotropic,  // on the nodes of the paper
    kIndependent,  // one lobe, channels share nothing (Bagher et al.)
  };
  Kind kind = Kind::kShared;
  std::optional<int> lobes = {};  // default: 3, of kIndependent 1
  // Isotropic models:
  Stretches stretches = {};
  // Anisotropic models; the defaults are nodes that the data resolve.
  std::optional<Axis> d_nodes = {}, g_nodes = {};
  std::optional<int> f_bins = {};
  // How nodes of D and G are chosen: as given above or by default; finer than the default where
  // that leaves an error that is seen (FinerNodes); or by ChooseNodes from the coarsest on.
  enum class NodeRule { kFinerWhereSeen, kGiven, kHeldOut };
  NodeRule nodes = NodeRule::kFinerWhereSeen;
};

// A value of --model, and of Python's `model`.
struct NamedForm {
  std::string name;
  FormOptions::Kind kind;
  std::string description;
  std::optional<int> lobes = {};  // if there is no choice
  bool chosen = false;  // the fit begins with this kind, and chooses another if it looks better
};
const std::vector<NamedForm>& NamedForms();
// Throws Error, which lists the known names, for others.
const NamedForm& FindForm(std::string_view name);

// The lobes of the form, given or by default.
int LobesOf(const FormOptions& options);

// Throws Error for options that contradict each other.
void CheckForm(const FormOptions& options);

// The spec for a measurement with this number of samples to fit. Default: the paper's isotropic
// spec; if azimuths were measured and matter, an anisotropic spec on nodes that the data resolve;
// smaller tables for few scattered samples. Throws Error for options that contradict each other or
// the measurement.
ModelSpec SpecFor(const Measurement& measurement, const FormOptions& options, int num_samples);

// The NamedForm that a spec has: "shared", "independent" or "anisotropic"; else "other".
std::string ModelName(const ModelSpec& spec);

// Candidates for ChooseNodes; empty without NodeRule::kHeldOut. Throws Error for an isotropic spec.
std::vector<FormSpec> NodesToTry(const Measurement& measurement, const FormOptions& options,
                                 const ModelSpec& spec);

// The spec on its own nodes and on finer ones, coarse to fine, where the data are directions on a
// grid and nothing but defaults decided on the nodes; else nothing.
std::vector<FormSpec> FinerNodes(const Measurement& measurement, const FormOptions& options,
                                 const ModelSpec& spec);

}  // namespace trilobe

#endif  // TRILOBE_FIT_FORM_H_
