#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/base/text.h"
#include "fit/study/study.h"
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

// What is said of each method, in their order; nothing of more than a sentence can hold, which the
// table tells.
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

// The summaries of one method, added up over problems.
MethodSummary Together(const std::vector<MethodSummary>& summaries, const std::string& method) {
  MethodSummary sum{.problem = "", .method = method};
  const auto add = [](const Share& share, Share* to) {
    to->count += share.count;
    to->of += share.of;
  };
  std::vector<double> seconds;
  for (const MethodSummary& of : summaries) {
    if (of.method != method) continue;
    sum.runs += of.runs;
    sum.failed += of.failed;
    add(of.as_good, &sum.as_good);
    add(of.same_lobes, &sum.same_lobes);
    add(of.same_again, &sum.same_again);
    sum.all_iterations += of.all_iterations;
    sum.raised += of.raised;
    sum.largest_rise = std::max(sum.largest_rise, of.largest_rise);
    seconds.push_back(of.seconds_to_as_good);
  }
  std::ranges::sort(seconds);
  sum.seconds_to_as_good = seconds[(seconds.size() - 1) / 2];
  return sum;
}

std::string LowestSentence(std::span<const StudyRun> runs,
                           const std::vector<std::string>& problems) {
  if (problems.size() > 1) return "";
  const StudyRun* const lowest = LowestRun(runs, problems.front());
  return "The lowest E, " + Text(lowest->objective(), 5) + ", is of " + lowest->method +
         ", start " + std::to_string(lowest->start) + ".";
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
  std::vector<std::string> sentences = {LowestSentence(runs, problems)};
  const auto tell = [&](const std::string& lead, const auto& words) {
    const std::string text = EachMethod(methods, words);
    if (!text.empty()) sentences.push_back(lead + ": " + text + ".");
  };
  tell("Runs within 1 % of the lowest E" + each,
       [](const MethodSummary& of) { return Of(of.as_good); });
  tell("They get there, in the median", [](const MethodSummary& of) {
    const double seconds = of.seconds_to_as_good;
    return std::isfinite(seconds) ? "after " + Text(seconds, 2) + " s" : std::string();
  });
  sentences.push_back(RaisedSentence(methods));
  const auto of_any = [](const Share& share) { return share.of > 0 ? Of(share) : std::string(); };
  tell("Other runs with the lobes of the lowest run" + each,
       [&](const MethodSummary& of) { return of_any(of.same_lobes); });
  tell("Other runs with the lobes of their own method's lowest run" + each,
       [&](const MethodSummary& of) { return of_any(of.same_again); });
  if (problems.size() == 1) {
    tell("The sphere beside the measurement, in the median", [&](const MethodSummary& of) {
      const auto own = std::ranges::find(summaries, of.method, &MethodSummary::method);
      return own->psnr_db ? Text(*own->psnr_db, 3) + " dB" : std::string();
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
