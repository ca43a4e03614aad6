#include "experiments/limits/term_model.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "model/spectral_color.h"
#include "model/splined_cosine.h"
#include "trilobe/core/base/catmull_rom.h"
#include "trilobe/core/base/error.h"

namespace trilobe {
namespace {

// Angle between the azimuths of two directions [rad]; pi/2 where one of them is the normal.
double AzimuthBetween(const Direction& a, const Direction& b) {
  const double length = std::hypot(a[0], a[1]) * std::hypot(b[0], b[1]);
  if (!(length > 0)) return kPi / 2;
  return std::acos(std::clamp((a[0] * b[0] + a[1] * b[1]) / length, -1.0, 1.0));
}

double SafeAcos(double cosine) { return std::acos(std::clamp(cosine, -1.0, 1.0)); }

}  // namespace

const char* SiteName(Site site) {
  switch (site) {
    case Site::kHalf:
      return "half";
    case Site::kDifference:
      return "difference";
    case Site::kRetroHalf:
      return "retro_half";
    case Site::kInTimesOut:
      return "in_times_out";
    case Site::kHeightCorrelated:
      return "height_correlated";
    case Site::kDirectionCorrelated:
      return "direction_correlated";
  }
  return "";
}

TermSpec TermSpec::Of(const ModelSpec& spec, int channels) {
  CheckIsotropic(spec, "a model of terms");
  TermSpec terms{.channels = channels, .sets = {}, .terms = {}};
  for (const Factor factor : kFactors) {
    const auto [per_lobe, per_channel] = spec.sharing(factor);
    terms.sets.push_back({.name = FactorName(factor),
                          .axis = spec.axis(factor),
                          .count = per_lobe ? spec.lobes : std::min(spec.lobes, 1),
                          .per_channel = per_channel});
  }
  terms.terms.push_back({.name = "diffuse", .reads = {}});
  for (int m = 0; m < spec.lobes; ++m) {
    const auto read = [&](Factor factor, Site site) {
      return TermRead{.set = static_cast<int>(factor),
                      .table = spec.sharing(factor).per_lobe ? m : 0,
                      .site = site};
    };
    Term lobe{.name = "lobe " + std::to_string(m + 1),
              .reads = {read(Factor::kD, Site::kHalf), read(Factor::kF, Site::kDifference),
                        read(Factor::kG, Site::kInTimesOut)},
              .over_cosines = true};
    lobe.reads[0].stretch = spec.stretches.of(m);
    terms.terms.push_back(std::move(lobe));
  }
  return terms;
}

void CheckTerms(const TermSpec& spec) {
  const auto check = [](const char* what, size_t is, size_t least, size_t most) {
    if (is >= least && is <= most) return;
    throw Error(ErrorKind::kMismatch, "a model of " + std::to_string(is) + " " + what +
                                          "; there must be " + std::to_string(least) + " to " +
                                          std::to_string(most))
        .About(what, is);
  };
  check("channels", spec.channels < 0 ? 0 : spec.channels, 1, kMaxTermChannels);
  check("terms", spec.terms.size(), 1, kMaxTerms);
  check("sets of tables", spec.sets.size(), 0, kMaxTerms);
  for (const TableSet& set : spec.sets) {
    if (set.count < 0 || set.count > kMaxTerms) {
      throw Error(ErrorKind::kMismatch, "tables '" + set.name + "': there are " +
                                            std::to_string(set.count) + "; there must be 0 to " +
                                            std::to_string(kMaxTerms))
          .About(set.name, set.count);
    }
    CheckAxis(set.axis, set.name.c_str());
    if (set.axis.polar()) {
      throw Error(ErrorKind::kUnsupported, "tables '" + set.name + "' must not be over azimuths")
          .About(set.name);
    }
  }
  for (const Term& term : spec.terms) {
    if (term.reads.size() > kMaxReads) {
      throw Error(ErrorKind::kMismatch, "term '" + term.name + "' reads " +
                                            std::to_string(term.reads.size()) +
                                            " tables; it may read " + std::to_string(kMaxReads))
          .About(term.name, term.reads.size());
    }
    int pairs = 0;
    for (const TermRead& read : term.reads) {
      if (read.set < 0 || read.set >= static_cast<int>(spec.sets.size()) || read.table < 0 ||
          read.table >= spec.sets[read.set].count) {
        throw Error(ErrorKind::kRange, "term '" + term.name + "' reads table " +
                                           std::to_string(read.table) + " of set " +
                                           std::to_string(read.set) + ", which there is not")
            .About(term.name, read.table);
      }
      if (IsPair(read.site)) ++pairs;
      CheckStretch(read.stretch);
      if (read.stretch.any() && read.site != Site::kHalf) {
        throw Error(ErrorKind::kUnsupported,
                    "term '" + term.name + "' stretches what is not over theta_h")
            .About(term.name, "stretch");
      }
    }
    if (pairs > 1 && term.over_cosines) {
      throw Error(ErrorKind::kUnsupported,
                  "term '" + term.name + "' reads two pairs; over cosines it may read one")
          .About(term.name, "pairs");
    }
  }
}

TermModel::TermModel(TermSpec spec) : spec_(std::move(spec)) {
  CheckTerms(spec_);
  int offset = spec_.channels * static_cast<int>(spec_.terms.size());
  for (const TableSet& set : spec_.sets) {
    set_begin_.push_back(offset);
    offset += set.axis.size * set.count * (set.per_channel ? spec_.channels : 1);
  }
  values_.assign(offset, 0.0);
}

TermModel TermModel::Of(const FactorModel& model) {
  TermModel terms(TermSpec::Of(model.spec()));
  std::ranges::copy(model.d(), terms.strength(0).begin());
  for (int m = 0; m < model.spec().lobes; ++m) {
    std::ranges::copy(model.s(m), terms.strength(1 + m).begin());
  }
  // Tables lie in the same order.
  for (const Factor factor : kFactors) {
    const int set = static_cast<int>(factor);
    for (int t = 0; t < model.spec().num_tables(factor); ++t) {
      const std::span<const double> from = model.table(factor, t);
      std::ranges::copy(from, terms.values_.begin() + terms.set_begin_[set] +
                                  static_cast<ptrdiff_t>(t) * static_cast<ptrdiff_t>(from.size()));
    }
  }
  return terms;
}

TermModel TermModel::Of(const SpectralModel& model) {
  const ModelSpec& spec = model.spec();
  TermModel terms(TermSpec::Of(spec, model.bands()));
  const auto set = [](Factor factor) { return static_cast<int>(factor); };
  std::ranges::copy(model.d(), terms.strength(0).begin());
  for (int m = 0; m < spec.lobes; ++m) {
    std::ranges::copy(model.s(m), terms.strength(1 + m).begin());
    for (int band = 0; band < model.bands(); ++band) {
      std::ranges::copy(model.F(m, band),
                        terms.table(set(Factor::kF), spec.F.per_lobe ? m : 0, band).begin());
    }
    for (const Factor factor : {Factor::kD, Factor::kG}) {
      std::ranges::copy(model.table(factor, spec.table(factor, m, 0)),
                        terms.table(set(factor), spec.sharing(factor).per_lobe ? m : 0, 0).begin());
    }
  }
  return terms;
}

int TermModel::num_parameters() const {
  auto count = static_cast<int>(values_.size());
  for (const TableSet& set : spec_.sets) {
    if (set.fixed) count -= set.axis.size * set.count * (set.per_channel ? spec_.channels : 1);
  }
  return count;
}

std::vector<FactorModel::Part> TermModel::Parts() const {
  std::vector<FactorModel::Part> parts;
  for (size_t t = 0; t < spec_.terms.size(); ++t) {
    parts.push_back({StrengthOffset(static_cast<int>(t)), spec_.channels});
  }
  for (size_t set = 0; set < spec_.sets.size(); ++set) {
    const TableSet& tables = spec_.sets[set];
    for (int k = 0; k < tables.count * (tables.per_channel ? spec_.channels : 1); ++k) {
      parts.push_back({set_begin_[set] + k * tables.axis.size, tables.axis.size});
    }
  }
  return parts;
}

TermReader::TermReader(const TermSpec& spec) {
  for (const Term& term : spec.terms) {
    std::vector<int>& places = place_.emplace_back();
    pair_.push_back(-1);
    for (const TermRead& read : term.reads) {
      const Axis& axis = spec.sets[read.set].axis;
      // All pairs read at the same two angles.
      const auto alike = [&](const Lookup& lookup) {
        return lookup.axis == axis && lookup.stretch == read.stretch &&
               (lookup.site == read.site || (IsPair(lookup.site) && IsPair(read.site)));
      };
      const auto found = std::ranges::find_if(lookups_, alike);
      places.push_back(static_cast<int>(found - lookups_.begin()));
      if (found == lookups_.end()) lookups_.push_back({axis, read.site, read.stretch});
      if (IsPair(read.site)) pair_.back() = places.back();
    }
  }
}

TermReader::At TermReader::StencilsAt(const HalfDiffAngles& angles) const {
  const Cosines cosines = ToCosines(angles);
  At at{.places = std::vector<Place>(lookups_.size()),
        .inverse_cosines = 1 / (cosines.i * cosines.o)};
  const DirectionPair pair = ToDirections(angles);
  at.correlation = [&] {
    constexpr double kRate = 4.41;
    const double phi = AzimuthBetween(pair.wi, pair.wo);
    return kRate * phi / (kRate * phi + 1);
  }();
  const Stretch::Place stretched(angles.theta_d, angles.phi_d);
  for (size_t k = 0; k < lookups_.size(); ++k) {
    const auto& [axis, site, stretch] = lookups_[k];
    Place& place = at.places[k];
    place.inverse_cosines = at.inverse_cosines;
    if (IsPair(site)) {
      place.in = axis.At(SafeAcos(cosines.i), 0);
      place.out = axis.At(SafeAcos(cosines.o), 0);
      if (axis.rule == Axis::Rule::kSpline) {
        const CatmullRom spline(axis.size);
        place.inverse_cosines =
            1 / (SplinedCosine(spline, place.in) * SplinedCosine(spline, place.out));
      }
    } else if (site == Site::kRetroHalf) {
      const Direction& wi = pair.wi;
      place.in = axis.At(HalfVector({{-wi[0], -wi[1], wi[2]}, pair.wo}).theta, 0);
    } else {
      const double theta =
          site == Site::kHalf ? stretch.ThetaH(angles.theta_h, stretched) : angles.theta_d;
      place.in = axis.At(theta, 0);
    }
  }
  return at;
}

ReadValue ValueOfRead(Site site, double in, double out, double correlation) {
  if (!IsPair(site)) return {.value = in, .by_in = 1};
  if (site == Site::kInTimesOut) return {.value = in * out, .by_in = out, .by_out = in};
  const double of_lower = site == Site::kHeightCorrelated ? 1 : correlation;
  const bool in_is_lower = in < out;
  const double value = 1 / (1 + std::max(in, out) + of_lower * std::min(in, out));
  const double slope = -value * value;
  return {.value = value,
          .by_in = slope * (in_is_lower ? of_lower : 1),
          .by_out = slope * (in_is_lower ? 1 : of_lower)};
}

void UnclampedValues(const TermModel& model, const TermReader& reader, const TermReader::At& at,
                     std::span<double> rho) {
  const TermSpec& spec = model.spec();
  std::ranges::fill(rho, 0.0);
  for (int t = 0; t < static_cast<int>(spec.terms.size()); ++t) {
    const Term& term = spec.terms[t];
    const auto read_all = [&](bool per_channel, int c) {
      double product = 1;
      for (size_t r = 0; r < term.reads.size(); ++r) {
        const TermRead& read = term.reads[r];
        if (spec.sets[read.set].per_channel != per_channel) continue;
        const TermReader::Place& place = at.places[reader.PlaceOf(t, static_cast<int>(r))];
        const std::span<const double> table = model.table(read.set, read.table, c);
        const double out = IsPair(read.site) ? place.out(table) : 0;
        product *= ValueOfRead(read.site, place.in(table), out, at.correlation).value;
      }
      return product;
    };
    double shared = read_all(/*per_channel=*/false, 0);
    if (term.over_cosines) shared *= reader.InverseCosines(at, t);
    for (int c = 0; c < spec.channels; ++c) {
      rho[c] += model.strength(t)[c] * shared * read_all(/*per_channel=*/true, c);
    }
  }
}

std::vector<double> Evaluate(const TermModel& model, const DirectionPair& directions) {
  std::vector<double> rho(model.spec().channels, 0.0);
  if (!(directions.wi[2] > 0 && directions.wo[2] > 0)) return rho;
  const TermReader reader(model.spec());
  UnclampedValues(model, reader, reader.StencilsAt(ToHalfDiff(directions)), rho);
  for (double& value : rho) value = std::max(value, 0.0);
  return rho;
}

std::function<Rgb(const HalfDiffAngles&)> RgbOf(const TermModel& model,
                                                const std::vector<double>& wavelengths) {
  const auto shared = std::make_shared<const TermModel>(model);
  const auto reader = std::make_shared<const TermReader>(model.spec());
  std::shared_ptr<const SpectralColor> color;
  if (!wavelengths.empty()) {
    color = std::make_shared<const SpectralColor>(
        SpectralColor::OfBands(wavelengths, "a model of terms"));
  }
  return [shared, reader, color](const HalfDiffAngles& angles) -> Rgb {
    std::vector<double> rho(shared->spec().channels);
    UnclampedValues(*shared, *reader, reader->StencilsAt(angles), rho);
    if (color == nullptr) return AtLeastZero({rho[0], rho[1], rho[2]});
    for (double& value : rho) value = std::max(value, 0.0);
    return AtLeastZero((*color)(rho));
  };
}

}  // namespace trilobe
