#ifndef TRILOBE_IO_PAGE_PAGE_H_
#define TRILOBE_IO_PAGE_PAGE_H_

#include <optional>
#include <string>
#include <vector>

#include "io/page/measured_data.h"
#include "trilobe/model/appearance/environment.h"
#include "trilobe/model/evaluate/read_model.h"
#include "trilobe/model/objective/iteration_record.h"

namespace trilobe {

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
