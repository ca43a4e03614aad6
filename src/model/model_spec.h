#ifndef TRILOBE_MODEL_MODEL_SPEC_H_
#define TRILOBE_MODEL_MODEL_SPEC_H_

#include <string>

#include "trilobe/brdf/channels.h"
#include "trilobe/brdf/merl_grid.h"

namespace trilobe {

inline constexpr int kMaxLobes = 8;
inline constexpr int kMaxTableSize = 1024;

// Whether a factor has a table of its own for each lobe, and for each colour channel.
struct TableSharing {
  bool per_lobe = true;
  bool per_channel = true;
  bool operator==(const TableSharing&) const = default;
};

enum class Factor { kD, kF, kG };
inline constexpr Factor kFactors[] = {Factor::kD, Factor::kF, Factor::kG};
const char* FactorName(Factor factor);  // "D", "F", "G"

// The shape of a model rho_C = d_C + sum_m s_C^m D(theta_h) F(theta_d) G(theta_i) G(theta_o) /
// (cos theta_i cos theta_o): how many lobes, which table is shared by what, how long tables are.
// The paper's isotropic model and the one that it compares with are two values of this type.
struct ModelSpec {
  int lobes = 3;  // 0 (Lambertian) to kMaxLobes
  TableSharing D{.per_lobe = true, .per_channel = false};
  TableSharing F{.per_lobe = false, .per_channel = true};
  TableSharing G{.per_lobe = true, .per_channel = false};
  int d_bins = 90;  // D: one entry a theta_h bin of the MERL grid
  int f_bins = 90;  // F: one entry a theta_d bin
  int g_nodes =
      90;  // G: nodes at theta = (k + 1/2) 90/g_nodes degrees, a Catmull-Rom spline between

  // `lobes` lobes with D, G shared by the channels, F shared by the lobes (paper eq. 3):
  // 822 numbers for three lobes on the MERL grid.
  static ModelSpec SharedFactors(int lobes, const MerlGrid& grid = {});
  // One lobe, nothing shared between channels (Bagher et al. 2016): 816 numbers.
  static ModelSpec IndependentG(const MerlGrid& grid = {});

  const TableSharing& sharing(Factor factor) const {
    return factor == Factor::kD ? D : factor == Factor::kF ? F : G;
  }
  int table_size(Factor factor) const {
    return factor == Factor::kD ? d_bins : factor == Factor::kF ? f_bins : g_nodes;
  }
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
  int num_parameters() const;

  bool operator==(const ModelSpec&) const = default;
};

// Throws Error unless the lobes are in [0, kMaxLobes] and every table has 4 to kMaxTableSize
// entries.
void CheckSpec(const ModelSpec& spec);

// Throws Error unless a model with the spec `is` is one of the spec `wanted`.
void CheckSameSpec(const ModelSpec& is, const ModelSpec& wanted);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MODEL_SPEC_H_
