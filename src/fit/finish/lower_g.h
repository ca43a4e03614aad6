#ifndef TRILOBE_FIT_FINISH_LOWER_G_H_
#define TRILOBE_FIT_FINISH_LOWER_G_H_

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "fit/finish/light_bounds.h"
#include "trilobe/core/base/channels.h"
#include "trilobe/core/base/stop_check.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/table_layout.h"

namespace trilobe {

// Most passes that lower G of a model that reflects too much light, isotropic or anisotropic.
constexpr int kPassesOfG = 40;

// Factor by which G is to be lowered where an albedo exceeds its limit by more than a thousandth:
// the root of limit over albedo, both less the diffuse part, since both G(theta_i) and G(theta_o)
// make a highlight. 1 elsewhere.
double FactorOfG(const Rgb& albedo, const Rgb& limit, std::span<const double> d);

// Factor that each of these angles asks for. [angles.size()]
using FactorsAt = std::function<std::vector<double>(std::span<const size_t> angles)>;
// Lowers G, by the factors that all angles ask for. [end]
using LowerBy = std::function<void(const std::vector<double>& factors)>;

// Lowers G until no angle from `begin` to below `end` asks for it, in at most so many passes;
// whether anything changed. An angle that is within its limit stays so, as G only falls.
bool LowerWhileExceeding(size_t begin, size_t end, int passes, const StopCheck& stop,
                         const FactorsAt& factors_at, const LowerBy& lower_by);

// Lowers G of all lobes at the stored nodes around each of these directions until it keeps to the
// limit there, and the diffuse term where that alone exceeds.
void LowerToBounds(const std::vector<LightBound>& bounds, const TableLayout& layout,
                   int num_threads, const StopCheck& stop, FactorModel* model);

}  // namespace trilobe

#endif  // TRILOBE_FIT_FINISH_LOWER_G_H_
