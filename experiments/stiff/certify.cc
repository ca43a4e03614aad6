// The right answers to the stiff cases, in fifty digits. See README.md beside this file.

#include <gflags/gflags.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "experiments/program.h"
#include "experiments/stiff/answers.h"
#include "experiments/stiff/certificate.h"

DEFINE_string(case, "all", "name of a case, or all; other answers in the file are kept");
DEFINE_int32(random_starts, 24, "starts besides the truth and the deterministic ones");
DEFINE_string(out, trilobe::CertifiedAnswers(), "file of the answers");

namespace trilobe {
namespace {

// Replaces a certificate of the list or adds it, in the order of the cases.
void Put(const Certificate& certificate, std::vector<Certificate>* all) {
  std::erase_if(*all, [&](const Certificate& other) { return other.name == certificate.name; });
  all->push_back(certificate);
  std::ranges::stable_sort(*all, {}, [](const Certificate& other) {
    return std::ranges::find(StiffCases(), other.name, &StiffCase::name) - StiffCases().begin();
  });
}

int Main() {
  std::vector<StiffCase> cases = StiffCases();
  if (FLAGS_case != "all") cases = {FindStiffCase(FLAGS_case)};
  std::vector<Certificate> all;
  if (std::filesystem::exists(FLAGS_out)) all = ReadCertificates(FLAGS_out);
  for (const StiffCase& stiff_case : cases) {
    const auto start = std::chrono::steady_clock::now();
    const Certificate certificate = Certify(stiff_case, FLAGS_random_starts);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    std::printf(
        "%-18s E %.9e of %.3e, optimality %.0e, %d of %d starts agree, %zu other minima, rank %d "
        "of %d, %zu undetermined, %.1f s\n",
        certificate.name.c_str(), certificate.objective, certificate.measured_energy,
        certificate.optimality, certificate.agreeing, certificate.starts, certificate.others.size(),
        certificate.rank, certificate.parameters, certificate.undetermined.size(), seconds.count());
    std::fflush(stdout);
    Put(certificate, &all);
    WriteCertificates(all, FLAGS_out);
  }
  return 0;
}

}  // namespace
}  // namespace trilobe

int main(int argc, char** argv) {
  return trilobe::ProgramMain(argc, argv, "certify [--case=NAME] [--random_starts=N] [--out=FILE]",
                              0, [](auto /*words*/) { return trilobe::Main(); });
}
