#include "io/formats/databases/rgl_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "core/base/text.h"
#include "io/formats/databases/bilinear_warp.h"
#include "io/formats/databases/rgl_mask.h"
#include "io/formats/databases/tensor_file.h"
#include "io/formats/spectrum_bands.h"
#include "io/formats/text/angle_list.h"
#include "trilobe/core/base/error.h"
#include "trilobe/core/system/parallel.h"
#include "trilobe/io/formats/measurement_format.h"

namespace trilobe {

// Directions are mapped to the unit square by x = sqrt(2 theta / pi), y = phi / (2 pi) + 1/2.
struct RglBrdf::Tables {
  std::vector<double> phi_i;    // [p], ascending [rad]; one if isotropic
  std::vector<double> theta_i;  // [t], ascending [rad]
  int symmetry;                 // 1, or 2 or 4 where phi_i is the last half or quarter of a circle
  BilinearStack ndf;            // [1]: density of microfacet normals
  BilinearStack sigma;          // [1]: projected area of the microfacets
  BilinearWarp vndf;            // [p t]: visible normals, to uniform coordinates
  BilinearStack rgb;            // [p t 3]: values in those coordinates
  std::vector<double> wavelengths;  // of spectra that are kept
  BilinearStack spectra;            // [p t wavelengths]: the same
  int bands;                        // wavelengths in the file
  std::string bands_note;           // what of them was read
  RglMask mask;                     // [p t]: which nodes of rgb were measured
};

// Position of a pair of directions in the tables.
struct RglBrdf::Place {
  SliceBlend blend = {};  // over (phi_i, theta_i)
  SquarePoint x = {};
  double factor = 0;  // of the values there
  bool seen = false;  // else nothing is reflected

  // Interpolated values dip below 0 here and there. The upper limit is for absurd tables, whose
  // product exceeds what a double holds.
  double ValueIn(const BilinearStack& stack, int bands, int band) const {
    double value = 0;
    for (int k = 0; k < blend.count; ++k) {
      value += blend.weight[k] * stack.At(blend.slice[k] * bands + band, x);
    }
    return value > 0 ? std::min(value * factor, std::numeric_limits<double>::max()) : 0.0;
  }
};

namespace {

// They are float32, so that 90 degrees may be a little more than kPi / 2.
constexpr double kRounding = 1e-4;

// Angles in ascending order from `min` to `max` [rad].
std::vector<double> ReadAngles(const TensorFile& file, const char* name, double min, double max) {
  std::vector<double> angles = file.Float32(name, 1).values;
  for (size_t k = 0; k < angles.size(); ++k) {
    const auto fail = [&](const std::string& expected) {
      const std::string angle = Text(angles[k], 6);
      file.Fail(name, "has " + angle + " as entry " + std::to_string(k) + "; " + expected,
                ErrorKind::kRange, angle);
    };
    if (!(angles[k] >= min - kRounding && angles[k] <= max + kRounding)) {
      fail("angles are in radians, from " + Text(min, 6) + " to " + Text(max, 6));
    }
    angles[k] = std::max(angles[k], min);  // no direction has a theta below 0
    if (k > 0 && angles[k] <= angles[k - 1]) {
      fail("it must be above the entry before it, " + Text(angles[k - 1], 6));
    }
  }
  return angles;
}

// The last two dimensions are rows (phi) and columns (theta), those before must be `leading`.
BilinearStack ReadStack(const TensorFile& file, const char* name, const std::vector<int>& leading) {
  const auto count = static_cast<int>(leading.size());
  Tensor tensor = file.Float32(name, count + 2);
  if (!std::equal(leading.begin(), leading.end(), tensor.shape.begin())) {
    file.Fail(name, "has another shape than phi_i, theta_i and the three channels ask for",
              ErrorKind::kMismatch);
  }
  const int rows = tensor.shape[count], columns = tensor.shape[count + 1];
  if (rows < 2 || columns < 2) {
    file.Fail(name, "must have at least 2 rows and 2 columns", ErrorKind::kRange);
  }
  if (tensor.values.size() > static_cast<size_t>(std::numeric_limits<int>::max())) {
    file.Fail(name, "has more entries than any measurement", ErrorKind::kLimit);
  }
  return {rows, columns, std::move(tensor.values)};
}

BilinearStack ReadNonNegative(const TensorFile& file, const char* name,
                              const std::vector<int>& leading) {
  BilinearStack stack = ReadStack(file, name, leading);
  const auto negative = std::ranges::find_if(stack.values, [](double x) { return x < 0; });
  if (negative != stack.values.end()) {
    const std::string entry = std::to_string(negative - stack.values.begin());
    file.Fail(name, "has a negative entry: number " + entry, ErrorKind::kRange, entry);
  }
  return stack;
}

// `rgb`, or `spectra` at `wavelengths`, as the database's *_spec.bsdf files and those for spectral
// renderers have them, as colours: those of linear sRGB. [p][t][3]
struct Colors {
  BilinearStack rgb;
  std::vector<double> wavelengths = {};  // of `spectra`
  BilinearStack spectra = {};            // [p][t][wavelengths]
  int bands = 0;                         // in the file
  std::string note = {};                 // what of them was read
};

Colors ReadColors(const TensorFile& file, int p, int t, const std::string& bands,
                  const std::string& source) {
  if (file.Has("rgb") || !file.Has("spectra")) return {ReadStack(file, "rgb", {p, t, kChannels})};
  const std::vector<double> wavelengths = file.Float32("wavelengths", 1).values;
  SpectrumBands color(wavelengths, bands, source);
  const auto count = static_cast<int>(wavelengths.size());
  BilinearStack spectra = ReadStack(file, "spectra", {p, t, count});
  const size_t nodes = static_cast<size_t>(spectra.rows) * spectra.columns;
  BilinearStack rgb = {spectra.rows, spectra.columns,
                       std::vector<double>(static_cast<size_t>(p) * t * kChannels * nodes)};
  std::vector<double> spectrum(count);
  for (size_t slice = 0; slice < static_cast<size_t>(p) * t; ++slice) {
    for (size_t node = 0; node < nodes; ++node) {
      for (int l = 0; l < count; ++l) {
        spectrum[l] = spectra.values[(slice * count + l) * nodes + node];
      }
      const Rgb at_node = color.ColorOf(spectrum);
      for (int c = 0; c < kChannels; ++c) {
        rgb.values[(slice * kChannels + c) * nodes + node] = at_node[c];
      }
    }
  }
  if (color.are_channels()) return {.rgb = std::move(rgb), .bands = count, .note = color.Note()};
  std::vector<double> read;
  for (const size_t l : color.read()) read.push_back(wavelengths[l]);
  if (color.read().size() < wavelengths.size()) {
    spectra = spectra.Chosen(count, color.read());
  }
  return {std::move(rgb), std::move(read), std::move(spectra), count, color.Note()};
}

// phi is taken modulo 2 pi.
SquarePoint ToSquare(double theta, double phi) {
  const double turns = phi / (2 * kPi) + 0.5;
  return {std::sqrt(theta * (2 / kPi)), turns - std::floor(turns)};
}

// The two neighbours of x among ascending nodes with their weights; the end one beyond the ends.
SliceBlend Neighbours(const std::vector<double>& nodes, double x) {
  const auto [lower, t] = FindBetween(nodes, x);
  SliceBlend blend;
  if (t < 1) blend.Add(static_cast<int>(lower), 1 - t);
  if (t > 0) blend.Add(static_cast<int>(lower) + 1, t);
  return blend;
}

// Files may leave out what a symmetry of the material repeats. 2: turned by 180 degrees it looks
// the same, and phi_i is from -180 to 0 degrees; 4: also mirrored at the x or the y axis, and phi_i
// is from -180 to -90 (so Mitsuba's `measured`, by the same authors).
int SymmetryOf(const TensorFile& file, const std::vector<double>& phi_i) {
  const double span = phi_i.back() - phi_i.front();
  constexpr double kSame = 1e-3;
  if (phi_i.size() == 1 || std::abs(span - 2 * kPi) <= kSame) return 1;
  for (const int symmetry : {2, 4}) {
    if (std::abs(span - 2 * kPi / symmetry) <= kSame && std::abs(phi_i.front() + kPi) <= kSame) {
      return symmetry;
    }
  }
  file.Fail("phi_i",
            "must have one entry, or reach once around the circle, or from -180 to 0 or -90 "
            "degrees");
}

// The signs of x and y by which the symmetry takes wi into the part of the circle that is stored.
std::array<double, 2> FoldingSigns(int symmetry, const Direction& wi) {
  if (symmetry == 1) return {1, 1};
  const double y = wi[1] < 0 ? 1 : -1;
  return {symmetry == 4 ? (wi[0] < 0 ? 1 : -1) : y, y};
}

// The directions that the symmetry makes of stored ones: copy 0 is themselves, 1 turns by 180
// degrees, 2 and 3 mirror at the x and y axes.
SphericalAngles Copied(const SphericalAngles& at, int copy) {
  const auto index = [copy](double phi) {
    return copy == 0 ? phi : copy == 1 ? phi + kPi : copy == 2 ? -phi : kPi - phi;
  };
  return {at.theta_i, index(at.phi_i), at.theta_o, index(at.phi_o)};
}

Direction ApplySigns(const Direction& w, const std::array<double, 2>& signs) {
  return {signs[0] * w[0], signs[1] * w[1], w[2]};
}

}  // namespace

RglBrdf::RglBrdf(std::unique_ptr<const Tables> tables) : tables_(std::move(tables)) {}
RglBrdf::RglBrdf(RglBrdf&&) noexcept = default;
RglBrdf& RglBrdf::operator=(RglBrdf&&) noexcept = default;
RglBrdf::~RglBrdf() = default;

RglBrdf RglBrdf::Parse(std::string_view bytes, const std::string& source,
                       const std::string& bands) {
  const TensorFile file(bytes, source);
  if (file.Has("M") && file.Has("theta_h")) {
    throw ErrorIn(ErrorKind::kUnsupported, source,
                  "this is a polarised .pbsdf file of Mueller matrices; save their first entry, "
                  "the BRDF of unpolarised light, as CSV")
        .About("M");
  }
  const std::vector<double> phi_i = ReadAngles(file, "phi_i", -2 * kPi, 2 * kPi);
  const std::vector<double> theta_i = ReadAngles(file, "theta_i", 0, kPi / 2);
  const int symmetry = SymmetryOf(file, phi_i);
  if (file.Byte("jacobian") == 0) {
    file.Fail("jacobian", "is 0: values without the microfacet Jacobian cannot be read");
  }
  const int p = static_cast<int>(phi_i.size()), t = static_cast<int>(theta_i.size());
  BilinearStack vndf = ReadNonNegative(file, "vndf", {p, t});
  if (const int slice = BilinearWarp::FirstVanishing(vndf); slice >= 0) {
    file.Fail("vndf", "is 0 everywhere at entry " + std::to_string(slice % t) + " of theta_i",
              ErrorKind::kData, std::to_string(slice % t));
  }
  Colors colors = ReadColors(file, p, t, bands, source);
  if (p > 1) {  // spectra of all azimuths take much memory
    colors.wavelengths.clear();
    colors.spectra = {};
  }
  RglMask mask(file, theta_i, p * t, colors.rgb.rows, colors.rgb.columns);
  return RglBrdf(std::make_unique<const Tables>(
      Tables{phi_i, theta_i, symmetry, ReadNonNegative(file, "ndf", {}),
             ReadNonNegative(file, "sigma", {}), BilinearWarp(std::move(vndf)),
             std::move(colors.rgb), std::move(colors.wavelengths), std::move(colors.spectra),
             colors.bands, std::move(colors.note), std::move(mask)}));
}

bool RglBrdf::isotropic() const { return tables_->phi_i.size() == 1; }

double RglBrdf::max_theta() const { return tables_->mask.max_theta(); }

RglBrdf::Place RglBrdf::Locate(const DirectionPair& directions) const {
  if (!(directions.wi[2] > 0 && directions.wo[2] > 0)) return {};
  const auto signs = FoldingSigns(tables_->symmetry, directions.wi);
  const Direction wi = ApplySigns(directions.wi, signs), wo = ApplySigns(directions.wo, signs);
  const Direction half = {wi[0] + wo[0], wi[1] + wo[1], wi[2] + wo[2]};
  const auto [theta_i, phi_i] = ToPolarAngles(wi);
  const auto [theta_m, phi_m] = ToPolarAngles(half);
  const SquarePoint u_i = ToSquare(theta_i, phi_i);
  const SquarePoint u_m = ToSquare(theta_m, isotropic() ? phi_m - phi_i : phi_m);

  SliceBlend blend;
  const double around =
      tables_->symmetry > 1 ? 0 : std::floor((phi_i - tables_->phi_i.front()) / (2 * kPi));
  const SliceBlend over_phi = Neighbours(tables_->phi_i, phi_i - 2 * kPi * around);
  const SliceBlend over_theta = Neighbours(tables_->theta_i, theta_i);
  for (int a = 0; a < over_phi.count; ++a) {
    for (int b = 0; b < over_theta.count; ++b) {
      blend.Add(over_phi.slice[a] * static_cast<int>(tables_->theta_i.size()) + over_theta.slice[b],
                over_phi.weight[a] * over_theta.weight[b]);
    }
  }

  // If the projected area vanishes, no microfacet is seen: nothing is reflected.
  const double divisor = 4 * tables_->sigma.At(0, u_i) * wo[2];
  if (!(divisor > 0)) return {};
  const SquarePoint x = tables_->vndf.Invert(blend, u_m);
  return {.blend = blend, .x = x, .factor = tables_->ndf.At(0, u_m) / divisor, .seen = true};
}

MeasuredValue RglBrdf::LookUp(const DirectionPair& directions) const {
  const Place at = Locate(directions);
  if (!at.seen) return {};
  MeasuredValue looked_up{.measured = tables_->mask.Measured(at.blend, at.x)};
  for (int channel = 0; channel < kChannels; ++channel) {
    looked_up.rho[channel] = at.ValueIn(tables_->rgb, kChannels, channel);
  }
  return looked_up;
}

int RglBrdf::bands() const { return tables_->bands; }

const std::string& RglBrdf::bands_note() const { return tables_->bands_note; }

const std::vector<double>& RglBrdf::wavelengths() const { return tables_->wavelengths; }

std::vector<double> RglBrdf::Spectrum(const DirectionPair& directions) const {
  const auto bands = static_cast<int>(wavelengths().size());
  std::vector<double> spectrum(bands);
  const Place at = Locate(directions);
  for (int l = 0; l < bands && at.seen; ++l) {
    spectrum[l] = at.ValueIn(tables_->spectra, bands, l);
  }
  return spectrum;
}

Measurement RglBrdf::Sample(const std::string& source, bool extrapolated) const {
  const Tables& t = *tables_;
  const auto thetas = static_cast<int>(t.theta_i.size());
  const int rows = t.rgb.rows, columns = t.rgb.columns;
  // A circle ends where it begins, and so does a half of one, turned. The ends of a quarter are
  // their own mirror images.
  const auto last = static_cast<int>(t.phi_i.size()) - 1;
  const int phis = t.symmetry == 4 ? last + 1 : last;
  SampleCollector collector(source, "RGL measurement, anisotropic, at its own directions");
  for (int slice = 0; slice < phis * thetas; ++slice) {
    const double phi_i = t.phi_i[slice / thetas], theta_i = t.theta_i[slice % thetas];
    const bool at_end = slice / thetas == 0 || slice / thetas == last;
    const int copies = t.symmetry == 4 && at_end ? 2 : t.symmetry;
    const Direction wi = ToDirection({theta_i, phi_i});
    const SquarePoint u_i = ToSquare(theta_i, phi_i);
    SliceBlend blend;
    blend.Add(slice, 1);
    // The last row stands for the same azimuths as the first, and so do all rows at theta_m = 0.
    for (int node = 0; node < (rows - 1) * columns; ++node) {
      const int row = node / columns, column = node % columns;
      if (column == 0 && row > 0) continue;
      const SquarePoint x = {static_cast<double>(column) / (columns - 1),
                             static_cast<double>(row) / (rows - 1)};
      const SquarePoint u_m = t.vndf.Sample(slice, x);
      const Direction m = ToDirection({u_m.x * u_m.x * (kPi / 2), (u_m.y - 0.5) * (2 * kPi)});
      const double cos_d = Dot(wi, m);
      const Direction wo = {2 * cos_d * m[0] - wi[0], 2 * cos_d * m[1] - wi[1],
                            2 * cos_d * m[2] - wi[2]};
      const double divisor = 4 * t.sigma.At(0, u_i) * wo[2];
      const bool above = wi[2] > 0 && wo[2] > 0 && cos_d > 0;
      Rgb rho{};
      for (int channel = 0; channel < kChannels && divisor > 0; ++channel) {
        const double value = t.rgb.At(slice * kChannels + channel, x) * t.ndf.At(0, u_m) / divisor;
        rho[channel] = value > 0 ? std::min(value, std::numeric_limits<double>::max()) : 0.0;
      }
      const auto [theta_o, phi_o] = ToPolarAngles(wo);
      for (int copy = 0; copy < copies; ++copy) {
        if (!above) {
          collector.LeaveOut(&BinCounts::below_surface);
        } else if (!extrapolated && std::max(theta_i, theta_o) > t.mask.max_theta() + kRounding) {
          collector.LeaveOut(&BinCounts::beyond_nodes);
        } else if (!extrapolated && !t.mask.Measured(blend, x)) {
          collector.LeaveOut(&BinCounts::extrapolated);
        } else {
          collector.Add(Copied({theta_i, phi_i, theta_o, phi_o}, copy), rho);
        }
      }
    }
  }
  Measurement measurement = collector.Take();
  measurement.anisotropic = true;
  return measurement;
}

BrdfTable TabulateRgl(const RglBrdf& brdf, const std::string& source, const MerlGrid& grid,
                      int num_threads) {
  if (!brdf.isotropic()) {
    throw ErrorIn(ErrorKind::kUnsupported, source,
                  "the material is anisotropic (field 'phi_i' has several entries); only isotropic "
                  "ones fit a MERL table")
        .About("phi_i");
  }
  BrdfTable table = MakeInvalidTable(source, grid);
  const std::vector<bool> above = BinsAboveSurface(grid);
  table.max_theta = brdf.max_theta();
  const double min_cosine = table.max_theta < kPi / 2 ? std::cos(table.max_theta) : 0;
  table.unmeasured.assign(grid.size(), Unmeasured::kNo);
  const int row_size = grid.theta_d * grid.phi_d;
  ParallelFor(grid.theta_h, num_threads, [&](int h) {
    for (int bin = h * row_size; bin < (h + 1) * row_size; ++bin) {
      if (!above[bin]) continue;
      const DirectionPair directions = ToDirections(grid.Center(bin));
      const MeasuredValue value = brdf.LookUp(directions);
      for (int channel = 0; channel < kChannels; ++channel) {
        table.SetValue(channel, bin, value.rho[channel]);
      }
      if (std::min(directions.wi[2], directions.wo[2]) < min_cosine) {
        table.unmeasured[bin] = Unmeasured::kBeyondNodes;
      } else if (!value.measured) {
        table.unmeasured[bin] = Unmeasured::kExtrapolated;
      }
    }
  });
  return table;
}

namespace {

// Beyond its last measured angles nothing counts as measured.
std::function<MeasuredValue(const DirectionPair&)> MakeLookUp(std::shared_ptr<const RglBrdf> rgl) {
  const double min_cosine = std::cos(rgl->max_theta()) - 1e-12;
  return [rgl = std::move(rgl), min_cosine](const DirectionPair& pair) {
    MeasuredValue value = rgl->LookUp(pair);
    value.measured = value.measured && std::min(pair.wi[2], pair.wo[2]) >= min_cosine;
    return value;
  };
}

// Spectra at some of the bins, as all would take gigabytes; enough for d, s and F of each
// wavelength.
BrdfSamples SpectraOf(const RglBrdf& brdf, const BrdfTable& table) {
  constexpr int kBins = 1 << 15;
  BrdfSamples samples = EvenlySpread(ValidSamples(table), kBins);
  Spectra spectra = {brdf.wavelengths(), {}};
  for (int j = 0; j < samples.size(); ++j) {
    const std::vector<double> rho = brdf.Spectrum(ToDirections(samples.Angles(j)));
    spectra.values.insert(spectra.values.end(), rho.begin(), rho.end());
  }
  samples.SetSpectra(std::move(spectra));
  return samples;
}

}  // namespace

MeasurementFormat RglFormat() {
  return {.name = "rgl",
          .description = "an RGL .bsdf file",
          .ending = ".bsdf",
          .is_text = false,
          .recognise = LooksLikeTensorFile,
          .read = [](std::string_view bytes, const std::string& source,
                     const SourceOptions& options) -> Measurement {
            auto rgl =
                std::make_shared<const RglBrdf>(RglBrdf::Parse(bytes, source, options.bands));
            const auto note_spectra = [&](Measurement* measurement) {
              measurement->bands = rgl->bands();
              if (rgl->bands() > 0) measurement->notes.push_back("read as: " + rgl->bands_note());
            };
            if (!rgl->isotropic()) {
              Measurement measurement = rgl->Sample(source, options.extrapolated);
              measurement.look_up = MakeLookUp(rgl);
              note_spectra(&measurement);
              return measurement;
            }
            Measurement measurement = {.source = source,
                                       .kind = "RGL measurement, at MERL bins",
                                       .table = TabulateRgl(*rgl, source, {}, options.num_threads),
                                       .look_up = MakeLookUp(rgl)};
            if (!rgl->wavelengths().empty() && CountsOf(measurement).valid > 0) {
              measurement.samples = SpectraOf(*rgl, *measurement.table);
            }
            note_spectra(&measurement);
            return measurement;
          }};
}

}  // namespace trilobe
