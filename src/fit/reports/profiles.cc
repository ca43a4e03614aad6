#include "fit/reports/profiles.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "fit/reports/csv.h"

namespace trilobe {
namespace {

constexpr double kForever = std::numeric_limits<double>::infinity();
constexpr double kLeastSeconds = 1e-6;

using Start = std::pair<std::string, int>;  // problem, start

// The seconds of each method from each start; infinite where it does not get there.
std::map<std::string, std::map<Start, double>> SecondsOf(std::span<const StudyRun> runs) {
  std::map<std::string, std::map<Start, double>> seconds;
  const std::vector<std::string> methods = MethodsOf(runs);
  for (const StudyRun& run : runs) {
    for (const std::string& method : methods) {
      seconds[method].try_emplace({run.problem, run.start}, kForever);
    }
    seconds[run.method][{run.problem, run.start}] = std::max(run.SecondsTo(kAsGood), kLeastSeconds);
  }
  return seconds;
}

// `times`: of each start, infinite ones among them. Begins at `first`.
Profile ProfileOf(const std::string& method, std::vector<double> times, double first,
                  int num_problems) {
  std::ranges::sort(times);
  Profile profile{.method = method, .points = {}};
  const auto add = [&](double x) {
    const auto solved = std::ranges::upper_bound(times, x) - times.begin();
    const double share = static_cast<double>(solved) / static_cast<double>(times.size());
    profile.points.push_back({x, share, WilsonInterval(share, num_problems)});
  };
  add(first);
  for (const double x : times) {
    if (std::isfinite(x) && x > profile.points.back().x) add(x);
  }
  return profile;
}

// `x_of`: what a time of a start counts as.
template <typename XOf>
std::vector<Profile> ProfilesOf(std::span<const StudyRun> runs, double first, const XOf& x_of) {
  const auto seconds = SecondsOf(runs);
  const int num_problems = static_cast<int>(ProblemsOf(runs).size());
  std::vector<Profile> profiles;
  for (const std::string& method : MethodsOf(runs)) {
    std::vector<double> times;
    for (const auto& [start, time] : seconds.at(method)) times.push_back(x_of(start, time));
    profiles.push_back(ProfileOf(method, std::move(times), first, num_problems));
  }
  return profiles;
}

}  // namespace

std::vector<Profile> PerformanceProfiles(std::span<const StudyRun> runs) {
  std::map<Start, double> least;
  for (const auto& [method, times] : SecondsOf(runs)) {
    for (const auto& [start, time] : times) {
      least[start] = std::min(least.try_emplace(start, kForever).first->second, time);
    }
  }
  return ProfilesOf(runs, 1, [&](const Start& start, double time) {
    return std::isfinite(time) ? time / least.at(start) : kForever;
  });
}

std::vector<Profile> DataProfiles(std::span<const StudyRun> runs) {
  double first = kForever;
  for (const auto& [method, times] : SecondsOf(runs)) {
    for (const auto& [start, time] : times) first = std::min(first, time);
  }
  if (!std::isfinite(first)) first = kLeastSeconds;
  return ProfilesOf(runs, first, [](const Start& /*start*/, double time) { return time; });
}

std::string ProfilesCsv(std::span<const StudyRun> runs) {
  Csv csv("profile,method,x,share,low,high");
  if (ProblemsOf(runs).size() < kFewestProblems) return csv.text();
  for (const auto& [name, profiles] : {std::pair("performance", PerformanceProfiles(runs)),
                                       std::pair("data", DataProfiles(runs))}) {
    for (const Profile& profile : profiles) {
      for (const auto& [x, share, interval] : profile.points) {
        csv.Add(name).Add(profile.method).Add(x).Add(share).Add(interval.low).Add(interval.high);
        csv.EndRow();
      }
    }
  }
  return csv.text();
}

}  // namespace trilobe
