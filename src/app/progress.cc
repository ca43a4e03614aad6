#include "app/progress.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>

#include "app/status.h"
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

// "12 s", rounded up.
std::string Whole(const char* format, double number) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), format, std::ceil(std::max(0.0, number)));
  return text.data();
}

}  // namespace

Progress::Progress(const SolverOptions& options, bool verbose)
    : max_iterations_(options.max_iterations),
      max_seconds_(options.max_seconds),
      verbose_(verbose) {}

void Progress::Show(const IterationRecord& record) {
  const double before = last_.minimised(), now = record.minimised();
  const double relative_change = before > 0 ? (now - before) / before : 0;
  std::array<char, 160> text{};
  std::snprintf(text.data(), text.size(), "iteration %d   E %s%.6g", record.iteration,
                record.objective_with_prior ? "with the prior " : "", now);
  std::string line = text.data();
  if (record.iteration > 0) {
    const double left =
        std::min((max_iterations_ - record.iteration) * record.seconds / record.iteration,
                 max_seconds_ - record.seconds);
    std::snprintf(text.data(), text.size(), " (%+.2g %%)   %.1f s", 100 * relative_change,
                  record.seconds);
    line += text.data() + Whole(", at most %.0f s left", left);
  }
  Status::Show(line);
  last_ = record;
}

void Progress::Show(const StartProgress& starts) const {
  if (starts.start && (Status::OnTerminal() || verbose_)) {
    const StartResult& start = *starts.start;
    Status::Clear();
    std::fprintf(stderr, "start %-14s E %-12.6g %s\n", start.name.c_str(), start.objective,
                 Describe(start, starts.lowest).c_str());
  }
  if (starts.start) return;
  const double seconds = since_.Seconds();
  const double left =
      std::min(seconds * (1 / std::max(starts.share, 1e-9) - 1), max_seconds_ - seconds);
  std::array<char, 160> text{};
  std::snprintf(text.data(), text.size(), "start %d of %d, round %d of %d   %.1f s", starts.ended,
                starts.starts, starts.round, starts.rounds, seconds);
  Status::Show(text.data() + Whole(", at most %.0f s left for starts", left));
}

JobProgress::JobProgress(size_t count, std::string what) : count_(count), what_(std::move(what)) {
  Show();
}

JobProgress::~JobProgress() { Status::End(); }

void JobProgress::Done(const std::string& name, bool took_time) {
  ++done_;
  timed_ += took_time ? 1 : 0;
  last_ = ", last " + name;
  Show();
}

void JobProgress::Show() const {
  std::string line =
      std::to_string(done_) + " of " + std::to_string(count_) + " " + what_ + " finished" + last_;
  if (timed_ > 0 && done_ < count_) {
    const double left =
        since_.Seconds() / static_cast<double>(timed_) * static_cast<double>(count_ - done_);
    line +=
        left < 90 ? Whole(", about %.0f s left", left) : Whole(", about %.0f min left", left / 60);
  }
  Status::Stage(line);
}

}  // namespace trilobe
