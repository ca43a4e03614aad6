#include <algorithm>
#include <cmath>
#include <functional>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/describe.h"
#include "app/flags.h"
#include "app/result_folder.h"
#include "core/files/file.h"
#include "fit/reports/bin_counts.h"
#include "fit/reports/model_report.h"
#include "fit/reports/print.h"
#include "io/formats/databases/rgl_file.h"
#include "io/formats/databases/utia_file.h"
#include "io/pictures/plots.h"
#include "model/measurement/anisotropy.h"
#include "model/measurement/note_symptoms.h"
#include "model/measurement/sample_symptoms.h"
#include "trilobe/core/base/error.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/model/measurement/measurement_stats.h"
#include "trilobe/model/measurement/tabulated_brdf.h"

namespace trilobe {
namespace {

// Picture of the measurement; empty without --out.
std::string PicturePath() { return FLAGS_out.empty() ? "" : FLAGS_out + "/measured.png"; }

using Json = nlohmann::ordered_json;

// BRDF of a measurement at single directions, and not only at bins: 0 where it was not measured.
class MeasuredBrdf {
 public:
  // `extrapolated`: also where it was not measured.
  MeasuredBrdf(const Measurement& measurement, bool extrapolated)
      : measurement_(measurement), extrapolated_(extrapolated) {
    if (!measurement.look_up) tabulated_.emplace(*measurement.table);
  }

  Rgb operator()(const DirectionPair& pair) const {
    if (!WithinAngles(pair)) return {0, 0, 0};
    if (tabulated_) return (*tabulated_)(pair);
    const MeasuredValue value = measurement_.look_up(pair);
    return value.measured || extrapolated_ ? value.rho : Rgb{0, 0, 0};
  }

  bool Measured(const DirectionPair& pair) const {
    return WithinAngles(pair) &&
           (tabulated_ || extrapolated_ || measurement_.look_up(pair).measured);
  }

 private:
  bool WithinAngles(const DirectionPair& pair) const {
    return std::min(pair.wi[2], pair.wo[2]) >= min_cosine_;
  }

  const Measurement& measurement_;
  const bool extrapolated_;
  // Directions at the limit itself count, whatever the last digit of their cosine.
  const double min_cosine_ =
      measurement_.table->max_theta < kPi / 2 ? std::cos(measurement_.table->max_theta) - 1e-12 : 0;
  std::optional<TabulatedBrdf> tabulated_;
};

void Print(const std::string& label, const PairError& error) {
  if (error.pairs == 0) {
    PrintLine(label, "no pair to compare");
  } else {
    PrintLine(label, "median " + Text(100 * error.median, 3) + " %, 95th percentile " +
                         Text(100 * error.percentile_95, 3) + " %, " + std::to_string(error.pairs) +
                         " pairs");
  }
}

Json ToJson(const PairError& error) {
  return {{"pairs", error.pairs},
          {"median", error.pairs > 0 ? Json(error.median) : Json()},
          {"percentile_95", error.pairs > 0 ? Json(error.percentile_95) : Json()}};
}

void DescribeTable(const Measurement& measurement, bool extrapolated) {
  const std::string& source = measurement.source;
  const int num_threads = ThreadsFromFlags();
  const BrdfTable& table = *measurement.table;
  const BinCounts bins = CountBins(table);
  const ValueRange range = RangeOfValidBins(table);
  const PairError exchange = ExchangeError(table);
  std::optional<PairError> reciprocity;
  std::optional<AlbedoTable> albedo;
  if (bins.valid > 0) {
    const MeasuredBrdf brdf(measurement, extrapolated);
    albedo = TabulateAlbedo(std::cref(brdf), num_threads, table.max_theta);
    if (measurement.look_up) {
      // A coarser grid: each value costs two inversions of a warp.
      reciprocity = ReciprocityError(
          std::cref(brdf), {.theta_h = 30, .theta_d = 30, .phi_d = 60}, num_threads,
          [&](const DirectionPair& pair) { return brdf.Measured(pair); });
    }
  }
  const std::string picture = PicturePath();
  if (!picture.empty()) {
    MakeDirectories(FLAGS_out);
    DrawMeasured(table, picture);
  }

  if (FLAGS_json) {
    Json json = {{"file", source},
                 {"kind", measurement.kind},
                 {"dimensions",
                  {{"theta_h", table.grid.theta_h},
                   {"theta_d", table.grid.theta_d},
                   {"phi_d", table.grid.phi_d}}},
                 {"bins", ToJson(bins)},
                 {"max_angle", MaxAngleDegrees(table)},
                 {"min", range.min},
                 {"max", range.max},
                 {"exchange_error", ToJson(exchange)},
                 {"reciprocity_error", reciprocity ? ToJson(*reciprocity) : Json()},
                 {"albedo", albedo ? ToJson(*albedo) : Json()},
                 {"notes", measurement.notes}};
    PrintJson(json);
    return;
  }
  PrintLine("file", source);
  PrintLine("kind", measurement.kind);
  PrintLine("bins", std::to_string(table.grid.theta_h) + " theta_h x " +
                        std::to_string(table.grid.theta_d) + " theta_d x " +
                        std::to_string(table.grid.phi_d) +
                        " phi_d = " + std::to_string(bins.total));
  PrintLine("  valid", std::to_string(bins.valid));
  for (const LeftOut& left_out : ReasonsOf(bins)) {
    PrintLine("  " + left_out.reason, std::to_string(left_out.bins));
  }
  PrintLine("measured up to", Text(MaxAngleDegrees(table)) + " deg");
  if (bins.valid > 0) {
    PrintLine("smallest value, RGB", Text(range.min) + " /sr");
    PrintLine("largest value, RGB", Text(range.max) + " /sr");
  }
  Print("exchange error", exchange);
  if (reciprocity) Print("reciprocity error", *reciprocity);
  if (!picture.empty()) PrintLine("written", picture);
  if (albedo) {
    const bool whole =
        bins.extrapolated + bins.beyond_nodes + bins.beyond_max_angle + bins.below_min_theta_d == 0;
    Print(*albedo, whole ? "directional albedo" : "directional albedo of what was measured");
  }
  for (const std::string& note : measurement.notes) PrintLine("note", note);
}

// Values of an angle among the samples.
struct AngleRange {
  double min_deg = 0, max_deg = 0;
  int values = 0;  // that differ by more than 1e-6 rad
};

AngleRange RangeOf(const std::vector<SphericalAngles>& all, double SphericalAngles::*angle) {
  std::vector<double> sorted;
  sorted.reserve(all.size());
  for (const SphericalAngles& angles : all) sorted.push_back(angles.*angle);
  if (sorted.empty()) return {};
  std::ranges::sort(sorted);
  AngleRange range{RadiansToDegrees(sorted.front()), RadiansToDegrees(sorted.back()), 1};
  for (size_t k = 1; k < sorted.size(); ++k) range.values += sorted[k] - sorted[k - 1] > 1e-6;
  return range;
}

Json ToJson(const AngleRange& range) {
  return {{"min", range.min_deg}, {"max", range.max_deg}, {"values", range.values}};
}

ValueRange RangeOf(const std::vector<Rgb>& values) {
  if (values.empty()) return {};
  ValueRange range{values.front(), values.front()};
  for (const Rgb& rho : values) {
    for (int c = 0; c < kChannels; ++c) {
      range.min[c] = std::min(range.min[c], rho[c]);
      range.max[c] = std::max(range.max[c], rho[c]);
    }
  }
  return range;
}

// Whether all channels are equal, as for one wavelength.
bool OneValueForAllChannels(const BrdfSamples& samples) {
  return std::ranges::all_of(samples.rho,
                             [](const Rgb& rho) { return rho[0] == rho[1] && rho[1] == rho[2]; });
}

// An RGL file's own directions differ from phi_i to phi_i; on a grid they do not.
Measurement OnGrid(const Measurement& measurement) {
  return measurement.look_up ? AtNodes(measurement, kUtiaGrid, ThreadsFromFlags()) : measurement;
}

Json ToJson(const Anisotropy& anisotropy) {
  const bool smooth = anisotropy.with_neighbours > 0;
  return {{"samples", anisotropy.samples},
          {"share", anisotropy.samples > 0 ? Json(anisotropy.share) : Json()},
          {"share_beyond_noise", smooth ? Json(anisotropy.smooth_share) : Json()}};
}

Json ToJson(const std::vector<ReflectedAtLeast>& reflected) {
  Json json = Json::array();
  for (const ReflectedAtLeast& one : reflected) {
    json.push_back({{"theta_i", RadiansToDegrees(one.theta_i)}, {"albedo", one.albedo}});
  }
  return json;
}

// "0.12 to 0.31 of the light, at 6 incidences".
std::string ReflectedText(const std::vector<ReflectedAtLeast>& reflected) {
  const auto [low, high] = std::ranges::minmax(reflected, {}, &ReflectedAtLeast::albedo);
  return Text(low.albedo, 3) + " to " + Text(high.albedo, 3) + " of the light, at " +
         std::to_string(reflected.size()) + (reflected.size() == 1 ? " incidence" : " incidences") +
         ", as far as samples reach";
}

void DescribeScattered(const Measurement& measurement) {
  const std::string picture = measurement.samples.size() > 0 ? PicturePath() : "";
  if (!picture.empty()) {
    MakeDirectories(FLAGS_out);
    if (measurement.anisotropic) {
      DrawPairs(OnGrid(measurement), picture);
    } else {
      DrawDirections(measurement, picture);
    }
  }
  const AngleRange theta_i = RangeOf(measurement.samples.directions, &SphericalAngles::theta_i);
  const AngleRange phi_i = RangeOf(measurement.samples.directions, &SphericalAngles::phi_i);
  const AngleRange theta_o = RangeOf(measurement.samples.directions, &SphericalAngles::theta_o);
  std::optional<Anisotropy> anisotropy;
  if (measurement.anisotropic) anisotropy = AnisotropyOf(OnGrid(measurement));
  const ValueRange range = RangeOf(measurement.samples.rho);
  const PairError reciprocity = ReciprocityError(measurement);
  const std::vector<ReflectedAtLeast> reflected = ReflectedLightOf(measurement.samples);
  const BinCounts& counts = measurement.counts;
  if (FLAGS_json) {
    PrintJson({{"file", measurement.source},
               {"kind", measurement.kind},
               {"samples", ToJson(counts)},
               {"out_of_gamut", measurement.out_of_gamut},
               {"max_angle", MaxAngleDegrees(measurement)},
               {"theta_i", ToJson(theta_i)},
               {"phi_i", ToJson(phi_i)},
               {"theta_o", ToJson(theta_o)},
               {"min", range.min},
               {"max", range.max},
               {"reciprocity_error", ToJson(reciprocity)},
               {"reflects_at_least", ToJson(reflected)},
               {"anisotropy", anisotropy ? ToJson(*anisotropy) : Json()},
               {"cannot_be_checked", UndecidedIn(measurement)},
               {"notes", measurement.notes}});
    return;
  }
  PrintLine("file", measurement.source);
  PrintLine("kind", measurement.kind);
  PrintLine("samples", std::to_string(counts.total));
  PrintLine("  valid", std::to_string(counts.valid));
  for (const LeftOut& left_out : ReasonsOf(counts)) {
    if (left_out.bins > 0) PrintLine("  " + left_out.reason, std::to_string(left_out.bins));
  }
  if (measurement.out_of_gamut > 0) {
    PrintLine("out of gamut, set to 0", std::to_string(measurement.out_of_gamut));
  }
  const auto print_notes = [&] {
    for (const std::string& note : measurement.notes) PrintLine("note", note);
  };
  if (counts.valid == 0) {
    print_notes();
    return;
  }
  const auto text = [](const AngleRange& angles) {
    return Text(angles.min_deg) + " to " + Text(angles.max_deg) + " deg, " +
           std::to_string(angles.values) + (angles.values == 1 ? " value" : " values");
  };
  PrintLine("theta_i", text(theta_i));
  if (anisotropy) PrintLine("phi_i", text(phi_i));
  PrintLine("theta_o", text(theta_o));
  if (OneValueForAllChannels(measurement.samples)) {
    PrintLine("values", Text(range.min[0]) + " to " + Text(range.max[0]) + " /sr");
  } else {
    PrintLine("smallest value, RGB", Text(range.min) + " /sr");
    PrintLine("largest value, RGB", Text(range.max) + " /sr");
  }
  Print("reciprocity error", reciprocity);
  if (!reflected.empty()) PrintLine("reflects at least", ReflectedText(reflected));
  if (anisotropy) {
    std::string change = "unknown: no sample was measured with the material turned";
    if (anisotropy->samples > 0) {
      change = Text(100 * anisotropy->share, 3) +
               " % of the energy is not in the mean over all turns, " +
               std::to_string(anisotropy->samples) + " samples";
    }
    if (anisotropy->with_neighbours > 0) {
      change += "; beyond noise " + Text(100 * std::max(0.0, anisotropy->smooth_share), 3) + " %";
    }
    PrintLine("anisotropy", change);
  }
  if (const std::string undecided = UndecidedIn(measurement); !undecided.empty()) {
    PrintLine("cannot be checked", undecided);
  }
  if (!picture.empty()) PrintLine("written", picture);
  print_notes();
}

}  // namespace

void DescribeMeasurement(const std::string& source) {
  if (!FLAGS_out.empty()) Inputs({source}).CheckOutput(PicturePath());
  const SourceOptions options = SourceOptionsFromFlags();
  Measurement measurement = LoadMeasurement(source, options);
  NoteSymptoms(ThreadsFromFlags(), &measurement);
  if (measurement.table) {
    DescribeTable(measurement, options.extrapolated);
  } else {
    DescribeScattered(measurement);
  }
}

}  // namespace trilobe
