#include "fit/reports/draw_study.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "core/base/quantile.h"
#include "core/base/text.h"
#include "fit/reports/curves.h"
#include "io/pictures/gnuplot.h"

namespace trilobe {
namespace {

using Drawing = StudyFigure::Drawing;

constexpr double kFloor = 1e-5;  // smaller excesses are drawn here: the lowest E

double Drawn(double excess) { return std::max(excess, kFloor); }

// An axis of excesses over the lowest E, up to the largest one.
std::string ExcessAxis(double largest) {
  std::string tics =
      "'lowest' 1e-5, '0.01 %%' 1e-4, '0.1 %%' 1e-3, '1 %%' 1e-2, '10 %%' 0.1, "
      "'100 %%' 1";
  double top = 1;
  for (double times = 10; top < largest && times < 1e18; times *= 10) {
    top = times - 1;
    tics += ", '" + GnuplotNumber(times) + " times' " + GnuplotNumber(top);
  }
  return "set logscale y\nset yrange [" + GnuplotNumber(kFloor / 1.6) + ":" +
         GnuplotNumber(1.6 * top) + "]\nset ytics (" + tics +
         ")\nset ylabel 'E above the lowest'\n";
}

// A curve for each run, in the colour of its method, which the first one names.
template <typename Rows>
Curves CurvesOf(std::span<const StudyRun> runs, const std::string& style, const Rows& rows_of) {
  Curves curves;
  const std::vector<std::string> methods = MethodsOf(runs);
  for (size_t k = 0; k < methods.size(); ++k) {
    std::string title = methods[k];
    for (const StudyRun& run : runs) {
      if (run.method != methods[k] || run.failed()) continue;
      curves.Add(rows_of(run), style + " " + StyleOf(k), title);
      title.clear();
    }
  }
  return curves;
}

double LargestExcess(std::span<const StudyRun> runs) {
  double largest = 0;
  for (const StudyRun& run : runs) {
    for (const IterationRecord& record : run.trace) {
      largest = std::max(largest, run.ExcessOf(record.minimised()));
    }
  }
  return largest;
}

// Whether a picture shows a record besides those before it: of thousands, each some 1 % later.
class Thinned {
 public:
  bool Takes(double x, bool is_last) {
    if (count_++ >= kAll && x < 1.01 * last_ && !is_last) return false;
    last_ = x;
    return true;
  }

 private:
  static constexpr int kAll = 200;
  int count_ = 0;
  double last_ = 0;
};

// The lowest E so far, over seconds.
Drawing ErrorAgainstTime(std::span<const StudyRun> runs) {
  std::vector<double> seconds;
  const Curves curves = CurvesOf(runs, "with steps linewidth 2", [&](const StudyRun& run) {
    std::vector<std::vector<double>> rows;
    double lowest = std::numeric_limits<double>::infinity();
    Thinned thinned;
    for (const IterationRecord& record : run.trace) {
      lowest = std::min(lowest, run.ExcessOf(record.minimised()));
      const bool is_last = &record == &run.trace.back();
      if (record.seconds > 0 && thinned.Takes(record.seconds, is_last)) {
        rows.push_back({record.seconds, Drawn(lowest)});
      }
    }
    if (rows.empty()) rows.push_back({1e-3, Drawn(lowest)});
    for (const std::vector<double>& row : rows) seconds.push_back(row[0]);
    return rows;
  });
  if (curves.empty()) return {};
  return {kWidth, kHeight,
          curves.data() + kKey + ExcessAxis(LargestExcess(runs)) + "set logscale x\nset xrange " +
              GnuplotLogRange(seconds, 3.5) + "\n" + LogTics(LogRange(seconds, 3.5), 'x') +
              "set xlabel 'seconds'\n" + curves.plot() + "\n"};
}

// The axis of iterations. Sweeps are so many more than joint steps that these would be next to the
// axis but for a logarithmic one, on which the start is at 1/2.
constexpr double kStart = 0.5;
std::string IterationAxis(int most, bool logarithmic) {
  const std::string to = ":" + std::to_string(most) + "]\n";
  if (!logarithmic) return "set xrange [0" + to;
  std::string tics = "'start' " + GnuplotNumber(kStart);
  for (int tic = 1; tic <= most && tic <= 100000000; tic *= 10) {
    tics += ", '" + std::to_string(tic) + "' " + std::to_string(tic);
  }
  return "set logscale x\nset xrange [" + GnuplotNumber(kStart) + to + "set xtics (" + tics + ")\n";
}

// E of each iteration.
Drawing Convergence(std::span<const StudyRun> runs) {
  constexpr std::int64_t kManyTimes = 10;
  int most = 1, fewest = std::numeric_limits<int>::max();
  for (const StudyRun& run : runs) {
    if (run.failed()) continue;
    most = std::max(most, run.iterations());
    fewest = std::min(fewest, run.iterations());
  }
  const bool logarithmic = most > kManyTimes * std::max(fewest, 1);
  const Curves curves = CurvesOf(runs, "with lines linewidth 2", [&](const StudyRun& run) {
    std::vector<std::vector<double>> rows;
    Thinned thinned;
    for (const IterationRecord& record : run.trace) {
      if (!thinned.Takes(record.iteration, &record == &run.trace.back())) continue;
      const double x = logarithmic ? std::max<double>(record.iteration, kStart) : record.iteration;
      rows.push_back({x, Drawn(run.ExcessOf(record.minimised()))});
    }
    return rows;
  });
  if (curves.empty()) return {};
  return {kWidth, kHeight,
          curves.data() + kKey + ExcessAxis(LargestExcess(runs)) +
              IterationAxis(most, logarithmic) + "set xlabel 'iteration (for AWLS, sweep)'\n" +
              curves.plot() + "\n"};
}

// Text as gnuplot's label of a tic, which is a format.
std::string AsFormat(const std::string& text) {
  std::string format;
  for (const char c : text) format += c == '%' ? "%%" : std::string(1, c);
  return format;
}

// A point for each run, side by side within its method.
Drawing FinalErrors(std::span<const StudyRun> runs) {
  const std::vector<std::string> methods = MethodsOf(runs);
  Curves curves;
  std::string tics;
  double largest = 0;
  int starts = 1;
  for (const StudyRun& run : runs) starts = std::max(starts, run.start);
  size_t letters = 0;
  for (const std::string& method : methods) letters = std::max(letters, method.size());
  constexpr size_t kLettersInARow = 60;
  const bool long_names = letters * methods.size() > kLettersInARow;
  for (size_t k = 0; k < methods.size(); ++k) {
    std::vector<std::vector<double>> rows;
    for (const StudyRun& run : runs) {
      if (run.method != methods[k] || run.failed()) continue;
      const double place = (run.start - (starts + 1) / 2.0) / starts;
      rows.push_back({static_cast<double>(k) + 0.7 * place, Drawn(run.excess())});
      largest = std::max(largest, run.excess());
    }
    tics += (k > 0 ? ", " : "") + GnuplotQuote(AsFormat(methods[k])) + " " + std::to_string(k);
    if (rows.empty()) continue;
    curves.Add(rows, "with points pointtype 7 pointsize 0.9 linecolor " + ColorOf(k), "");
  }
  if (curves.empty()) return {};
  return {kWidth, kHeight,
          curves.data() + ExcessAxis(largest) +
              "set xrange [-0.5:" + GnuplotNumber(static_cast<double>(methods.size()) - 0.5) +
              "]\nset grid noxtics\nset xtics noenhanced " + (long_names ? "rotate by -20 " : "") +
              "(" + tics + ")\n" + curves.plot() + "\n"};
}

// D of a lobe over the root of theta_h in degrees, of an anisotropic one the mean over phi_h.
std::vector<std::vector<double>> DistributionOf(const ModelFile& file, int lobe) {
  const Axis& axis = file.model.spec().d_axis;
  const std::span<const double> D = file.model.D(lobe, 0);
  std::vector<std::vector<double>> rows;
  for (int k = 0; k < axis.size; k += axis.phi_nodes) {
    double sum = 0;
    for (int b = 0; b < axis.phi_nodes; ++b) sum += D[k + b];
    const double degrees = axis.Theta(k) * 180 / std::numbers::pi;
    if (sum > 0) rows.push_back({std::sqrt(degrees), sum / axis.phi_nodes});
  }
  return rows;
}

// The panel of a method and a lobe: its runs in colour, the lowest of all in black.
std::string LobePanel(const StudyRun& lowest, const std::vector<const StudyRun*>& runs, int lobe,
                      size_t method, const std::string& title) {
  Curves curves;
  for (const StudyRun* run : runs) {
    const int own = run == &lowest ? lobe : run->lobes->lobe[lobe];
    if (own < 0) continue;  // it has fewer lobes
    const std::vector<std::vector<double>> rows = DistributionOf(run->file, own);
    if (!rows.empty()) curves.Add(rows, "with lines linewidth 2 " + StyleOf(method), "");
  }
  const std::vector<std::vector<double>> of_lowest = DistributionOf(lowest.file, lobe);
  if (curves.empty() || of_lowest.empty()) return "set multiplot next\n";
  curves.Add(of_lowest, "with lines linewidth 1.5 dashtype 2 linecolor '#000000'", "");
  return "set title " + title + " noenhanced\n" + curves.data() + curves.plot() + "\n";
}

// The axis of D of a lobe, for all runs.
std::string DistributionAxis(const StudyRun& lowest, std::span<const StudyRun> runs, int lobe) {
  std::vector<double> values;
  for (const StudyRun& run : runs) {
    if (!run.lobes && &run != &lowest) continue;
    const int own = run.lobes ? run.lobes->lobe[lobe] : lobe;
    if (own < 0) continue;
    for (const std::vector<double>& row : DistributionOf(run.file, own)) values.push_back(row[1]);
  }
  return "set yrange " + GnuplotLogRange(values, 5) + "\n" + LogTics(LogRange(values, 5), 'y');
}

// "lm", and below "lobe 2, match 0.97", the median over the runs; for gnuplot.
std::string PanelTitle(const std::string& method, const std::vector<const StudyRun*>& runs,
                       int lobe) {
  std::vector<double> matches;
  for (const StudyRun* run : runs) {
    if (run->lobes) matches.push_back(run->lobes->match[lobe]);
  }
  constexpr size_t kLetters = 34;
  const std::string name = method.size() > kLetters ? method.substr(0, kLetters - 1) + "…" : method;
  std::string text = "lobe " + std::to_string(lobe + 1);
  if (!matches.empty()) text += ", match " + Text(Median(std::move(matches)), 2);
  return GnuplotQuote(name) + R"(."\n".)" + GnuplotQuote(text);
}

// A row of panels for each method, a column for each lobe of the lowest run.
Drawing Lobes(std::span<const StudyRun> runs) {
  if (runs.empty()) return {};
  const StudyRun* const lowest = LowestRun(runs, runs.front().problem);
  if (lowest == nullptr || lowest->file.model.spec().lobes == 0) return {};
  const int lobes = lowest->file.model.spec().lobes;
  const std::vector<std::string> methods = MethodsOf(runs);
  std::string panels;
  int rows = 0;
  for (size_t k = 0; k < methods.size(); ++k) {
    std::vector<const StudyRun*> own;
    for (const StudyRun& run : runs) {
      if (run.method == methods[k] && (run.lobes || &run == lowest)) own.push_back(&run);
    }
    if (own.empty()) continue;
    ++rows;
    for (int lobe = 0; lobe < lobes; ++lobe) {
      panels += DistributionAxis(*lowest, runs, lobe) +
                LobePanel(*lowest, own, lobe, k, PanelTitle(methods[k], own, lobe));
    }
  }
  return {320 * lobes, 260 * rows + 60,
          "set multiplot layout " + std::to_string(rows) + "," + std::to_string(lobes) +
              " title 'D [1/sr] over θ_h; dashed: the lowest run' font ',13'\n"
              "set nokey\nset logscale y\nset xrange [0:sqrt(90)]\n"
              "set xtics ('0°' 0, '5°' sqrt(5), '15°' sqrt(15), '45°' sqrt(45), '90°' sqrt(90))\n"
              "set title offset 0,-0.7\nset lmargin 7\nset rmargin 3\nset tmargin 2.8\n"
              "set bmargin 2\n" +
              panels + "unset multiplot\n"};
}

constexpr StudyFigure kFigures[] = {
    {"error_against_time",
     "The lowest E so far, over the seconds since each run prepared its data.", ErrorAgainstTime},
    {"convergence", "E after each iteration: one line a run.", Convergence},
    {"final_error", "E at the end of each run, by starting point from left to right.", FinalErrors},
    {"lobes",
     "D over θh of each lobe: all runs of a method laid over each other; dashed, the lowest run.",
     Lobes}};

}  // namespace

std::span<const StudyFigure> StudyFigures() { return kFigures; }

bool DrawStudyFigure(const StudyFigure& figure, std::span<const StudyRun> runs,
                     const std::string& folder) {
  const Drawing drawing = figure.draw(runs);
  if (drawing.script.empty()) return false;
  for (const char* const ending : {".svg", ".pdf"}) {
    DrawVectors(folder + "/" + figure.name + ending, drawing.width, drawing.height, drawing.script);
  }
  return true;
}

}  // namespace trilobe
