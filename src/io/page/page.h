#ifndef TRILOBE_IO_PAGE_PAGE_H_
#define TRILOBE_IO_PAGE_PAGE_H_

#include <optional>
#include <string>
#include <vector>

#include "trilobe/model/appearance/environment.h"
#include "trilobe/model/evaluate/read_model.h"
#include "trilobe/model/measurement/brdf_table.h"
#include "trilobe/model/measurement/node_brdf.h"
#include "trilobe/model/objective/iteration_record.h"

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

// What a page shows besides the model.
struct PageContents {
  std::string name;                      // of the material, its title
  std::string source;                    // of the measurement, if there is one
  std::optional<MeasuredData> measured;  // what is drawn beside the model
  int parameters = 0;                    // that the model stores
  // What a person would see, of the sphere or of samples; empty where nothing was compared.
  std::string verdict, visibility;
  double psnr_db = 0, mean_delta_e = 0, delta_e_95 = 0;
  std::vector<IterationRecord> trace;
  const Environment* probe = nullptr;  // the light; null: the studio, which the page makes itself
};

// One file of HTML with all that it needs: web/, the model, the measurement. It works from a disk,
// without a server or a network.
std::string FormatPage(const ModelFile& model, const PageContents& contents);

}  // namespace trilobe

#endif  // TRILOBE_IO_PAGE_PAGE_H_
