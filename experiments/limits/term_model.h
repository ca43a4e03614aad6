#ifndef TRILOBE_EXPERIMENTS_LIMITS_TERM_MODEL_H_
#define TRILOBE_EXPERIMENTS_LIMITS_TERM_MODEL_H_

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "trilobe/core/base/channels.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/core/base/stencil.h"
#include "trilobe/model/axis.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/spectral_model.h"
#include "trilobe/model/stretch.h"

// Models of any terms, of which the paper's is one. A model over channels c is
//   rho_c = sum_t s_tc R_t1c R_t2c ... [/ (cos theta_i cos theta_o)],
// where s are the strengths of term t and each R is what the term reads of a table. Isotropic.
namespace trilobe {

// The angle at which a table T is read, and the formula that is applied to the value.
enum class Site {
  kHalf,        // T(theta_h), by the stretch of the read
  kDifference,  // T(theta_d)
  // T of the angle between the normal and the half vector of wo and the mirrored wi: 0 where light
  // returns to where it came from, as by reflective tape.
  kRetroHalf,
  kInTimesOut,  // T(theta_i) T(theta_o)
  // 1 / (1 + T(theta_i) + T(theta_o)): T is Smith's Lambda, and heights of masking and shadowing
  // are correlated (Heitz 2014, eq. 99).
  kHeightCorrelated,
  // 1 / (1 + max + l min) of T(theta_i) and T(theta_o): their azimuths, too. l = 4.41 p / (4.41 p +
  // 1), p the angle between the azimuths of wi and wo [rad] (van Ginneken et al. 1998).
  kDirectionCorrelated,
};
inline constexpr Site kSites[] = {
    Site::kHalf,       Site::kDifference,       Site::kRetroHalf,
    Site::kInTimesOut, Site::kHeightCorrelated, Site::kDirectionCorrelated};
const char* SiteName(Site site);  // "half", ... in model files
// Whether the site reads a table twice, at theta_i and at theta_o.
inline bool IsPair(Site site) { return site >= Site::kInTimesOut; }

// Tables over one axis.
struct TableSet {
  std::string name;  // "D"
  Axis axis;         // not polar
  int count = 1;     // tables, times the channels with per_channel
  bool per_channel = false;
  bool fixed = false;  // by a formula; no solver moves it

  bool operator==(const TableSet&) const = default;
};

struct TermRead {
  int set = 0, table = 0;  // table `table` of set `set`, of the channel with per_channel
  Site site = Site::kHalf;
  Stretch stretch = {};

  bool operator==(const TermRead&) const = default;
};

struct Term {
  std::string name;  // "lobe 1"
  std::vector<TermRead> reads;
  bool over_cosines = false;

  bool operator==(const Term&) const = default;
};

struct TermSpec {
  int channels = kChannels;
  std::vector<TableSet> sets;
  std::vector<Term> terms;

  // The paper's form, and all others of a FactorModel: d, then a term a lobe, which reads D, F and
  // G. Throws Error if it is anisotropic.
  static TermSpec Of(const ModelSpec& spec, int channels = kChannels);

  bool operator==(const TermSpec&) const = default;
};

inline constexpr int kMaxTermChannels = 64;
inline constexpr int kMaxTerms = 16;
inline constexpr int kMaxReads = 4;  // of a term

// Throws Error unless there are 1 to kMaxTermChannels channels, up to kMaxTerms terms and sets, and
// kMaxReads reads a term, of tables that there are, axes valid, and stretches within their bounds.
void CheckTerms(const TermSpec& spec);

// The parameters of such a model, all >= 0: strengths by term, then tables by set. A value type.
//
//   TermModel model = TermModel::Of(fitted);                // a FactorModel's values
//   model.strength(0)[2] = 0.1;                             // of the first term, in blue
//   const std::vector<double> rho = Evaluate(model, pair);  // [channels]
class TermModel {
 public:
  // All zeros. Throws Error for an invalid spec.
  explicit TermModel(TermSpec spec);
  // The same function as the model; of a spectral one, a channel a wavelength.
  static TermModel Of(const FactorModel& model);
  static TermModel Of(const SpectralModel& model);

  const TermSpec& spec() const { return spec_; }
  std::span<double> parameters() { return values_; }
  std::span<const double> parameters() const { return values_; }
  // Number of parameters that a solver may move.
  int num_parameters() const;

  std::span<double> strength(int term) {  // [channels]
    return std::span<double>(values_).subspan(StrengthOffset(term), spec_.channels);
  }
  std::span<const double> strength(int term) const {
    return std::span<const double>(values_).subspan(StrengthOffset(term), spec_.channels);
  }
  std::span<double> table(int set, int table, int channel) {  // [sets[set].axis.size]
    return std::span<double>(values_).subspan(TableOffset(set, table, channel), SizeOf(set));
  }
  std::span<const double> table(int set, int table, int channel) const {
    return std::span<const double>(values_).subspan(TableOffset(set, table, channel), SizeOf(set));
  }

  // Places in parameters().
  int StrengthOffset(int term) const { return term * spec_.channels; }
  int TableOffset(int set, int table, int channel) const {
    const TableSet& tables = spec_.sets[set];
    const int number = tables.per_channel ? table * spec_.channels + channel : table;
    return set_begin_[set] + number * tables.axis.size;
  }
  // The strengths of each term, then each table, in order.
  std::vector<FactorModel::Part> Parts() const;

 private:
  size_t SizeOf(int set) const { return static_cast<size_t>(spec_.sets[set].axis.size); }

  TermSpec spec_;
  std::vector<int> set_begin_;
  std::vector<double> values_;
};

// Reads the tables of a spec for a pair of directions. Reads of the same axis, site and stretch
// share their stencils.
class TermReader {
 public:
  explicit TermReader(const TermSpec& spec);

  struct Place {
    Stencil in, out;             // `out` only of a pair
    double inverse_cosines = 0;  // of a pair; splined where the axis is
  };
  struct At {
    std::vector<Place> places;   // [num_places]
    double inverse_cosines = 0;  // 1 / (cos theta_i cos theta_o), of terms without a pair
    double correlation = 1;      // l of kDirectionCorrelated
  };
  At StencilsAt(const HalfDiffAngles& angles) const;

  int num_places() const { return static_cast<int>(lookups_.size()); }
  // Number of the place that a read of a term uses.
  int PlaceOf(int term, int read) const { return place_[term][read]; }
  double InverseCosines(const At& at, int term) const {
    const int pair = pair_[term];
    return pair < 0 ? at.inverse_cosines : at.places[pair].inverse_cosines;
  }

 private:
  struct Lookup {
    Axis axis;
    Site site;
    Stretch stretch;
  };
  std::vector<Lookup> lookups_;
  std::vector<std::vector<int>> place_;  // [terms][reads]
  std::vector<int> pair_;                // [terms]: the place of its pair, or -1
};

// A read's value and its derivatives by the two lookups of a pair, or by one.
struct ReadValue {
  double value = 0, by_in = 0, by_out = 0;
};
ReadValue ValueOfRead(Site site, double in, double out, double correlation);

// The values at a place, as E compares them with a measurement: below 0 where a spline undershoots.
// rho: [channels].
void UnclampedValues(const TermModel& model, const TermReader& reader, const TermReader::At& at,
                     std::span<double> rho);

// The model's BRDF [1/sr] in RGB, of directions above the surface: of channels that are wavelengths
// [nm], the colour, of which channels below 0 are 0; without wavelengths they are R, G and B.
std::function<Rgb(const HalfDiffAngles&)> RgbOf(const TermModel& model,
                                                const std::vector<double>& wavelengths);

// BRDF [1/sr] of each channel; 0 if a direction is below the surface. Throws Error for NaN.
// [channels]
std::vector<double> Evaluate(const TermModel& model, const DirectionPair& directions);

}  // namespace trilobe

#endif  // TRILOBE_EXPERIMENTS_LIMITS_TERM_MODEL_H_
