// Whether models have the lobes of another one, and the light of each lobe. See README.md beside
// this file.

#include <algorithm>
#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "experiments/program.h"
#include "model/objective/gauge.h"
#include "model/objective/lobe_match.h"
#include "trilobe/core/base/channels.h"
#include "trilobe/model/objective/lobe_light.h"
#include "trilobe/model/read_model.h"

namespace trilobe {
namespace {

using Json = nlohmann::ordered_json;

double ColourCosine(const Rgb& a, const Rgb& b) {
  double both = 0, of_a = 0, of_b = 0;
  for (int c = 0; c < kChannels; ++c) {
    both += a[c] * b[c];
    of_a += a[c] * a[c];
    of_b += b[c] * b[c];
  }
  return of_a > 0 && of_b > 0 ? both / std::sqrt(of_a * of_b) : 0;
}

// How alike the two lobes of a model are that are most alike but for their strength.
double LikestPair(const ModelFile& file, const LobeLight& light) {
  double likest = 0;
  for (int m = 0; m < file.model.spec().lobes; ++m) {
    for (int n = 0; n < m; ++n) {
      double alike = ColourCosine(light.lobes[m], light.lobes[n]);
      for (const Factor factor : kFactors) {
        alike *= FactorCosine(factor, file, m, file, n, {1, 1, 1});
      }
      likest = std::max(likest, alike);
    }
  }
  return likest;
}

// Reads the paths of models from standard input, a line each, and prints a line of JSON for each.
// "light": of the lobes, the mean of the channels, that of the diffuse term last.
int Main(const std::string& reference_path) {
  const ModelFile reference = ReadModel(reference_path);
  for (std::string path; std::getline(std::cin, path);) {
    const ModelFile file = ReadModel(path);
    std::vector<bool> unobserved = file.unobserved;
    unobserved.resize(file.model.parameters().size(), false);
    const LobeLight light = ComputeLobeLight(ObservedEntries(unobserved), file.model);
    Json albedos = Json::array();
    for (const Rgb& lobe : light.lobes) albedos.push_back(Mean(lobe));
    albedos.push_back(Mean(light.diffuse));
    const LobeMatch match = MatchLobes(reference, file);
    std::cout << Json{{"agreement", match.agreement},
                      {"lobe", match.lobe},
                      {"match", match.match},
                      {"light", albedos},
                      {"likest_pair", LikestPair(file, light)}}
              << "\n";
  }
  return 0;
}

}  // namespace
}  // namespace trilobe

int main(int argc, char** argv) {
  return trilobe::ProgramMain(argc, argv, "match_lobes REFERENCE.json < PATHS", 1,
                              [](auto words) { return trilobe::Main(words[0]); });
}
