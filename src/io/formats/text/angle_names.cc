#include "io/formats/text/angle_names.h"

#include <algorithm>
#include <span>

#include "io/formats/text/column_words.h"

namespace trilobe {
namespace {

using Role = ColumnRole;

constexpr std::string_view kThetaWords[] = {"theta", "zenith", "polar", "zen", "zn"};
constexpr std::string_view kPhiWords[] = {"azimuthal", "azimuth", "azimut", "acimut", "azymut",
                                          "azim",      "azi",     "az",     "phi"};
constexpr std::string_view kPhiAlone[] = {"raa", "daa"};
// Words of the difference of two azimuths, and words that say nothing of it.
constexpr std::string_view kDifference[] = {"relative", "relativo",   "relativa",   "relatif",
                                            "relativ",  "difference", "differenza", "differenz",
                                            "delta",    "diferencia", "diff",       "rel"};
constexpr std::string_view kFillers[] = {"of",  "de",   "di",      "du",    "the",
                                         "and", "from", "between", "winkel"};
constexpr std::string_view kElevationWords[] = {"elevation", "altitude", "elev"};
// Words of other things, too, where no word of a direction is beside them.
constexpr std::string_view kElevationBeside[] = {"grazing", "hohe", "elv", "el"};
constexpr std::string_view kIncident[] = {
    "i",      "in",          "inc",    "incident", "incidence", "incoming", "l",
    "light",  "src",         "source", "sun",      "solar",     "illum",    "illumination",
    "quelle", "lichtquelle", "licht",  "sonne",    "sonnen",    "soleil",   "solaire"};
constexpr std::string_view kOutgoing[] = {
    "o",         "out",      "outgoing",    "r",       "refl",      "reflected",  "reflection",
    "s",         "sc",       "scat",        "scatter", "scattered", "scattering", "v",
    "view",      "viewing",  "viewer",      "e",       "exit",      "emission",   "emergent",
    "obs",       "observer", "observation", "sensor",  "detektor",  "beobachter", "empfanger",
    "detecteur", "capteur",  "observateur", "camera",  "det",       "detector",   "receiver"};
// Words that need no word for an angle beside them.
constexpr std::string_view kIncidentAlone[] = {
    "inc",          "incident",   "incidence", "incoming",       "aoi",           "ti",
    "thi",          "sza",        "einfall",   "einfallswinkel", "einfallwinkel", "dincidence",
    "deincidencia", "diincidenza"};
constexpr std::string_view kOutgoingAlone[] = {"outgoing",
                                               "scatter",
                                               "scattered",
                                               "scattering",
                                               "view",
                                               "viewing",
                                               "exit",
                                               "emission",
                                               "emergence",
                                               "detector",
                                               "receiver",
                                               "reflection",
                                               "dereflexion",
                                               "diriflessione",
                                               "aos",
                                               "aor",
                                               "aov",
                                               "to",
                                               "tho",
                                               "tr",
                                               "thr",
                                               "vza",
                                               "dobservation",
                                               "deobservacion",
                                               "diosservazione",
                                               "ausfallswinkel",
                                               "ausfallwinkel",
                                               "beobachtungswinkel",
                                               "streuwinkel",
                                               "detektorwinkel"};

// "angle from specular", "theta_s - theta_spec", "off-specular angle".
constexpr std::string_view kFromMirror[] = {"fromspec",   "tospec",    "offspec",
                                            "deltaspec",  "minusspec", "aspecular",
                                            "frommirror", "tomirror",  "sthetaspec"};

// Role of a theta or phi by the rest of its name.
std::optional<Role> RoleBySide(std::string_view side, Role incident, Role outgoing, Role unsaid) {
  if (side.empty()) return unsaid;
  if (IsOneOf(side, kIncident)) return incident;
  if (IsOneOf(side, kOutgoing)) return outgoing;
  return std::nullopt;
}

std::optional<Role> RoleByWords(std::string_view key, std::span<const std::string_view> words,
                                Role incident, Role outgoing, Role unsaid) {
  for (const std::string_view word : words) {
    std::optional<Role> role;
    if (key.starts_with(word)) {
      role = RoleBySide(key.substr(word.size()), incident, outgoing, unsaid);
    }
    if (!role && key.ends_with(word)) {
      role = RoleBySide(key.substr(0, key.size() - word.size()), incident, outgoing, unsaid);
    }
    if (role) return role;
  }
  return std::nullopt;
}

// Words of these that need no other word for an angle, and are of other things, too.
constexpr std::string_view kOfOthers[] = {"detector", "receiver", "view", "scatter"};

// What the words of a name beside that of the azimuth say.
struct Said {
  bool difference = false, incident = false, outgoing = false;
};

bool TakeWord(std::span<const std::string_view> words, std::string_view* text) {
  std::string_view longest;
  for (const std::string_view word : words) {
    const bool is_letter = word.size() == 1;  // which is a word where nothing is beside it
    if (is_letter ? *text != word : !text->starts_with(word)) continue;
    if (word.size() > longest.size()) longest = word;
  }
  text->remove_prefix(longest.size());
  return !longest.empty();
}

// Takes all words off a text; false where something else is in it.
bool TakeWords(std::string_view text, Said* said) {
  while (!text.empty()) {
    if (TakeWord(kDifference, &text)) {
      said->difference = true;
    } else if (TakeWord(kIncident, &text)) {
      said->incident = true;
    } else if (TakeWord(kOutgoing, &text)) {
      said->outgoing = true;
    } else if (!TakeWord(kFillers, &text)) {
      return false;
    }
  }
  return true;
}

std::optional<AngleName> AzimuthNamed(std::string_view key) {
  constexpr AngleName kDifferenceOfTwo = {.role = Role::kPhi, .is_difference = true};
  if (IsOneOf(key, kPhiAlone)) return kDifferenceOfTwo;
  for (const std::string_view word : kPhiWords) {
    const size_t at = key.find(word);
    if (at == std::string_view::npos) continue;
    std::string_view before = key.substr(0, at);
    Said said;
    if (before == "d") {  // "dphi"
      said.difference = true;
      before = {};
    }
    if (!TakeWords(before, &said) || !TakeWords(key.substr(at + word.size()), &said)) continue;
    if (said.difference) return kDifferenceOfTwo;
    if (said.incident && said.outgoing) continue;
    return AngleName{.role = said.incident   ? Role::kPhiI
                             : said.outgoing ? Role::kPhiO
                                             : Role::kPhi};
  }
  return std::nullopt;
}

}  // namespace

std::optional<AngleName> AngleNamed(std::string_view plain) {
  const std::string key = LettersAndDigits(plain);
  // "az_i", but not "azi".
  if (key == "azi" && plain.find(key) == std::string_view::npos) {
    return AngleName{.role = Role::kPhiI};
  }
  std::string rest = key;
  const size_t angle = rest.find("angle");
  if (angle != std::string::npos) rest.erase(angle, 5);
  if (const auto role =
          RoleByWords(rest, kElevationWords, Role::kThetaI, Role::kThetaO, Role::kTheta)) {
    return AngleName{.role = *role, .from_horizon = true};
  }
  if (const auto role =
          RoleByWords(rest, kElevationBeside, Role::kThetaI, Role::kThetaO, Role::kOther)) {
    if (role != Role::kOther) return AngleName{.role = *role, .from_horizon = true};
  }
  if (key == "angle") return AngleName{.role = Role::kTheta};
  if (std::ranges::any_of(kFromMirror, [&](std::string_view word) {
        return key.find(word) != std::string::npos;
      })) {
    return AngleName{.role = Role::kFromMirror};
  }
  bool says_angle = angle != std::string::npos;
  for (const std::string_view word : {"angulo", "angolo", "of"}) {
    const size_t at = rest.find(word);
    if (at == std::string::npos) continue;
    says_angle |= word != "of";
    rest.erase(at, word.size());
  }
  if (IsOneOf(rest, kIncidentAlone)) return AngleName{.role = Role::kThetaI};
  if (IsOneOf(rest, kOutgoingAlone)) {
    const bool is_word = !says_angle && IsOneOf(rest, kOfOthers);
    if (rest == "reflection" && !says_angle) return std::nullopt;  // of light
    return AngleName{.role = Role::kThetaO, .is_word = is_word};
  }
  if (rest == "phase" || rest == "pha") return AngleName{.role = Role::kPhase};
  if (rest == "pi" || rest == "saa") return AngleName{.role = Role::kPhiI};
  if (rest == "po" || rest == "pr" || rest == "vaa") return AngleName{.role = Role::kPhiO};
  if (const auto role =
          RoleByWords(rest, kThetaWords, Role::kThetaI, Role::kThetaO, Role::kTheta)) {
    return AngleName{.role = *role};
  }
  return AzimuthNamed(rest);
}

bool HasAzimuthWord(std::string_view name) {
  constexpr std::string_view kBegun[] = {"azim", "acimut", "azymut"};
  constexpr std::string_view kWords[] = {"az", "azi", "phi", "raa", "daa", "saa", "vaa"};
  const std::vector<std::string> words = WordsOf(name);
  return std::ranges::any_of(words, [&](const std::string& word) {
    return IsOneOf(word, kWords) || std::ranges::any_of(kBegun, [&](std::string_view begun) {
             return word.find(begun) != std::string::npos;
           });
  });
}

}  // namespace trilobe
