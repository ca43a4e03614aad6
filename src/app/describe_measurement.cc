#include <functional>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "trilobe/app/albedo_table.h"
#include "trilobe/app/describe.h"
#include "trilobe/app/flags.h"
#include "trilobe/app/print.h"
#include "trilobe/io/file.h"
#include "trilobe/io/merl_file.h"
#include "trilobe/io/rgl_file.h"
#include "trilobe/io/source.h"
#include "trilobe/model/measurement_stats.h"
#include "trilobe/model/tabulated_brdf.h"

namespace trilobe {
namespace {

using Json = nlohmann::ordered_json;

// A measurement and what only its own format knows.
struct Measurement {
  std::string kind;
  BrdfTable table;
  std::optional<RglBrdf> rgl;
};

Measurement LoadMeasurement(const std::string& source, int num_threads) {
  if (source.starts_with("synth:")) {
    return {"synthetic measurement", LoadSource(source, SourceOptionsFromFlags()), {}};
  }
  const std::string bytes = ReadFile(source);
  if (!LooksLikeRgl(bytes)) return {"MERL measurement", ParseMerl(bytes, source), {}};
  RglBrdf brdf = RglBrdf::Parse(bytes, source);
  BrdfTable table = TabulateRgl(brdf, source, {}, num_threads);
  return {"RGL measurement, at MERL bins", std::move(table), std::move(brdf)};
}

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

}  // namespace

void DescribeMeasurement(const std::string& source) {
  const int num_threads = ThreadsFromFlags();
  const Measurement measurement = LoadMeasurement(source, num_threads);
  const BrdfTable& table = measurement.table;
  const BinCounts bins = CountBins(table);
  const ValueRange range = RangeOfValidBins(table);
  const PairError exchange = ExchangeError(table);
  std::optional<PairError> reciprocity;
  std::optional<AlbedoTable> albedo;
  if (measurement.rgl) {
    const BrdfFunction brdf = [&](const DirectionPair& pair) {
      return measurement.rgl->Evaluate(pair);
    };
    // A coarser grid: each value costs two inversions of a warp.
    reciprocity = ReciprocityError(brdf, {.theta_h = 30, .theta_d = 30, .phi_d = 60}, num_threads);
    albedo = TabulateAlbedo(brdf, num_threads);
  } else if (bins.valid > 0) {
    const TabulatedBrdf brdf(table);
    albedo = TabulateAlbedo(std::cref(brdf), num_threads);
  }

  if (FLAGS_json) {
    Json json = {{"file", source},
                 {"kind", measurement.kind},
                 {"dimensions",
                  {{"theta_h", table.grid.theta_h},
                   {"theta_d", table.grid.theta_d},
                   {"phi_d", table.grid.phi_d}}},
                 {"bins",
                  {{"total", bins.total},
                   {"valid", bins.valid},
                   {"below_surface", bins.below_surface},
                   {"non_finite", bins.non_finite},
                   {"negative", bins.negative}}},
                 {"min", range.min},
                 {"max", range.max},
                 {"exchange_error", ToJson(exchange)},
                 {"reciprocity_error", reciprocity ? ToJson(*reciprocity) : Json()},
                 {"albedo", albedo ? ToJson(*albedo) : Json()}};
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
  PrintLine("  below the surface", std::to_string(bins.below_surface));
  PrintLine("  lost (negative)", std::to_string(bins.negative));
  PrintLine("  NaN or infinite", std::to_string(bins.non_finite));
  if (bins.valid > 0) {
    PrintLine("smallest value, RGB", Text(range.min) + " /sr");
    PrintLine("largest value, RGB", Text(range.max) + " /sr");
  }
  Print("exchange error", exchange);
  if (reciprocity) Print("reciprocity error", *reciprocity);
  if (albedo) Print(*albedo);
}

}  // namespace trilobe
