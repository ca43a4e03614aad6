#include "app/flags.h"

#include <gflags/gflags.h>

#include <algorithm>
#include <iostream>
#include <list>
#include <sstream>
#include <thread>
#include <type_traits>
#include <utility>
#include <variant>

#include "core/base/text.h"
#include "core/files/text_lines.h"
#include "io/formats/source_option.h"
#include "io/pictures/image_file.h"
#include "trilobe/core/base/error.h"
#include "trilobe/io/formats/source.h"

DEFINE_int32(threads, 0, "threads to use; 0 for all cores");
DEFINE_int64(seed, 1,
             "seed of all random numbers: of --init=random, of random starts of a solver, and of "
             "--data_seed unless that is given");
DEFINE_string(out, "", "output: a file or, for fit, study, info and plot, a folder");
DEFINE_bool(force, false,
            "overwrite or remove files in the way of --out even if Trilobe has not written them");
DEFINE_bool(json, false, "print one JSON object instead of a table");
DEFINE_bool(verbose, false, "print all details, not only the verdict and what it rests on");

DEFINE_string(
    probe, "",
    "light probe for the spheres, a lat-long Radiance .hdr file; without it a built-in sky "
    "with a sun and area lights");

namespace trilobe {

namespace {

// The values of a flag that is defined by a row of a table, where gflags keeps them.
struct FlagStorage {
  OptionValue value, default_value;
};

// By the names of the flags; addresses stay.
std::map<std::string, FlagStorage>& Storage() {
  static std::map<std::string, FlagStorage> storage;
  return storage;
}

}  // namespace

void DefineFlag(const std::string& name, const std::string& help,
                const OptionValue& default_value) {
  const auto [place, added] = Storage().insert({name, {default_value, default_value}});
  if (!added) return;
  FlagStorage& storage = place->second;
  // gflags keeps the pointers.
  static std::list<std::string> texts;
  const std::string& flag = place->first;
  const std::string& text = texts.emplace_back(help);
  std::visit(
      [&](auto& value) {
        auto& at_first = std::get<std::decay_t<decltype(value)>>(storage.default_value);
        gflags::FlagRegisterer(flag.c_str(), text.c_str(), __FILE__, &value, &at_first);
      },
      storage.value);
}

const OptionValue& FlagValue(const std::string& name) { return Storage().at(name).value; }

const std::string& TextFlag(const std::string& name) {
  return std::get<std::string>(FlagValue(name));
}

bool IsOn(const std::string& name) { return std::get<bool>(FlagValue(name)); }

void DefineSourceFlags() {
  for (const SourceOption& option : AllSourceOptions()) {
    const std::string range = option.range.must_be;
    DefineFlag(option.name, option.help + (range.empty() ? "" : ", " + range),
               option.default_value);
  }
}

bool IsDefault(const std::string& flag) {
  return gflags::GetCommandLineFlagInfoOrDie(flag.c_str()).is_default;
}

std::string FlagText(const std::string& flag) {
  return gflags::GetCommandLineFlagInfoOrDie(flag.c_str()).current_value;
}

std::map<std::string, std::string> GivenFlags(const std::vector<std::string>& flags) {
  std::map<std::string, std::string> given;
  for (const std::string& flag : flags) {
    const auto info = gflags::GetCommandLineFlagInfoOrDie(flag.c_str());
    if (!info.is_default) given[flag] = info.current_value;
  }
  return given;
}

int ThreadsFromFlags() {
  if (FLAGS_threads < 0) {
    throw Error(ErrorKind::kRange, "--threads is negative; give 0 for all cores")
        .About("threads", FLAGS_threads);
  }
  // Cores that this process may use.
  const int cores = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  if (FLAGS_threads == 0) return cores;
  static bool told = false;
  if (FLAGS_threads > cores && !std::exchange(told, true)) {
    std::cerr << "trilobe: --threads=" << FLAGS_threads
              << " is more than there are cores, which gains nothing; using " << cores << "\n";
  }
  return std::min(FLAGS_threads, cores);
}

SourceOptions SourceOptionsFromFlags(bool has_starts) {
  SourceOptions options = {.seed = static_cast<uint64_t>(FLAGS_seed),
                           .num_threads = ThreadsFromFlags()};
  for (const SourceOption& option : AllSourceOptions()) {
    const auto flag = gflags::GetCommandLineFlagInfoOrDie(option.name.c_str());
    if (flag.current_value != flag.default_value) option.set(flag.current_value, &options);
  }
  options.seed_is_for_data = !IsDefault("data_seed") || (!has_starts && !IsDefault("seed"));
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
    throw Error(ErrorKind::kConflict,
                "--" + flag + " is for measurements, and " + path + " is a model; leave it out")
        .At(path)
        .About(flag, value);
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
