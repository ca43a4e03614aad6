#ifndef TRILOBE_IO_PLOT_PAIR_H_
#define TRILOBE_IO_PLOT_PAIR_H_

#include <string>
#include <vector>

#include "trilobe/appearance/appearance.h"

namespace trilobe {

// Pictures of a measured and a fitted material, of a sphere or of what fills the picture.
struct PairPicture {
  std::string source;
  // Texts left of the squares that the pictures consist of, one above another; or none, of one.
  std::vector<std::string> rows;
  ImagePair counted;  // what is compared
  ImagePair whole;    // what is shown, of the same size
};

// Draws them side by side, exposed alike, and how far apart they are to the eye; the options say
// what they were lit by.
void DrawImagePair(const PairPicture& picture, const AppearanceOptions& options,
                   const std::string& path);

// Writes the two alone, without text.
void WriteImagePair(const PairPicture& picture, const std::string& path);

// Writes one alone, exposed by itself.
void WriteImage(const RenderedImage& image, const std::string& path);

}  // namespace trilobe

#endif  // TRILOBE_IO_PLOT_PAIR_H_
