#include "app/flags.h"

#include <gflags/gflags.h>

#include <algorithm>
#include <iostream>
#include <sstream>
#include <thread>
#include <utility>

#include "core/base/text.h"
#include "core/files/text_lines.h"
#include "io/formats/source_option.h"
#include "io/formats/utia_file.h"
#include "io/pictures/image_file.h"
#include "trilobe/core/base/error.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/model/objective/weighting.h"

DEFINE_int32(threads, 0, "threads to use; 0 for all cores");
DEFINE_int64(
    seed, 1,
    "seed of whatever is random: --init=random, random starts of a solver, and what --data_seed is "
    "of unless that is given");
DEFINE_int64(
    data_seed, -1,
    "seed of what is done to the measurement: the noise of synth: sources, --missing and "
    "--corrupt; with one of its own, --seed alone moves the start on the same data; -1: as "
    "--seed");
DEFINE_int32(lobes, 3, "specular lobes of the full model, 0 to 8");
DEFINE_double(noise, 0, "relative noise of a synth: source, 0 to 1");
DEFINE_double(
    missing, 0,
    "share of the measured bins or samples to leave out at random, by --data_seed, from 0 up "
    "to 1: how would a fit do with fewer?");
DEFINE_string(corrupt, "",
              "do to the measurement what instruments do, by --data_seed: KIND:STRENGTH,..., as "
              "noise:0.05,gaps:0.9; `trilobe help convert` lists the kinds (docs/your-data.md)");
DEFINE_string(
    cosine, "0",
    "correct a measurement that has been multiplied by cos theta_i to this power, from -2 "
    "to 2: 1 where it has a cosine too many, -1 where it has one too few; o:1 where that "
    "is cos theta_o; `trilobe info` tells");
DEFINE_double(scale, 1,
              "multiply all values by this, from 1e-6 to 1e6: 0.01 for percents, 0.3183 for pi f");
DEFINE_string(azimuth, "from_light",
              "from_mirror: azimuths phi_o of scattered samples are counted from the mirror "
              "direction; `trilobe info` tells");
DEFINE_string(tilt, "0",
              "correct a measurement whose sample leant by so many degrees towards azimuth 0, from "
              "which the light of a table comes, from -30 to 30; `trilobe info` tells; auto: as "
              "the highlight of a table shows");
DEFINE_double(max_angle, 90,
              "leave out bins whose theta_i or theta_o is beyond this, in degrees, above 0 to 90");
DEFINE_double(min_theta_d, -1,
              "leave out bins whose theta_d, half the angle between the two directions, is below "
              "this, in degrees, from 0 to below 90, since a detector there stands in its own "
              "light; -1: as far as scattered samples show that it did");
DEFINE_bool(extrapolated, false,
            "of an RGL file, also take what its authors did not measure but extrapolated, and what "
            "lies beyond its last theta_i");
DEFINE_bool(
    outliers, false,
    "also take the bins of a table that are much darker or brighter than those around them");
DEFINE_bool(dark_noise, false,
            "take the readings of a table as they are, though dark noise is more than a tenth of "
            "their signal; else they become medians of what surrounds them");
DEFINE_string(radiometry, trilobe::UtiaRadiometries().front().name,
              "what the numbers of a UTIA file are: brdf, cosine, srgb or dj_brdf "
              "(docs/file-formats.md)");
DEFINE_string(columns, "",
              "of a text table, the names of its columns, in the place of a header: "
              "theta_i,phi_i,theta_o,phi_o,r,g,b, or f for one value, 550nm for that at a "
              "wavelength, and - for a column to leave out (docs/file-formats.md)");
DEFINE_double(theta_i, -1,
              "of a text table without a column theta_i, the angle of incidence of all its "
              "samples, in degrees from 0 to below 90");
DEFINE_string(
    bands, "",
    "of spectra, the wavelengths to read, in nm: one, as 550, for all channels; three, as "
    "650,550,450, as r, g and b, the longest as r; or more, to make a colour of; without, "
    "all make a colour, and --spectral keeps each (docs/file-formats.md)");
DEFINE_string(weighting, trilobe::Weightings().front().name,
              "weights of the objective: a name, or power:KEY=VALUE,... (docs/objective.md)");
DEFINE_string(out, "", "where to write: a file or, for fit, study, info and plot, a folder");
DEFINE_bool(force, false,
            "overwrite or remove what is in the way of --out, though Trilobe has not written it");
DEFINE_bool(json, false, "print one JSON object instead of a table");
DEFINE_bool(verbose, false,
            "print all there is to say, and not only the verdict and what it rests on");

DEFINE_string(
    probe, "",
    "light probe for the spheres, a lat-long Radiance .hdr file; without it a built-in sky "
    "with a sun and area lights");

namespace trilobe {

bool IsDefault(const std::string& flag) {
  return gflags::GetCommandLineFlagInfoOrDie(flag.c_str()).is_default;
}

std::map<std::string, std::string> GivenFlags(const std::vector<std::string>& flags) {
  std::map<std::string, std::string> given;
  for (const std::string& flag : flags) {
    const auto info = gflags::GetCommandLineFlagInfoOrDie(flag.c_str());
    if (!info.is_default) given[flag] = info.current_value;
  }
  return given;
}

std::string FlagHelp(const std::string& flag) {
  const auto info = gflags::GetCommandLineFlagInfoOrDie(flag.c_str());
  std::string value = info.default_value.empty() ? "..." : info.default_value;
  if (info.type == "double") value = Text(std::stod(value));  // gflags gives 17 digits
  return "  --" + flag + "=" + value + "\n      " + info.description + "\n";
}

int ThreadsFromFlags() {
  if (FLAGS_threads < 0) throw Error("--threads is negative; give 0 for all cores");
  // Those that this process may use.
  const int cores = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  if (FLAGS_threads == 0) return cores;
  static bool told = false;
  if (FLAGS_threads > cores && !std::exchange(told, true)) {
    std::cerr << "trilobe: --threads=" << FLAGS_threads
              << " is more than there are cores, which gains nothing; using " << cores << "\n";
  }
  return std::min(FLAGS_threads, cores);
}

SourceOptions SourceOptionsFromFlags() {
  if (FLAGS_data_seed < -1) throw Error("--data_seed must be 0 or more, or -1: as --seed");
  SourceOptions options = {.seed = static_cast<uint64_t>(FLAGS_seed),
                           .num_threads = ThreadsFromFlags()};
  for (const SourceOption& option : AllSourceOptions()) {
    const auto flag = gflags::GetCommandLineFlagInfoOrDie(option.name.c_str());
    if (flag.current_value != flag.default_value) option.set(flag.current_value, &options);
  }
  CheckSourceOptions(options);
  return options;
}

std::vector<std::string> MeasurementFlags() {
  std::vector<std::string> flags;
  for (const SourceOption& option : AllSourceOptions()) {
    if (option.name == "data_seed") flags.emplace_back("seed");
    flags.push_back(option.name);
  }
  return flags;
}

std::vector<std::string> Split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, separator);) {
    const size_t begin = part.find_first_not_of(' ');
    parts.push_back(begin == std::string::npos
                        ? ""
                        : part.substr(begin, part.find_last_not_of(' ') + 1 - begin));
  }
  return parts;
}

std::vector<std::string> WithSourceFlags(std::vector<std::string> others) {
  for (const std::string& flag : MeasurementFlags()) others.push_back(flag);
  others.emplace_back("threads");
  return others;
}

void RefuseForModel(const std::string& path, const std::vector<std::string>& flags) {
  for (const auto& [flag, value] : GivenFlags(flags)) {
    throw Error("--" + flag + " is for measurements, and " + path + " is a model; leave it out");
  }
}

AppearanceOptions AppearanceOptionsFromFlags() {
  static const Environment probe =
      FLAGS_probe.empty() ? StudioEnvironment() : ReadProbe(FLAGS_probe);
  AppearanceOptions options{.environment = &probe, .num_threads = ThreadsFromFlags()};
  // For tests, which would spend most of their time on its lights, and on pixels of pictures.
  if (const int lights = google::Int32FromEnv("TRILOBE_TEST_LIGHTS", 0); lights > 0) {
    options.lights = lights;
    options.size /= 3;
  }
  return options;
}

}  // namespace trilobe
