#include "solvers/sums/scattered_equations.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "core/algebra/symmetric_matrix.h"
#include "solvers/sums/add_normal_equations.h"
#include "trilobe/core/system/parallel.h"

namespace trilobe {
namespace {

// Rows of a kind, or of the tables of D that are read by one stretch, but for where their sums lie.
AccumulatorRows RowsOf(const BatchEvaluator& reader, ParameterKind kind, int stretch) {
  const ModelSpec& spec = reader.spec();
  const FactorModel model(spec);
  AccumulatorRows rows;
  rows.kind = kind;
  if (kind == ParameterKind::kAmplitudes) {
    rows.entries = kChannels;
    rows.lanes = reader.amplitude_lanes();
    for (int a = 0; a <= spec.lobes; ++a) rows.table.push_back(a);
    rows.lane = rows.table;
  } else {
    const Factor factor = FactorOf(kind);
    rows.by_cell = factor != Factor::kG;
    rows.entries = spec.table_size(factor);
    rows.lanes = reader.lanes(factor).size;
    for (int t = 0; t < spec.num_tables(factor); ++t) {
      if (factor == Factor::kD && spec.StretchOfTable(t) != stretch) continue;
      rows.table.push_back(t);
      rows.lane.push_back(reader.lanes(factor).of_table[t]);
    }
  }
  rows.tables = static_cast<int>(rows.table.size());
  for (int entry = 0; entry < rows.entries; ++entry) {
    for (const int t : rows.table) {
      rows.parameter.push_back(kind != ParameterKind::kAmplitudes
                                   ? model.TableOffset(FactorOf(kind), t) + entry
                               : t == spec.lobes ? entry
                                                 : kChannels * (1 + t) + entry);
    }
  }
  return rows;
}

}  // namespace

ScatteredEquations::ScatteredEquations(const FoldedSamples& samples, const ModelSpec& spec,
                                       int num_threads)
    : reader_(samples, spec),
      num_threads_(num_threads),
      accumulators_(NumAccumulators(samples.size())) {
  const auto add = [&](ParameterKind kind, int stretch) {
    layout_.rows.push_back(RowsOf(reader_, kind, stretch));
  };
  add(ParameterKind::kAmplitudes, 0);
  for (int k = 0; k < samples.order.of_D; ++k) add(ParameterKind::kD, k);
  add(ParameterKind::kF, 0);
  add(ParameterKind::kG, 0);
  const AccumulatorRows& amplitudes = layout_.amplitudes();
  for (AccumulatorRows& rows : layout_.rows) {
    num_parameters_ += static_cast<int>(rows.parameter.size());
    rows.own_lines = AccumulatorRows::kFirstAmplitude + amplitudes.entries * amplitudes.tables;
    rows.own = layout_.size;
    layout_.size += rows.entries * rows.own_size();
    for (const AccumulatorRows& others : layout_.rows) {
      rows.blocks.push_back(layout_.size);
      if (others.kind != ParameterKind::kAmplitudes) {
        layout_.size +=
            &others == &rows && rows.by_cell
                ? rows.InCell(static_cast<int>(samples.cells_of(FactorOf(rows.kind)).size()), 0)
                : static_cast<size_t>(others.entries) * rows.entries * others.tables * rows.lanes;
      }
      if (&others == &rows) break;
    }
  }
}

void ScatteredEquations::Evaluate(const FactorModel& model, Hessian hessian,
                                  QuadraticModel* result) {
  reader_.SetModel(model);
  const int count = static_cast<int>(accumulators_.size());
  std::vector<double> objectives(count);
  ParallelFor(count, num_threads_, [&](int k) {
    const int64_t size = reader_.samples().size();
    accumulators_[k].assign(layout_.size, 0.0);
    objectives[k] =
        AddNormalEquations(reader_, layout_, hessian, static_cast<int>(size * k / count),
                           static_cast<int>(size * (k + 1) / count), accumulators_[k].data());
  });
  result->objective =
      std::accumulate(objectives.begin(), objectives.end(), reader_.samples().constant);

  constexpr size_t kPiece = 1 << 16;
  ParallelFor(static_cast<int>((layout_.size + kPiece - 1) / kPiece), num_threads_, [&](int piece) {
    const size_t begin = piece * kPiece, end = std::min(begin + kPiece, layout_.size);
    for (int k = 1; k < count; ++k) {
      for (size_t i = begin; i < end; ++i) accumulators_[0][i] += accumulators_[k][i];
    }
  });
  const auto n = static_cast<size_t>(num_parameters_);
  result->gradient.assign(n, 0.0);
  result->squared_lengths.assign(n, 0.0);
  // All of the lower triangle is set below, but for what is within a kind by cells, which is added.
  result->H.resize(n * n);
  for (const AccumulatorRows& rows : layout_.rows) {
    if (!rows.by_cell || rows.parameter.empty()) continue;
    const int first = std::ranges::min(rows.parameter);
    ParallelFor(static_cast<int>(rows.parameter.size()), num_threads_, [&](int k) {
      const size_t p = rows.parameter[k];
      std::fill_n(&result->H[p * n + first], p + 1 - first, 0.0);
    });
  }
  for (const AccumulatorRows& rows : layout_.rows) {
    // Entries by threes of tables fill lines of the cache.
    constexpr int kEntries = 8;
    ParallelFor((rows.entries + kEntries - 1) / kEntries, num_threads_, [&](int chunk) {
      const int begin = chunk * kEntries, end = std::min(begin + kEntries, rows.entries);
      for (int entry = begin; entry < end; ++entry) GatherOwn(rows, entry, result);
      GatherBlocks(rows, begin, end, result);
    });
    if (rows.by_cell) GatherCells(rows, result);
    GatherSquaredLengths(rows, hessian, result);
  }
  MirrorTriangle(Triangle::kLower, n, result->H.data(), num_threads_);
}

// The gradient, and products with amplitudes. A product of two parameters of one kind is in one
// place or the other, or half in both.
void ScatteredEquations::GatherOwn(const AccumulatorRows& rows, int entry,
                                   QuadraticModel* result) const {
  const auto n = static_cast<size_t>(num_parameters_);
  const AccumulatorRows& amplitudes = layout_.amplitudes();
  const double* const sums = accumulators_[0].data();
  for (int t = 0; t < rows.tables; ++t) {
    const size_t p = rows.parameter[entry * rows.tables + t];
    const double* const own = sums + rows.own + entry * rows.own_size() + rows.lane[t];
    result->gradient[p] = own[AccumulatorRows::kGradient * rows.lanes];
    double* const target = &result->H[p * n];
    for (size_t i = 0; i < amplitudes.parameter.size(); ++i) {
      target[amplitudes.parameter[i]] = own[(AccumulatorRows::kFirstAmplitude + i) * rows.lanes];
    }
    if (rows.kind != ParameterKind::kAmplitudes) continue;
    for (int u = 0; u < rows.tables; ++u) {
      const size_t line = AccumulatorRows::kFirstAmplitude + entry * rows.tables + t;
      target[rows.parameter[entry * rows.tables + u]] +=
          sums[rows.own + entry * rows.own_size() + line * rows.lanes + rows.lane[u]];
    }
  }
}

// Gathers products of all pairs of entries, for these of the rows.
void ScatteredEquations::GatherBlocks(const AccumulatorRows& rows, int first_entry, int last_entry,
                                      QuadraticModel* result) const {
  const auto n = static_cast<size_t>(num_parameters_);
  for (size_t k = 1; k < rows.blocks.size(); ++k) {
    const AccumulatorRows& others = layout_.rows[k];
    const bool own = &others == &rows;
    if (own && rows.by_cell) continue;
    const double* const blocks = accumulators_[0].data() + rows.blocks[k];
    const int block = others.tables * rows.lanes;
    const auto at = [&](int e_of, int e) {
      return blocks + (static_cast<size_t>(e_of) * rows.entries + e) * block;
    };
    for (int e = 0; e < others.entries; ++e) {
      const int* const columns =
          others.parameter.data() + static_cast<ptrdiff_t>(e) * others.tables;
      for (int entry = first_entry; entry < last_entry; ++entry) {
        const double* const from = at(e, entry);
        const double* const mirrored = own ? at(entry, e) : nullptr;
        for (int t = 0; t < rows.tables; ++t) {
          const int lane = rows.lane[t];
          const auto p = static_cast<size_t>(rows.parameter[entry * rows.tables + t]);
          for (int u = 0; u < others.tables; ++u) {
            double value = from[u * rows.lanes + lane];
            if (own) value += mirrored[t * rows.lanes + rows.lane[u]];
            const auto q = static_cast<size_t>(columns[u]);
            // Tables of D that are read by different stretches are in any order. Within G the
            // other triangle has the same.
            if (own || q < p) {
              result->H[p * n + q] = value;
            } else {
              result->H[q * n + p] = value;
            }
          }
        }
      }
    }
  }
}

// Gathers products within a kind, cell by cell.
void ScatteredEquations::GatherCells(const AccumulatorRows& rows, QuadraticModel* result) const {
  const auto n = static_cast<size_t>(num_parameters_);
  const double* const blocks = accumulators_[0].data() + rows.blocks.back();
  const int block = rows.tables * rows.lanes;
  const std::vector<Cell>& cells = reader_.samples().cells_of(FactorOf(rows.kind));
  for (size_t number = 0; number < cells.size(); ++number) {
    const Cell& cell = cells[number];
    const auto at = [&](int k, int l) {
      return blocks + rows.InCell(static_cast<int>(number), k) + static_cast<ptrdiff_t>(l) * block;
    };
    for (int k = 0; k < cell.size; ++k) {
      for (int l = 0; l < cell.size; ++l) {
        for (int t = 0; t < rows.tables; ++t) {
          const size_t p = rows.parameter[cell.entry[k] * rows.tables + t];
          for (int u = 0; u < rows.tables; ++u) {
            const size_t q = rows.parameter[cell.entry[l] * rows.tables + u];
            if (q > p) continue;  // the other triangle
            result->H[p * n + q] +=
                at(l, k)[u * rows.lanes + rows.lane[t]] + at(k, l)[t * rows.lanes + rows.lane[u]];
          }
        }
      }
    }
  }
}

void ScatteredEquations::GatherSquaredLengths(const AccumulatorRows& rows, Hessian hessian,
                                              QuadraticModel* result) const {
  const double* const own = accumulators_[0].data() + rows.own;
  for (int entry = 0; entry < rows.entries; ++entry) {
    for (int t = 0; t < rows.tables; ++t) {
      const size_t p = rows.parameter[entry * rows.tables + t];
      result->squared_lengths[p] =
          hessian == Hessian::kNewton
              ? own[entry * rows.own_size() + AccumulatorRows::kSquaredLength * rows.lanes +
                    rows.lane[t]]
              : result->H[p * (static_cast<size_t>(num_parameters_) + 1)];
    }
  }
}

}  // namespace trilobe
