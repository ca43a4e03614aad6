#ifndef TRILOBE_IO_PICTURES_PLOTS_H_
#define TRILOBE_IO_PICTURES_PLOTS_H_

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/pictures/words.h"
#include "model/appearance/picture_data.h"
#include "trilobe/io/formats/model_file.h"
#include "trilobe/model/appearance/appearance.h"
#include "trilobe/model/measurement/brdf_table.h"
#include "trilobe/model/measurement/measurement.h"
#include "trilobe/model/objective/iteration_record.h"
#include "trilobe/model/spectral_model.h"

namespace trilobe {

// Pictures of a fit as PNG files, drawn by gnuplot. All functions throw Error if gnuplot is missing
// or fails or the file cannot be written. The same input gives the same picture. Tables that are
// compared must have the same grid. Use:
//
//   DrawFactors(ReadModel("plastic.json"), "factors.png");

// The factors as in the paper's Fig. 5: D over theta_h, F over theta_d, G over theta, and the
// coefficients d and s. Unobserved entries are hollow. Lobes with s = 0 are omitted and the legend
// says so. For an anisotropic model, D and G of each lobe are polar maps over theta and phi.
void DrawFactors(const ModelFile& file, const std::string& path);

// Measured BRDF (points) and fitted BRDF (lines) over theta_h, at five theta_d and phi_d = 90
// degrees, one panel per channel.
void DrawSlices(const BrdfTable& measured, const BrdfTable& fitted, const std::string& path);

// The same for data at nodes, in two rows: over phi_i at several theta_i, viewed along the normal
// (a rotating sample); and over phi_o at several theta_o, lit from phi_i = 0 at a medium theta_i.
void DrawSlices(const NodeBrdf& measured, const SphericalBrdf& fitted, const std::string& path);

// The same for scattered samples on no grid, in the plane of incidence: over theta_o (negative on
// the light's side) at a few measured theta_i, from samples up to a few degrees off the plane.
// HasSlices: whether there are enough of them.
bool HasSlices(const Measurement& scattered);
void DrawSlices(const Measurement& scattered, const SphericalBrdf& fitted, const std::string& path);

// Spheres of the measured and the fitted material under the environment of the options, and their
// visible difference. The numbers are `error`, or else CompareAppearance is run.
void DrawSpheres(const BrdfTable& measured, const AngularBrdf& fitted, const std::string& path,
                 const AppearanceOptions& options, const std::optional<SphereError>& error = {});

void DrawSpheres(const NodeBrdf& measured, const SphericalBrdf& fitted, const std::string& path,
                 const AppearanceOptions& options, const std::optional<SphereError>& error = {});

// The fitted sphere alone, without text.
void DrawFittedSphere(const Material& fitted, const std::string& path,
                      const AppearanceOptions& options);

// Measured and fitted material on a draped cloth (ViewCloth), lit along its thread and across it.
void DrawCloth(const NodeBrdf& measured, const SphericalBrdf& fitted, const std::string& path,
               const AppearanceOptions& options);

// The two spheres side by side, twice as wide as options.size, with a word below each. Needs no
// gnuplot.
struct PairWords {
  Word left = Word::kMeasured, right = Word::kFitted;
};
void WriteSpherePair(const BrdfTable& measured, const AngularBrdf& fitted, const std::string& path,
                     const AppearanceOptions& options, const PairWords& words = {});
void WriteSpherePair(const PictureData& measured, const Material& fitted, const std::string& path,
                     const AppearanceOptions& options, const PairWords& words = {});

// The same without words, as the bytes of a PNG file, options.size pixels wide each; of the fitted
// one alone if `measured` is empty. For a page.
std::string PngOfSpheres(const PictureData& measured, const Material& fitted,
                         const AppearanceOptions& options);

// Coverage: for each degree of theta_i and theta_o the valid share of the bins above the surface.
// The dashed line is table.max_theta.
void DrawMeasured(const BrdfTable& table, const std::string& path);

// Scattered samples at all pairs of directions of the UTIA database: rho cos theta_i cos theta_o,
// mean of the channels, as UTIA shows its materials. Throws Error if a sample is at another
// direction.
void DrawPairs(const Measurement& scattered, const std::string& path);

// Directions of scattered samples: a polar map of wo for each of up to nine theta_i, steps of 5
// degrees, light from the left; the colour is the mean value of the channels.
void DrawDirections(const Measurement& scattered, const std::string& path);

// E over iterations and over seconds. Filtered iterations and rejected steps are marked. Throws
// Error for an empty trace.
void DrawTrace(std::span<const IterationRecord> trace, const std::string& title,
               const std::string& path);

// A spectral model: over wavelength the error of each and the albedo of the diffuse term and of
// each lobe, and over theta_d the F of each, of lobe 1 if lobes differ. relative_error: E over that
// of a black model, [bands].
void DrawBands(const SpectralModel& model, std::span<const double> relative_error,
               const std::string& title, const std::string& path);

// Cost and quality of the full and the pruned model of a material.
struct TradeOff {
  struct End {
    double bytes = 0, core_seconds = 0, psnr_db = 0;
  };
  std::string name;
  End full, pruned;
};

// One row per material, with both models on axes of bytes, time and PSNR. Throws Error for an empty
// list.
void DrawTradeOff(std::span<const TradeOff> models, const std::string& path);

// Throws Error if a value of the model or an E of the trace exceeds 1e200, which no axis can show.
// The functions that draw them call it.
void CheckDrawable(const ModelFile& file, std::span<const IterationRecord> trace);

// Draws all pictures that the inputs allow into an existing folder and returns their paths:
// factors.png, slices.png, spheres.png, cloth.png (needs data at nodes) and trace.png (needs
// records). For dense isotropic scattered samples spheres.png shows a table of them
// (TableOfSamples); without data or with few samples, only the fit. `sphere`: the result of
// CompareAppearance, if known.
std::vector<std::string> DrawPictures(const ModelFile& file, const PictureData& measured,
                                      std::span<const IterationRecord> trace,
                                      const std::string& folder,
                                      const AppearanceOptions& appearance,
                                      const std::optional<SphereError>& sphere = {});

// File names that DrawPictures may write.
inline constexpr const char* kPictureNames[] = {"factors.png", "slices.png", "spheres.png",
                                                "cloth.png", "trace.png"};

}  // namespace trilobe

#endif  // TRILOBE_IO_PICTURES_PLOTS_H_
