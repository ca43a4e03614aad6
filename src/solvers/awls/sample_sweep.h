#ifndef TRILOBE_SOLVERS_AWLS_SAMPLE_SWEEP_H_
#define TRILOBE_SOLVERS_AWLS_SAMPLE_SWEEP_H_

#include <array>
#include <span>
#include <vector>

#include "trilobe/brdf/channels.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/objective/objective.h"
#include "trilobe/solvers/awls/sweep.h"
#include "trilobe/solvers/run.h"

namespace trilobe {

// Sweeps from the samples themselves, whatever tables they read and where: the same element updates
// in the same order as the literal one. It keeps each sample's residuals and its readings of all
// tables up to date, and of each entry a list of the samples that read it, so that an update costs
// a few operations a sample that reads the entry.
class SampleSweep : public Sweep {
 public:
  SampleSweep(const Objective& objective, PhaseSeconds* phases);

  void operator()(const OnElement& on_element, FactorModel* model) override;

 private:
  // Who reads the entries of a factor's tables, entry by entry.
  struct Readers {
    std::vector<int> begin;                // [table_size + 1]
    std::vector<int> sample;               // [begin.back()]
    std::vector<double> weight, weight_o;  // the same; of G theta_i's and theta_o's, else one
  };
  // What of a model a sample reads, table by table. [num_tables][samples]
  using Readings = std::vector<std::vector<double>>;
  // Those of the tables that serve a lobe and channel. [samples]
  struct LobeReadings {
    const double *D = nullptr, *F = nullptr, *G_i = nullptr, *G_o = nullptr;
  };

  void UpdateBlocks(double E, int rounds, const OnElement& on_block, FactorModel* model) override;
  void UpdateG(const OnElement& on_element, FactorModel* model) override;

  static Readers ReadersOf(const std::vector<WeightedSample>& samples, const ModelSpec& spec,
                           Factor factor);
  const Readers& readers(Factor factor) const { return readers_[static_cast<int>(factor)]; }

  // Sets readings and residuals to those of the model.
  void Evaluate(const FactorModel& model);

  // What a lobe reads in a channel at sample j, without the factors that are left out.
  double K(int m, int c, int j) const {  // G G / (cos cos)
    const LobeReadings& lobe = lobes_[c][m];
    return lobe.G_i[j] * lobe.G_o[j] * inverse_cosines_[j];
  }
  double D(int m, int c, int j) const { return lobes_[c][m].D[j]; }
  double F(int m, int c, int j) const { return lobes_[c][m].F[j]; }

  // Puts elements in which rho of a channel is linear, one a lobe or table, where E is lowest:
  // respond(j, c, v) sets by how much each moves rho. `samples` are those that any of them moves,
  // `weights` what respond's numbers are multiplied by.
  template <typename Respond>
  void Update(std::span<const int> samples, std::span<const double> weights,
              ModelSpec::ChannelRange channels, const Respond& respond,
              std::span<double* const> elements, double E, double* steps);

  // An entry of a table of D or F, or of the tables of several lobes.
  void UpdateEntries(Factor factor, std::span<const int> tables, int entry, double E,
                     FactorModel* model);
  void UpdateNode(int table, int entry, FactorModel* model);
  // d and s of a channel, from `first` of these 1 + lobes numbers on so many.
  void UpdateAmplitudes(int channel, int first, int count, double E, FactorModel* model);

  const ModelSpec spec_;
  const int num_samples_;
  PhaseSeconds* const phases_;
  const std::vector<WeightedSample>& samples_;
  std::array<Readers, 3> readers_;
  std::vector<int> all_;
  std::vector<double> ones_;
  std::array<std::vector<double>, kChannels> weight_, residual_;  // rho* - rho
  std::vector<double> inverse_cosines_;
  Readings D_, F_, G_i_, G_o_;
  std::array<std::array<LobeReadings, kMaxLobes>, kChannels> lobes_;
};

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_AWLS_SAMPLE_SWEEP_H_
