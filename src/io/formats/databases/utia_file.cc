#include "io/formats/databases/utia_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/base/names.h"
#include "core/files/content.h"
#include "core/files/file.h"
#include "core/files/little_endian.h"
#include "trilobe/core/base/error.h"
#include "trilobe/io/formats/measurement_format.h"
#include "trilobe/model/measurement/measurement_stats.h"

namespace trilobe {
namespace {

constexpr size_t Bytes(const HemisphereGrid& grid) {
  const auto nodes = static_cast<size_t>(grid.nodes());
  return sizeof(double) * kChannels * nodes * nodes;
}

// IEC 61966-2-1, from code to linear light; unlike LinearizeSrgb for codes above 1, which BRDFs
// have.
double DecodeSrgb(double x) { return x > 0.04045 ? std::pow((x + 0.055) / 1.055, 2.4) : x / 12.92; }

double AsBrdf(double stored, double /*cos_theta_i*/) { return stored; }
double WithCosine(double stored, double cos_theta_i) { return stored / cos_theta_i; }
double AsSrgb(double stored, double /*cos_theta_i*/) { return DecodeSrgb(stored); }
double AsDupuy(double stored, double /*cos_theta_i*/) {
  return std::isnan(stored) ? stored : 100 * DecodeSrgb(std::max(stored, 0.0) / 140);
}

// --- The order of the numbers -------------------------------------------------------------------

// An order in which a file might store the values of pairs of directions.
struct Order {
  const HemisphereGrid& grid;
  bool rows_by_phi = false, columns_by_phi = false;  // index 6 b + a in the place of 48 a + b
  bool interleaved = false;                          // R, G, B of a pair side by side

  int Index(int node, bool by_phi) const {
    return by_phi ? grid.thetas * (node % grid.phis) + node / grid.phis : node;
  }
  size_t operator()(int channel, int i, int o) const {
    const auto nodes = static_cast<size_t>(grid.nodes());
    const size_t pair = nodes * Index(i, rows_by_phi) + Index(o, columns_by_phi);
    return interleaved ? kChannels * pair + channel : nodes * nodes * channel + pair;
  }
};

class MeanDifference {
 public:
  void Add(double a, double b) {
    if (!std::isfinite(a) || !std::isfinite(b)) return;
    const double size = std::abs(a) + std::abs(b);
    sum_ += size > 0 ? std::min(std::abs(a - b) / size, 1.0) : 0;
    ++count_;
  }
  double mean() const { return count_ > 0 ? sum_ / count_ : 0; }

 private:
  double sum_ = 0;
  int count_ = 0;
};

// Mean difference of values that should be near, in one reading of the file: those of swapped
// directions, and of directions with neighbouring azimuths of incidence or of reflection. Each
// alone is blind to some order: swapping all azimuths with all elevations keeps reciprocity.
double Roughness(const std::vector<double>& stored, const Order& order) {
  MeanDifference swapped, beside_i, beside_o;
  const HemisphereGrid& grid = order.grid;
  const auto next = [&grid](int node) {
    const int b = node % grid.phis;
    return node - b + (b + 1) % grid.phis;
  };
  for (int i = 0; i < grid.nodes(); ++i) {
    for (int o = 0; o < grid.nodes(); ++o) {
      const double value = stored[order(1, i, o)];
      swapped.Add(value, stored[order(1, o, i)]);
      beside_i.Add(value, stored[order(1, next(i), o)]);
      beside_o.Add(value, stored[order(1, i, next(o))]);
    }
  }
  return (swapped.mean() + beside_i.mean() + beside_o.mean()) / 3;
}

// A sentence where another order makes the numbers much smoother; empty otherwise.
std::string OtherOrder(const std::vector<double>& stored, const HemisphereGrid& grid) {
  const auto order_of = [&grid](int k) {
    return Order{grid, (k & 1) != 0, (k & 2) != 0, (k & 4) != 0};
  };
  const double as_read = Roughness(stored, order_of(0));
  double least = as_read;
  int least_at = 0;
  for (int k = 1; k < 8; ++k) {
    const double roughness = Roughness(stored, order_of(k));
    if (roughness < least) {
      least = roughness;
      least_at = k;
    }
  }
  const Order best = order_of(least_at);
  constexpr double kMuch = 0.7;
  if (!(least < kMuch * as_read)) return "";
  std::string text = "the numbers look as if they stood in another order: ";
  if (best.rows_by_phi || best.columns_by_phi) {
    text += std::string(best.rows_by_phi && best.columns_by_phi ? "directions"
                        : best.rows_by_phi                      ? "incident directions"
                                                                : "outgoing directions") +
            " by azimuth, 6 b + a in the place of 48 a + b";
  }
  if (best.interleaved) {
    text += std::string(best.rows_by_phi || best.columns_by_phi ? ", and " : "") +
            "R, G and B of each pair side by side in the place of planes";
  }
  const auto percent = [](double x) { return std::to_string(std::lround(100 * x)) + " %"; };
  return text + " (values of neighbouring and of swapped directions differ by " +
         percent(2 * as_read) + " as read, by " + percent(2 * least) +
         " so); put them into the order of docs/file-formats.md";
}

}  // namespace

const std::vector<UtiaRadiometry>& UtiaRadiometries() {
  static const std::vector<UtiaRadiometry> radiometries = {
      {"brdf", "the BRDF in linear RGB, as Filip's own reader takes them", AsBrdf},
      {"cosine", "the BRDF times cos theta_i", WithCosine},
      {"srgb", "the BRDF coded by the sRGB curve, as Fichet's utia.py takes them", AsSrgb},
      {"dj_brdf", "100 x the sRGB decoding of max(number, 0) / 140, as Dupuy's dj_brdf.h does",
       AsDupuy},
  };
  return radiometries;
}

Measurement ParseUtia(std::string_view bytes, const std::string& source,
                      std::string_view radiometry, const HemisphereGrid& grid) {
  CheckHemisphereGrid(grid);
  const UtiaRadiometry& meaning = FindNamed("radiometry", radiometry, UtiaRadiometries());
  if (const size_t size = Bytes(grid); bytes.size() != size) {
    const std::string nodes = std::to_string(grid.nodes());
    throw ErrorIn(ErrorKind::kFormat, source,
                  std::to_string(bytes.size()) + " bytes; a UTIA file has " + std::to_string(size) +
                      ", 3 x " + nodes + " x " + nodes + " float64" +
                      (bytes.size() < size ? "; get it once more" : ""))
        .About("bytes", bytes.size());
  }
  std::vector<double> stored(bytes.size() / sizeof(double));
  std::memcpy(stored.data(), bytes.data(), bytes.size());
  SampleCollector collector(source, "UTIA measurement");
  const Order order = {grid};
  for (int i = 0; i < grid.nodes(); ++i) {
    const double cos_theta_i = std::cos(grid.Theta(i));
    for (int o = 0; o < grid.nodes(); ++o) {
      Rgb rho;
      for (int c = 0; c < kChannels; ++c) {
        rho[c] = meaning.to_brdf(stored[order(c, i, o)], cos_theta_i);
      }
      collector.Add(grid.Angles(i, o), rho);
    }
  }
  Measurement measurement = collector.Take();
  measurement.anisotropic = true;
  if (const std::string note = OtherOrder(stored, grid); !note.empty()) measurement.notes = {note};
  return measurement;
}

void WriteUtia(const Measurement& scattered, const std::string& path,
               const BeforeRenaming& before_renaming) {
  const NodeTable values = ValuesAtNodes(scattered, kUtiaGrid);
  std::vector<double> plane(values.rho.size());
  WriteFile(
      path,
      [&](std::ostream& out) {
        for (int c = 0; c < kChannels; ++c) {
          for (size_t k = 0; k < plane.size(); ++k) {
            plane[k] = values.present[k] ? values.rho[k][c] : -1;
          }
          out.write(reinterpret_cast<const char*>(plane.data()),
                    static_cast<std::streamsize>(sizeof(double) * plane.size()));
        }
      },
      before_renaming);
}

namespace {

// Recognised by the size alone; a text of that size is none.
bool LooksLikeUtia(std::string_view bytes) {
  return bytes.size() == Bytes(kUtiaGrid) &&
         RecogniseContent(bytes).kind == Content::Kind::kUnknown;
}

}  // namespace

MeasurementFormat UtiaFormat() {
  return {.name = "utia",
          .description = "a UTIA .bin file",
          .ending = ".bin",
          .is_text = false,
          .recognise = LooksLikeUtia,
          .read =
              [](std::string_view bytes, const std::string& source, const SourceOptions& options) {
                return ParseUtia(bytes, source, options.radiometry);
              },
          .written_as = "UTIA layout",
          .holds_anisotropic = true,
          .write =
              [](const Measurement& measurement, const std::string& path, int num_threads,
                 const BeforeRenaming& before_renaming) {
                const Measurement at_nodes = AtNodes(measurement, kUtiaGrid, num_threads);
                WriteUtia(at_nodes, path, before_renaming);
                return ValidText(at_nodes.counts, "pairs of directions");
              }};
}

}  // namespace trilobe
