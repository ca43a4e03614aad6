#include "io/pictures/plot_panels.h"

#include <algorithm>
#include <utility>

#include "io/pictures/gnuplot.h"

namespace trilobe {
namespace {

// In pixels.
constexpr int kLeft = 150, kRight = 45;    // of a panel's axes: room for labels and tics
constexpr int kAbove = 130, kBelow = 110;  // for title and legend, for labels
constexpr int kPanelHeight = 340;

std::string Fraction(double a, int b) { return GnuplotNumber(a / b); }

}  // namespace

std::string PanelMargins(int x, int y, int width, int height, int canvas_width, int canvas_height) {
  return "set lmargin at screen " + Fraction(x, canvas_width) + "\nset rmargin at screen " +
         Fraction(x + width, canvas_width) + "\nset tmargin at screen " +
         Fraction(canvas_height - y, canvas_height) + "\nset bmargin at screen " +
         Fraction(canvas_height - y - height, canvas_height) + "\n";
}

void PanelRows::Add(std::vector<Panel> panels, int columns) {
  std::erase_if(panels, [](const Panel& panel) { return panel.plot.empty(); });
  for (size_t k = 0; k < panels.size(); ++k) {
    if (k % columns == 0) rows_.emplace_back();
    rows_.back().push_back(std::move(panels[k]));
  }
}

int PanelRows::height() const {
  return static_cast<int>(rows_.size()) * (kAbove + kPanelHeight + kBelow);
}

std::string PanelRows::Script(int top, int canvas) const {
  std::string script;
  for (const std::vector<Panel>& row : rows_) {
    const int cell = width_ / static_cast<int>(row.size());
    for (size_t k = 0; k < row.size(); ++k) {
      const Panel& panel = row[k];
      const int x = static_cast<int>(k) * cell + kLeft, width = cell - kLeft - kRight;
      const std::string center = " at screen " + Fraction(x + width / 2.0, width_) + ", screen ";
      script += PanelMargins(x, top + kAbove, width, kPanelHeight, width_, canvas) +
                "set border 3 linecolor '#555555'\nset tics nomirror out\n"
                "set grid xtics ytics\nset xtics nomirror out autofreq\n"
                "set ytics nomirror out autofreq\n"
                "set label 1 '" +
                panel.title + "'" + center + Fraction(canvas - top - 34, canvas) +
                " center font ',19'\nset key" + center + Fraction(canvas - top - 50, canvas) +
                " center top horizontal maxrows 2 font ',15'\n" + panel.setup + panel.plot +
                "\nunset label\n";
    }
    top += kAbove + kPanelHeight + kBelow;
  }
  return script;
}

}  // namespace trilobe
