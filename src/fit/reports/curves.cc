#include "fit/reports/curves.h"

#include <iterator>
#include <string_view>

#include "io/pictures/gnuplot.h"

namespace trilobe {

std::string ColorOf(size_t method) {
  constexpr std::string_view kColors[] = {"#0072B2", "#D55E00", "#009E73", "#CC79A7",
                                          "#E69F00", "#56B4E9", "#7D7D7D", "#8C6D31"};
  return "'" + std::string(kColors[method % std::size(kColors)]) + "'";
}

std::string StyleOf(size_t method) {
  return "linecolor " + ColorOf(method) + " dashtype " + std::to_string(1 + method / 8);
}

void Curves::Add(const std::vector<std::vector<double>>& rows, const std::string& style,
                 const std::string& title, const std::string& columns) {
  const std::string name = "curve" + std::to_string(count_++);
  data_ += GnuplotData(name, rows);
  plot_ += plot_.empty() ? "plot " : ", ";
  plot_ += "$" + name + " using " + columns + " " + style + " " +
           (title.empty() ? "notitle" : "title " + GnuplotQuote(title) + " noenhanced");
}

}  // namespace trilobe
