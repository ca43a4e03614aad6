#include "app/progress.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>

#include "trilobe/core/base/printable.h"

namespace trilobe {
namespace {

// Says where a start has ended.
std::string Describe(const StartResult& start, double lowest) {
  const double above = 100 * (start.objective / lowest - 1);
  if (!(above > 0)) return "the lowest so far";
  constexpr double kSameE = 0.1;  // %, by which starts of one minimum differ at most
  const char* const minimum = start.minimum == 1 ? "lobes alike"
                              : above <= kSameE  ? "other lobes"
                                                 : "another minimum";
  constexpr double kLeast = 1e-3;  // that is worth its digits
  if (above < kLeast) return std::string("at the lowest, ") + minimum;
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.2g %% above the lowest, %s", above, minimum);
  return text.data();
}

}  // namespace

Progress::Progress(const SolverOptions& options, bool verbose)
    : max_iterations_(options.max_iterations),
      max_seconds_(options.max_seconds),
      on_terminal_(isatty(STDERR_FILENO) != 0),
      verbose_(verbose) {}

Progress::~Progress() {
  if (on_terminal_) std::fputs("\r\033[K", stderr);
}

void Progress::Show(const IterationRecord& record) {
  if (!on_terminal_) return;
  const double before = last_.minimised(), now = record.minimised();
  const double relative_change = before > 0 ? (now - before) / before : 0;
  std::fprintf(stderr, "\r\033[Kiteration %d   E %s%.6g", record.iteration,
               record.objective_with_prior ? "with the prior " : "", now);
  if (record.iteration > 0) {
    const double left =
        std::min((max_iterations_ - record.iteration) * record.seconds / record.iteration,
                 max_seconds_ - record.seconds);
    std::fprintf(stderr, " (%+.2g %%)   %.1f s, at most %.0f s left", 100 * relative_change,
                 record.seconds, std::ceil(std::max(0.0, left)));
  }
  std::fflush(stderr);
  last_ = record;
}

void Progress::Show(const StartProgress& starts) const {
  if (starts.start && (on_terminal_ || verbose_)) {
    const StartResult& start = *starts.start;
    std::fprintf(stderr, "%sstart %-14s E %-12.6g %s\n", on_terminal_ ? "\r\033[K" : "",
                 start.name.c_str(), start.objective, Describe(start, starts.lowest).c_str());
  }
  if (!on_terminal_ || starts.start) return;
  const double seconds = since_.Seconds();
  const double left =
      std::min(seconds * (1 / std::max(starts.share, 1e-9) - 1), max_seconds_ - seconds);
  std::fprintf(stderr,
               "\r\033[Kstart %d of %d, round %d of %d   %.1f s, at most %.0f s left for starts",
               starts.ended, starts.starts, starts.round, starts.rounds, seconds,
               std::ceil(std::max(0.0, left)));
  std::fflush(stderr);
}

JobProgress::JobProgress(size_t count, std::string what)
    : on_terminal_(isatty(STDERR_FILENO) != 0), count_(count), what_(std::move(what)) {
  Show();
}

JobProgress::~JobProgress() { Clear(); }

void JobProgress::Clear() const {
  if (on_terminal_) std::fputs("\r\033[K", stderr);
}

void JobProgress::Done(const std::string& name, bool took_time) {
  ++done_;
  timed_ += took_time ? 1 : 0;
  last_ = ", last " + Printable(name);
  Show();
}

void JobProgress::Show() const {
  if (!on_terminal_) return;
  std::fprintf(stderr, "\r\033[K%zu of %zu %s finished%s", done_, count_, what_.c_str(),
               last_.c_str());
  if (timed_ > 0 && done_ < count_) {
    const double left =
        since_.Seconds() / static_cast<double>(timed_) * static_cast<double>(count_ - done_);
    std::fprintf(stderr, left < 90 ? ", about %.0f s left" : ", about %.0f min left",
                 left < 90 ? std::ceil(left) : std::ceil(left / 60));
  }
  std::fflush(stderr);
}

}  // namespace trilobe
