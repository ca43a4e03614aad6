#include <algorithm>
#include <vector>

#include "core/base/file_names.h"
#include "io/pictures/gnuplot.h"
#include "io/pictures/plots.h"
#include "trilobe/core/base/error.h"

namespace trilobe {

void DrawTrace(std::span<const IterationRecord> trace, const std::string& title,
               const std::string& path) {
  if (trace.empty()) {
    throw Error(ErrorKind::kMissing, "the trace has no record, so there is nothing to draw")
        .About("trace");
  }
  CheckDrawable({}, trace);
  // Iteration, seconds, E that the solver lowers, filtered, rejected, E of the data.
  std::vector<std::vector<double>> rows;
  std::vector<double> objectives;
  const bool with_prior = trace.front().objective_with_prior.has_value();
  bool filtered = false, rejected = false;
  for (const IterationRecord& record : trace) {
    rows.push_back({static_cast<double>(record.iteration), record.seconds, record.minimised(),
                    record.filtered ? 1.0 : 0.0, record.accepted ? 0.0 : 1.0, record.objective});
    objectives.insert(objectives.end(), {record.minimised(), record.objective});
    filtered = filtered || record.filtered;
    rejected = rejected || !record.accepted;
  }
  const auto [low, high] = std::ranges::minmax(objectives);
  std::string script = GnuplotData("trace", rows);
  script +=
      "set multiplot layout 1,2 title " +
      GnuplotTitle(title.empty() ? "Convergence" : "Convergence: " + FileNameOf(title), 1600, 22) +
      "\nset lmargin 11\nset rmargin 3\n";
  if (high > 10 * low) {
    script += "set logscale y\nset format y '10^{%T}'\nset yrange " +
              GnuplotLogRange(objectives, 30) + "\n";
  } else {  // an axis of less than a decade has too few powers of ten to be read
    script += "set format y '%.4g'\nset yrange [" + GnuplotNumber(0.98 * low) + ":" +
              GnuplotNumber(high > 0 ? 1.02 * high : 1) + "]\n";
  }
  const auto panel = [&](const char* column, const char* label, double last) {
    script += std::string("set xlabel '") + label +
              "'\nset xrange [0:" + GnuplotNumber(last > 0 ? 1.02 * last : 1) +
              "]\nplot $trace using " + column +
              ":3 with linespoints pointtype 7 pointsize 0.9 linewidth 2.5 linecolor '" +
              kOkabeIto[4] + "' " + (with_prior ? "title 'of data and prior'" : "notitle");
    if (with_prior) {
      script += std::string(", '' using ") + column +
                ":6 with linespoints pointtype 5 pointsize 0.7 linewidth 2 linecolor '" +
                kOkabeIto[1] + "' title 'of the data alone'";
    }
    const auto mark = [&](const char* flag, const char* symbol, const char* meaning) {
      script += std::string(", '' using ") + column + ":(" + flag +
                " > 0 ? $3 : NaN) with points pointtype " + symbol +
                " pointsize 1.8 linewidth 2 linecolor '" + kOkabeIto[5] + "' title '" + meaning +
                "'";
    };
    if (filtered) mark("$4", "6", "after the filter on G");
    if (rejected) mark("$5", "2", "step taken back");
    script += '\n';
  };
  script += "set ylabel 'objective E'\n";
  if (trace.back().iteration < 8) script += "set xtics 1\n";
  panel("1", "iteration", trace.back().iteration);
  script += "set ylabel ''\n";
  script += "set xtics autofreq\n";
  panel("2", "seconds", trace.back().seconds);
  DrawPng(path, 1600, 800, script);
}

}  // namespace trilobe
