#ifndef TRILOBE_IO_PICTURES_PLOT_FACTORS_H_
#define TRILOBE_IO_PICTURES_PLOT_FACTORS_H_

#include <string>
#include <vector>

#include "io/pictures/plot_panels.h"
#include "trilobe/io/model_files/model_file.h"
#include "trilobe/model/lobes/lobe_light.h"

namespace trilobe {

// Whether a lobe reflects nothing, as its s is 0.
bool Absent(const FactorModel& model, int lobe);

// Which lobe, or channel, a table belongs to; 0 where it serves them all.
struct TableOwner {
  int lobe = 0, channel = 0;
};
TableOwner OwnerOf(const ModelSpec& spec, Factor factor, int index);

// "lobe 1", "lobe 2, red (s = 0)", "all lobes".
std::string TableName(const FactorModel& model, Factor factor, int index);

// All tables of a factor as curves: in one panel, or in one a lobe where they differ by lobe and by
// channel. An axis holds the entries that matter, those that data were seen of and that light goes
// through; others are dotted, and may leave it. Empty where there is no curve.
std::vector<Panel> CurvePanels(const ModelFile& file, const LobeLight& light, Factor factor);

// Bars of the albedos of the diffuse term and of each lobe, by channel, with their values written
// above.
Panel AlbedoPanel(const LobeLight& light);

// DrawFactors of an anisotropic model.
void DrawPolarFactors(const ModelFile& file, const LobeLight& light, const std::string& path);

}  // namespace trilobe

#endif  // TRILOBE_IO_PICTURES_PLOT_FACTORS_H_
