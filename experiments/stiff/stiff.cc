// How many digits of the certified answers do the solvers find? See README.md beside this file.

#include <gflags/gflags.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/files/file.h"
#include "experiments/program.h"
#include "experiments/stiff/agreement.h"
#include "experiments/stiff/answers.h"
#include "experiments/stiff/certificate.h"
#include "experiments/stiff/reference_problem.h"
#include "model/objective/gauge.h"
#include "trilobe/core/base/error.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/starts/solvers.h"

DEFINE_string(case, "all", "name of a case, or all");
DEFINE_string(solver, "all", "name of a solver, or all that can work on the case");
DEFINE_bool(list, false, "print the cases and what is hard about each, and end");
DEFINE_int32(max_iterations, 500,
             "iterations of each; no other stopping rule but that of a solver"
             " that finds no lower E, or an exact fit");
DEFINE_string(answers, trilobe::CertifiedAnswers(), "the certified answers");
DEFINE_string(out, "", "file for the results, JSON");

namespace trilobe {
namespace {

using Json = nlohmann::ordered_json;

// Nearer to the certified E than this, relative to the scale of its digits, a run has found it.
constexpr double kFound = 1e-6;

// The largest rise of E from one iteration's record to the next, relative to E before.
double WorstRise(const std::vector<IterationRecord>& trace) {
  double worst = 0;
  for (size_t k = 1; k < trace.size(); ++k) {
    const double before = trace[k - 1].objective, after = trace[k].objective;
    if (after > before) worst = std::max(worst, (after - before) / before);
  }
  return worst;
}

// Tells how a run ended: at the certified E, below it (then that is no minimum), at another
// stationary point that the certification met, or at none of these.
std::string End(double objective, double scale, const Certificate& right) {
  const double excess = (objective - right.objective) / scale;
  if (objective == right.objective || std::abs(excess) <= kFound) return "certified";
  if (excess < 0) return "below";
  for (const auto& [other, starts] : right.others) {
    if (std::abs(objective - other) <= kFound * other) return "other";
  }
  return "elsewhere";
}

bool IsValid(const FactorModel& model) {
  return std::ranges::all_of(model.parameters(),
                             [](double x) { return std::isfinite(x) && x >= 0; });
}

Json Run(const StiffCase& stiff_case, const SolverEntry& solver, const Certificate& right) {
  const StiffProblem problem = stiff_case.make();
  const Objective objective = MakeObjective(problem);
  CheckCertifies(right, objective);
  FactorModel model = StartOf(problem, objective);
  SolverOptions options;
  options.max_iterations = FLAGS_max_iterations;
  options.relative_decrease_tolerance = 0;
  options.optimality_tolerance = 0;
  Json result = {{"case", stiff_case.name},
                 {"description", stiff_case.description},
                 {"model", problem.spec.anisotropic() ? "anisotropic" : "isotropic"},
                 {"solver", solver.name}};
  try {
    const SolverSummary summary = solver.make()->Solve(objective, options, &model);
    const double E = summary.final_objective;
    const double scale = right.exact ? right.measured_energy : right.objective;
    const ReferenceProblem<long double> reference(problem.samples, problem.spec, problem.weighting);
    VectorOf<long double> x(problem.spec.num_parameters());
    for (int k = 0; k < x.size(); ++k) x(k) = model.parameters()[k];
    const auto exact_E = static_cast<double>(reference.Value(x));
    NormalizeScale(objective.coverage(), &model);
    const TableAgreement tables = CompareTables(model, right.model, right.Determined());
    result.update({{"stop_reason", StopReasonName(summary.stop_reason)},
                   {"end", End(E, scale, right)},
                   {"initial_objective", summary.initial_objective},
                   {"objective", E},
                   {"certified_objective", right.objective},
                   {"digits_objective", DigitsOfAgreement(E, right.objective, scale)},
                   {"digits_tables", tables.tables},
                   {"digits_entries", tables.entries},
                   {"digits_scorer", DigitsOfAgreement(E, exact_E, right.exact ? scale : exact_E)},
                   {"rise_over_start", E > summary.initial_objective},
                   {"worst_rise", WorstRise(summary.trace)},
                   {"valid", std::isfinite(E) && IsValid(model)},
                   {"seconds", summary.seconds},
                   {"iterations", summary.iterations},
                   {"notes", summary.notes}});
    if (summary.diagnosis) {
      result.update({{"optimality", summary.diagnosis->optimality},
                     {"rank", summary.diagnosis->rank},
                     {"condition", summary.diagnosis->condition},
                     {"unresolved", summary.diagnosis->unresolved}});
    }
  } catch (const Error& error) {
    result["error"] = error.what();
  }
  return result;
}

template <typename T>
std::vector<T> Chosen(const std::vector<T>& all, const std::string& name,
                      const T& (*find)(std::string_view)) {
  return name == "all" ? all : std::vector<T>{find(name)};
}

void Print(const Json& result) {
  std::printf("%-18s %-16s ", result["case"].get<std::string>().c_str(),
              result["solver"].get<std::string>().c_str());
  if (result.contains("error")) {
    std::printf("error: %s\n", result["error"].get<std::string>().c_str());
  } else {
    std::printf(
        "%-14s %-10s E %.6e digits %4.1f, tables %4.1f, entries %4.1f, %d iterations, %.3f s\n",
        result["stop_reason"].get<std::string>().c_str(), result["end"].get<std::string>().c_str(),
        result["objective"].get<double>(), result["digits_objective"].get<double>(),
        result["digits_tables"].get<double>(), result["digits_entries"].get<double>(),
        result["iterations"].get<int>(), result["seconds"].get<double>());
  }
  std::fflush(stdout);
}

// 0 if no run left a number that is none, or raised E.
int Main() {
  if (FLAGS_list) {
    for (const StiffCase& stiff_case : StiffCases()) {
      std::printf("%-20s %s\n", stiff_case.name.c_str(), stiff_case.description.c_str());
    }
    return 0;
  }
  const std::vector<Certificate> certificates = ReadCertificates(FLAGS_answers);
  Json results = Json::array();
  bool sound = true;
  for (const StiffCase& stiff_case : Chosen(StiffCases(), FLAGS_case, FindStiffCase)) {
    const auto right = std::ranges::find(certificates, stiff_case.name, &Certificate::name);
    if (right == certificates.end()) {
      throw Error(ErrorKind::kMissing,
                  FLAGS_answers + " has no answer to " + stiff_case.name + "; run certify")
          .At(FLAGS_answers)
          .About("case", stiff_case.name);
    }
    for (const SolverEntry& solver : Chosen(Solvers(), FLAGS_solver, FindSolver)) {
      results.push_back(Run(stiff_case, solver, *right));
      const Json& result = results.back();
      Print(result);
      sound &= result.contains("error") || (result["valid"] && !result["rise_over_start"]);
    }
  }
  if (!FLAGS_out.empty()) {
    WriteFile(FLAGS_out, [&](std::ostream& out) { out << results.dump(1) << "\n"; });
  }
  if (sound) return 0;
  std::fprintf(stderr, "stiff: a run ended with no valid model, or above its start\n");
  return 1;
}

}  // namespace
}  // namespace trilobe

int main(int argc, char** argv) {
  return trilobe::ProgramMain(argc, argv,
                              "stiff [--case=NAME] [--solver=NAME] [--out=FILE] | --list", 0,
                              [](auto /*words*/) { return trilobe::Main(); });
}
