#ifndef TRILOBE_IO_PICTURES_PLOT_PANELS_H_
#define TRILOBE_IO_PICTURES_PLOT_PANELS_H_

#include <span>
#include <string>
#include <vector>

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

}  // namespace trilobe

#endif  // TRILOBE_IO_PICTURES_PLOT_PANELS_H_
