#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "core/base/text.h"
#include "fit/reports/study.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {
namespace {

// "a", "a and b", "a, b and c".
std::string Listed(const std::vector<std::string>& words) {
  std::string text;
  for (size_t k = 0; k < words.size(); ++k) {
    if (k > 0) text += k + 1 < words.size() ? ", " : " and ";
    text += words[k];
  }
  return text;
}

// "all 5", "3 of 5", "none of 5".
std::string Of(const Share& share) {
  if (share.count == share.of) return "all " + std::to_string(share.of);
  return (share.count == 0 ? "none" : std::to_string(share.count)) + " of " +
         std::to_string(share.of);
}

std::string PercentText(double share) { return Text(100 * share, 3) + " %"; }

// Words on each method, in their order; nothing for more methods than a sentence can hold, which
// the table tells.
template <typename Words>
std::string EachMethod(const std::vector<MethodSummary>& methods, const Words& words) {
  constexpr size_t kMost = 5;
  if (methods.size() > kMost) return "";
  std::vector<std::string> parts;
  for (const MethodSummary& of : methods) {
    if (const std::string text = words(of); !text.empty()) parts.push_back(of.method + " " + text);
  }
  return Listed(parts);
}

bool IsLimit(const std::string& reason) {
  return StudyRun{.problem = "", .method = "", .folder = "", .stop_reason = reason}.reached_limit();
}

// Text on the endings that count, such as "10 of 10 stopped by --max_iterations".
template <typename Counts>
std::string EndingsOf(const MethodSummary& of, const Counts& counts) {
  std::string text;
  for (const auto& [reason, count] : of.endings) {
    if (!counts(reason)) continue;
    text += (text.empty() ? "" : ", ") + std::to_string(count) + " of " + std::to_string(of.runs) +
            " " + EndingWords(reason);
  }
  return text;
}

// The summaries of one method, added up over problems; no medians.
MethodSummary Together(const std::vector<MethodSummary>& summaries, const std::string& method) {
  MethodSummary sum{.problem = "", .method = method};
  const auto add = [](const Share& share, Share* to) {
    to->count += share.count;
    to->of += share.of;
  };
  for (const MethodSummary& of : summaries) {
    if (of.method != method) continue;
    sum.runs += of.runs;
    sum.failed += of.failed;
    add(of.as_good, &sum.as_good);
    add(of.same_lobes, &sum.same_lobes);
    add(of.same_as_own, &sum.same_as_own);
    add(of.unseen, &sum.unseen);
    for (const auto& [reason, count] : of.endings) {
      const auto known =
          std::ranges::find(sum.endings, reason, &std::pair<std::string, int>::first);
      if (known == sum.endings.end()) {
        sum.endings.emplace_back(reason, count);
      } else {
        known->second += count;
      }
    }
    sum.all_iterations += of.all_iterations;
    sum.raised += of.raised;
    sum.largest_rise = std::max(sum.largest_rise, of.largest_rise);
  }
  return sum;
}

std::string LowestSentence(std::span<const StudyRun> runs,
                           const std::vector<std::string>& problems) {
  if (problems.size() > 1) return "";
  const StudyRun* const lowest = LowestRun(runs, problems.front());
  std::string text = "The lowest E, " + Text(lowest->objective(), 5) + ", is of " + lowest->method +
                     ", start " + std::to_string(lowest->start);
  if (lowest->relative_E) {
    text += ": " + PercentText(*lowest->relative_E) + " of a black model's";
    if (lowest->noise_E) {
      text += ". Noise alone would leave " + PercentText(*lowest->noise_E) +
              ", as far as samples of the same directions tell";
    }
  }
  return text + ".";
}

// Runs that a limit stopped. Their E might have fallen further.
std::string LimitSentence(const std::vector<MethodSummary>& methods) {
  int stopped = 0, runs = 0;
  std::vector<std::string> parts;
  for (const MethodSummary& of : methods) {
    runs += of.runs;
    const std::string text = EndingsOf(of, IsLimit);
    if (!text.empty()) parts.push_back(of.method + " " + text);
    for (const auto& [reason, count] : of.endings) stopped += IsLimit(reason) ? count : 0;
  }
  if (parts.empty()) return "";
  constexpr size_t kMost = 5;
  return "Not converged, so that E might fall further: " +
         (parts.size() <= kMost ? Listed(parts)
                                : std::to_string(stopped) + " of " + std::to_string(runs) +
                                      " runs, stopped by a limit") +
         ".";
}

// Text such as "after 2.1 s" for one problem; for several the geometric mean, "after 4.4 s on 2 of
// 3 problems".
std::string TimesText(const Times& times) {
  const std::string where = times.of == 1 || times.reached == times.of
                                ? ""
                                : " on " + std::to_string(times.reached) + " of " +
                                      std::to_string(times.of) + " problems";
  if (times.reached == 0) return times.short_of_limit ? "not within the limit" : "never";
  return "after " + Text(times.geometric_mean, 2) + " s" + where;
}

// The method of the least E of held-out samples, in the median, and those within kAsGood of it.
std::string HeldOutSentence(const std::vector<MethodSummary>& summaries,
                            const std::vector<std::string>& problems) {
  std::vector<std::string> parts;
  for (const std::string& problem : problems) {
    const MethodSummary* best = nullptr;
    for (const MethodSummary& of : summaries) {
      if (of.problem != problem || !of.held_out_E) continue;
      if (best == nullptr || *of.held_out_E < *best->held_out_E) best = &of;
    }
    if (best == nullptr) continue;
    std::vector<std::string> as_good;
    for (const MethodSummary& of : summaries) {
      if (of.problem != problem || !of.held_out_E || &of == best) continue;
      if (*of.held_out_E <= (1 + kAsGood) * *best->held_out_E) as_good.push_back(of.method);
    }
    parts.push_back((problems.size() > 1 ? "of " + problem + " " : "") + "by " + best->method +
                    ", E " + PercentText(*best->held_out_E) + " of a black model's" +
                    (as_good.empty() ? "" : " (within 1 % of that: " + Listed(as_good) + ")"));
  }
  constexpr size_t kMost = 5;
  if (parts.empty() || parts.size() > kMost) return "";
  return std::string("Samples that were held out are predicted best") +
         (problems.size() > 1 ? ": " : " ") + Listed(parts) + ".";
}

// Whether differences in E are seen.
std::string SeenSentence(std::span<const StudyRun> runs,
                         const std::vector<MethodSummary>& methods) {
  Share unseen;
  bool of_sphere = true;
  for (const MethodSummary& of : methods) {
    unseen.count += of.unseen.count;
    unseen.of += of.unseen.of;
  }
  for (const StudyRun& run : runs) of_sphere = of_sphere && (run.failed() || run.of_sphere);
  const std::string where = of_sphere ? "" : " where it was measured";
  if (unseen.count == unseen.of && unseen.of > 1) {
    return "All " + std::to_string(unseen.of) +
           " models cannot be told apart from the measurement" + where +
           ": their differences in E are not seen.";
  }
  if (unseen.count == 0) return "Each model can be told apart from the measurement" + where + ".";
  const std::string each = EachMethod(methods, [](const MethodSummary& of) {
    return of.unseen.of > 0 ? Of(of.unseen) : std::string();
  });
  return "Models that cannot be told apart from the measurement" + where + ": " +
         (each.empty() ? Of(unseen) : each) + ".";
}

// E that rose is told of each method that did so, and of the others that it never did.
std::string RaisedSentence(const std::vector<MethodSummary>& methods) {
  std::vector<std::string> raised, never;
  int iterations = 0;
  for (const MethodSummary& of : methods) {
    if (of.raised == 0) {
      never.push_back(of.method);
      iterations += of.all_iterations;
    } else {
      raised.push_back(of.method + " raised E in " + std::to_string(of.raised) + " of " +
                       std::to_string(of.all_iterations) + " iterations, by " +
                       Text(100 * of.largest_rise, 2) + " % at most");
    }
  }
  std::string text;
  if (!never.empty()) {
    text = "E never rose in " + std::to_string(iterations) + " iterations of " +
           (raised.empty() ? std::string("all methods") : Listed(never)) + ".";
  }
  if (!raised.empty()) text += (text.empty() ? "" : " ") + Listed(raised) + ".";
  return text;
}

}  // namespace

std::string EndingWords(const std::string& reason) {
  constexpr std::pair<StopReason, const char*> kWords[] = {
      {StopReason::kConverged, "converged"},
      {StopReason::kOptimal, "at a minimum"},
      {StopReason::kExactFit, "exact"},
      {StopReason::kNoDecrease, "found no step down"},
      {StopReason::kMaxIterations, "stopped by --max_iterations"},
      {StopReason::kMaxSeconds, "stopped by --max_seconds"}};
  for (const auto& [known, words] : kWords) {
    if (reason == StopReasonName(known)) return words;
  }
  return reason;
}

std::string EndingsText(const MethodSummary& of) {
  return EndingsOf(of, [](const std::string& /*reason*/) { return true; });
}

std::vector<std::string> VerdictOn(std::span<const StudyRun> runs) {
  if (runs.empty()) return {};
  if (std::ranges::all_of(runs, &StudyRun::failed)) {
    return {"No run has a result: " + runs.front().error};
  }
  const std::vector<std::string> problems = ProblemsOf(runs);
  const std::vector<MethodSummary> summaries = SummariesOf(runs);
  std::vector<MethodSummary> methods;
  for (const std::string& method : MethodsOf(runs)) {
    methods.push_back(Together(summaries, method));
  }
  const std::string each = problems.size() > 1 ? " of its problem" : "";
  std::vector<std::string> sentences = {LowestSentence(runs, problems),
                                        HeldOutSentence(summaries, problems)};
  const auto tell = [&](const std::string& lead, const auto& words) {
    const std::string text = EachMethod(methods, words);
    if (!text.empty()) sentences.push_back(lead + ": " + text + ".");
  };
  tell("Runs within 1 % of the lowest E" + each,
       [](const MethodSummary& of) { return Of(of.as_good); });
  sentences.push_back(LimitSentence(methods));
  tell(problems.size() > 1 ? "Their median run gets there, in the geometric mean of the problems"
                           : "They get there, in the median",
       [&](const MethodSummary& of) { return TimesText(TimesOf(summaries, of.method)); });
  sentences.push_back(RaisedSentence(methods));
  const auto of_any = [](const Share& share) { return share.of > 0 ? Of(share) : std::string(); };
  tell("Other runs with the lobes of the lowest run" + each,
       [&](const MethodSummary& of) { return of_any(of.same_lobes); });
  tell("Other runs with the lobes of their own method's lowest run" + each,
       [&](const MethodSummary& of) { return of_any(of.same_as_own); });
  sentences.push_back(SeenSentence(runs, methods));
  if (problems.size() == 1) {
    tell(std::string("Mean Delta E of the ") + (runs.front().of_sphere ? "sphere" : "samples") +
             ", in the median",
         [&](const MethodSummary& of) {
           const auto own = std::ranges::find(summaries, of.method, &MethodSummary::method);
           return own->mean_delta_e ? Text(*own->mean_delta_e, 2) : std::string();
         });
  }
  tell("Failed, and counted as infinite", [](const MethodSummary& of) {
    return of.failed > 0 ? std::to_string(of.failed) + " of " + std::to_string(of.runs)
                         : std::string();
  });
  std::erase(sentences, "");
  return sentences;
}

}  // namespace trilobe
