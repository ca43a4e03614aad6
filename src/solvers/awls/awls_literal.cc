#include <numeric>
#include <optional>
#include <vector>

#include "core/algebra/element_step.h"
#include "trilobe/model/value_of.h"
#include "trilobe/solvers/run.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {
namespace {

// Change of a sample's value in one channel with an element: rho(x + delta) = rho + p1 delta + p2
// delta^2.
struct Response {
  double p1 = 0, p2 = 0;
};

// The response to entry k of table t of a factor: the sum over the lobes that the table serves.
Response TableResponse(const FactorModel& model, const SampleStencils& at, Factor factor, int t,
                       int k, int c) {
  const ModelReads reads{model, at};
  Response response;
  for (int m = 0; m < model.spec().lobes; ++m) {
    if (!model.spec().serves(factor, t, m, c)) continue;
    const double s = reads.s(m, c), D = reads.D(m, c), F = reads.F(m, c);
    const Shadowing G = reads.G(m, c);
    if (factor == Factor::kD) {
      const double weight = at.DOf(model.spec().stretches.index(m)).WeightOf(k);
      response.p1 += LobeValue(weight * s, 1.0, F, G);
    } else if (factor == Factor::kF) {
      response.p1 += LobeValue(at.F.WeightOf(k) * s, D, 1.0, G);
    } else {
      // (a_i + c_i delta)(a_o + c_o delta), the paper's third situation; c_i or c_o may be 0.
      const double c_i = at.G_i.WeightOf(k), c_o = at.G_o.WeightOf(k);
      const double y = LobeValue(s, D, F, G.inverse_cosines);
      response.p1 += y * (c_i * G.o + c_o * G.i);
      response.p2 += y * c_i * c_o;
    }
  }
  return response;
}

Response SpecularWeightResponse(const FactorModel& model, const SampleStencils& at, int m, int c) {
  const ModelReads reads{model, at};
  return {LobeValue(1.0, reads.D(m, c), reads.F(m, c), reads.G(m, c)), 0};
}

// For each entry of a factor's tables, the samples that read it.
using SampleLists = std::vector<std::vector<int>>;

SampleLists SamplesByEntry(const std::vector<WeightedSample>& samples, const ModelSpec& spec,
                           Factor factor) {
  SampleLists lists(spec.table_size(factor));
  for (int j = 0; j < static_cast<int>(samples.size()); ++j) {
    const auto add = [&lists, j](const Stencil& stencil) {
      for (int k = 0; k < stencil.size; ++k) {
        std::vector<int>& list = lists[stencil.index[k]];
        if (list.empty() || list.back() != j) list.push_back(j);
      }
    };
    const SampleStencils& at = samples[j].stencils;
    if (factor == Factor::kD) {
      add(at.D);
      for (const Stencil& D : at.more_D) add(D);
    }
    if (factor == Factor::kF) add(at.F);
    if (factor == Factor::kG) {
      add(at.G_i);
      add(at.G_o);
    }
  }
  return lists;
}

class ReferenceSweep {
 public:
  ReferenceSweep(const Objective& objective, const SolverOptions& options)
      : objective_(objective), options_(options), samples_(objective.weighted_samples()) {
    for (const Factor factor : kFactors) {
      by_entry_.push_back(SamplesByEntry(samples_, objective.spec(), factor));
    }
    all_.resize(samples_.size());
    std::iota(all_.begin(), all_.end(), 0);
  }

  // d, s, D, F, then G, one element at a time (docs/sums.md).
  void operator()(FactorModel* model) const {
    const ModelSpec& spec = objective_.spec();
    for (int c = 0; c < kChannels; ++c) {
      Update(
          all_, {c, c + 1},
          [](const SampleStencils&, int) {
            return Response{1, 0};
          },
          &model->d()[c], *model);
    }
    for (int m = 0; m < spec.lobes; ++m) {
      for (int c = 0; c < kChannels; ++c) {
        Update(
            all_, {c, c + 1},
            [&](const SampleStencils& at, int) { return SpecularWeightResponse(*model, at, m, c); },
            &model->s(m)[c], *model);
      }
    }
    for (const Factor factor : kFactors) {
      for (int t = 0; t < spec.num_tables(factor); ++t) {
        const ModelSpec::ChannelRange channels = spec.channels(factor, t);
        for (int k = 0; k < spec.table_size(factor); ++k) {
          Update(
              by_entry_[static_cast<int>(factor)][k], channels,
              [&](const SampleStencils& at, int c) {
                return TableResponse(*model, at, factor, t, k, c);
              },
              &model->table(factor, t)[k], *model);
        }
      }
    }
  }

 private:
  // Puts *element, a number of `model`, where E is lowest.
  template <typename ResponseOf>
  void Update(const std::vector<int>& samples, ModelSpec::ChannelRange channels,
              const ResponseOf& response_of, double* element, const FactorModel& model) const {
    ElementQuartic change;
    for (const int j : samples) {
      const WeightedSample& sample = samples_[j];
      for (int c = channels.begin; c < channels.end; ++c) {
        const double residual = sample.rho[c] - UnclampedValue(model, sample.stencils, c);
        const Response response = response_of(sample.stencils, c);
        change.AddSample(sample.weight[c], residual, response.p1, response.p2);
      }
    }
    *element = BestElement(*element, change);
    if (options_.on_element) options_.on_element(model);
  }

  const Objective& objective_;
  const SolverOptions& options_;
  const std::vector<WeightedSample>& samples_;
  std::vector<SampleLists> by_entry_;  // [factor][entry]
  std::vector<int> all_;
};

// The same element updates as Awls, each from the samples that the element touches (paper 2.3): the
// reference that Awls is tested and timed against.
class AwlsLiteral : public Solver {
 private:
  SolverSummary DoSolve(const Objective& objective, const SolverOptions& options,
                        FactorModel* model) const override {
    Run run("awls_literal", objective, options, model);
    std::optional<ReferenceSweep> sweep;
    {
      const ScopedTimer timer = run.Time(&PhaseSeconds::preparing);
      sweep.emplace(objective, options);
    }
    const auto timed_sweep = [&](FactorModel* current) {
      const ScopedTimer timer = run.Time(&PhaseSeconds::evaluating);
      (*sweep)(current);
    };
    RepeatSweeps(timed_sweep, objective, *model, &run);
    return run.Finish();
  }
};

}  // namespace

SolverEntry AwlsLiteralEntry() {
  return {.name = "awls_literal",
          .description = "awls from every sample, element by element: slow, the reference for awls",
          .reference = "Peng, Zheng, Lv, section 2.3",
          .options = {"g_filter_sigma"},
          .make = [] { return std::make_unique<AwlsLiteral>(); }};
}

}  // namespace trilobe
