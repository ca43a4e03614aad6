#ifndef TRILOBE_IO_PICTURES_PLOT_PAIR_H_
#define TRILOBE_IO_PICTURES_PLOT_PAIR_H_

#include <string>
#include <vector>

#include "trilobe/model/appearance/appearance.h"

namespace trilobe {

// Pictures of a measured and a fitted material, of a sphere or of what fills the picture.
struct PairPicture {
  std::string source;
  // Texts left of the squares that the pictures consist of, one above another; or none, of one.
  std::vector<std::string> rows;
  SphereError error;    // the figures below
  std::string subject;  // what they are of
  ImagePairs images;    // of these the map of differences shows what was measured
};

// Draws them side by side, exposed alike, and how far apart they are to the eye, in colours that
// mean the same in all pictures; the options say what they were lit by.
void DrawImagePair(const PairPicture& picture, const AppearanceOptions& options,
                   const std::string& path);

// Writes the two alone, without text.
void WriteImagePair(const ImagePairs& images, const std::string& path);

// Writes one alone, so many pixels wide, exposed by itself.
void WriteImage(const RenderedImage& image, int size, const std::string& path);

}  // namespace trilobe

#endif  // TRILOBE_IO_PICTURES_PLOT_PAIR_H_
