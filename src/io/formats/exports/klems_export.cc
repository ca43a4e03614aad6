#include "io/formats/exports/klems_export.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <pugixml.hpp>
#include <sstream>

#include "core/base/text.h"
#include "io/formats/optical/klems_basis.h"
#include "io/formats/spectrum.h"
#include "model/measurement/counter_random.h"
#include "trilobe/core/system/parallel.h"

namespace trilobe {
namespace {

// Azimuths of patches of the full basis begin and end at multiples of a turn over so many.
constexpr int kSectors = 480;
// Numbers of directions of light per patch, and of half vectors per direction.
constexpr int kThetas = 4, kGrazingThetas = 10, kPhis = 4, kRays = 48, kNodes = 96;

const KlemsBasis& Full() { return KlemsBases()[0]; }

double SquaredSine(double degrees) { return std::pow(std::sin(DegreesToRadians(degrees)), 2); }

// Projected solid angle of a patch.
double ProjectedSolidAngle(const KlemsRing& ring) {
  return kPi * (SquaredSine(ring.end) - SquaredSine(ring.begin)) / ring.patches;
}

size_t RingOf(double theta) {
  const double degrees = RadiansToDegrees(theta);
  const auto& rings = Full().rings;
  const auto ring = std::ranges::find_if(rings.begin(), rings.end() - 1,
                                         [&](const KlemsRing& one) { return degrees < one.end; });
  return ring - rings.begin();
}

// Light that goes into a part of the hemisphere, over the incident light.
struct Part {
  Rgb light{};       // integral of f cos theta_o d omega_o
  double angle = 0;  // integral of cos theta_o d omega_o, by the same rule
  Rgb least = {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
               std::numeric_limits<double>::infinity()};  // f

  void Add(const Part& other) {
    angle += other.angle;
    for (int c = 0; c < kChannels; ++c) {
      light[c] += other.light[c];
      least[c] = std::min(least[c], other.least[c]);
    }
  }

  // The mean of f. The rule is off where patches end, by as much for f as for 1; so it integrates
  // f - least, and least is integrated exactly.
  Rgb Mean(double projected_solid_angle) const {
    Rgb mean{};
    for (int c = 0; c < kChannels; ++c) {
      const double base = angle > 0 ? least[c] : 0;
      mean[c] = std::max(base + (light[c] - base * angle) / projected_solid_angle, 0.0);
    }
    return mean;
  }
};
using Parts = std::vector<Part>;  // [ring][sector]

// Two rules for the light that goes from wi into the hemisphere, together. One takes half vectors
// m,
//   d omega_o = 4 (wi . m) sin theta_m d theta_m d phi_m,
// evenly in phi_m and in the root of theta_m up to where wo meets the horizon, and so resolves
// highlights; the other takes a direction wo of each part of the hemisphere. A direction counts by
// the sum of how densely the two have theirs (the balance heuristic of Veach and Guibas 1995).
class LightRule {
 public:
  LightRule(const PairBrdf& brdf, const Direction& wi, double share, Parts* parts)
      : brdf_(brdf), wi_(wi), light_(ToPolarAngles(wi)), share_(share), parts_(*parts) {}

  void AddHalfVectors(uint64_t seed) {
    for (int ray = 0; ray < kRays; ++ray) {
      const double turn = 2 * kPi * (ray + UniformAt(seed, 2 * ray)) / kRays;
      const double shift = UniformAt(seed, 2 * ray + 1);
      for (int node = 0; node < kNodes; ++node) {
        const double root = LastRoot(turn) * (node + shift) / kNodes;
        AddHalfVector(ToDirection({root * root, light_.phi + turn}));
      }
    }
  }

  void AddParts(uint64_t seed) {
    for (size_t r = 0; r < Full().rings.size(); ++r) {
      const double from = SquaredSine(Full().rings[r].begin), to = SquaredSine(Full().rings[r].end);
      for (int s = 0; s < kSectors; ++s) {
        const double t = UniformAt(seed, r * kSectors + s);
        const double phi = 2 * kPi * (s + 0.5) / kSectors;
        Add(ToDirection({std::asin(std::sqrt(from + (to - from) * t)), phi}), r, s);
      }
    }
  }

 private:
  // The root of theta_m where wo meets the horizon.
  double LastRoot(double turn) const {
    const double psi = std::atan2(std::sin(light_.theta) * std::cos(turn), std::cos(light_.theta));
    return std::sqrt((psi + kPi / 2) / 2);
  }

  void AddHalfVector(const Direction& m) {
    const double twice = 2 * Dot(wi_, m);
    const Direction wo = {twice * m[0] - wi_[0], twice * m[1] - wi_[1], twice * m[2] - wi_[2]};
    if (!(wo[2] > 0)) return;  // rounding, at the very horizon
    const PolarAngles out = ToPolarAngles(wo);
    const double turns = out.phi / (2 * kPi);
    const int sector = static_cast<int>((turns - std::floor(turns)) * kSectors);
    Add(wo, RingOf(out.theta), std::min(sector, kSectors - 1));
  }

  void Add(const Direction& wo, size_t ring, int sector) {
    const PolarAngles m = HalfVector({wi_, wo});
    const double root = std::sqrt(m.theta);
    const double of_half_vector = wo[2] * 4 * Dot(wi_, ToDirection(m)) * std::sin(m.theta) * 2 *
                                  root * LastRoot(m.phi - light_.phi) / kNodes * 2 * kPi / kRays;
    const KlemsRing& there = Full().rings[ring];
    const double of_part = ProjectedSolidAngle(there) * there.patches / kSectors;
    Part sample;
    sample.least = brdf_({wi_, wo});
    sample.angle = share_ * of_half_vector * of_part / (of_half_vector + of_part);
    for (int c = 0; c < kChannels; ++c) sample.light[c] = sample.angle * sample.least[c];
    parts_[ring * kSectors + sector].Add(sample);
  }

  const PairBrdf& brdf_;
  const Direction wi_;
  const PolarAngles light_;
  const double share_;
  Parts& parts_;
};

// Reflected light for incidence that is even, by projected solid angle, from opposite a patch.
Parts LightOf(const PairBrdf& brdf, const KlemsRing& ring, double phi, uint64_t seed) {
  Parts parts(Full().rings.size() * kSectors);
  const double from = SquaredSine(ring.begin), to = SquaredSine(ring.end);
  const int thetas = ring.end == 90 ? kGrazingThetas : kThetas;
  for (int t = 0; t < thetas; ++t) {
    const double theta = std::asin(std::sqrt(from + (to - from) * (t + 0.5) / thetas));
    for (int p = 0; p < kPhis; ++p) {
      const double offset = ((p + 0.5) / kPhis - 0.5) * 2 * kPi / ring.patches;
      LightRule rule(brdf, ToDirection({theta, phi + kPi + offset}), 1.0 / (thetas * kPhis),
                     &parts);
      const uint64_t number = (seed * kGrazingThetas + t) * kPhis + p;
      rule.AddHalfVectors(2 * number);
      rule.AddParts(2 * number + 1);
    }
  }
  return parts;
}

// The means of a column, of light by which the hemisphere is turned by so many sectors.
std::vector<Rgb> ColumnOf(const Parts& parts, int turned) {
  std::vector<Rgb> means;
  for (size_t r = 0; r < Full().rings.size(); ++r) {
    const KlemsRing& ring = Full().rings[r];
    const int width = kSectors / ring.patches;
    for (int k = 0; k < ring.patches; ++k) {
      Part patch;
      const int first = k * width - width / 2 - turned + 2 * kSectors;
      for (int s = first; s < first + width; ++s) patch.Add(parts[r * kSectors + s % kSectors]);
      means.push_back(patch.Mean(ProjectedSolidAngle(ring)));
    }
  }
  return means;
}

}  // namespace

std::vector<Rgb> KlemsMeans(const ExportedBrdf& brdf, int num_threads) {
  struct Column {
    const KlemsRing* ring;
    int patch;
  };
  std::vector<Column> columns;
  for (const KlemsRing& ring : Full().rings) {
    for (int k = 0; k < ring.patches; ++k) columns.push_back({&ring, k});
  }
  const size_t size = columns.size();
  std::vector<Rgb> means(size * size);
  // Columns of an isotropic BRDF are those of the first patch of a ring, turned.
  ParallelFor(static_cast<int>(size), num_threads, [&](int first) {
    const auto& [ring, patch] = columns[first];
    if (!brdf.anisotropic && patch > 0) return;
    const Parts parts = LightOf(brdf.value, *ring, 2 * kPi * patch / ring->patches, first);
    const int turns = brdf.anisotropic ? 1 : ring->patches;
    for (int k = 0; k < turns; ++k) {
      const std::vector<Rgb> column = ColumnOf(parts, k * kSectors / ring->patches);
      for (size_t o = 0; o < size; ++o) means[o * size + first + k] = column[o];
    }
  });
  return means;
}

namespace {

Rgb ValueAt(const std::vector<Rgb>& means, const DirectionPair& pair) {
  const auto patch_of = [](const PolarAngles& at) {
    const size_t r = RingOf(at.theta);
    size_t before = 0;
    for (size_t k = 0; k < r; ++k) before += Full().rings[k].patches;
    const int patches = Full().rings[r].patches;
    const double turns = at.phi / (2 * kPi) + 0.5 / patches;
    return before + std::min(static_cast<int>((turns - std::floor(turns)) * patches), patches - 1);
  };
  const PolarAngles light = ToPolarAngles(pair.wi);
  const size_t i = patch_of({light.theta, light.phi + kPi}), o = patch_of(ToPolarAngles(pair.wo));
  return means[o * static_cast<size_t>(std::sqrt(means.size())) + i];
}

// --- XML -----------------------------------------------------------------------------------------

using Xml = pugi::xml_node;

void AppendText(const char* name, const std::string& text, Xml* parent) {
  parent->append_child(name).text().set(text.c_str());
}

void AppendBasis(Xml* parent) {
  Xml basis = parent->append_child("AngleBasis");
  AppendText("AngleBasisName", Full().name, &basis);
  for (const KlemsRing& ring : Full().rings) {
    Xml block = basis.append_child("AngleBasisBlock");
    AppendText("Theta", Text(MiddleOf(ring)), &block);
    AppendText("nPhis", std::to_string(ring.patches), &block);
    Xml bounds = block.append_child("ThetaBounds");
    AppendText("LowerTheta", Text(ring.begin), &bounds);
    AppendText("UpperTheta", Text(ring.end), &bounds);
  }
}

// Appends the matrix of `channel` of `means`.
void AppendMatrix(const std::vector<Rgb>& means, int channel, const char* side, Xml* parent) {
  const size_t size = PatchesOf(Full()).size();
  std::string numbers = "\n";
  for (size_t k = 0; k < means.size(); ++k) {
    numbers += Text(means[k][channel], 6) + (k % size == size - 1 ? ",\n" : ", ");
  }
  Xml block = parent->append_child("WavelengthDataBlock");
  AppendText("WavelengthDataDirection", side, &block);
  AppendText("ColumnAngleBasis", Full().name, &block);
  AppendText("RowAngleBasis", Full().name, &block);
  AppendText("ScatteringDataType", "BRDF", &block);
  AppendText("ScatteringData", numbers, &block);
}

void AppendWavelength(const std::vector<Rgb>& means, int channel, const char* name, char detector,
                      Xml* layer) {
  Xml data = layer->append_child("WavelengthData");
  AppendText("LayerNumber", "System", &data);
  AppendText("Wavelength", name, &data);
  data.child("Wavelength").append_attribute("unit") = "Integral";
  AppendText("SourceSpectrum", "CIE Illuminant D65 1nm.ssp", &data);
  AppendText("DetectorSpectrum", std::string("ASTM E308 1931 ") + detector + ".dsp", &data);
  for (const char* const side : {"Reflection Front", "Reflection Back"}) {
    AppendMatrix(means, channel, side, &data);
  }
}

std::string FormatXml(const std::vector<Rgb>& means, bool grey, const std::string& name) {
  pugi::xml_document document;
  Xml element = document.append_child("WindowElement");
  element.append_attribute("xmlns") = "http://windows.lbl.gov";
  AppendText("WindowElementType", "System", &element);
  AppendText("FileType", "BSDF", &element);
  Xml layer = element.append_child("Optical").append_child("Layer");
  Xml material = layer.append_child("Material");
  AppendText("Name", ValidUtf8(name), &material);
  AppendText("Manufacturer", "Trilobe", &material);
  AppendText("DeviceType", "Other", &material);
  Xml definition = layer.append_child("DataDefinition");
  AppendText("IncidentDataStructure", "Columns", &definition);
  AppendBasis(&definition);
  AppendWavelength(means, grey ? 0 : 1, "Visible", 'Y', &layer);
  if (!grey) {
    AppendWavelength(means, 0, "CIE-X", 'X', &layer);
    AppendWavelength(means, 2, "CIE-Z", 'Z', &layer);
  }
  std::ostringstream text;
  document.save(text, "", pugi::format_indent, pugi::encoding_utf8);
  return text.str();
}

}  // namespace

KlemsExport ExportKlems(const ExportedBrdf& brdf, const std::string& name, int num_threads) {
  std::vector<Rgb> means = KlemsMeans(brdf, num_threads);
  const ExportError error =
      MeasureError([&](const DirectionPair& pair) { return ValueAt(means, pair); }, brdf.places);
  const bool grey = AreGrey(means);
  KlemsExport result = {
      .bytes = {}, .colored = !grey, .median_error = error.median, .high_error = error.high};
  if (!grey) {
    for (Rgb& mean : means) mean = TristimulusOf(mean);
  }
  result.bytes = FormatXml(means, grey, name);
  return result;
}

}  // namespace trilobe
