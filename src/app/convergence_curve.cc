#include "app/convergence_curve.h"

#include <algorithm>
#include <iomanip>
#include <limits>
#include <ostream>

#include "core/files/file.h"
#include "trilobe/model/objective/score.h"

namespace trilobe {
namespace {

// A model is kept when this many times the seconds of the one before have gone by; before the first
// hundredth of a second, none but the start.
constexpr double kGrowth = 1.5;
constexpr double kFirstSeconds = 0.01;

}  // namespace

void ConvergenceCurve::Keep(const IterationRecord& record, const FactorModel& model) {
  last_ = {record, model};
  if (points_.empty() ||
      record.seconds >= std::max(kFirstSeconds, kGrowth * points_.back().record.seconds)) {
    points_.push_back(last_);
  }
}

void ConvergenceCurve::Write(const std::string& path, const Objective& objective) const {
  std::vector<Point> points = points_;
  if (!points.empty() && points.back().record.iteration != last_.record.iteration) {
    points.push_back(last_);
  }
  WriteFile(path, [&](std::ostream& out) {
    out << "iteration,seconds,objective,psnr_db,rmse,mean_relative_error,mean_log_error\n"
        << std::setprecision(std::numeric_limits<double>::max_digits10);
    for (const auto& [record, model] : points) {
      // Of the form that was fitted, whichever was chosen then.
      const ScoreReport score = ScoreModel(Objective(objective, model.spec()), model);
      out << record.iteration << ',' << record.seconds << ',' << score.objective << ','
          << score.psnr_db << ',' << score.rmse << ',' << score.mean_relative_error << ','
          << score.mean_log_error << '\n';
    }
  });
}

}  // namespace trilobe
