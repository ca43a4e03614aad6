#ifndef TRILOBE_IO_PICTURES_PLOT_FACTORS_H_
#define TRILOBE_IO_PICTURES_PLOT_FACTORS_H_

#include <string>
#include <vector>

#include "trilobe/io/model_files/model_file.h"
#include "trilobe/model/lobes/lobe_light.h"

namespace trilobe {

// A panel of a picture: its title, commands that come before `plot`, and what `plot` draws.
struct Panel {
  std::string title;  // enhanced
  std::string setup;
  std::string plot;
};

// Panels below each other, in rows, each row as wide as the canvas.
class PanelRows {
 public:
  explicit PanelRows(int width) : width_(width) {}

  // Up to so many panels in a row; empty ones are left out.
  void Add(std::vector<Panel> panels, int columns);

  int height() const;
  // With their first row's upper end `top` pixels below that of a canvas of that height, each with
  // its legend above it, where no curve can be.
  std::string Script(int top, int canvas) const;

 private:
  int width_;
  std::vector<std::vector<Panel>> rows_;
};

// Commands that put what is plotted next at pixel (x, y) of the canvas, from its top left.
std::string PanelMargins(int x, int y, int width, int height, int canvas_width, int canvas_height);

// Whether the s of a lobe is 0.
bool ReflectsNothing(const FactorModel& model, int lobe);

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
