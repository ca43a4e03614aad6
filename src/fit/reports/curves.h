#ifndef TRILOBE_FIT_REPORTS_CURVES_H_
#define TRILOBE_FIT_REPORTS_CURVES_H_

#include <cstddef>
#include <string>
#include <vector>

// The figures of a study share this, for gnuplot.

namespace trilobe {

inline constexpr int kWidth = 760, kHeight = 460;  // of a figure, in pixels
inline constexpr const char* kKey = "set key outside center top horizontal\n";

// The colour of a method, quoted, and the style of its curves. More than eight methods have the
// same colours, dashed.
std::string ColorOf(size_t method);
std::string StyleOf(size_t method);

// Blocks of data, and the plot that shows them.
class Curves {
 public:
  // `style`: what follows `using 1:2`, or other `columns`. No title: none in the key.
  void Add(const std::vector<std::vector<double>>& rows, const std::string& style,
           const std::string& title, const std::string& columns = "1:2");

  bool empty() const { return plot_.empty(); }
  const std::string& data() const { return data_; }
  const std::string& plot() const { return plot_; }

 private:
  std::string data_, plot_;
  int count_ = 0;
};

}  // namespace trilobe

#endif  // TRILOBE_FIT_REPORTS_CURVES_H_
