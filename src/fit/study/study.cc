#include "fit/study/study.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <locale>
#include <sstream>
#include <utility>

#include "core/base/text.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The lower median, of at least one value: between a finite value and infinity is nothing.
double Median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

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

// What an excess is relative to: the lowest E, or where this is next to nothing, as of data without
// noise, the smallest part of the E at the start that rounding leaves.
double Unit(const std::vector<const StudyRun*>& runs, double lowest) {
  constexpr double kRounding = 1e-12;
  double initial = 0;
  for (const StudyRun* run : runs) {
    if (!run->failed()) initial = std::max(initial, run->trace.front().minimised());
  }
  return std::max({lowest, kRounding * initial, std::numeric_limits<double>::min()});
}

// Wilson's interval at 1.96 standard deviations, 95 %, `side` -1 or 1.
double WilsonBound(const Share& share, int side) {
  if (share.of == 0) return side < 0 ? 0 : 1;
  constexpr double z = 1.959964;
  const double n = share.of, p = share.value();
  const double half = z * std::sqrt(p * (1 - p) / n + z * z / (4 * n * n));
  return std::clamp((p + z * z / (2 * n) + side * half) / (1 + z * z / n), 0.0, 1.0);
}

void Count(bool counts, Share* share) {
  share->count += counts ? 1 : 0;
  ++share->of;
}

MethodSummary Summarise(const std::vector<const StudyRun*>& runs, const std::string& problem,
                        const std::string& method) {
  MethodSummary summary{.problem = problem, .method = method};
  summary.runs = static_cast<int>(runs.size());
  std::vector<double> excess, seconds, seconds_to, iterations, psnr, delta_e, agreement;
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
    if (run->psnr_db) psnr.push_back(*run->psnr_db);
    if (run->mean_delta_e) delta_e.push_back(*run->mean_delta_e);
    const SolverSummary::Raises raises = SolverSummary::FindRaises(run->trace);
    summary.all_iterations += run->iterations();
    summary.raised += static_cast<int>(raises.iterations.size());
    summary.largest_rise = std::max(summary.largest_rise, raises.largest);
    if (run->lobes) {
      agreement.push_back(run->lobes->agreement);
      Count(run->lobes->agreement >= kSameLobes, &summary.same_lobes);
    }
    if (run->own_lobes) Count(run->own_lobes->agreement >= kSameLobes, &summary.same_again);
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
  summary.agreement = MedianOf(agreement);
  return summary;
}

// Numbers that read back to the same double, in any locale; "" where there is none.
class Csv {
 public:
  explicit Csv(const char* header) {
    out_.imbue(std::locale::classic());
    out_ << header << '\n' << std::setprecision(std::numeric_limits<double>::max_digits10);
  }
  template <typename Value>
  Csv& Add(const Value& value) {
    Begin() << value;
    return *this;
  }
  Csv& Add(const std::string& text) {
    Begin() << CsvField(text);
    return *this;
  }
  Csv& Add(const std::optional<double>& value) { return value ? Add(*value) : Add(""); }
  void EndRow() {
    out_ << '\n';
    first_ = true;
  }
  std::string text() const { return out_.str(); }

 private:
  std::ostream& Begin() {
    if (!first_) out_ << ',';
    first_ = false;
    return out_;
  }

  std::ostringstream out_;
  bool first_ = true;
};

}  // namespace

double StudyRun::objective() const {
  double least = kInfinity;
  for (const IterationRecord& record : trace) least = std::min(least, record.minimised());
  return least;
}

int StudyRun::iterations() const { return std::max(0, static_cast<int>(trace.size()) - 1); }

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

double Share::low() const { return WilsonBound(*this, -1); }
double Share::high() const { return WilsonBound(*this, 1); }

std::vector<std::string> ProblemsOf(std::span<const StudyRun> runs) {
  return NamesOf(runs, &StudyRun::problem);
}

std::vector<std::string> MethodsOf(std::span<const StudyRun> runs) {
  return NamesOf(runs, &StudyRun::method);
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

std::string RunsCsv(std::span<const StudyRun> runs) {
  Csv csv(
      "problem,method,start,objective,excess,iterations,seconds,seconds_to_1_percent,raised,"
      "largest_rise,lobe_agreement,psnr_db,mean_delta_e,stop_reason,folder,error");
  for (const StudyRun& run : runs) {
    const SolverSummary::Raises raises = SolverSummary::FindRaises(run.trace);
    csv.Add(run.problem).Add(run.method).Add(run.start);
    csv.Add(run.objective()).Add(run.excess()).Add(run.iterations()).Add(run.seconds);
    csv.Add(run.SecondsTo(kAsGood)).Add(raises.iterations.size()).Add(raises.largest);
    csv.Add(run.lobes ? std::optional(run.lobes->agreement) : std::nullopt);
    csv.Add(run.psnr_db).Add(run.mean_delta_e).Add(run.stop_reason).Add(run.folder).Add(run.error);
    csv.EndRow();
  }
  return csv.text();
}

std::string MethodsCsv(std::span<const MethodSummary> summaries) {
  Csv csv(
      "problem,method,runs,failed,lowest_excess,median_excess,highest_excess,within_1_percent,"
      "within_1_percent_low,within_1_percent_high,within_0.1_percent,seconds,"
      "seconds_to_1_percent,expected_seconds_to_1_percent,iterations,raised,largest_rise,"
      "same_lobes_as_lowest,same_lobes_again,lobe_agreement,psnr_db,mean_delta_e");
  for (const MethodSummary& of : summaries) {
    csv.Add(of.problem).Add(of.method).Add(of.runs).Add(of.failed);
    csv.Add(of.lowest).Add(of.median).Add(of.highest);
    csv.Add(of.as_good.value()).Add(of.as_good.low()).Add(of.as_good.high());
    csv.Add(of.the_same.value()).Add(of.seconds).Add(of.seconds_to_as_good);
    csv.Add(of.expected_seconds).Add(of.iterations).Add(of.raised).Add(of.largest_rise);
    csv.Add(of.same_lobes.value()).Add(of.same_again.value()).Add(of.agreement);
    csv.Add(of.psnr_db).Add(of.mean_delta_e);
    csv.EndRow();
  }
  return csv.text();
}

std::string TracesCsv(std::span<const StudyRun> runs) {
  Csv csv("problem,method,start,iteration,seconds,objective");
  for (const StudyRun& run : runs) {
    for (const IterationRecord& record : run.trace) {
      csv.Add(run.problem).Add(run.method).Add(run.start);
      csv.Add(record.iteration).Add(record.seconds).Add(record.minimised());
      csv.EndRow();
    }
  }
  return csv.text();
}

}  // namespace trilobe
