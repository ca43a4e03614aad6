// Singular values and weakest directions of J at a fitted model. See README.md beside this file.

#include <gflags/gflags.h>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "experiments/program.h"
#include "trilobe/core/base/error.h"
#include "trilobe/io/formats/model_file.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/solvers/sums/normal_equations.h"

DEFINE_string(weighting, "compressive", "weights of the objective");
DEFINE_bool(extrapolated, false, "of an RGL file, also take what was extrapolated");
DEFINE_double(max_angle, 90, "leave out bins whose theta_i or theta_o is beyond this, in degrees");
DEFINE_int32(weakest, 5, "how many of the weakest directions to describe");
DEFINE_int32(threads, 2, "threads to use");

namespace trilobe {
namespace {

using Json = nlohmann::ordered_json;

// Directions in which scale moves between a table and s, in parameters scaled to columns of J of
// length 1: J is 0 along each. In relative changes: 1 for the table's entries, -1 for each s that
// it serves, -2 where that is G, which is there twice. [moving.size()][tables]
Eigen::MatrixXd GaugeDirections(const FactorModel& model, const std::vector<int>& moving,
                                const Eigen::VectorXd& lengths) {
  const ModelSpec& spec = model.spec();
  std::vector<Eigen::VectorXd> directions;
  for (const Factor factor : kFactors) {
    for (int t = 0; t < spec.num_tables(factor); ++t) {
      Eigen::VectorXd relative = Eigen::VectorXd::Zero(spec.num_parameters());
      relative.segment(model.TableOffset(factor, t), spec.table_size(factor)).setOnes();
      for (int m = 0; m < spec.lobes; ++m) {
        for (int c = 0; c < kChannels; ++c) {
          if (spec.serves(factor, t, m, c)) {
            relative(kChannels * (1 + m) + c) = factor == Factor::kG ? -2 : -1;
          }
        }
      }
      const Eigen::Map<const Eigen::VectorXd> x(model.parameters().data(), relative.size());
      directions.emplace_back(relative.cwiseProduct(x)(moving).cwiseProduct(lengths));
    }
  }
  Eigen::MatrixXd result(moving.size(), directions.size());
  for (size_t k = 0; k < directions.size(); ++k) {
    const double length = directions[k].norm();
    result.col(static_cast<int>(k)) = length > 0 ? directions[k] / length : directions[k];
  }
  return result;
}

// An orthonormal basis of the columns' span. [rows][rank]
Eigen::MatrixXd OrthonormalBasis(const Eigen::MatrixXd& columns) {
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(columns);
  return Eigen::MatrixXd(qr.householderQ()).leftCols(qr.rank());
}

// "d", "s0" (of lobe 0), "D0", "F0" (the 0th table), ... in the order of FactorModel::Parts().
std::vector<std::string> PartNames(const ModelSpec& spec) {
  std::vector<std::string> names = {"d"};
  for (int m = 0; m < spec.lobes; ++m) names.push_back("s" + std::to_string(m));
  for (const Factor factor : kFactors) {
    for (int t = 0; t < spec.num_tables(factor); ++t) {
      names.push_back(FactorName(factor) + std::to_string(t));
    }
  }
  return names;
}

// How much of a unit vector lies in each part of the model, and where it is largest.
Json Describe(const FactorModel& model, const std::vector<int>& moving,
              const Eigen::VectorXd& direction) {
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(model.spec().num_parameters());
  squares(moving) = direction.cwiseAbs2();
  Eigen::Index peak = 0;
  squares.maxCoeff(&peak);
  const std::vector<std::string> names = PartNames(model.spec());
  const std::vector<FactorModel::Part> parts = model.Parts();
  Json shares, largest;
  for (size_t k = 0; k < parts.size(); ++k) {
    const auto [begin, size] = parts[k];
    shares[names[k]] = squares.segment(begin, size).sum();
    if (peak >= begin && peak < begin + size) {
      largest = {{"part", names[k]}, {"entry", peak - begin}};
    }
  }
  return {{"shares", shares}, {"largest", largest}};
}

Json Spectrum(const Objective& objective, const FactorModel& model) {
  QuadraticModel at;
  NormalEquations(objective).Evaluate(model, Hessian::kGaussNewton, &at);
  const int n = model.spec().num_parameters();
  std::vector<int> moving;  // columns of J that are not 0
  for (int k = 0; k < n; ++k) {
    if (at.squared_lengths[k] > 0) moving.push_back(k);
  }
  if (moving.empty()) {
    throw Error(ErrorKind::kData, "no number of the model moves any sample; J is 0").About("model");
  }
  const Eigen::Map<const Eigen::MatrixXd> JtJ(at.H.data(), n, n);
  const Eigen::VectorXd lengths = JtJ.diagonal()(moving).cwiseSqrt();
  const Eigen::VectorXd inverse = lengths.cwiseInverse();
  const Eigen::MatrixXd gauge = OrthonormalBasis(GaugeDirections(model, moving, lengths));
  // J'J has trace n, so no eigenvalue above that: raised by 2n, those of the gauge come last.
  const double raise = 2.0 * static_cast<double>(moving.size());
  const Eigen::MatrixXd scaled =
      inverse.asDiagonal() * JtJ(moving, moving).eval() * inverse.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled +
                                                             raise * gauge * gauge.transpose());
  const int count = static_cast<int>(moving.size() - gauge.cols());
  Json values = Json::array(), weakest = Json::array();
  for (int k = count - 1; k >= 0; --k) {
    values.push_back(std::sqrt(std::max(0.0, eigen.eigenvalues()(k))));
  }
  for (int k = 0; k < std::min(count, FLAGS_weakest); ++k) {
    Json direction = {{"singular_value", values[count - 1 - k]}};
    direction.update(Describe(model, moving, eigen.eigenvectors().col(k)));
    weakest.push_back(direction);
  }
  return {{"objective", at.objective},
          {"columns", moving.size()},
          {"gauge_directions", gauge.cols()},
          {"singular_values", values},
          {"weakest", weakest}};
}

int Main(const std::string& model_path, const std::string& source) {
  const FactorModel model = ReadModel(model_path).model;
  const SourceOptions options = {.num_threads = FLAGS_threads,
                                 .max_angle_deg = FLAGS_max_angle,
                                 .extrapolated = FLAGS_extrapolated};
  const Objective objective(ValidSamples(LoadTable(source, options)), model.spec(),
                            FindWeighting(FLAGS_weighting), FLAGS_threads);
  std::printf("%s\n", Spectrum(objective, model).dump().c_str());
  return 0;
}

}  // namespace
}  // namespace trilobe

int main(int argc, char** argv) {
  return trilobe::ProgramMain(argc, argv, "spectrum MODEL SOURCE", 2,
                              [](auto words) { return trilobe::Main(words[0], words[1]); });
}
