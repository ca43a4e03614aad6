#ifndef TRILOBE_IO_PICTURES_GNUPLOT_H_
#define TRILOBE_IO_PICTURES_GNUPLOT_H_

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace trilobe {

// Palette for colour-blind readers (Okabe and Ito 2008), as gnuplot colour strings.
inline constexpr const char* kOkabeIto[] = {"#E69F00", "#56B4E9", "#009E73", "#F0E442",
                                            "#0072B2", "#D55E00", "#CC79A7", "#000000"};
// Colours of the channels R, G, B and of up to eight lobes, seen on white and on black; those of
// web/plots.js are the same.
inline constexpr const char* kChannelColors[] = {"#D55E00", "#009E73", "#0072B2"};
inline constexpr const char* kLobeColors[] = {"#E69F00", "#56B4E9", "#CC79A7", "#8E6BBF",
                                              "#8C6D31", "#23939C", "#7D7D7D", "#A8A800"};

// Text as a gnuplot string literal. Quotes become typographic ones; control characters and invalid
// UTF-8 are replaced. Use it with `noenhanced` for text of a user.
std::string GnuplotQuote(std::string_view text);

// The same for the title of a picture of `width` pixels, with the largest font up to `size` that
// fits. A very long title is cut.
std::string GnuplotTitle(std::string_view text, int width, int size);

// A number in gnuplot syntax, independent of the locale. Numbers that are not finite make a gap.
std::string GnuplotNumber(double x);

// A named block of inline data, `$name << EOD`, for `plot $name using ...`. [rows][columns]
std::string GnuplotData(std::string_view name, std::span<const std::vector<double>> rows);

// Range of a logarithmic axis for the positive `values`, at most `decades` below the largest. Never
// empty.
struct AxisRange {
  double low = 0, high = 1;
};
AxisRange LogRange(std::span<const double> values, double decades);
// The same for `set yrange`: "[0.01:20]".
std::string GnuplotLogRange(std::span<const double> values, double decades);
// Tics of such an axis ('x' or 'y') and their format: powers of ten, and also 2 and 5 times these
// if one per decade is too few.
std::string LogTics(const AxisRange& range, char axis);

// Whether `gnuplot` is on the PATH.
bool HaveGnuplot();
// Throws Error, which says what to install, unless HaveGnuplot().
void RequireGnuplot();

// Runs `gnuplot` on a script and atomically writes its PNG picture to `path`. The script may hold
// inline data, also binary. It runs after the common style: a pngcairo terminal of this size in
// pixels, font sizes, light grid. Throws Error if gnuplot is not installed, fails (with its
// message), or exceeds `max_seconds` (its processes are then killed), or if the file cannot be
// written. Pictures here take a second or two.
void DrawPng(const std::string& path, int width, int height, const std::string& script,
             double max_seconds = 120);

// The same as vectors, for print: SVG or PDF by the extension of `path`, which must be one of
// these.
void DrawVectors(const std::string& path, int width, int height, const std::string& script,
                 double max_seconds = 120);

}  // namespace trilobe

#endif  // TRILOBE_IO_PICTURES_GNUPLOT_H_
