#ifndef TRILOBE_MODEL_MODEL_SPEC_H_
#define TRILOBE_MODEL_MODEL_SPEC_H_

#include <string>

#include "trilobe/core/geometry/channels.h"
#include "trilobe/core/geometry/merl_grid.h"
#include "trilobe/model/axis.h"
#include "trilobe/model/stretch.h"

namespace trilobe {

inline constexpr int kMaxLobes = 8;

// Whether a factor has a table of its own for each lobe, and for each colour channel.
struct TableSharing {
  bool per_lobe = true;
  bool per_channel = true;
  bool operator==(const TableSharing&) const = default;
};

enum class Factor { kD, kF, kG };
inline constexpr Factor kFactors[] = {Factor::kD, Factor::kF, Factor::kG};
const char* FactorName(Factor factor);  // "D", "F", "G"

// The shape of a model rho_C = d_C + sum_m s_C^m D(h) F(theta_d) G(wi) G(wo) / (cos theta_i cos
// theta_o): how many lobes, which table is shared by what, where the entries of tables stand. The
// paper's isotropic and anisotropic models and the one that it compares with are values of it.
struct ModelSpec {
  int lobes = 3;  // 0 (Lambertian) to kMaxLobes
  TableSharing D{.per_lobe = true, .per_channel = false};
  TableSharing F{.per_lobe = false, .per_channel = true};
  TableSharing G{.per_lobe = true, .per_channel = false};
  Axis d_axis{.rule = Axis::Rule::kRootTheta};  // of theta_h, or of (theta_h, phi_h)
  Axis f_axis{.rule = Axis::Rule::kTheta};      // of theta_d
  Axis g_axis{.rule = Axis::Rule::kSpline};     // of theta, or of (theta, phi)
  Stretches stretches = {};                     // of the highlights, of isotropic models only

  // `lobes` lobes with D, G shared by the channels, F shared by the lobes (paper eq. 3):
  // 822 parameters for three lobes on the MERL grid.
  static ModelSpec SharedFactors(int lobes, const MerlGrid& grid = {});
  // The same with D and G over azimuths, too, on the nodes of UTIA's directions (paper eq. 4):
  // 2,010 parameters for three lobes.
  static ModelSpec Anisotropic(int lobes);
  // The same on the nodes that proved right between samples and beyond them (docs/anisotropic.md),
  // for data with so many phi: D on 12 theta by 36 phi at most, F in 6 bins, G on 6 by 24 at most
  // and, where the data end at the last of these, two rings towards the horizon. No sample reads
  // these, so that canonical forms (gauge.h) continue G to them.
  static ModelSpec AnisotropicFor(int lobes, int data_phis, double data_max_theta);
  // An isotropic form for so many scattered samples: F in 10 bins and G on 9 nodes where there are
  // less than two hundred for each parameter, which then leave bins of F and nodes of G between
  // them to go where they like.
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
  // Whether values change when the material is turned about its normal.
  bool anisotropic() const { return d_axis.polar() || g_axis.polar(); }
  int num_tables(Factor factor) const;

  // The channels that a table serves: [begin, end).
  struct ChannelRange {
    int begin, end;
  };
  ChannelRange channels(Factor factor, int table_index) const {
    const int c = table_index % kChannels;
    return sharing(factor).per_channel ? ChannelRange{c, c + 1} : ChannelRange{0, kChannels};
  }

  // Which table of `factor` serves this lobe and channel, in [0, num_tables).
  int table(Factor factor, int lobe, int channel) const {
    const auto [per_lobe, per_channel] = sharing(factor);
    return (per_lobe ? lobe : 0) * (per_channel ? kChannels : 1) + (per_channel ? channel : 0);
  }
  // True if that table serves this lobe and channel.
  bool serves(Factor factor, int table_index, int lobe, int channel) const {
    return table(factor, lobe, channel) == table_index;
  }
  // By which of the distinct stretches a table of D is read.
  int StretchOfTable(int d_table) const {
    return stretches.index(D.per_lobe ? d_table / (D.per_channel ? kChannels : 1) : 0);
  }
  int num_parameters() const;

  bool operator==(const ModelSpec&) const = default;
};

// Throws Error unless the lobes are in [0, kMaxLobes], the axes are in order (CheckAxis), F one
// of theta_d alone, and the stretches (Stretches::Check), which no anisotropic spec has, and which
// are several only where each lobe has its own D.
void CheckSpec(const ModelSpec& spec);

// Throws Error, which says what `wants` it, if the spec is anisotropic.
void CheckIsotropic(const ModelSpec& spec, const char* wants);

// Throws Error unless a model with the spec `is` is one of the spec `wanted`.
void CheckSameSpec(const ModelSpec& is, const ModelSpec& wanted);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MODEL_SPEC_H_
