#include "trilobe/sums/sample_equations.h"

#include <algorithm>
#include <array>
#include <span>

#include "trilobe/base/parallel.h"

namespace trilobe {
namespace {

// A number that a sample reads, or what it moves rho by.
struct Term {
  int parameter;
  double value;
};

// At most d, and a lobe's s, D, F and both readings of G, of all lobes.
constexpr int kMaxTerms = 1 + kMaxLobes * (1 + 4 * Stencil::kMaxSize);

// Those of one sample and channel, each parameter once.
class Terms {
 public:
  void Add(int parameter, double value) { terms_[size_++] = {parameter, value}; }
  // The same for a parameter that may be among those from `first` on.
  void AddAmong(int first, int parameter, double value) {
    for (int k = first; k < size_; ++k) {
      if (terms_[k].parameter != parameter) continue;
      terms_[k].value += value;
      return;
    }
    Add(parameter, value);
  }
  // The entries of a table that begins at `offset`, times `scale`.
  void AddStencil(int first, int offset, const Stencil& stencil, double scale) {
    for (int k = 0; k < stencil.size; ++k) {
      AddAmong(first, offset + stencil.index[k], stencil.weight[k] * scale);
    }
  }
  int size() const { return size_; }
  std::span<const Term> terms() const { return {terms_.data(), static_cast<size_t>(size_)}; }

 private:
  std::array<Term, kMaxTerms> terms_;
  int size_ = 0;
};

// What one lobe reads in one channel.
struct LobeReadings {
  double s = 0, D = 0, F = 0, G_i = 0, G_o = 0;
  int D_offset = 0, F_offset = 0, G_offset = 0;

  LobeReadings() = default;
  LobeReadings(const FactorModel& model, const SampleStencils& at, int m, int c)
      : s(model.s(m)[c]),
        D(at.D(model.D(m, c))),
        F(at.F(model.F(m, c))),
        G_i(at.G_i(model.G(m, c))),
        G_o(at.G_o(model.G(m, c))),
        D_offset(model.TableOffset(Factor::kD, model.spec().table(Factor::kD, m, c))),
        F_offset(model.TableOffset(Factor::kF, model.spec().table(Factor::kF, m, c))),
        G_offset(model.TableOffset(Factor::kG, model.spec().table(Factor::kG, m, c))) {}
};

}  // namespace

// Sums of some of the samples. Each product of two parameters goes to one of their two places in H,
// whichever comes first.
struct SampleEquations::Share {
  double objective = 0;
  std::vector<double> gradient, H, squared_lengths;

  void Reset(size_t n) {
    objective = 0;
    gradient.assign(n, 0.0);
    squared_lengths.assign(n, 0.0);
    H.assign(n * n, 0.0);
  }

  void Add(const Terms& derivatives, double w, double residual) {
    const size_t n = gradient.size();
    const std::span<const Term> terms = derivatives.terms();
    for (size_t k = 0; k < terms.size(); ++k) {
      const double w_k = w * terms[k].value;
      gradient[terms[k].parameter] += w_k * residual;
      squared_lengths[terms[k].parameter] += w_k * terms[k].value;
      double* const row = &H[terms[k].parameter * n];
      for (size_t l = k; l < terms.size(); ++l) row[terms[l].parameter] += w_k * terms[l].value;
    }
  }

  void AddOuter(double scale, std::span<const Term> rows, std::span<const Term> columns) {
    const size_t n = gradient.size();
    for (const Term& a : rows) {
      double* const row = &H[a.parameter * n];
      for (const Term& b : columns) row[b.parameter] += scale * a.value * b.value;
    }
  }

  // rho is linear in each of s, D, F and in the two readings of G, so only products of two
  // different ones have a second derivative.
  void AddSecondDerivatives(const LobeReadings& lobe, const SampleStencils& at, int s_parameter,
                            double scale) {
    Terms D, F, G;  // G: d (G_i G_o)
    const Term s{s_parameter, 1};
    D.AddStencil(0, lobe.D_offset, at.D, 1);
    F.AddStencil(0, lobe.F_offset, at.F, 1);
    G.AddStencil(0, lobe.G_offset, at.G_i, lobe.G_o);
    G.AddStencil(0, lobe.G_offset, at.G_o, lobe.G_i);
    const double scaled = scale * at.inverse_cosines, K = lobe.G_i * lobe.G_o;
    AddOuter(scaled * lobe.F * K, {&s, 1}, D.terms());
    AddOuter(scaled * lobe.D * K, {&s, 1}, F.terms());
    AddOuter(scaled * lobe.D * lobe.F, {&s, 1}, G.terms());
    AddOuter(scaled * lobe.s * K, D.terms(), F.terms());
    AddOuter(scaled * lobe.s * lobe.F, D.terms(), G.terms());
    AddOuter(scaled * lobe.s * lobe.D, F.terms(), G.terms());
    // Of an entry with itself twice the product, of two entries that of both readings, which here
    // are added to one place or the other.
    const double of_G = scaled * lobe.s * lobe.D * lobe.F;
    const size_t n = gradient.size();
    for (int k = 0; k < at.G_i.size; ++k) {
      const size_t a = lobe.G_offset + at.G_i.index[k];
      for (int l = 0; l < at.G_o.size; ++l) {
        const size_t b = lobe.G_offset + at.G_o.index[l];
        const double product = of_G * at.G_i.weight[k] * at.G_o.weight[l];
        H[a * n + b] += a == b ? 2 * product : product;
      }
    }
  }

  void AddChannel(const FactorModel& model, const WeightedSample& sample, int c, Hessian hessian) {
    const ModelSpec& spec = model.spec();
    const SampleStencils& at = sample.stencils;
    std::array<LobeReadings, kMaxLobes> lobes;
    double rho = model.d()[c];
    Terms derivatives;
    derivatives.Add(c, 1);
    for (int m = 0; m < spec.lobes; ++m) {
      const LobeReadings& lobe = lobes[m] = LobeReadings(model, at, m, c);
      const double K = lobe.G_i * lobe.G_o * at.inverse_cosines;
      rho += lobe.s * lobe.D * lobe.F * K;
      derivatives.Add(kChannels * (1 + m) + c, lobe.D * lobe.F * K);
    }
    int first[3] = {};  // term of a factor's table; one that several lobes share comes once
    for (int m = 0; m < spec.lobes; ++m) {
      const LobeReadings& lobe = lobes[m];
      const double K = lobe.G_i * lobe.G_o * at.inverse_cosines;
      const double y = lobe.s * lobe.D * lobe.F * at.inverse_cosines;
      const auto first_of = [&](Factor factor) {
        int& term = first[static_cast<int>(factor)];
        if (m == 0 || spec.sharing(factor).per_lobe) term = derivatives.size();
        return term;
      };
      derivatives.AddStencil(first_of(Factor::kD), lobe.D_offset, at.D, lobe.s * lobe.F * K);
      derivatives.AddStencil(first_of(Factor::kF), lobe.F_offset, at.F, lobe.s * lobe.D * K);
      const int first_of_G = first_of(Factor::kG);
      derivatives.AddStencil(first_of_G, lobe.G_offset, at.G_i, y * lobe.G_o);
      derivatives.AddStencil(first_of_G, lobe.G_offset, at.G_o, y * lobe.G_i);
    }
    const double w = sample.weight[c], residual = rho - sample.rho[c];
    objective += w * residual * residual;
    Add(derivatives, w, residual);
    if (hessian == Hessian::kGaussNewton) return;
    for (int m = 0; m < spec.lobes; ++m) {
      AddSecondDerivatives(lobes[m], at, kChannels * (1 + m) + c, w * residual);
    }
  }
};

SampleEquations::SampleEquations(const Objective& objective) : objective_(objective) {
  for (int k = 0; k < NumShares(objective.samples().size()); ++k) {
    shares_.push_back(std::make_unique<Share>());
  }
}

SampleEquations::~SampleEquations() = default;

void SampleEquations::Evaluate(const FactorModel& model, Hessian hessian, QuadraticModel* result) {
  const std::vector<WeightedSample>& samples = objective_.weighted_samples();
  const size_t n = model.spec().num_parameters(), count = shares_.size();
  ParallelFor(static_cast<int>(count), objective_.num_threads(), [&](int k) {
    Share& share = *shares_[k];
    share.Reset(n);
    const size_t end = samples.size() * (k + 1) / count;
    for (size_t j = samples.size() * k / count; j < end; ++j) {
      for (int c = 0; c < kChannels; ++c) share.AddChannel(model, samples[j], c, hessian);
    }
  });
  for (const auto& share : shares_) {
    result->objective += share->objective;
    for (size_t k = 0; k < n; ++k) {
      result->gradient[k] += share->gradient[k];
      result->squared_lengths[k] += share->squared_lengths[k];
    }
  }
  // Both places of a product, of all shares, in their order.
  ParallelFor(static_cast<int>(n), objective_.num_threads(), [&](int row) {
    const size_t k = row;
    for (size_t l = k; l < n; ++l) {
      double sum = 0;
      for (const auto& share : shares_) {
        sum += share->H[k * n + l];
        if (l > k) sum += share->H[l * n + k];
      }
      result->H[k * n + l] = result->H[l * n + k] = sum;
    }
  });
}

}  // namespace trilobe
