#ifndef TRILOBE_IO_PAGE_MEASURED_DATA_H_
#define TRILOBE_IO_PAGE_MEASURED_DATA_H_

#include <string>
#include <vector>

#include "trilobe/model/measurement/brdf_table.h"
#include "trilobe/model/measurement/node_brdf.h"

namespace trilobe {

// A measurement as a page carries it. A value is q = round(kSteps log2(1 + rho / kFloor)), off by
// 0.14 % at most. What is kept is how q differs from what the pair before in the row and the one in
// the row before say, their mean where both were measured: 2 x, or -2 x - 1 of a negative x, in a
// Rice code (Rice 1979), whose number of low bits each row of a channel says in 4 bits. Before all
// values come the lengths of runs of pairs that were measured and were not, by turns, with 5 low
// bits each. Bits are filled from the lowest.
inline constexpr double kMeasuredFloor = 1e-3;  // [1/sr]
inline constexpr int kMeasuredSteps = 256;
struct MeasuredData {
  // Of a table: theta_h, theta_d, phi_d. Of nodes: pairs, incidence first.
  std::vector<int> shape;
  bool nodes = false;
  HemisphereGrid grid;   // of nodes
  double max_theta = 0;  // of nodes [rad]
  int samples = 0;       // that were measured
  std::string bits;      // the code
};

// Two bins of phi_d become one where there are more than 90, so that a page stays below 2 MB.
MeasuredData EncodeMeasured(const BrdfTable& table);

// On at most kMostNodes nodes; of more, on fewer, between which the measurement is linear.
inline constexpr int kMostNodes = 432;
MeasuredData EncodeMeasured(const NodeBrdf& brdf);

}  // namespace trilobe

#endif  // TRILOBE_IO_PAGE_MEASURED_DATA_H_
