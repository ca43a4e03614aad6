#include "fit/prune/tableau.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/algebra/cholesky.h"
#include "core/base/multiversion.h"

namespace trilobe {
namespace {

// to += sum_p factor[p] rows[p], for `count` rows, a multiple of 4, one after the other in memory.
TRILOBE_MULTIVERSION void AddRows(int size, size_t stride, int count, const double* factor,
                                  const double* rows, double* target) {
  for (int p = 0; p < count; p += 4) {
    const double *const a = rows + p * stride, *const b = a + stride, *const c = b + stride,
                        *const d = c + stride;
    const double f = factor[p], g = factor[p + 1], h = factor[p + 2], i = factor[p + 3];
#pragma omp simd
    for (int k = 0; k < size; ++k) target[k] += f * a[k] + g * b[k] + h * c[k] + i * d[k];
  }
}

}  // namespace

Tableau::Tableau(std::vector<double> A, std::vector<double> z)
    : stride_(z.size()),
      size_(static_cast<int>(z.size())),
      T_(std::move(A)),
      U_(stride_ * kMaxWaiting),
      V_(stride_ * kMaxWaiting),
      h_(std::move(z)),
      free_(stride_, true) {
  valid_ = FactorCholesky(size_, T_.data());
  if (valid_) InvertFactored(size_, T_.data());
}

double Tableau::Pivot(int k) {
  const double pivot = At(k, k), scale = 1 / std::abs(pivot), h_k = h_[k];
  std::vector<double>& t = t_;
  t.resize(size_);
  for (int i = 0; i < size_; ++i) t[i] = At(k, i);
  t[k] = 0;
  AddOuterProduct(-1 / pivot);
  for (int i = 0; i < size_; ++i) {
    h_[i] -= t[i] * h_k / pivot;
    T_[i * stride_ + k] = T_[k * stride_ + i] = t[i] * scale;
  }
  T_[k * stride_ + k] = -1 / pivot;
  // What waits has nothing to add there.
  std::fill_n(U_.begin() + k * kMaxWaiting, kMaxWaiting, 0.0);
  std::fill_n(V_.begin() + k * kMaxWaiting, kMaxWaiting, 0.0);
  h_[k] = h_k * scale;
  free_[k] = !free_[k];
  return h_k * h_k / pivot;
}

double Tableau::Rise(const Constraint& c) const {
  double value = 0, variance = 0;
  for (const Term& a : c) {
    if (!free_[a.row]) continue;
    value += a.factor * h_[a.row];
    for (const Term& b : c) {
      if (free_[b.row]) variance += a.factor * b.factor * At(a.row, b.row);
    }
  }
  const int first = c.begin()->row;
  double release = 0;
  if (!free_[first]) {
    // Where it would go below 0 the others of the constraint have to be 0 with it.
    const double sigma = -At(first, first);
    double follow = c.begin()->factor;
    for (const Term& a : c) {
      if (free_[a.row]) follow += a.factor * At(first, a.row);
    }
    value += follow * h_[first] / sigma;
    variance += follow * follow / sigma;
    release = h_[first] * h_[first] / sigma;
    if (!(variance > 0)) return 0;
    const double held = follow / sigma * (1 / c.begin()->factor);
    const double z = h_[first] / sigma - held * value / variance;
    if (z * c.begin()->factor < 0) {
      double rise = 0;
      for (const Term& a : c) {
        if (free_[a.row] && h_[a.row] > 0) rise += h_[a.row] * h_[a.row] / At(a.row, a.row);
      }
      return rise;
    }
  }
  return variance > 0 ? value * value / variance - release : 0;
}

void Tableau::Impose(const Constraint& c) {
  t_.assign(size_, 0.0);
  double value = 0, variance = 0;
  for (const Term& a : c) {
    if (!free_[a.row]) continue;
    value += a.factor * h_[a.row];
    for (int i = 0; i < size_; ++i) t_[i] += a.factor * At(a.row, i);
  }
  for (const Term& a : c) {
    if (free_[a.row]) {
      variance += a.factor * t_[a.row];
    } else {
      t_[a.row] += a.factor;
    }
  }
  if (!(variance > 0)) return;
  AddOuterProduct(-1 / variance);
  for (int i = 0; i < size_; ++i) h_[i] -= t_[i] * value / variance;
}

void Tableau::Remove(int k) {
  const int last = --size_;
  for (int i = 0; i <= last; ++i) T_[k * stride_ + i] = T_[last * stride_ + i];
  for (int i = 0; i < last; ++i) T_[i * stride_ + k] = T_[i * stride_ + last];
  T_[k * stride_ + k] = T_[last * stride_ + last];
  for (std::vector<double>* const rows : {&U_, &V_}) {
    std::copy_n(rows->begin() + last * kMaxWaiting, kMaxWaiting, rows->begin() + k * kMaxWaiting);
  }
  h_[k] = h_[last];
  free_[k] = free_[last];
}

void Tableau::AddOuterProduct(double factor) {
  for (int i = 0; i < size_; ++i) {
    U_[i * kMaxWaiting + waiting_] = t_[i];
    V_[i * kMaxWaiting + waiting_] = factor * t_[i];
  }
  if (++waiting_ < kMaxWaiting) return;
  std::vector<double> rows(kMaxWaiting * stride_);  // V'
  for (int i = 0; i < size_; ++i) {
    for (int p = 0; p < kMaxWaiting; ++p) rows[p * stride_ + i] = V_[i * kMaxWaiting + p];
  }
  for (int i = 0; i < size_; ++i) {
    AddRows(size_, stride_, kMaxWaiting, U_.data() + i * kMaxWaiting, rows.data(),
            T_.data() + i * stride_);
  }
  waiting_ = 0;
}

}  // namespace trilobe
