#include "trilobe/io/utia_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "trilobe/base/error.h"
#include "trilobe/base/named.h"
#include "trilobe/io/content.h"
#include "trilobe/io/file.h"
#include "trilobe/io/little_endian.h"

namespace trilobe {
namespace {

constexpr int kNodes = kUtiaGrid.nodes();
constexpr int kPlane = kNodes * kNodes;
static_assert(kUtiaSize == sizeof(double) * kChannels * kPlane);

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

// Where a file might have the value of a pair of directions.
struct Order {
  bool rows_by_phi = false, columns_by_phi = false;  // index 6 b + a in the place of 48 a + b
  bool interleaved = false;                          // R, G, B of a pair side by side

  static int Index(int a, int b, bool by_phi) {
    return by_phi ? kUtiaGrid.thetas * b + a : kUtiaGrid.phis * a + b;
  }
  size_t operator()(int channel, int i, int o) const {
    const int row = Index(i / kUtiaGrid.phis, i % kUtiaGrid.phis, rows_by_phi);
    const int column = Index(o / kUtiaGrid.phis, o % kUtiaGrid.phis, columns_by_phi);
    const int pair = kNodes * row + column;
    return interleaved ? kChannels * pair + channel : kPlane * channel + pair;
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

// How far apart values are that should be near, in one reading of the file: those of swapped
// directions, and of directions with neighbouring azimuths of incidence or of reflection. Each
// alone is blind to some order: swapping all azimuths with all elevations keeps reciprocity.
double Roughness(const std::vector<double>& stored, const Order& order) {
  MeanDifference swapped, beside_i, beside_o;
  const auto next = [](int node) {
    const int b = node % kUtiaGrid.phis;
    return node - b + (b + 1) % kUtiaGrid.phis;
  };
  for (int i = 0; i < kNodes; ++i) {
    for (int o = 0; o < kNodes; ++o) {
      const double value = stored[order(1, i, o)];
      swapped.Add(value, stored[order(1, o, i)]);
      beside_i.Add(value, stored[order(1, next(i), o)]);
      beside_o.Add(value, stored[order(1, i, next(o))]);
    }
  }
  return (swapped.mean() + beside_i.mean() + beside_o.mean()) / 3;
}

// A sentence where another order makes the numbers much smoother; empty otherwise.
std::string OtherOrder(const std::vector<double>& stored) {
  const double as_read = Roughness(stored, {});
  double least = as_read;
  Order best;
  for (int k = 1; k < 8; ++k) {
    const Order order = {(k & 1) != 0, (k & 2) != 0, (k & 4) != 0};
    const double roughness = Roughness(stored, order);
    if (roughness < least) {
      least = roughness;
      best = order;
    }
  }
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
                      std::string_view radiometry) {
  const UtiaRadiometry& meaning = FindNamed("radiometry", radiometry, UtiaRadiometries());
  if (bytes.size() != kUtiaSize) {
    throw Error(source + ": " + std::to_string(bytes.size()) + " bytes; a UTIA file has " +
                std::to_string(kUtiaSize) + ", 3 x 288 x 288 float64" +
                (bytes.size() < kUtiaSize ? "; get it once more" : ""));
  }
  std::vector<double> stored(kChannels * kPlane);
  std::memcpy(stored.data(), bytes.data(), kUtiaSize);
  SampleCollector collector(source, "UTIA measurement");
  for (int i = 0; i < kNodes; ++i) {
    const double cos_theta_i = std::cos(kUtiaGrid.Theta(i));
    for (int o = 0; o < kNodes; ++o) {
      Rgb rho;
      for (int c = 0; c < kChannels; ++c) {
        rho[c] = meaning.to_brdf(stored[Order()(c, i, o)], cos_theta_i);
      }
      collector.Add(kUtiaGrid.Angles(i, o), rho);
    }
  }
  Measurement measurement = collector.Take();
  measurement.anisotropic = true;
  if (const std::string note = OtherOrder(stored); !note.empty()) measurement.notes = {note};
  return measurement;
}

void WriteUtia(const Measurement& scattered, const std::string& path) {
  const NodeTable values = ValuesAtNodes(scattered, kUtiaGrid);
  std::vector<double> plane(kPlane);
  WriteFile(path, [&](std::ostream& out) {
    for (int c = 0; c < kChannels; ++c) {
      for (int k = 0; k < kPlane; ++k) plane[k] = values.present[k] ? values.rho[k][c] : -1;
      out.write(reinterpret_cast<const char*>(plane.data()),
                static_cast<std::streamsize>(sizeof(double) * kPlane));
    }
  });
}

}  // namespace trilobe
