#ifndef TRILOBE_MODEL_MODEL_SPEC_H_
#define TRILOBE_MODEL_MODEL_SPEC_H_

#include <string>

#include "trilobe/core/base/channels.h"
#include "trilobe/core/base/merl_grid.h"
#include "trilobe/model/axis.h"
#include "trilobe/model/stretch.h"

namespace trilobe {

inline constexpr int kMaxLobes = 8;

// Whether a factor has a separate table for each lobe, and for each colour channel.
struct TableSharing {
  bool per_lobe = true;
  bool per_channel = true;
  bool operator==(const TableSharing&) const = default;
};

enum class Factor { kD, kF, kG };
inline constexpr Factor kFactors[] = {Factor::kD, Factor::kF, Factor::kG};
const char* FactorName(Factor factor);  // "D", "F", "G"

// The structure of a model rho_C = d_C + sum_m s_C^m D(h) F(theta_d) G(wi) G(wo) / (cos theta_i cos
// theta_o): number of lobes, sharing of tables, and positions of their entries. It covers the
// paper's isotropic and anisotropic models and the model that the paper compares with.
struct ModelSpec {
  int lobes = 3;  // 0 (Lambertian) to kMaxLobes
  TableSharing D{.per_lobe = true, .per_channel = false};
  TableSharing F{.per_lobe = false, .per_channel = true};
  TableSharing G{.per_lobe = true, .per_channel = false};
  Axis d_axis{.rule = Axis::Rule::kRootTheta};  // of theta_h, or of (theta_h, phi_h)
  Axis f_axis{.rule = Axis::Rule::kTheta};      // of theta_d
  Axis g_axis{.rule = Axis::Rule::kSpline};     // of theta, or of (theta, phi)
  Stretches stretches = {};                     // of highlights; isotropic models only

  // D and G shared by the channels, F shared by the lobes (paper eq. 3): 822 parameters for three
  // lobes on the MERL grid.
  static ModelSpec SharedFactors(int lobes, const MerlGrid& grid = {});
  // The same with D and G also over azimuths, on UTIA's nodes (paper eq. 4): 2,010 parameters for
  // three lobes.
  static ModelSpec Anisotropic(int lobes);
  // The same on nodes that generalise better between and beyond samples (docs/forms.md), for
  // data with `data_phis` azimuths: D on at most 12 theta by 36 phi, F in 6 bins, G on at most 6 by
  // 24. If the data end at the last theta of G, two rings towards the horizon follow, which no
  // sample reads and to which the canonical form (gauge.h) extrapolates G.
  static ModelSpec AnisotropicFor(int lobes, int data_phis, double data_max_theta);
  // An isotropic spec for scattered samples: F in 10 bins and G on 9 nodes if there are fewer than
  // 200 samples per parameter, which would leave some bins of F and nodes of G poorly determined.
  ModelSpec ForScattered(int num_samples) const;
  // One lobe, nothing shared between channels (Bagher et al. 2016): 816 parameters.
  static ModelSpec IndependentG(const MerlGrid& grid = {});

  const TableSharing& sharing(Factor factor) const {
    return factor == Factor::kD ? D : factor == Factor::kF ? F : G;
  }
  const Axis& axis(Factor factor) const {
    return factor == Factor::kD ? d_axis : factor == Factor::kF ? f_axis : g_axis;
  }
  int table_size(Factor factor) const { return axis(factor).size; }
  // Whether values change when the material is rotated about its normal.
  bool anisotropic() const { return d_axis.polar() || g_axis.polar(); }
  int num_tables(Factor factor) const;

  // The channels of a table: [begin, end).
  struct ChannelRange {
    int begin, end;
  };
  ChannelRange channels(Factor factor, int table_index) const {
    const int c = table_index % kChannels;
    return sharing(factor).per_channel ? ChannelRange{c, c + 1} : ChannelRange{0, kChannels};
  }

  // The table of `factor` for a lobe and channel, in [0, num_tables).
  int table(Factor factor, int lobe, int channel) const {
    const auto [per_lobe, per_channel] = sharing(factor);
    return (per_lobe ? lobe : 0) * (per_channel ? kChannels : 1) + (per_channel ? channel : 0);
  }
  // Whether a table is that of a lobe and channel.
  bool serves(Factor factor, int table_index, int lobe, int channel) const {
    return table(factor, lobe, channel) == table_index;
  }
  // Index of the distinct stretch of a table of D.
  int StretchOfTable(int d_table) const {
    return stretches.index(D.per_lobe ? d_table / (D.per_channel ? kChannels : 1) : 0);
  }
  int num_parameters() const;

  bool operator==(const ModelSpec&) const = default;
};

// Throws Error unless lobes is in [0, kMaxLobes], the axes are valid (CheckAxis), F is over theta_d
// alone, and the stretches are valid (Stretches::Check). Anisotropic specs must have no stretch;
// several stretches need a D per lobe.
void CheckSpec(const ModelSpec& spec);

// Throws Error, naming what `wants` an isotropic spec, if the spec is anisotropic.
void CheckIsotropic(const ModelSpec& spec, const char* wants);

// Throws Error unless the spec of a model, `is`, equals `wanted`.
void CheckSameSpec(const ModelSpec& is, const ModelSpec& wanted);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MODEL_SPEC_H_
