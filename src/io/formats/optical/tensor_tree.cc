#include "io/formats/optical/tensor_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "core/files/text_lines.h"

namespace trilobe {
namespace {

constexpr int kMaxRank = 4;
constexpr std::string_view kBetween = " \t\r\n,";

// A cell of the unit cube.
struct Cell {
  std::array<double, kMaxRank> begin{};
  double size = 1;
};

// The direction over a point of the unit disk to which Shirley and Chiu's map takes one of the unit
// square.
PolarAngles OverSquare(double x, double y) {
  const double a = 2 * x - 1, b = 2 * y - 1;
  if (a == 0 && b == 0) return {};
  const bool along = std::abs(a) > std::abs(b);
  const double radius = along ? a : b;
  const double phi = along ? kPi / 4 * b / a : kPi / 2 - kPi / 4 * a / b;
  return {std::asin(std::min(std::abs(radius), 1.0)), radius < 0 ? phi + kPi : phi};
}

class TreeReader {
 public:
  TreeReader(std::string_view text, int rank, const TreeFailure& fail,
             const std::function<void(const SphericalAngles&, double)>& add)
      : rest_(text), rank_(rank), fail_(fail), add_(add) {}

  void Read() {
    ReadNode({}, 0);
    Skip();
    if (!rest_.empty()) fail_("there is more after the tensor tree", "more");
  }

 private:
  // Skips white space and commas.
  void Skip() { rest_.remove_prefix(std::min(rest_.find_first_not_of(kBetween), rest_.size())); }

  bool Take(char c) {
    Skip();
    if (!rest_.starts_with(c)) return false;
    rest_.remove_prefix(1);
    return true;
  }

  void ReadNode(const Cell& cell, int depth) {
    constexpr int kDeepest = 16;
    if (depth > kDeepest) fail_("a tensor tree deeper than 16 levels", "levels");
    if (!Take('{')) fail_("expected { in the tensor tree", "{");
    Skip();
    if (rest_.starts_with('{')) {
      for (int child = 0; child < 1 << rank_; ++child) {
        Cell half = {.begin = cell.begin, .size = cell.size / 2};
        for (int k = 0; k < rank_; ++k) {
          if ((child >> k & 1) != 0) half.begin[k] += half.size;
        }
        ReadNode(half, depth + 1);
      }
    } else {
      ReadGrid(cell);
    }
    if (!Take('}')) fail_("expected } in the tensor tree", "}");
  }

  // A value, or a grid of as many along each axis, a power of two; the last axis is the fastest.
  void ReadGrid(const Cell& cell) {
    std::vector<double> values;
    for (Skip(); !rest_.empty() && rest_[0] != '}'; Skip()) {
      const std::string_view word = rest_.substr(0, rest_.find_first_of(" \t\r\n,{}"));
      const std::optional<double> value = ToNumber(word);
      if (!value) {
        fail_(
            std::string("'").append(word.substr(0, 40)).append("' in the tensor tree is no number"),
            word);
      }
      values.push_back(*value);
      rest_.remove_prefix(word.size());
    }
    int level = 0;
    while (level * rank_ < 40 && size_t{1} << level * rank_ < values.size()) ++level;
    if (size_t{1} << level * rank_ != values.size()) {
      fail_(std::to_string(values.size()) + " values in a leaf of a tensor tree of rank " +
                std::to_string(rank_),
            std::to_string(values.size()));
    }
    const double size = cell.size / (1 << level);
    for (size_t n = 0; n < values.size(); ++n) {
      Cell part = {.begin = cell.begin, .size = size};
      for (int k = 0; k < rank_; ++k) {
        const size_t index = n >> (rank_ - 1 - k) * level & ((size_t{1} << level) - 1);
        part.begin[k] += static_cast<double>(index) * size;
      }
      Add(part, values[n]);
    }
  }

  // The axes of rank 4 are the point of the disk opposite the light, then that of the eye. Of rank
  // 3 the light is at the azimuth 180 degrees, and the first axis its point from the rim, at 0, to
  // the middle, at 1/2.
  void Add(const Cell& cell, double value) const {
    std::array<double, kMaxRank> x{};
    for (int k = 0; k < rank_; ++k) x[k] = cell.begin[k] + cell.size / 2;
    if (rank_ == 4) {
      const PolarAngles opposite = OverSquare(x[0], x[1]), eye = OverSquare(x[2], x[3]);
      add_({opposite.theta, opposite.phi + kPi, eye.theta, eye.phi}, value);
      return;
    }
    if (cell.begin[0] >= 0.5) return;  // not used
    const double along = std::min(x[0], cell.begin[0] + (0.5 - cell.begin[0]) / 2);
    const PolarAngles eye = OverSquare(x[1], x[2]);
    add_({std::asin(1 - 2 * along), kPi, eye.theta, eye.phi}, value);
  }

  std::string_view rest_;
  int rank_;
  const TreeFailure& fail_;
  const std::function<void(const SphericalAngles&, double)>& add_;
};

}  // namespace

void ReadTensorTree(std::string_view text, int rank, const TreeFailure& fail,
                    const std::function<void(const SphericalAngles&, double)>& add) {
  TreeReader(text, rank, fail, add).Read();
}

}  // namespace trilobe
