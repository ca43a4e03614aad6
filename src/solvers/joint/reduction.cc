#include "solvers/joint/reduction.h"

#include <cstddef>

namespace trilobe {

void Reduction::Add(int column, double weight) {
  column_.push_back(column);
  weight_.push_back(weight);
}

void Reduction::EndRow() { begin_.push_back(static_cast<int>(column_.size())); }

int Reduction::NewColumn() {
  source_.push_back(num_parameters());
  return size() - 1;
}

void Reduction::EndPart() {
  const int begin = parts_.empty() ? 0 : parts_.back().begin + parts_.back().size;
  parts_.push_back({begin, size() - begin});
}

Reduction::Reduction(const ModelSpec& spec, const TableLayout& layout) {
  CheckLayout(layout, spec);
  for (int part = 0; part <= spec.lobes; ++part) {
    const bool coloured = part == 0 ? layout.coloured_d : layout.coloured_s;
    for (int c = 0; c < kChannels; ++c) {
      Add(c == 0 || coloured ? NewColumn() : size() - 1, 1);
      EndRow();
    }
    EndPart();
  }
  for (const Factor factor : kFactors) {
    for (int t = 0; t < spec.num_tables(factor); ++t) {
      const std::vector<int>& nodes = layout.of(factor, t);
      const int first = size();
      for (int entry = 0; entry < spec.table_size(factor); ++entry) {
        const NodeWeights at = WeightsAt(nodes, entry);
        if (nodes[at.right] == entry) NewColumn();
        if (at.left != at.right) Add(first + at.left, 1 - at.t);
        Add(first + at.right, at.left != at.right ? at.t : 1);
        EndRow();
      }
      EndPart();
    }
  }
}

Reduction Reduction::BySharing(const ModelSpec& spec, const ModelSpec& fewer) {
  const FactorModel full(spec), shared(fewer);
  // The number of `fewer` that each of `spec` becomes.
  std::vector<int> target(spec.num_parameters());
  for (int k = 0; k < kChannels * (1 + spec.lobes); ++k) target[k] = k;
  for (const Factor factor : kFactors) {
    for (int m = 0; m < spec.lobes; ++m) {
      for (int c = 0; c < kChannels; ++c) {
        const int begin = full.TableOffset(factor, spec.table(factor, m, c));
        const int target_begin = shared.TableOffset(factor, fewer.table(factor, m, c));
        for (int k = 0; k < spec.table_size(factor); ++k) target[begin + k] = target_begin + k;
      }
    }
  }
  Reduction reduction;
  reduction.source_.assign(fewer.num_parameters(), -1);
  for (int k = 0; k < spec.num_parameters(); ++k) {
    reduction.Add(target[k], 1);
    reduction.EndRow();
    if (int& source = reduction.source_[target[k]]; source < 0) source = k;
  }
  reduction.parts_ = shared.Parts();
  return reduction;
}

Reduction Reduction::ComposedWith(const Reduction& inner) const {
  Reduction product;
  for (int k = 0; k < num_parameters(); ++k) {
    for (int n = begin_[k]; n < begin_[k + 1]; ++n) {
      const int j = column_[n];
      for (int i = inner.begin_[j]; i < inner.begin_[j + 1]; ++i) {
        product.Add(inner.column_[i], weight_[n] * inner.weight_[i]);
      }
    }
    product.EndRow();
  }
  for (const int j : inner.source_) product.source_.push_back(source_[j]);
  product.parts_ = inner.parts_;
  return product;
}

std::vector<double> Reduction::Expand(std::span<const double> y) const {
  std::vector<double> x(num_parameters(), 0.0);
  for (int k = 0; k < num_parameters(); ++k) {
    for (int n = begin_[k]; n < begin_[k + 1]; ++n) x[k] += weight_[n] * y[column_[n]];
  }
  return x;
}

std::vector<double> Reduction::Restrict(std::span<const double> x) const {
  std::vector<double> y;
  y.reserve(source_.size());
  for (const int k : source_) y.push_back(x[k]);
  return y;
}

std::vector<double> Reduction::Transpose(std::span<const double> x) const {
  std::vector<double> y(size(), 0.0);
  for (int k = 0; k < num_parameters(); ++k) {
    for (int n = begin_[k]; n < begin_[k + 1]; ++n) y[column_[n]] += weight_[n] * x[k];
  }
  return y;
}

QuadraticModel Reduction::operator()(const QuadraticModel& at) const {
  const size_t n = num_parameters(), m = size();
  QuadraticModel reduced{.objective = at.objective,
                         .gradient = Transpose(at.gradient),
                         .H = std::vector<double>(m * m, 0.0),
                         .squared_lengths = std::vector<double>(m, 0.0)};
  for (size_t k = 0; k < n; ++k) {
    const std::vector<double> row = Transpose({&at.H[k * n], n});  // of H B
    for (int i = begin_[k]; i < begin_[k + 1]; ++i) {
      const double weight = weight_[i];
      double* const target = &reduced.H[column_[i] * m];
      for (size_t j = 0; j < m; ++j) target[j] += weight * row[j];
      reduced.squared_lengths[column_[i]] += weight * weight * at.squared_lengths[k];
    }
  }
  return reduced;
}

}  // namespace trilobe
