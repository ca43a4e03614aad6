#include "io/formats/source_option.h"

#include <optional>
#include <sstream>
#include <type_traits>

#include "core/files/text_lines.h"
#include "trilobe/core/base/error.h"
#include "trilobe/io/formats/source.h"

namespace trilobe {
namespace {

[[noreturn]] void Fail(std::string_view name, std::string_view text, const std::string& expected) {
  throw Error("--" + std::string(name) + "=" + std::string(text) + ": give " + expected);
}

double NumberOf(std::string_view name, std::string_view text) {
  if (const std::optional<double> number = ToNumber(text)) return *number;
  Fail(name, text, "a number");
}

bool TruthOf(std::string_view name, std::string_view text) {
  if (text == "true" || text == "false") return text == "true";
  Fail(name, text, "true or false");
}

std::string TextOf(double number) {
  std::ostringstream text;
  text.precision(17);
  text << number;
  return text.str();
}

// A name that template arguments can hold.
template <size_t kSize>
struct Name {
  char text[kSize];
  constexpr Name(const char (&name)[kSize]) {  // NOLINT(google-explicit-constructor): by a literal
    for (size_t k = 0; k < kSize; ++k) text[k] = name[k];
  }
};

// The option that is this member.
template <Name kName, auto kMember>
SourceOption Option() {
  using T = std::decay_t<decltype(SourceOptions().*kMember)>;
  return {kName.text,
          [](std::string_view text, SourceOptions* options) {
            if constexpr (std::is_same_v<T, std::string>) {
              options->*kMember = std::string(text);
            } else if constexpr (std::is_same_v<T, bool>) {
              options->*kMember = TruthOf(kName.text, text);
            } else {
              options->*kMember = NumberOf(kName.text, text);
            }
          },
          [](const SourceOptions& options) {
            if constexpr (std::is_same_v<T, std::string>) {
              return options.*kMember;
            } else {
              return TextOf(options.*kMember);
            }
          }};
}

void SetTilt(std::string_view text, SourceOptions* options) {
  options->tilt_deg = text == "auto" ? std::nullopt : ToNumber(text);
  if (text != "auto" && !options->tilt_deg) {
    Fail("tilt", text, "a number of degrees from -30 to 30, or auto");
  }
}

void SetAzimuth(std::string_view text, SourceOptions* options) {
  if (text != "from_mirror" && text != "from_light") {
    Fail("azimuth", text, "from_mirror or from_light");
  }
  options->azimuth_from_mirror = text == "from_mirror";
}

void SetDataSeed(std::string_view text, SourceOptions* options) {
  constexpr double kMost = 9007199254740992;  // up to which a double has all integers
  const double seed = NumberOf("data_seed", text);
  if (!(seed >= 0 && seed <= kMost && seed == static_cast<double>(static_cast<uint64_t>(seed)))) {
    Fail("data_seed", text, "an integer from 0");
  }
  options->seed = static_cast<uint64_t>(seed);
}

}  // namespace

const std::vector<SourceOption>& AllSourceOptions() {
  using Options = SourceOptions;
  static const std::vector<SourceOption> options = {
      Option<"noise", &Options::noise>(),
      Option<"missing", &Options::missing>(),
      Option<"corrupt", &Options::corrupt>(),
      {"tilt", SetTilt,
       [](const Options& of) { return of.tilt_deg ? TextOf(*of.tilt_deg) : std::string("auto"); }},
      {"cosine", SetCosine,
       [](const Options& of) { return TextOf(of.cosine) + ",o:" + TextOf(of.cosine_o); }},
      Option<"scale", &Options::scale>(),
      {"azimuth", SetAzimuth,
       [](const Options& of) {
         return std::string(of.azimuth_from_mirror ? "from_mirror" : "from_light");
       }},
      {"data_seed", SetDataSeed, [](const Options& of) { return std::to_string(of.seed); }},
      Option<"max_angle", &Options::max_angle_deg>(),
      Option<"min_theta_d", &Options::min_theta_d_deg>(),
      Option<"extrapolated", &Options::extrapolated>(),
      Option<"outliers", &Options::outliers>(),
      Option<"dark_noise", &Options::dark_noise>(),
      Option<"radiometry", &Options::radiometry>(),
      Option<"columns", &Options::columns>(),
      Option<"theta_i", &Options::theta_i_deg>(),
      Option<"bands", &Options::bands>()};
  return options;
}

}  // namespace trilobe
