#ifndef TRILOBE_FIT_FINISH_EDGE_COURSE_H_
#define TRILOBE_FIT_FINISH_EDGE_COURSE_H_

#include <vector>

#include "fit/finish/factored_albedos.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/table_layout.h"

namespace trilobe {

// Ways in which F and G of an isotropic model go on where the data end, so that what they reflect
// together is smooth. Entries of all tables change; ExpandStored makes those that are not stored
// follow.

// Continues F and G beyond an angle [rad] together. Along a highlight, where
// theta_i = theta_o = theta_d, a lobe reflects F q^2 with q = G / cos theta, and towards the edge
// of the data F may grow a millionfold as q falls. With phi = log F / 2, the mean of channels, what
// goes on as within the ten degrees before, and levels off (LevelledOff), is log q + phi, and
// log F - 2 phi of each channel; phi itself goes on as over its last three entries, so that F and q
// still make up for each other.
void ContinueTogether(double from, FactorModel* model);

// The angles at which FollowCourse reads albedos: each half degree from 50 to 89.5 degrees [rad].
std::vector<double> AnglesOfCourse();

// Scales G, by half of the logarithm as two of them make a highlight, and the colours of F towards
// the horizon until the directional albedo follows its own smooth course: at each half degree from
// 64 degrees, the quadratic fitted to its logarithms within `around` degrees, by weights that fall
// off (Cleveland, Journal of the American Statistical Association 74, 1979). `albedos`: of models
// with this D, at AnglesOfCourse().
void FollowCourse(double around, const TableLayout& layout, const FactoredAlbedos& albedos,
                  FactorModel* model);

}  // namespace trilobe

#endif  // TRILOBE_FIT_FINISH_EDGE_COURSE_H_
