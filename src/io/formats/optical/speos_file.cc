#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "core/base/text.h"
#include "core/files/text_lines.h"
#include "io/formats/spectrum_bands.h"
#include "io/formats/text/angle_list.h"
#include "io/formats/text/same_name.h"
#include "model/spectral_color.h"
#include "trilobe/core/base/error.h"
#include "trilobe/io/formats/measurement_format.h"

namespace trilobe {
namespace {

constexpr std::string_view kSpeosSpectral = "optis - brdf surface file";
constexpr std::string_view kSpeosAnisotropic = "optis - anisotropic bsdf surface file";

bool BeginsWith(std::string_view text, std::string_view name) {
  return SameName(text.substr(0, name.size()), name);
}

// Lines as they are, blank ones too, and numbers one after the other, wherever lines end.
class SpeosText {
 public:
  SpeosText(std::string_view text, const std::string& source) : rest_(text), source_(source) {}

  // Fails at the line of what was read last.
  [[noreturn]] void Fail(const std::string& problem, ErrorKind kind, std::string_view key,
                         std::string_view value = "") const {
    throw Error(kind, source_ + ": line " + std::to_string(at_) + ": " + problem)
        .At(source_, at_)
        .About(key, value);
  }

  // Reads up to the end of the line, or of the text.
  std::string_view RestOfLine(const char* what) {
    at_ = line_;
    if (rest_.empty()) Fail(std::string("the file ends before ") + what, ErrorKind::kMissing, what);
    const size_t end = std::min(rest_.find('\n'), rest_.size());
    const std::string_view line = rest_.substr(0, end);
    Skip(std::min(end + 1, rest_.size()));
    return Trimmed(line);
  }

  void Skip(size_t count) {
    const std::string_view skipped = rest_.substr(0, count);
    line_ += static_cast<int>(std::ranges::count(skipped, '\n'));
    rest_.remove_prefix(skipped.size());
  }

  double Number(const char* what) {
    constexpr std::string_view kBlanks = " \t\r\n";
    Skip(std::min(rest_.find_first_not_of(kBlanks), rest_.size()));
    at_ = line_;
    if (rest_.empty()) Fail(std::string("the file ends before ") + what, ErrorKind::kMissing, what);
    const std::string_view word =
        rest_.substr(0, std::min(rest_.find_first_of(kBlanks), rest_.size()));
    const std::optional<double> number = ToNumber(word);
    if (!number) {
      Fail("expected " + std::string(what) + ", not '" + Printable(word.substr(0, 40)) + "'",
           ErrorKind::kFormat, what, word);
    }
    rest_.remove_prefix(word.size());
    return *number;
  }

  int Count(const char* what) {
    constexpr double kMost = 10000;
    const double count = Number(what);
    if (!(count >= 1 && count <= kMost) || count != std::floor(count)) {
      Fail(std::string("expected ") + what + ", from 1 to 10000", ErrorKind::kRange, what,
           FactText(count));
    }
    return static_cast<int>(count);
  }

  bool Flag(const char* what) {
    const double flag = Number(what);
    if (flag != 0 && flag != 1) {
      Fail(std::string("expected ") + what + ", 0 or 1", ErrorKind::kFormat, what, FactText(flag));
    }
    return flag == 1;
  }

  // Reads ascending numbers.
  std::vector<double> Numbers(int count, const char* what, double least, double most) {
    std::vector<double> numbers;
    while (numbers.size() < static_cast<size_t>(count)) {
      numbers.push_back(Number(what));
      const double number = numbers.back();
      const bool ascends = numbers.size() == 1 || number > numbers[numbers.size() - 2];
      if (!(number >= least && number <= most) || !ascends) {
        Fail(Text(number) + " is none of ascending " + what + " from " + Text(least) + " to " +
                 Text(most),
             ErrorKind::kRange, what, FactText(number));
      }
    }
    return numbers;
  }

 private:
  std::string_view rest_;
  std::string source_;
  int line_ = 1, at_ = 1;
};

// --- Tables --------------------------------------------------------------------------------------

// Values by the angles of the outgoing direction. The mirror direction has phi = 0.
struct SpeosTable {
  std::vector<double> thetas, phis;  // [degrees]
  std::vector<double> values;        // [theta][phi]

  bool transmits() const { return thetas[0] >= 90; }
};

SpeosTable ReadSpeosTable(SpeosText* text) {
  SpeosTable table;
  const int thetas = text->Count("the number of theta");
  const int phis = text->Count("the number of phi");
  table.phis = text->Numbers(phis, "phi", 0, 360);
  for (int t = 0; t < thetas; ++t) {
    const double theta = text->Number("theta");
    if (!(theta >= 0 && theta <= 180) || (t > 0 && !(theta > table.thetas.back()))) {
      text->Fail(Text(theta) + " is none of ascending theta from 0 to 180", ErrorKind::kRange,
                 "theta", FactText(theta));
    }
    table.thetas.push_back(theta);
    for (int p = 0; p < phis; ++p) table.values.push_back(text->Number("a value"));
  }
  return table;
}

// How much of a turn each phi stands for: of half of one, all of which lies twice, or of a whole.
std::vector<double> SharesOfPhi(const std::vector<double>& phis, const SpeosText& text) {
  if (phis.size() == 1) return {1};
  const double first = phis.front(), last = phis.back(), reach = last - first;
  const double step = phis[1] - first;
  const bool closed = std::abs(reach - 360) < 1e-6;
  const bool half = std::abs(reach - 180) < 1e-6;
  const bool open = !half && std::abs(reach + step - 360) < 1e-6;
  if (!closed && !half && !open) {
    text.Fail("phi goes from " + Text(first) + " to " + Text(last) +
                  "; it must go round half a turn or a whole one",
              ErrorKind::kRange, "phi", FactText(last));
  }
  std::vector<double> shares(phis.size());
  for (size_t k = 0; k + 1 < phis.size(); ++k) {
    const double width = (phis[k + 1] - phis[k]) / (half ? 180 : 360);
    shares[k] += width / 2;
    shares[k + 1] += width / 2;
  }
  if (open) {
    shares.front() += step / 720;
    shares.back() += step / 720;
  }
  return shares;
}

// The light that the values are in proportion to: their integral over the hemisphere, those of a
// BSDF times the cosine; linear between the angles.
double LightOf(const SpeosTable& table, bool is_bsdf, const SpeosText& text) {
  const std::vector<double> shares = SharesOfPhi(table.phis, text);
  const auto mean = [&](size_t t) {
    const auto row = table.values.begin() + t * shares.size();
    return std::inner_product(shares.begin(), shares.end(), row, 0.0);
  };
  constexpr int kSteps = 16;
  double light = 0;
  for (size_t t = 0; t + 1 < table.thetas.size(); ++t) {
    const double from = DegreesToRadians(table.thetas[t]);
    const double width = DegreesToRadians(table.thetas[t + 1]) - from;
    const double lower = mean(t), upper = mean(t + 1);
    for (int k = 0; k < kSteps; ++k) {
      const double part = (k + 0.5) / kSteps, theta = from + part * width;
      if (theta >= kPi / 2) break;
      const double value = std::lerp(lower, upper, part);
      light += value * std::sin(theta) * (is_bsdf ? std::cos(theta) : 1) * width / kSteps;
    }
  }
  return 2 * kPi * light;
}

// Factor by which values are multiplied, for `reflectance`; 0 for a black table.
double ScaleOf(const SpeosTable& table, double reflectance, bool is_bsdf, const SpeosText& text) {
  const double light = LightOf(table, is_bsdf, text);
  return light > 0 ? reflectance / light : 0;
}

// Calls add(angles, k) for each direction, the k-th of the table. Light comes from theta_i, and
// from the azimuth 180 degrees - rotation.
template <typename Add>
void ForEachDirection(const SpeosTable& table, double theta_i, double rotation, const Add& add) {
  for (size_t t = 0; t < table.thetas.size(); ++t) {
    const size_t phis = table.thetas[t] == 0 ? 1 : Distinct(table.phis);
    for (size_t p = 0; p < phis; ++p) {
      const SphericalAngles at = {DegreesToRadians(theta_i), DegreesToRadians(180 - rotation),
                                  DegreesToRadians(table.thetas[t]),
                                  DegreesToRadians(table.phis[p] - rotation)};
      add(at, t * table.phis.size() + p);
    }
  }
}

// BRDF of a value of a table.
double SpeosValue(double value, const SphericalAngles& at, double scale, bool is_bsdf) {
  return scale * value / (is_bsdf ? 1 : std::cos(at.theta_o));
}

// --- Files ---------------------------------------------------------------------------------------

constexpr double kMostMicrons = 1e6;  // [nm]

// `.brdf`: a table of each incidence and wavelength, with its reflectance [%].
Measurement ReadSpectral(SpeosText* text, bool is_bsdf, const std::string& source,
                         const SourceOptions& options) {
  const int incidences = text->Count("the number of incidences");
  const int count = text->Count("the number of wavelengths");
  const auto theta_i = text->Numbers(incidences, "incidences", 0, 90);
  const auto wavelengths = text->Numbers(count, "wavelengths", 1, kMostMicrons);
  SpectrumBands bands(wavelengths, options.bands, source);
  SampleCollector collector(source, "Speos BRDF file of scattered samples");
  for (const double incidence : theta_i) {
    std::vector<SpeosTable> tables;
    std::vector<double> scales;
    while (tables.size() < wavelengths.size()) {
      const double reflectance = text->Number("a reflectance [%]") / 100;
      SpeosTable table = ReadSpeosTable(text);
      if (table.transmits()) continue;
      if (!(reflectance >= 0 && reflectance <= 10)) {
        text->Fail("the reflectance above is none", ErrorKind::kRange, "reflectance",
                   FactText(reflectance));
      }
      if (!tables.empty() && (table.thetas != tables[0].thetas || table.phis != tables[0].phis)) {
        text->Fail("the table above has other angles than those of other wavelengths",
                   ErrorKind::kMismatch, "angles");
      }
      scales.push_back(ScaleOf(table, reflectance, is_bsdf, *text));
      tables.push_back(std::move(table));
    }
    std::vector<double> spectrum(tables.size());
    ForEachDirection(tables[0], incidence, 0, [&](const SphericalAngles& at, size_t k) {
      for (size_t l = 0; l < tables.size(); ++l) {
        spectrum[l] = SpeosValue(tables[l].values[k], at, scales[l], is_bsdf);
      }
      bands.Add(at, spectrum, &collector);
    });
  }
  Measurement measurement = collector.Take();
  measurement.bands = bands.all();
  measurement.notes.push_back("read as: " + bands.Note() + ", ");
  return measurement;
}

struct Rotation {
  double degrees = 0;
  std::vector<double> theta_i;
};

std::vector<Rotation> ReadRotations(SpeosText* text) {
  std::vector<Rotation> rotations;
  const int count = text->Count("the number of anisotropy angles");
  for (const double degrees : text->Numbers(count, "anisotropy angles", 0, 360)) {
    rotations.push_back({degrees, {}});
  }
  for (Rotation& rotation : rotations) {
    const int incidences = text->Count("the number of incidences");
    rotation.theta_i = text->Numbers(incidences, "incidences", 0, 90);
  }
  return rotations;
}

// The reflectance of one direction of incidence, by wavelength.
struct SpeosSpectrum {
  double theta = 0, phi = 0;  // [degrees]
  std::vector<double> wavelengths, values;

  // Linear between wavelengths; of one for which all are the same, that.
  Rgb Color(const std::string& source) const {
    if (std::ranges::all_of(values, [&](double value) { return value == values[0]; })) {
      return {values[0], values[0], values[0]};
    }
    std::vector<double> dense, spectrum;
    for (double at = 380; at <= 780; at += 5) {
      const auto [lower, t] = FindBetween(wavelengths, at);
      dense.push_back(at);
      spectrum.push_back(std::lerp(values[lower], values[lower + 1], t));
    }
    return SpectralColor(dense, source)(spectrum);
  }
};

SpeosSpectrum ReadSpeosSpectrum(SpeosText* text) {
  SpeosSpectrum spectrum;
  spectrum.theta = text->Number("theta of the spectrum");
  spectrum.phi = text->Number("phi of the spectrum");
  text->RestOfLine("the description of the spectrum");
  text->RestOfLine("the description of the spectrum");
  const int count = text->Count("the number of wavelengths");
  for (int k = 0; k < count; ++k) {
    spectrum.wavelengths.push_back(text->Number("a wavelength [nm]"));
    const double percent = text->Number("a reflectance [%]");
    if (k > 0 && !(spectrum.wavelengths[k] > spectrum.wavelengths[k - 1])) {
      text->Fail("wavelengths must ascend", ErrorKind::kRange, "wavelengths");
    }
    if (!(percent >= 0 && percent <= 1000)) {
      text->Fail("this reflectance is none", ErrorKind::kRange, "reflectance", FactText(percent));
    }
    spectrum.values.push_back(percent / 100);
  }
  return spectrum;
}

// Factor for the values of all tables, for a reflectance of 1: that of the rotation nearest to the
// spectrum's phi, between the incidences about its theta.
double ScaleAt(const SpeosSpectrum& spectrum, const std::vector<Rotation>& rotations,
               const std::vector<SpeosTable>& tables, bool is_bsdf, const SpeosText& text) {
  size_t first = 0, at = 0, nearest = 0;  // tables
  double least = HUGE_VAL;
  for (size_t r = 0; r < rotations.size(); ++r) {
    const double distance = std::abs(rotations[r].degrees - spectrum.phi);
    if (distance < least) {
      least = distance;
      nearest = r;
      first = at;
    }
    at += rotations[r].theta_i.size();
  }
  const std::vector<double>& theta_i = rotations[nearest].theta_i;
  const auto scale = [&](size_t k) { return ScaleOf(tables[first + k], 1, is_bsdf, text); };
  const auto [lower, t] = FindBetween(theta_i, spectrum.theta);
  return t > 0 ? std::lerp(scale(lower), scale(lower + 1), t) : scale(lower);
}

// `.anisotropicbsdf`: a table of each anisotropy angle and incidence, and one spectrum for all.
Measurement ReadAnisotropic(SpeosText* text, bool transmits, bool is_bsdf,
                            const std::string& source) {
  const std::vector<Rotation> rotations = ReadRotations(text);
  if (transmits) ReadRotations(text);
  const SpeosSpectrum spectrum = ReadSpeosSpectrum(text);
  if (transmits) ReadSpeosSpectrum(text);
  std::vector<SpeosTable> tables;
  for (const Rotation& rotation : rotations) {
    for (size_t k = 0; k < rotation.theta_i.size(); ++k) {
      tables.push_back(ReadSpeosTable(text));
      if (tables.back().transmits()) {
        text->Fail("the table above is of transmitted light", ErrorKind::kUnsupported, "table");
      }
    }
  }
  const Rgb color = spectrum.Color(source);
  const double scale = ScaleAt(spectrum, rotations, tables, is_bsdf, *text);
  std::vector<double> degrees;
  for (const Rotation& rotation : rotations) degrees.push_back(rotation.degrees);
  SampleCollector collector(source, "Speos anisotropic BSDF file of scattered samples");
  size_t next = 0;
  for (size_t r = 0; r < Distinct(degrees); ++r) {
    for (const double theta_i : rotations[r].theta_i) {
      const SpeosTable& table = tables[next++];
      ForEachDirection(table, theta_i, degrees[r], [&](const SphericalAngles& at, size_t k) {
        const double value = SpeosValue(table.values[k], at, scale, is_bsdf);
        if (!(value >= 0)) {
          collector.Add(at, {value, value, value});
        } else {
          collector.AddColor(at, {value * color[0], value * color[1], value * color[2]});
        }
      });
    }
  }
  Measurement measurement = collector.Take();
  measurement.anisotropic = Distinct(degrees) > 1;
  return measurement;
}

// A BRDF in the text formats of Ansys Speos (formerly OPTIS; docs/file-formats.md). Values are in
// proportion to a BRDF or to an intensity, and scaled to the reflectance that the file gives.
// Throws Error, with the line, on anything else.
Measurement ParseSpeos(std::string_view bytes, const std::string& source,
                       const SourceOptions& options) {
  SpeosText text(bytes, source);
  const std::string_view header = text.RestOfLine("its header");
  const bool anisotropic = BeginsWith(header, kSpeosAnisotropic);
  if (!anisotropic && !BeginsWith(header, kSpeosSpectral)) {
    text.Fail("expected 'OPTIS - brdf surface file' or 'OPTIS - Anisotropic BSDF surface file'",
              ErrorKind::kFormat, "header");
  }
  const std::string_view version = header.substr(std::min(header.rfind('v'), header.size() - 1));
  const double number = ToNumber(version.substr(1)).value_or(0);
  if (!(number >= 7 && number < 10)) {
    text.Fail("version " + Printable(version.substr(0, 20)) +
                  " is not read; save it anew in the BSDF viewer of Speos, or as CSV",
              ErrorKind::kUnsupported, "version", version);
  }
  if (text.Flag("the mode")) {
    text.Fail("this is the binary mode; save it as text in the BSDF viewer of Speos",
              ErrorKind::kUnsupported, "mode");
  }
  text.RestOfLine("its comment");
  text.RestOfLine("its comment");
  const double characters = text.Number("the length of the description");
  text.RestOfLine("the description");
  if (!(characters >= 0 && characters <= 1e6)) {
    text.Fail("the length above is none", ErrorKind::kRange, "length", FactText(characters));
  }
  text.Skip(static_cast<size_t>(characters));
  text.RestOfLine("what follows the description");
  if (anisotropic) {
    for (const char* const axis : {"x of the anisotropy vector", "y of it", "z of it"}) {
      text.Number(axis);
    }
  }
  const bool reflects = text.Flag("whether it reflects");
  const bool transmits = text.Flag("whether it transmits");
  if (!reflects) {
    text.Fail("these are transmitted light; only reflection can be read", ErrorKind::kUnsupported,
              "reflection");
  }
  const bool is_bsdf = text.Flag("the type of the values");
  Measurement measurement = anisotropic ? ReadAnisotropic(&text, transmits, is_bsdf, source)
                                        : ReadSpectral(&text, is_bsdf, source, options);
  std::vector<std::string>& notes = measurement.notes;
  if (notes.empty()) notes.emplace_back("read as: ");
  notes[0] += std::string("values in proportion to ") + (is_bsdf ? "a BRDF" : "an intensity") +
              ", scaled to the reflectance that the file gives";
  return measurement;
}

bool LooksLikeSpeos(std::string_view text) {
  return BeginsWith(text, kSpeosSpectral) || BeginsWith(text, kSpeosAnisotropic);
}

}  // namespace

MeasurementFormat SpeosFormat() {
  return {.name = "speos",
          .description = "a Speos .brdf or .anisotropicbsdf text",
          .ending = ".anisotropicbsdf",
          .is_text = true,
          .recognise = LooksLikeSpeos,
          .read = ParseSpeos};
}

}  // namespace trilobe
