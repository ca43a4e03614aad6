#include "trilobe/model/objective/sample_residual.h"

#include <ceres/dynamic_autodiff_cost_function.h>
#include <ceres/dynamic_numeric_diff_cost_function.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <new>
#include <set>
#include <string>
#include <vector>

#include "tests/test_util.h"

// Counts what this thread allocates in this program. The sanitizers have operators of their own.
static thread_local int allocations = 0;
#if !defined(TRILOBE_SANITIZED)
[[gnu::noinline]] void* operator new(size_t size) {
  ++allocations;
  if (void* const memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, size_t /*size*/) noexcept {
  std::free(memory);
}
#endif

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 5, .theta_d = 6, .phi_d = 8};
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

// Log-normal numbers, a tenth of them 0.
FactorModel ModelWithZeros(const ModelSpec& spec) {
  FactorModel model = RandomModel(spec, 3);
  Random random(4);
  for (double& x : model.parameters()) {
    if (random.Uniform() < 0.1) x = 0;
  }
  return model;
}

// Samples at bins, which read 1 entry of D and F and up to 4 + 4 of G; and the same between bins,
// which read 2, 2 and up to 4 + 4.
std::vector<BrdfSamples> OnGridAndBetween() {
  BrdfSamples on_grid = ValidSamples(RandomTable(kGrid, 1));
  BrdfSamples between = Scattered(on_grid);
  Random random(2);
  for (HalfDiffAngles& angles : between.angles) {
    angles.theta_h *= random.Uniform(0.8, 1);
    angles.theta_d *= random.Uniform(0.8, 1);
  }
  return {on_grid, between};
}

SampleStencils Magnitudes(SampleStencils at) {
  const auto make_positive = [](Stencil* stencil) {
    for (double& weight : stencil->weight) weight = std::abs(weight);
  };
  for (Stencil* const stencil : {&at.D, &at.F, &at.G_i, &at.G_o}) make_positive(stencil);
  for (Stencil& D : at.more_D) make_positive(&D);
  return at;
}

// A sample's functor and the blocks of a model that it reads.
struct Reading {
  Reading(const WeightedSample& sample, ParameterBlocks* layout)
      : residual(*layout, sample, &numbers) {
    for (const int b : numbers) blocks.push_back(layout->block(b).data());
  }
  std::vector<int> numbers;
  std::vector<double*> blocks;
  SampleResidual residual;
};

TEST(SampleResidual, IsTheWeightedErrorOfTheModel) {
  for (const auto& [name, spec] : TestSpecs(kGrid)) {
    ParameterBlocks layout(spec);
    const FactorModel model = ModelWithZeros(spec);
    layout.Read(model);
    for (const BrdfSamples& samples : OnGridAndBetween()) {
      const Objective objective(samples, spec, FindWeighting("compressive"));
      long double E = 0;
      for (const WeightedSample& sample : objective.weighted_samples()) {
        const Reading reading(sample, &layout);
        double residuals[kChannels];
        ASSERT_TRUE(reading.residual(reading.blocks.data(), residuals));
        for (int c = 0; c < kChannels; ++c) {
          const double rho = UnclampedValue(model, sample.stencils, c);
          const double weight = std::sqrt(sample.weight[c]);
          // At most 20 roundings a lobe, of terms that do not cancel.
          const double terms =
              sample.rho[c] + UnclampedValue(model, Magnitudes(sample.stencils), c);
          EXPECT_NEAR(residuals[c], weight * (rho - sample.rho[c]),
                      20 * kEpsilon * (1 + spec.lobes) * weight * terms)
              << name;
          E += static_cast<long double>(residuals[c]) * residuals[c];
        }
      }
      const double expected = objective.Value(model);
      EXPECT_NEAR(static_cast<double>(E), expected, 1e-12 * expected) << name;
    }
  }
}

TEST(SampleResidual, ReadsEachBlockOnce) {
  const ModelSpec spec = ModelSpec::SharedFactors(3, kGrid);
  ParameterBlocks layout(spec);
  std::vector<std::set<size_t>> sizes;
  for (const BrdfSamples& samples : OnGridAndBetween()) {
    const Objective objective(samples, spec, FindWeighting("uniform"));
    std::set<size_t>& own = sizes.emplace_back();
    for (const WeightedSample& sample : objective.weighted_samples()) {
      const Reading reading(sample, &layout);
      EXPECT_EQ(std::set<int>(reading.numbers.begin(), reading.numbers.end()).size(),
                reading.numbers.size());
      own.insert(reading.numbers.size());
    }
  }
  // d, s, a row of D and of F, and of the 6 rows of G those within 2 nodes of either direction.
  EXPECT_EQ(*sizes[0].begin(), 2 + 1 + 1 + 3U);
  EXPECT_EQ(*sizes[0].rbegin(), 2 + 1 + 1 + 6U);
  EXPECT_EQ(*sizes[1].rbegin(), 2 + 2 + 2 + 6U);

  const ModelSpec diffuse = ModelSpec::SharedFactors(0, kGrid);
  ParameterBlocks diffuse_layout(diffuse);
  const Objective objective(OnGridAndBetween().front(), diffuse, FindWeighting("uniform"));
  const Reading reading(objective.Sample(0), &diffuse_layout);
  EXPECT_EQ(reading.numbers, std::vector<int>{ParameterBlocks::kD});
}

// A row-major Jacobian a block, one after the other.
struct Derivatives {
  std::vector<double> residuals;
  std::vector<double> jacobian;
};

template <typename CostFunction>
Derivatives Differentiate(const ParameterBlocks& layout, Reading* reading) {
  CostFunction cost(&reading->residual, ceres::DO_NOT_TAKE_OWNERSHIP);
  cost.SetNumResiduals(SampleResidual::kNumResiduals);
  std::vector<size_t> offsets;
  size_t size = 0;
  for (const int b : reading->numbers) {
    cost.AddParameterBlock(static_cast<int>(layout.block(b).size()));
    offsets.push_back(size);
    size += SampleResidual::kNumResiduals * layout.block(b).size();
  }
  Derivatives derivatives{std::vector<double>(SampleResidual::kNumResiduals),
                          std::vector<double>(size)};
  std::vector<double*> jacobians;
  for (const size_t offset : offsets) jacobians.push_back(derivatives.jacobian.data() + offset);
  EXPECT_TRUE(
      cost.Evaluate(reading->blocks.data(), derivatives.residuals.data(), jacobians.data()));
  return derivatives;
}

double Largest(const std::vector<double>& values) {
  double largest = 0;
  for (const double x : values) largest = std::max(largest, std::abs(x));
  return largest;
}

// Automatic derivatives against numeric ones by Ridders' extrapolation, as ceres::GradientChecker
// compares them; it hands out Eigen matrices of the Ceres library, which Eigen cannot free in a
// program under AddressSanitizer.
TEST(SampleResidual, DerivativesAreThoseOfItsValues) {
  using Automatic = ceres::DynamicAutoDiffCostFunction<SampleResidual, 8>;
  using Numeric = ceres::DynamicNumericDiffCostFunction<SampleResidual, ceres::RIDDERS>;
  for (const auto& [name, spec] : TestSpecs(kGrid)) {
    ParameterBlocks layout(spec);
    layout.Read(ModelWithZeros(spec));
    for (const BrdfSamples& samples : OnGridAndBetween()) {
      const Objective objective(samples, spec, FindWeighting("compressive"));
      for (int j = 0; j < objective.samples().size(); j += kSanitized ? 37 : 5) {
        Reading reading(objective.Sample(j), &layout);
        const Derivatives automatic = Differentiate<Automatic>(layout, &reading);
        const Derivatives numeric = Differentiate<Numeric>(layout, &reading);
        // The model is a polynomial of degree 2 in each number. So the first difference, over 1e-2
        // or more, is exact but for the rounding errors of the values, at most 20 a lobe.
        const double tolerance =
            20 * kEpsilon * (1 + spec.lobes) / 1e-2 *
            std::max(Largest(automatic.residuals), Largest(automatic.jacobian));
        for (size_t k = 0; k < automatic.jacobian.size(); ++k) {
          EXPECT_NEAR(automatic.jacobian[k], numeric.jacobian[k], tolerance)
              << name << ", sample " << j << ", derivative " << k;
        }
      }
    }
  }
}

// Evaluates with numbers, and with the Jets of ceres::DynamicAutoDiffCostFunction.
TEST(SampleResidual, AllocatesNothingInAnEvaluation) {
  using Jet = ceres::Jet<double, 8>;
  for (const auto& [name, spec] : TestSpecs(kGrid)) {
    ParameterBlocks layout(spec);
    layout.Read(ModelWithZeros(spec));
    for (const BrdfSamples& samples : OnGridAndBetween()) {
      const Reading reading(Objective(samples, spec, FindWeighting("uniform")).Sample(3), &layout);
      std::vector<std::vector<Jet>> jets;
      std::vector<const Jet*> blocks;
      for (const int b : reading.numbers) {
        const auto block = layout.block(b);
        blocks.push_back(jets.emplace_back(block.begin(), block.end()).data());
      }
      std::array<double, kChannels> residuals;
      std::array<Jet, kChannels> jet_residuals;
      const int before = allocations;
      ASSERT_TRUE(reading.residual(reading.blocks.data(), residuals.data()));
      ASSERT_TRUE(reading.residual(blocks.data(), jet_residuals.data()));
      EXPECT_EQ(allocations, before) << name;
      for (int c = 0; c < kChannels; ++c) EXPECT_EQ(jet_residuals[c].a, residuals[c]) << name;
    }
  }
  EXPECT_EQ(allocations > 0, !kSanitized);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
