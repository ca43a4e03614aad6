#ifndef TRILOBE_IO_PICTURES_PLOT_FACTORS_H_
#define TRILOBE_IO_PICTURES_PLOT_FACTORS_H_

#include <string>
#include <vector>

#include "trilobe/io/formats/model_file.h"
#include "trilobe/model/objective/lobe_light.h"

namespace trilobe {

// A panel of a picture: title, commands before `plot`, and arguments of `plot`.
struct Panel {
  std::string title;  // enhanced
  std::string setup;
  std::string plot;
};

// Rows of panels, each row as wide as the canvas.
class PanelRows {
 public:
  explicit PanelRows(int width) : width_(width) {}

  // Adds panels in rows of up to `columns`. Empty panels are omitted.
  void Add(std::vector<Panel> panels, int columns);

  int height() const;
  // The script. The first row begins `top` pixels below the top of a canvas of height `canvas`.
  // Legends are above the panels.
  std::string Script(int top, int canvas) const;

 private:
  int width_;
  std::vector<std::vector<Panel>> rows_;
};

// Commands that place the next plot at pixel (x, y) from the top left of the canvas.
std::string PanelMargins(int x, int y, int width, int height, int canvas_width, int canvas_height);

// Whether the s of a lobe is 0.
bool ReflectsNothing(const FactorModel& model, int lobe);

// The lobe and channel of a table; 0 if it serves all of them.
struct TableOwner {
  int lobe = 0, channel = 0;
};
TableOwner OwnerOf(const ModelSpec& spec, Factor factor, int index);

// "lobe 1", "lobe 1 (nearly diffuse)", "lobe 2, red (s = 0)", "all lobes".
std::string TableName(const FactorModel& model, const LobeLight& light, Factor factor, int index);

// All tables of a factor as curves in one panel, or in one panel per lobe if they differ by lobe
// and by channel. The axis covers observed entries through which light goes; others are dotted, and
// left out above it, where the legend says up to which value. Empty if there is no curve.
std::vector<Panel> CurvePanels(const ModelFile& file, const LobeLight& light, Factor factor);

// Bars of the albedo of the diffuse term and of each lobe, by channel, labelled with their values.
Panel AlbedoPanel(const LobeLight& light);

// DrawFactors for an anisotropic model.
void DrawPolarFactors(const ModelFile& file, const LobeLight& light, const std::string& path);

}  // namespace trilobe

#endif  // TRILOBE_IO_PICTURES_PLOT_FACTORS_H_
