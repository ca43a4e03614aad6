#ifndef TRILOBE_IO_PICTURES_GNUPLOT_H_
#define TRILOBE_IO_PICTURES_GNUPLOT_H_

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace trilobe {

// Colours that stay apart for colour-blind readers (Okabe and Ito 2008), as gnuplot colour strings.
inline constexpr const char* kOkabeIto[] = {"#E69F00", "#56B4E9", "#009E73", "#F0E442",
                                            "#0072B2", "#D55E00", "#CC79A7", "#000000"};
// For the channels R, G, B, and for up to eight lobes, from the same palette.
inline constexpr const char* kChannelColors[] = {"#D55E00", "#009E73", "#0072B2"};
inline constexpr const char* kLobeColors[] = {"#000000", "#E69F00", "#56B4E9", "#CC79A7",
                                              "#009E73", "#D55E00", "#0072B2", "#F0E442"};

// Any text as a gnuplot string literal: quotes replaced by typographic ones, control characters and
// broken UTF-8 replaced. Use it with `noenhanced` for text that a user chose.
std::string GnuplotQuote(std::string_view text);

// The same for the title of a picture that is `width` pixels wide, with its font: in letters as
// large as fit, up to `size`; a very long one is cut.
std::string GnuplotTitle(std::string_view text, int width, int size);

// What pictures call a source: "synth:copper", or of a path the name of the file.
std::string PictureName(const std::string& source);

// A number as gnuplot reads it, independent of the locale; one that is not finite makes a gap.
std::string GnuplotNumber(double x);

// A named block of inline data, `$name << EOD`, for `plot $name using ...`. [rows][columns]
std::string GnuplotData(std::string_view name, std::span<const std::vector<double>> rows);

// The ends of a logarithmic axis that holds the positive `values`, but no more than `decades` below
// the largest. Never empty.
struct AxisRange {
  double low = 0, high = 1;
};
AxisRange LogRange(std::span<const double> values, double decades);
// The same for `set yrange`: "[0.01:20]".
std::string GnuplotLogRange(std::span<const double> values, double decades);
// Tics of such an axis, 'x' or 'y', and their format: powers of ten, or also 2 and 5 times these,
// where one a decade would be too few.
std::string LogTics(const AxisRange& range, char axis);

// Whether there is a `gnuplot` on the PATH.
bool HaveGnuplot();
// Throws Error, which says what to install, unless there is.
void RequireGnuplot();

// Runs `gnuplot` on a script and writes the PNG picture that it draws to `path`, as a whole or not
// at all. The script may carry data inline, also binary; it begins in the common style: a pngcairo
// terminal of this size in pixels, font sizes, light grid. Throws Error when gnuplot is not
// installed, when it fails (with its own message), when it takes longer than `max_seconds` (then it
// is ended, and all that it started), or when the file cannot be written. The pictures here take a
// second or two.
void DrawPng(const std::string& path, int width, int height, const std::string& script,
             double max_seconds = 120);

}  // namespace trilobe

#endif  // TRILOBE_IO_PICTURES_GNUPLOT_H_
