// The right answers to the stiff cases, in fifty digits. See README.md beside this file.

#include <gflags/gflags.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>
#include <vector>

#include "experiments/stiff/certificate.h"

DEFINE_string(case, "", "certify this case alone, and keep the other answers of the file");
DEFINE_int32(random_starts, 8, "starts besides the truth and the deterministic ones");
DEFINE_string(out, TRILOBE_STIFF_ANSWERS, "file of the answers");

namespace trilobe {
namespace {

void Main() {
  std::vector<Certificate> certificates;
  if (!FLAGS_case.empty() && std::filesystem::exists(FLAGS_out)) {
    certificates = ReadCertificates(FLAGS_out);
  }
  if (!FLAGS_case.empty()) FindStiffCase(FLAGS_case);  // or an error
  std::vector<Certificate> all;
  for (const StiffCase& stiff_case : StiffCases()) {
    if (!FLAGS_case.empty() && FLAGS_case != stiff_case.name) {
      const auto known = std::ranges::find(certificates, stiff_case.name, &Certificate::name);
      if (known != certificates.end()) all.push_back(*known);
      continue;
    }
    const auto start = std::chrono::steady_clock::now();
    all.push_back(Certify(stiff_case, FLAGS_random_starts));
    const Certificate& of = all.back();
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    std::printf(
        "%-20s E %.12e of %.3e, promise %.0e, optimality %.0e, %d of %d starts, %zu others, flat "
        "%d, down %d, rank "
        "%d of %d, condition %.1e, undetermined %zu, spread %.0e, %.1f s\n",
        of.name.c_str(), of.objective, of.measured_energy, of.relative_decrease, of.optimality,
        of.agreeing, of.starts, of.others.size(), of.flat_directions, of.descent_directions,
        of.rank, of.parameters, of.condition, of.undetermined.size(), of.spread, seconds.count());
    std::fflush(stdout);
  }
  WriteCertificates(all, FLAGS_out);
}

}  // namespace
}  // namespace trilobe

int main(int argc, char** argv) {
  gflags::SetUsageMessage("certify [--case=NAME] [--random_starts=N] [--out=FILE]");
  gflags::ParseCommandLineFlags(&argc, &argv, true);
  try {
    trilobe::Main();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "certify: error: %s\n", error.what());
    return 1;
  }
  return 0;
}
