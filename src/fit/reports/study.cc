#include "fit/reports/study.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/quantile.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::optional<double> MedianOf(const std::vector<double>& values) {
  return values.empty() ? std::nullopt : std::optional<double>(Median(values));
}

template <typename Name>
std::vector<std::string> NamesOf(std::span<const StudyRun> runs, Name name) {
  std::vector<std::string> names;
  for (const StudyRun& run : runs) {
    if (std::ranges::find(names, run.*name) == names.end()) names.push_back(run.*name);
  }
  return names;
}

std::vector<const StudyRun*> RunsOf(std::span<const StudyRun> runs, const std::string& problem,
                                    const std::string& method) {
  std::vector<const StudyRun*> chosen;
  for (const StudyRun& run : runs) {
    if (run.problem == problem && (method.empty() || run.method == method)) chosen.push_back(&run);
  }
  return chosen;
}

const StudyRun* Lowest(const std::vector<const StudyRun*>& runs) {
  const StudyRun* lowest = nullptr;
  for (const StudyRun* run : runs) {
    if (run->failed()) continue;
    if (lowest == nullptr || run->objective() < lowest->objective()) lowest = run;
  }
  return lowest;
}

std::optional<LobeMatch> Match(const StudyRun* reference, const StudyRun& run) {
  if (reference == nullptr || reference == &run) return {};
  const ModelSpec &spec = run.file.model.spec(), &of_reference = reference->file.model.spec();
  if (!HaveComparableLobes(spec, of_reference)) return {};
  if (spec.lobes == 0 && of_reference.lobes == 0) return {};
  return MatchLobes(reference->file, run.file);
}

// Unit of an excess: the lowest E or, if that is next to nothing, as for data without noise, the
// smallest part of the E at the start that rounding leaves.
double Unit(const std::vector<const StudyRun*>& runs, double lowest) {
  constexpr double kRounding = 1e-12;
  double initial = 0;
  for (const StudyRun* run : runs) {
    if (!run->failed()) initial = std::max(initial, run->trace.front().minimised());
  }
  return std::max({lowest, kRounding * initial, std::numeric_limits<double>::min()});
}

void Count(bool counts, Share* share) {
  share->count += counts ? 1 : 0;
  ++share->of;
}

void Append(const std::optional<double>& value, std::vector<double>* values) {
  if (value) values->push_back(*value);
}

void CountEnding(const std::string& reason, std::vector<std::pair<std::string, int>>* endings) {
  const auto known = std::ranges::find(*endings, reason, &std::pair<std::string, int>::first);
  if (known != endings->end()) {
    ++known->second;
  } else {
    endings->emplace_back(reason, 1);
  }
}

MethodSummary Summarise(const std::vector<const StudyRun*>& runs, const std::string& problem,
                        const std::string& method) {
  MethodSummary summary{.problem = problem, .method = method};
  summary.runs = static_cast<int>(runs.size());
  std::vector<double> excess, seconds, seconds_to, iterations, psnr, delta_e, agreement;
  std::vector<double> relative, held_out, held_out_delta_e;
  double all_seconds = 0;
  for (const StudyRun* run : runs) {
    excess.push_back(run->excess());
    seconds.push_back(run->failed() ? kInfinity : run->seconds);
    seconds_to.push_back(run->SecondsTo(kAsGood));
    Count(run->excess() <= kAsGood, &summary.as_good);
    Count(run->excess() <= kTheSame, &summary.the_same);
    if (run->failed()) {
      ++summary.failed;
      continue;
    }
    all_seconds += run->seconds;
    iterations.push_back(run->iterations());
    CountEnding(run->stop_reason, &summary.endings);
    if (run->excess() > kAsGood && run->reached_limit()) summary.short_of_limit = true;
    if (summary.parameters == 0) summary.parameters = run->parameters;
    Append(run->relative_E, &relative);
    Append(run->held_out_E, &held_out);
    Append(run->held_out_delta_e, &held_out_delta_e);
    Append(run->psnr_db, &psnr);
    Append(run->mean_delta_e, &delta_e);
    if (run->optimality) {
      summary.optimality = std::max(summary.optimality.value_or(0), *run->optimality);
    }
    Count(!run->seen, &summary.unseen);
    const SolverSummary::Raises raises = SolverSummary::FindRaises(run->trace);
    summary.all_iterations += run->iterations();
    summary.raised += static_cast<int>(raises.iterations.size());
    summary.largest_rise = std::max(summary.largest_rise, raises.largest);
    if (const std::optional<double> alike = run->agreement()) {
      agreement.push_back(*alike);
      Count(*alike >= kSameLobes, &summary.same_lobes);
    }
    if (run->own_lobes) Count(run->own_lobes->agreement >= kSameLobes, &summary.same_as_own);
  }
  summary.lowest = std::ranges::min(excess);
  summary.highest = std::ranges::max(excess);
  summary.median = Median(excess);
  summary.seconds = Median(seconds);
  summary.seconds_to_as_good = Median(seconds_to);
  summary.expected_seconds =
      summary.as_good.count > 0 ? all_seconds / summary.as_good.count : kInfinity;
  summary.iterations = MedianOf(iterations).value_or(0);
  summary.psnr_db = MedianOf(psnr);
  summary.mean_delta_e = MedianOf(delta_e);
  summary.relative_E = MedianOf(relative);
  summary.held_out_E = MedianOf(held_out);
  summary.held_out_delta_e = MedianOf(held_out_delta_e);
  summary.agreement = MedianOf(agreement);
  return summary;
}

}  // namespace

double StudyRun::objective() const {
  double least = kInfinity;
  for (const IterationRecord& record : trace) least = std::min(least, record.minimised());
  return least;
}

int StudyRun::iterations() const { return std::max(0, static_cast<int>(trace.size()) - 1); }

bool StudyRun::reached_limit() const {
  return stop_reason == StopReasonName(StopReason::kMaxIterations) ||
         stop_reason == StopReasonName(StopReason::kMaxSeconds);
}

std::optional<double> StudyRun::agreement() const {
  return lobes ? std::optional(lobes->agreement) : std::nullopt;
}

double StudyRun::SecondsTo(double most_excess) const {
  const auto reached = std::ranges::find_if(trace, [&](const IterationRecord& record) {
    return ExcessOf(record.minimised()) <= most_excess;
  });
  return reached == trace.end() ? kInfinity : reached->seconds;
}

std::vector<StudyRun> RunsOn(const std::string& problem, std::span<const StudyRun> runs) {
  std::vector<StudyRun> own;
  for (const StudyRun* run : RunsOf(runs, problem, "")) own.push_back(*run);
  return own;
}

const StudyRun* LowestRun(std::span<const StudyRun> runs, const std::string& problem) {
  return Lowest(RunsOf(runs, problem, ""));
}

void CompareRuns(std::vector<StudyRun>* runs) {
  for (const std::string& problem : ProblemsOf(*runs)) {
    const std::vector<const StudyRun*> all = RunsOf(*runs, problem, "");
    const StudyRun* const lowest = Lowest(all);
    if (lowest == nullptr) continue;
    const double least = lowest->objective(), unit = Unit(all, least);
    for (StudyRun& run : *runs) {
      if (run.problem != problem || run.failed()) continue;
      run.lowest = least;
      run.unit = unit;
      run.lobes = Match(lowest, run);
      run.own_lobes = Match(Lowest(RunsOf(*runs, problem, run.method)), run);
    }
  }
}

Interval WilsonInterval(double share, int n) {
  if (n == 0) return {};
  constexpr double z = 1.959964;  // standard deviations, 95 %
  const double middle = share + z * z / (2.0 * n), scale = 1 + z * z / n;
  const double half = z * std::sqrt(share * (1 - share) / n + z * z / (4.0 * n * n));
  return {.low = std::clamp((middle - half) / scale, 0.0, 1.0),
          .high = std::clamp((middle + half) / scale, 0.0, 1.0)};
}

double Share::low() const { return WilsonInterval(value(), of).low; }
double Share::high() const { return WilsonInterval(value(), of).high; }

std::vector<std::string> ProblemsOf(std::span<const StudyRun> runs) {
  return NamesOf(runs, &StudyRun::problem);
}

std::vector<std::string> MethodsOf(std::span<const StudyRun> runs) {
  return NamesOf(runs, &StudyRun::method);
}

Times TimesOf(std::span<const MethodSummary> summaries, const std::string& method) {
  constexpr double kLeast = 1e-6;
  Times times;
  double logarithms = 0;
  for (const MethodSummary& of : summaries) {
    if (of.method != method) continue;
    ++times.of;
    if (std::isfinite(of.seconds_to_as_good)) {
      ++times.reached;
      logarithms += std::log(std::max(of.seconds_to_as_good, kLeast));
    } else {
      times.short_of_limit = times.short_of_limit || of.short_of_limit;
    }
  }
  if (times.reached > 0) times.geometric_mean = std::exp(logarithms / times.reached);
  return times;
}

std::vector<MethodSummary> SummariesOf(std::span<const StudyRun> runs) {
  std::vector<MethodSummary> summaries;
  for (const std::string& problem : ProblemsOf(runs)) {
    for (const std::string& method : MethodsOf(runs)) {
      const std::vector<const StudyRun*> own = RunsOf(runs, problem, method);
      if (!own.empty()) summaries.push_back(Summarise(own, problem, method));
    }
  }
  return summaries;
}

}  // namespace trilobe
