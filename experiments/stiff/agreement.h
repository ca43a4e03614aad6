#ifndef TRILOBE_EXPERIMENTS_STIFF_AGREEMENT_H_
#define TRILOBE_EXPERIMENTS_STIFF_AGREEMENT_H_

#include <vector>

#include "trilobe/model/factor_model.h"

namespace trilobe {

// Doubles agree in no more digits than this.
inline constexpr double kMaxDigits = 15;

// Digits in which a value agrees with the right one, the log relative error of NIST's StRD:
// -log10(|value - right| / scale), in [0, kMaxDigits]. 0 for NaN; all where the two are equal.
double DigitsOfAgreement(double value, double right, double scale);

// How well a model agrees with the right one, over its determined parameters, in digits.
struct TableAgreement {
  double tables = kMaxDigits;   // worst error over the largest entry of its table, d or s of a lobe
  double entries = kMaxDigits;  // worst error over the entry itself
};

// The model with its lobes in the order in which it agrees best with the right one, over its
// determined parameters. Both are canonical; `determined` is by parameter.
FactorModel MatchLobes(const FactorModel& model, const FactorModel& right,
                       const std::vector<bool>& determined);

// The agreement of canonical models, lobes matched: they have no order.
TableAgreement CompareTables(const FactorModel& model, const FactorModel& right,
                             const std::vector<bool>& determined);

}  // namespace trilobe

#endif  // TRILOBE_EXPERIMENTS_STIFF_AGREEMENT_H_
