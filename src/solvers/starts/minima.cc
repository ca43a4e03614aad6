#include "solvers/starts/minima.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>
#include <sstream>

#include "model/objective/gauge.h"
#include "model/objective/lobe_match.h"
#include "trilobe/model/read_model.h"

namespace trilobe {
namespace {

constexpr int kAgreeing = 3;
constexpr double kUnlikely = 0.05;

bool IsRandom(const StartResult& start) { return start.name.find('/') != std::string::npos; }

}  // namespace

int Minima::count() const {
  return starts.empty() ? 0 : std::ranges::max(starts, {}, &StartResult::minimum).minimum;
}

int Minima::at_best() const {
  return static_cast<int>(std::ranges::count(starts, 1, &StartResult::minimum));
}

double Minima::NewMinimum() const {
  std::set<int> seen;
  double n = 0;
  for (const StartResult& start : starts) {
    if (!IsRandom(start)) continue;
    ++n;
    seen.insert(start.minimum);
  }
  const auto w = static_cast<double>(seen.size());
  return n < 2 ? 1 : std::min(1.0, w * (w + 1) / (n * (n - 1)));
}

bool Minima::Enough() const {
  const auto agrees = [](const StartResult& start) {
    return start.minimum == 1 && IsRandom(start);
  };
  return std::ranges::count_if(starts, agrees) >= kAgreeing && NewMinimum() <= kUnlikely;
}

std::string Minima::Describe() const {
  const auto random = std::ranges::count_if(starts, IsRandom);
  std::ostringstream text;
  text << "of " << starts.size() << " starts, " << random << " of them random, " << at_best()
       << " ended in the lowest of " << count() << (count() == 1 ? " minimum" : " minima");
  if (random > 1) {
    text << "; a further random one would be expected to end in a new minimum with a probability "
         << "of " << std::lround(100 * NewMinimum()) << " %";
  }
  return text.str();
}

Minima FindMinima(const StartElimination& elimination, const Objective& objective) {
  Minima minima{.starts = elimination.Results()};
  const std::vector<const FactorModel*> models = elimination.Models();
  const std::vector<bool> unobserved = UnobservedParameters(objective.coverage());
  const auto file_of = [&](size_t start) {
    return ModelFile{.model = *models[start], .unobserved = unobserved, .fit = {}};
  };
  std::vector<size_t> lowest;  // start of each minimum
  for (size_t k = 0; k < minima.starts.size(); ++k) {
    StartResult& start = minima.starts[k];
    for (size_t of = 0; of < lowest.size() && start.minimum == 0; ++of) {
      const double E = minima.starts[lowest[of]].objective;
      const bool near = start.objective <= (1 + Minima::kSameMinimum) * E;
      if (near && MatchLobes(file_of(lowest[of]), file_of(k)).agreement >= Minima::kAlike) {
        start.minimum = static_cast<int>(of) + 1;
      }
    }
    if (start.minimum == 0) {
      lowest.push_back(k);
      start.minimum = static_cast<int>(lowest.size());
    }
  }
  return minima;
}

}  // namespace trilobe
