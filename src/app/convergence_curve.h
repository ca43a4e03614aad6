#ifndef TRILOBE_APP_CONVERGENCE_CURVE_H_
#define TRILOBE_APP_CONVERGENCE_CURVE_H_

#include <string>
#include <vector>

#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/iteration_record.h"
#include "trilobe/model/objective/objective.h"

namespace trilobe {

// How a fit's errors go down with time, measured without delaying the fit: it keeps copies of
// models at seconds that grow by a constant factor, and scores them when the fit is over.
class ConvergenceCurve {
 public:
  // The first model, and each that comes when enough time has gone by since the one before.
  void Keep(const IterationRecord& record, const FactorModel& model);

  // Writes convergence.csv (docs/file-formats.md): those kept, and the last model of the fit.
  void Write(const std::string& path, const Objective& objective) const;

 private:
  struct Point {
    IterationRecord record;
    FactorModel model;
  };
  std::vector<Point> points_;
  Point last_;
};

}  // namespace trilobe

#endif  // TRILOBE_APP_CONVERGENCE_CURVE_H_
