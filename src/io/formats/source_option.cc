#include "io/formats/source_option.h"

#include <charconv>
#include <optional>
#include <utility>

#include "core/base/names.h"
#include "core/files/option_row.h"
#include "core/files/text_lines.h"
#include "io/formats/databases/utia_file.h"
#include "io/formats/spectrum_bands.h"
#include "trilobe/core/base/check.h"
#include "trilobe/core/base/error.h"
#include "trilobe/model/measurement/corruption.h"

namespace trilobe {
namespace {

// The row of the option that is this member.
template <OptionName kName, auto kMember>
SourceOption Option(SourceOption row) {
  return MemberRow<SourceOption, kName, kMember>(std::move(row));
}

void SetTilt(std::string_view text, SourceOptions* options) {
  options->tilt_deg = text == "auto" ? std::nullopt : ToNumber(text);
  if (text != "auto" && !options->tilt_deg) {
    FailOptionText("tilt", text, "a number of degrees from -30 to 30, or auto");
  }
}

// By "1" or "i:1" of cos theta_i, by "o:1" of cos theta_o.
void SetCosine(std::string_view text, SourceOptions* options) {
  const bool outgoing = text.starts_with("o:");
  const bool named = outgoing || text.starts_with("i:");
  const std::optional<double> exponent = ToNumber(text.substr(named ? 2 : 0));
  if (!exponent) {
    throw Error(
        ErrorKind::kFormat,
        "--cosine=" + std::string(text) +
            ": give the exponent of cos theta_i that values have been multiplied by, as 1, or "
            "of cos theta_o, as o:1")
        .About("cosine", text);
  }
  (outgoing ? options->cosine_o : options->cosine) = *exponent;
}

void SetAzimuth(std::string_view text, SourceOptions* options) {
  if (text != "from_mirror" && text != "from_light") {
    FailOptionText("azimuth", text, "from_mirror or from_light");
  }
  options->azimuth_from_mirror = text == "from_mirror";
}

void SetDataSeed(std::string_view text, SourceOptions* options) {
  const char* const end = text.data() + text.size();
  const auto [parsed, error] = std::from_chars(text.data(), end, options->seed);
  if (error != std::errc() || parsed != end) FailOptionText("data_seed", text, "an integer from 0");
}

bool IsSeedUsed(const SourceOptions& of) {
  return !of.seed_is_for_data || of.noise > 0 || of.missing > 0 || !of.corrupt.empty();
}

bool IsSynth(std::string_view reader, const Measurement& /*measurement*/) {
  return reader == "synth:";
}
bool IsTextTable(std::string_view reader, const Measurement& /*measurement*/) {
  return reader == "csv";
}

// -1 stands for no angle.
bool IsAngleOrNone(double degrees) { return degrees == -1 || (degrees >= 0 && degrees < 90); }

std::vector<SourceOption> MakeOptions() {
  using Options = SourceOptions;
  return {
      Option<"noise", &Options::noise>(
          {.help = "relative noise of a synth: source",
           .range = {"from 0 to 1", [](double x) { return x >= 0 && x <= 1; }},
           .of = "--noise is of synth: sources",
           .applies = IsSynth}),
      Option<"missing", &Options::missing>(
          {.help = "share of the measured bins or samples to leave out at random, by --data_seed, "
                   "to see how a fit does with fewer",
           .range = {"from 0 up to 1", [](double x) { return x >= 0 && x < 1; }},
           .changes_values = true}),
      Option<"corrupt", &Options::corrupt>(
          {.help =
               "simulate errors of instruments, by --data_seed: KIND:STRENGTH,..., such as "
               "noise:0.05,gaps:0.9; `trilobe help convert` lists the kinds (docs/your-data.md)",
           .changes_values = true}),
      {.name = "tilt",
       .help = "tilt of the measured sample to correct, in degrees towards azimuth 0, from which "
               "the light of a table comes, from -30 to 30; `trilobe info` tells; auto: as the "
               "highlight of a table shows",
       .default_value = "0",
       .changes_values = true,
       .set = SetTilt,
       .get =
           [](const Options& of) {
             return of.tilt_deg ? OptionText(*of.tilt_deg) : std::string("auto");
           }},
      {.name = "cosine",
       .help = "correct a measurement that has been multiplied by cos theta_i to this power, from "
               "-2 to 2: 1 for one cosine too many, -1 for one too few; o:1 for cos theta_o; "
               "`trilobe info` tells",
       .default_value = "0",
       .changes_values = true,
       .set = SetCosine,
       .get =
           [](const Options& of) {
             return OptionText(of.cosine) + ",o:" + OptionText(of.cosine_o);
           }},
      Option<"scale", &Options::scale>(
          {.help = "multiply all values by this: 0.01 for percents, 0.3183 for pi f, 1 for a "
                   "reflectance that is f in 1/sr; 0: not given",
           .range = {"from 1e-6 to 1e6, or 0 for none",
                     [](double x) { return x == 0 || (x >= 1e-6 && x <= 1e6); }},
           .changes_values = true}),
      {.name = "azimuth",
       .help = "from_mirror: azimuths phi_o of scattered samples are counted from the mirror "
               "direction; `trilobe info` tells",
       .default_value = "from_light",
       .of = "--azimuth is of scattered samples",
       .applies = [](std::string_view, const Measurement& measured) { return !measured.table; },
       .set = SetAzimuth,
       .get =
           [](const Options& of) {
             return std::string(of.azimuth_from_mirror ? "from_mirror" : "from_light");
           }},
      {.name = "data_seed",
       .help = "seed of random changes to the measurement: the noise of synth: sources, --missing "
               "and --corrupt; if given, --seed varies the start alone, on the same data; by "
               "default the value of --seed",
       .default_value = "",
       .of = "--data_seed, by default --seed, is of --noise, --missing and --corrupt",
       .is_used = IsSeedUsed,
       .changes_values = true,
       .set = SetDataSeed,
       .get = [](const Options& of) { return std::to_string(of.seed); }},
      Option<"max_angle", &Options::max_angle_deg>(
          {.help = "leave out bins whose theta_i or theta_o is beyond this",
           .range = {"in degrees above 0, up to 90", [](double x) { return x > 0 && x <= 90; }},
           .changes_values = true}),
      Option<"min_theta_d", &Options::min_theta_d_deg>(
          {.help = "leave out bins whose theta_d, half the angle between the two directions, is "
                   "below this, since a detector there blocks the light; -1: as far as scattered "
                   "samples show that it did",
           .range = {"in degrees from 0 to below 90, or -1 to go by the data", IsAngleOrNone},
           .changes_values = true}),
      Option<"extrapolated", &Options::extrapolated>(
          {.help = "for an RGL file: also take values that its authors extrapolated instead of "
                   "measuring, and those beyond its last theta_i; of scattered samples, what seems "
                   "to be filled in",
           .of = "--extrapolated is of RGL files and of scattered samples",
           .applies =
               [](std::string_view reader, const Measurement& measured) {
                 return reader == "rgl" || !measured.table;
               }}),
      Option<"outliers", &Options::outliers>({.help = "also take the bins of a table that are much "
                                                      "darker or brighter than those around them"}),
      Option<"dark_noise", &Options::dark_noise>(
          {.help = "keep the readings of a table whose dark noise is more than a tenth of their "
                   "signal; by default they become medians of the values around them"}),
      Option<"radiometry", &Options::radiometry>(
          {.help = "quantity that a UTIA file stores: brdf, cosine, srgb or dj_brdf "
                   "(docs/file-formats.md)",
           .of = "--radiometry is of UTIA files",
           .applies = [](std::string_view reader,
                         const Measurement&) { return reader == "utia"; }}),
      Option<"columns", &Options::columns>(
          {.help = "names of the columns of a text table, in the place of a header: "
                   "theta_i,phi_i,theta_o,phi_o,r,g,b, or f for one value, 550nm for that at a "
                   "wavelength, and - for a column to leave out; or theta_i=NAME,f=NAME by the "
                   "names of its header (docs/file-formats.md)",
           .of = "--columns is of text tables",
           .applies = IsTextTable}),
      Option<"rows", &Options::rows>(
          {.help = "the rows of a text table with these cells alone: polarization=s,sample=2",
           .of = "--rows is of text tables",
           .applies = IsTextTable}),
      Option<"theta_i", &Options::theta_i_deg>(
          {.help = "angle of incidence of all samples of a text table without a column theta_i",
           .range = {"in degrees from 0 to below 90, or -1 for none", IsAngleOrNone},
           .of = "--theta_i is of text tables",
           .applies = IsTextTable}),
      Option<"theta_o", &Options::theta_o_deg>(
          {.help = "the same of a table without a column theta_o, as of a detector that stands "
                   "still",
           .range = {"in degrees from 0 to below 90, or -1 for none", IsAngleOrNone},
           .of = "--theta_o is of text tables",
           .applies = IsTextTable}),
      Option<"bands", &Options::bands>(
          {.help = "wavelengths of spectra to read, in nm: one, as 550, for all channels; three, "
                   "as 650,550,450, as r, g and b, the longest as r; or more, to make a colour of; "
                   "by default all make a colour, and --spectral keeps each (docs/file-formats.md)",
           .of = "--bands is of spectra",
           .applies = [](std::string_view, const Measurement& measured) {
             return measured.bands != 0;
           }})};
}

}  // namespace

const std::vector<SourceOption>& AllSourceOptions() {
  static const std::vector<SourceOption> options = MakeOptions();
  return options;
}

const SourceOption& FindSourceOption(std::string_view name) {
  return FindNamed("option of a measurement", name, AllSourceOptions());
}

std::vector<const SourceOption*> GivenOptions(const SourceOptions& options) {
  std::vector<const SourceOption*> given;
  for (const SourceOption& option : AllSourceOptions()) {
    if (option.get(options) != option.get({})) given.push_back(&option);
  }
  return given;
}

void CheckSourceOptions(const SourceOptions& options) {
  CheckNumThreads(options.num_threads);
  for (const SourceOption& option : AllSourceOptions()) {
    CheckRange(option, options);
  }
  FindNamed("radiometry", options.radiometry, UtiaRadiometries());
  ParseCorruptions(options.corrupt);
  ParseBands(options.bands);
  const double tilt = options.tilt_deg.value_or(0);
  CheckNumber("--tilt", tilt, tilt >= -30 && tilt <= 30, "in degrees from -30 to 30, or auto");
  for (const double exponent : {options.cosine, options.cosine_o}) {
    CheckNumber("--cosine", exponent, exponent >= -2 && exponent <= 2, "from -2 to 2");
  }
}

}  // namespace trilobe
