#ifndef TRILOBE_IO_PICTURES_PAGE_H_
#define TRILOBE_IO_PICTURES_PAGE_H_

#include <optional>
#include <string>
#include <vector>

#include "trilobe/model/appearance/environment.h"
#include "trilobe/model/measurement/brdf_samples.h"
#include "trilobe/model/measurement/brdf_table.h"
#include "trilobe/model/measurement/node_brdf.h"
#include "trilobe/model/objective/iteration_record.h"
#include "trilobe/model/read_model.h"

namespace trilobe {

// A compressed measurement in a page. Values are quantised to q = round(kMeasuredSteps
// log2(1 + rho / kMeasuredFloor)), with an error of at most 0.14 %. The prediction of q is the mean
// of the measured ones among the previous pair in the row and the same pair in the previous row.
// The difference x is stored as 2 x, or -2 x - 1 for x < 0, in a Rice code (Rice 1979). Each row of
// a channel begins with the number of low bits (4 bits). Before all values come the lengths of
// alternating runs of measured and unmeasured pairs, with 5 low bits. Bits fill bytes from the
// lowest.
inline constexpr double kMeasuredFloor = 1e-3;  // [1/sr]
inline constexpr int kMeasuredSteps = 256;
//
// Scattered samples are stored as they are: theta_i, phi_i, theta_o, phi_o [degrees], R, G, B
// [1/sr], each a float of 4 bytes, the lowest first.
struct MeasuredData {
  enum class Kind { kTable, kNodes, kSamples };

  Kind kind = Kind::kTable;
  // Table: theta_h, theta_d, phi_d. Nodes: incident, outgoing. Samples: those stored.
  std::vector<int> shape;
  HemisphereGrid grid;       // for nodes
  double max_theta = 0;      // for nodes and samples [rad]
  bool anisotropic = false;  // for samples: their azimuths count
  int samples = 0;           // number measured
  std::string bits;          // the code
};

// Merges pairs of phi_d bins if there are more than 90, so that a page stays below 2 MB.
MeasuredData EncodeMeasured(const BrdfTable& table);

// Resamples by linear interpolation if there are more than kMostNodes nodes.
inline constexpr int kMostNodes = 432;
MeasuredData EncodeMeasured(const NodeBrdf& brdf);

// Encodes at most kMostSamples, spread evenly over the order of the samples, so that a page stays
// below 2 MB. Throws Error unless the samples have directions.
inline constexpr int kMostSamples = 40000;
MeasuredData EncodeMeasured(const BrdfSamples& samples, double max_theta, bool anisotropic);

// Contents of a page besides the model.
struct PageContents {
  std::string name;                      // of the material; the title
  std::string source;                    // of the measurement, if any
  std::optional<MeasuredData> measured;  // drawn beside the model
  int parameters = 0;                    // stored
  // Visible difference of the spheres or samples; empty if nothing was compared.
  std::string verdict, visibility;
  double psnr_db = 0, mean_delta_e = 0, delta_e_95 = 0;
  bool of_sphere = true;      // or of samples
  double measured_share = 1;  // of what a renderer reads (MeasuredShare)
  // The largest value of the model between samples over the largest sample; 0 if unknown.
  double reach = 0;
  std::vector<std::string> notes;  // on the measurement, and advice
  std::vector<std::string> ggx;    // what is nearest to each lobe, in words; "" for nothing
  std::vector<IterationRecord> trace;
  std::string wavelengths;             // of a spectral fit, in words
  const Environment* probe = nullptr;  // the light; null: the studio, which the page computes
  // What browsers without WebGL 2 show: PngOfSpheres, of the measurement too if it is drawn.
  std::string spheres;
};

// A self-contained HTML file with web/, the model and the measurement. It needs no server and no
// network.
std::string FormatPage(const ModelFile& model, const PageContents& contents);

}  // namespace trilobe

#endif  // TRILOBE_IO_PICTURES_PAGE_H_
