#include "experiments/stiff/certificate.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/files/file.h"
#include "experiments/stiff/agreement.h"
#include "experiments/stiff/minimize.h"
#include "experiments/stiff/reference_problem.h"
#include "trilobe/core/base/error.h"
#include "trilobe/solvers/starts/initial_model.h"

namespace trilobe {
namespace {

using Json = nlohmann::ordered_json;

// In extended precision, and in fifty digits.
constexpr int kIterations = 600, kPolishIterations = 3000;
// Ends of E within this of each other, relative to E, are one; and those whose E is at the rounding
// error of the data, relative to the measured energy.
constexpr double kSameObjective = 1e-8, kExact = 1e-27;
constexpr int kPolished = 2;  // ends to polish among those that agree
// Eigenvalues below this share of the largest are 0.
constexpr double kFlat = 1e-25;
// Entries that differ by less, relative to the largest of their table, are the same: of minimisers
// in fifty digits, and of those that are not polished.
constexpr double kMoves = 1e-9, kMovesUnpolished = 1e-2;

template <typename Real>
VectorOf<Real> ToVector(std::span<const double> x) {
  VectorOf<Real> result(static_cast<int>(x.size()));
  for (size_t k = 0; k < x.size(); ++k) result(static_cast<int>(k)) = x[k];
  return result;
}

FactorModel ToModel(const ModelSpec& spec, const VectorOf<Big>& x) {
  FactorModel model(spec);
  for (int k = 0; k < x.size(); ++k) model.parameters()[k] = static_cast<double>(x(k));
  return model;
}

std::vector<FactorModel> Starts(const StiffProblem& problem, int random_starts) {
  const Objective objective = MakeObjective(problem);
  std::vector<FactorModel> starts;
  if (problem.truth) starts.push_back(*problem.truth);
  if (problem.start) starts.push_back(*problem.start);
  for (const char* name : {"analytic", "highlight", "constant"}) {
    starts.push_back(FindInitialModel(name).make(objective, 1));
  }
  for (int seed = 1; seed <= random_starts; ++seed) {
    starts.push_back(FindInitialModel("random").make(objective, seed));
  }
  return starts;
}

// Shape of E around the minimiser x.
class Neighbourhood {
 public:
  Neighbourhood(const ReferenceProblem<Big>& problem, VectorOf<Big> x)
      : problem_(problem), x_(std::move(x)), at_(problem.Evaluate(x_)) {
    const int n = static_cast<int>(x_.size());
    length_ = at_.JtJ.diagonal().cwiseSqrt();
    for (int k = 0; k < n; ++k) {
      if (!(length_(k) > 0)) continue;
      moving_.push_back(k);
      const Big force = at_.gradient(k) / length_(k);
      if (x_(k) > 0 || !(force > Big(kFlat) * sqrt(at_.objective))) free_.push_back(k);
    }
  }

  // Fills rank, condition, and the counts of directions; finds the flat directions.
  void Describe(Certificate* certificate) {
    const VectorOf<Big> singular = Spectrum(at_.JtJ, moving_).eigenvalues();
    for (int k = 0; k < singular.size(); ++k) {
      if (singular(k) <= Big(kFlat) * singular.maxCoeff()) continue;
      if (certificate->rank++ == 0) {
        certificate->condition = static_cast<double>(sqrt(singular.maxCoeff() / singular(k)));
      }
    }
    certificate->free_parameters = static_cast<int>(free_.size());
    const auto curvature = Spectrum(at_.hessian, free_);
    for (int k = 0; k < static_cast<int>(free_.size()); ++k) {
      const Big value = curvature.eigenvalues()(k);
      if (value > Big(kFlat)) continue;
      if (value < -Big(kFlat)) {
        ++certificate->descent_directions;
        continue;
      }
      ++certificate->flat_directions;
      flat_.push_back(Direction(curvature.eigenvectors().col(k)));
    }
  }

  // True for the parameters whose canonical value moves along a flat direction, or whose J is 0.
  std::vector<bool> Undetermined() const {
    std::vector<bool> result(x_.size(), false);
    const VectorOf<Big> canonical = problem_.Canonical(x_);
    const Big step(1e-16);
    for (const VectorOf<Big>& direction : flat_) {
      const VectorOf<Big> moved = problem_.Canonical(x_ + step * direction);
      for (const auto [begin, size] : FactorModel(problem_.spec()).Parts()) {
        const Big scale = canonical.segment(begin, size).maxCoeff();
        for (int k = begin; k < begin + size; ++k) {
          const Big speed = abs(moved(k) - canonical(k)) / step;
          if (speed > Big(kMoves) * scale) result[k] = true;
        }
      }
    }
    for (int k = 0; k < x_.size(); ++k) {
      if (!(length_(k) > 0)) result[k] = true;
    }
    return result;
  }

 private:
  // Spectrum of a symmetric matrix in the scale in which columns of J have length 1.
  Eigen::SelfAdjointEigenSolver<MatrixOf<Big>> Spectrum(const MatrixOf<Big>& lower,
                                                        const std::vector<int>& numbers) const {
    const int size = static_cast<int>(numbers.size());
    MatrixOf<Big> scaled(size, size);
    for (int i = 0; i < size; ++i) {
      for (int j = 0; j <= i; ++j) {
        scaled(i, j) = scaled(j, i) =
            lower(numbers[i], numbers[j]) / (length_(numbers[i]) * length_(numbers[j]));
      }
    }
    return Eigen::SelfAdjointEigenSolver<MatrixOf<Big>>(scaled);
  }

  // In x, so long that some parameter moves by as much as the largest of its part.
  VectorOf<Big> Direction(const VectorOf<Big>& scaled) const {
    VectorOf<Big> direction = VectorOf<Big>::Zero(x_.size());
    for (size_t i = 0; i < free_.size(); ++i) {
      direction(free_[i]) = scaled(static_cast<int>(i)) / length_(free_[i]);
    }
    Big largest(0);
    for (const auto [begin, size] : FactorModel(problem_.spec()).Parts()) {
      const Big scale = x_.segment(begin, size).maxCoeff();
      if (!(scale > 0)) continue;
      largest =
          std::max<Big>(largest, direction.segment(begin, size).cwiseAbs().maxCoeff() / scale);
    }
    if (largest > 0) direction /= largest;
    return direction;
  }

  const ReferenceProblem<Big>& problem_;
  const VectorOf<Big> x_;
  const Derivatives<Big> at_;
  VectorOf<Big> length_;  // lengths of the columns of J
  std::vector<int> moving_, free_;
  std::vector<VectorOf<Big>> flat_;
};

// Marks entries in which another minimiser differs, and returns the largest difference of the rest,
// relative to the largest entry of the table.
double MarkDifferences(const FactorModel& other, const FactorModel& model, double tolerance,
                       std::vector<bool>* undetermined) {
  std::vector<bool> determined = *undetermined;
  determined.flip();
  const FactorModel matched = MatchLobes(other, model, determined);
  double spread = 0;
  for (const auto [begin, size] : model.Parts()) {
    const double scale = std::ranges::max(model.parameters().subspan(begin, size));
    for (int k = begin; k < begin + size; ++k) {
      if (!determined[k]) continue;
      const double difference = std::abs(matched.parameters()[k] - model.parameters()[k]);
      if (difference > tolerance * scale) {
        (*undetermined)[k] = true;
      } else if (difference > 0) {
        spread = std::max(spread, difference / scale);
      }
    }
  }
  return spread;
}

Json ToJson(const Certificate& certificate) {
  Json others = Json::array();
  for (const auto& [objective, starts] : certificate.others) {
    others.push_back({{"objective", objective}, {"starts", starts}});
  }
  return {{"name", certificate.name},
          {"samples", certificate.samples},
          {"parameters", certificate.parameters},
          {"objective", certificate.objective_text},
          {"measured_energy", certificate.measured_energy},
          {"exact", certificate.exact},
          {"relative_decrease", certificate.relative_decrease},
          {"optimality", certificate.optimality},
          {"starts", certificate.starts},
          {"agreeing", certificate.agreeing},
          {"others", others},
          {"free_parameters", certificate.free_parameters},
          {"flat_directions", certificate.flat_directions},
          {"descent_directions", certificate.descent_directions},
          {"rank", certificate.rank},
          {"condition", certificate.condition},
          {"spread", certificate.spread},
          {"undetermined", certificate.undetermined},
          {"model", certificate.model.parameters()}};
}

Certificate FromJson(const Json& json) {
  Certificate certificate;
  json.at("name").get_to(certificate.name);
  json.at("samples").get_to(certificate.samples);
  json.at("parameters").get_to(certificate.parameters);
  json.at("objective").get_to(certificate.objective_text);
  certificate.objective = static_cast<double>(Big(certificate.objective_text));
  json.at("measured_energy").get_to(certificate.measured_energy);
  json.at("exact").get_to(certificate.exact);
  json.at("relative_decrease").get_to(certificate.relative_decrease);
  json.at("optimality").get_to(certificate.optimality);
  json.at("starts").get_to(certificate.starts);
  json.at("agreeing").get_to(certificate.agreeing);
  for (const Json& other : json.at("others")) {
    certificate.others.push_back(
        {other.at("objective").get<double>(), other.at("starts").get<int>()});
  }
  json.at("free_parameters").get_to(certificate.free_parameters);
  json.at("flat_directions").get_to(certificate.flat_directions);
  json.at("descent_directions").get_to(certificate.descent_directions);
  json.at("rank").get_to(certificate.rank);
  json.at("condition").get_to(certificate.condition);
  json.at("spread").get_to(certificate.spread);
  json.at("undetermined").get_to(certificate.undetermined);
  certificate.model = FactorModel(FindStiffCase(certificate.name).make().spec);
  const auto x = json.at("model").get<std::vector<double>>();
  if (x.size() != certificate.model.parameters().size()) {
    throw Error(ErrorKind::kMismatch, certificate.name + ": the certified model has " +
                                          std::to_string(x.size()) + " numbers, the case " +
                                          std::to_string(certificate.model.parameters().size()) +
                                          "; run certify again")
        .About(certificate.name, x.size());
  }
  std::ranges::copy(x, certificate.model.parameters().begin());
  return certificate;
}

}  // namespace

std::vector<bool> Certificate::Determined() const {
  std::vector<bool> determined(model.parameters().size(), true);
  for (const int k : undetermined) determined[k] = false;
  return determined;
}

Certificate Certify(const StiffCase& stiff_case, int random_starts) {
  const StiffProblem stiff = stiff_case.make();
  const ReferenceProblem<long double> coarse(stiff.samples, stiff.spec, stiff.weighting);
  const ReferenceProblem<Big> problem(stiff.samples, stiff.spec, stiff.weighting);
  const Big energy = problem.MeasuredEnergy();

  ReferenceMinimizer<long double> explorer(coarse);
  std::vector<Minimum<long double>> ends;
  for (const FactorModel& start : Starts(stiff, random_starts)) {
    ends.push_back(explorer.Minimize(ToVector<long double>(start.parameters()), kIterations));
  }
  const auto starts = static_cast<int>(ends.size());
  std::ranges::stable_sort(ends, {}, &Minimum<long double>::objective);
  const auto same = [&](long double a, long double b) {
    return std::abs(a - b) <=
           kSameObjective * std::min(a, b) + kExact * static_cast<long double>(energy);
  };
  const long double lowest = ends.front().objective;

  Certificate certificate;
  certificate.name = stiff_case.name;
  certificate.samples = stiff.samples.size();
  certificate.parameters = stiff.spec.num_parameters();
  certificate.starts = starts;
  std::vector<Minimum<Big>> polished;
  ReferenceMinimizer<Big> polisher(problem);
  for (const Minimum<long double>& end : ends) {
    if (same(end.objective, lowest)) {
      ++certificate.agreeing;
      if (static_cast<int>(polished.size()) == kPolished) continue;
      polished.push_back(polisher.Minimize(end.x.cast<Big>(), kPolishIterations));
    } else if (end.converged) {
      const auto objective = static_cast<double>(end.objective);
      if (!certificate.others.empty() && same(objective, certificate.others.back().objective)) {
        ++certificate.others.back().starts;
      } else {
        certificate.others.push_back({objective, 1});
      }
    }
  }
  std::ranges::stable_sort(polished, {}, &Minimum<Big>::objective);
  const Minimum<Big>& best = polished.front();
  certificate.objective = static_cast<double>(best.objective);
  certificate.objective_text = best.objective.str(30, std::ios_base::scientific);
  certificate.measured_energy = static_cast<double>(energy);
  certificate.exact = best.objective <= Big(kExact) * energy;
  certificate.relative_decrease = static_cast<double>(best.relative_decrease);
  certificate.optimality = static_cast<double>(best.optimality);

  Neighbourhood around(problem, best.x);
  around.Describe(&certificate);
  certificate.model = ToModel(stiff.spec, problem.Canonical(best.x));
  std::vector<bool> undetermined = around.Undetermined();
  if (!best.converged) undetermined.assign(undetermined.size(), true);  // nor E beyond the promise
  const auto canonical = [&](const VectorOf<Big>& x) {
    return ToModel(stiff.spec, problem.Canonical(x));
  };
  for (const Minimum<Big>& other : polished) {
    certificate.spread =
        std::max(certificate.spread,
                 MarkDifferences(canonical(other.x), certificate.model, kMoves, &undetermined));
  }
  for (const Minimum<long double>& end : ends) {
    if (!end.converged || !same(end.objective, lowest)) continue;
    MarkDifferences(canonical(end.x.cast<Big>()), certificate.model, kMovesUnpolished,
                    &undetermined);
  }
  for (size_t k = 0; k < undetermined.size(); ++k) {
    if (undetermined[k]) certificate.undetermined.push_back(static_cast<int>(k));
  }
  return certificate;
}

std::vector<Certificate> ReadCertificates(const std::string& path) {
  std::vector<Certificate> certificates;
  try {
    const Json file = Json::parse(ReadFile(path));
    for (const Json& json : file.at("certificates")) certificates.push_back(FromJson(json));
  } catch (const Json::exception& error) {
    throw ErrorIn(ErrorKind::kFormat, path, std::string("no certificates: ") + error.what());
  }
  return certificates;
}

void WriteCertificates(const std::vector<Certificate>& certificates, const std::string& path) {
  Json all = Json::array();
  for (const Certificate& certificate : certificates) all.push_back(ToJson(certificate));
  const Json file = {{"made_by", "build/release/experiments/certify"}, {"certificates", all}};
  WriteFile(path, [&](std::ostream& out) { out << file.dump(1) << "\n"; });
}

void CheckCertifies(const Certificate& certificate, const Objective& objective) {
  const double energy = objective.MeasuredEnergy();
  if (certificate.samples == objective.samples().size() &&
      std::abs(energy - certificate.measured_energy) <= 1e-12 * certificate.measured_energy) {
    return;
  }
  throw Error(ErrorKind::kMismatch,
              "case " + certificate.name +
                  " is not the one that was certified: other samples; run certify again")
      .About("case", certificate.name);
}

}  // namespace trilobe
