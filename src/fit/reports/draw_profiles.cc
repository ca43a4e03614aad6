#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "fit/reports/curves.h"
#include "fit/reports/draw_study.h"
#include "fit/reports/profiles.h"
#include "io/pictures/gnuplot.h"

namespace trilobe {
namespace {

using Drawing = StudyFigure::Drawing;

// Both ends of each step of a profile, up to `last`: x, share, and the interval.
std::vector<std::vector<double>> StepsOf(const Profile& profile, double last) {
  std::vector<std::vector<double>> rows;
  for (size_t k = 0; k < profile.points.size(); ++k) {
    const auto& [x, share, interval] = profile.points[k];
    const double end = k + 1 < profile.points.size() ? profile.points[k + 1].x : last;
    rows.push_back({x, share, interval.low, interval.high});
    rows.push_back({end, share, interval.low, interval.high});
  }
  return rows;
}

Drawing Draw(const std::vector<Profile>& profiles, const std::string& x_label) {
  constexpr size_t kMostBands = 4;  // more hide each other
  double first = profiles.front().points.front().x, last = first;
  for (const Profile& profile : profiles) last = std::max(last, profile.points.back().x);
  last = std::max(1.2 * last, 2 * first);
  Curves curves;
  for (size_t k = 0; k < profiles.size() && profiles.size() <= kMostBands; ++k) {
    curves.Add(StepsOf(profiles[k], last),
               "with filledcurves fillstyle transparent solid 0.1 noborder linecolor " + ColorOf(k),
               "", "1:3:4");
  }
  for (size_t k = 0; k < profiles.size(); ++k) {
    curves.Add(StepsOf(profiles[k], last), "with lines linewidth 2.5 " + StyleOf(k),
               profiles[k].method);
  }
  return {kWidth, kHeight,
          curves.data() + kKey + "set logscale x\nset xrange [" + GnuplotNumber(first) + ":" +
              GnuplotNumber(last) + "]\n" + LogTics({first, last}, 'x') +
              "set yrange [0:1.02]\nset ytics ('0' 0, '25 %%' 0.25, '50 %%' 0.5, '75 %%' 0.75, "
              "'100 %%' 1)\nset ylabel 'runs within 1 % of the lowest E'\nset xlabel '" +
              x_label + "'\n" + curves.plot() + "\n"};
}

bool HasProfiles(std::span<const StudyRun> runs) {
  return ProblemsOf(runs).size() >= kFewestProblems;
}

Drawing Performance(std::span<const StudyRun> runs) {
  if (!HasProfiles(runs)) return {};
  return Draw(PerformanceProfiles(runs), "time over that of the fastest from the same start");
}

Drawing Data(std::span<const StudyRun> runs) {
  if (!HasProfiles(runs)) return {};
  return Draw(DataProfiles(runs), "seconds");
}

constexpr StudyFigure kProfiles[] = {
    {"performance_profile",
     "Performance profiles: the share of runs that come within 1 % of the lowest E of their "
     "problem "
     "in at most x times the time of the fastest method from the same start. Bands, of up to four "
     "methods: 95 % intervals.",
     Performance},
    {"data_profile",
     "Data profiles: the share of runs that come within 1 % of the lowest E of their problem in x "
     "seconds. Bands, of up to four methods: 95 % intervals.",
     Data}};

}  // namespace

std::span<const StudyFigure> ProfileFigures() { return kProfiles; }

}  // namespace trilobe
