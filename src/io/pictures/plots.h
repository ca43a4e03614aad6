#ifndef TRILOBE_IO_PICTURES_PLOTS_H_
#define TRILOBE_IO_PICTURES_PLOTS_H_

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "model/appearance/picture_data.h"
#include "trilobe/io/model_files/model_file.h"
#include "trilobe/model/appearance/appearance.h"
#include "trilobe/model/measurement/brdf_table.h"
#include "trilobe/model/measurement/measurement.h"
#include "trilobe/model/objective/iteration_record.h"

namespace trilobe {

// Pictures of a fit as PNG files, drawn by gnuplot. All throw Error when gnuplot is missing or
// fails or the file cannot be written; the same input gives the same picture. Tables that are
// compared must have the same grid.

// The factors as in the paper's Fig. 5: D over theta_h, F over theta_d, G over theta, and the
// coefficients d and s. Entries that no data touched are hollow; lobes with s = 0 are not drawn,
// and the legend says so. Of an anisotropic model D and G of each lobe are maps, theta outwards and
// phi around.
void DrawFactors(const ModelFile& file, const std::string& path);

// Measured BRDF (points) and fitted one (lines) over theta_h, at five theta_d and phi_d = 90
// degrees, one panel a channel.
void DrawSlices(const BrdfTable& measured, const BrdfTable& fitted, const std::string& path);

// The same at nodes, in two rows: over phi_i at several theta_i, seen along the normal, as if the
// sample were turned; and over phi_o at several theta_o, lit from phi_i = 0 at a middling theta_i.
void DrawSlices(const NodeBrdf& measured, const SphericalBrdf& fitted, const std::string& path);

// The same of scattered samples on no grid, in the plane of incidence: over theta_o, on the light's
// side below 0, at a few theta_i that were measured, as samples up to a few degrees off show it;
// and whether there are enough of them.
bool HasSlices(const Measurement& scattered);
void DrawSlices(const Measurement& scattered, const SphericalBrdf& fitted, const std::string& path);

// Measured and fitted material on a sphere under the environment of the options, all of it, and how
// far apart they are to the eye; the figures are those of the spheres that CompareAppearance
// compares, found anew unless they are given.
void DrawSpheres(const BrdfTable& measured, const AngularBrdf& fitted, const std::string& path,
                 const AppearanceOptions& options, const std::optional<SphereError>& error = {});

void DrawSpheres(const NodeBrdf& measured, const SphericalBrdf& fitted, const std::string& path,
                 const AppearanceOptions& options, const std::optional<SphereError>& error = {});

// The fitted one alone, without text, where no measurement can be shown beside it.
void DrawFittedSphere(const Material& fitted, const std::string& path,
                      const AppearanceOptions& options);

// The same on a draped cloth (ViewCloth), lit along its thread and across it.
void DrawCloth(const NodeBrdf& measured, const SphericalBrdf& fitted, const std::string& path,
               const AppearanceOptions& options);

// The two spheres alone, side by side, without text.
void WriteSpherePair(const BrdfTable& measured, const AngularBrdf& fitted, const std::string& path,
                     const AppearanceOptions& options);
void WriteSpherePair(const PictureData& measured, const Material& fitted, const std::string& path,
                     const AppearanceOptions& options);

// Which directions were measured: for each degree of theta_i and theta_o the share of the bins
// above the surface that is valid. Dashed: table.max_theta.
void DrawMeasured(const BrdfTable& table, const std::string& path);

// Scattered samples at the directions of the UTIA database, all pairs of them: rho cos theta_i cos
// theta_o, the mean of the channels, as UTIA shows its materials. Throws Error where a sample is at
// another direction.
void DrawPairs(const Measurement& scattered, const std::string& path);

// E over iterations and over seconds; iterations after which the filter ran, and those whose step
// was taken back, are marked. Throws Error when the trace is empty.
void DrawTrace(std::span<const IterationRecord> trace, const std::string& title,
               const std::string& path);

// Two models of one material: what each takes, and how well it fits.
struct TradeOff {
  struct End {
    double bytes = 0, core_seconds = 0, psnr_db = 0;
  };
  std::string name;
  End full, pruned;
};

// A row a material, with both models on axes of bytes, time and PSNR. Throws Error when there is
// no model.
void DrawTradeOff(std::span<const TradeOff> models, const std::string& path);

// Throws Error where a model's values, or E in a trace, are beyond 1e200, which no axis shows. All
// that draw them do.
void CheckDrawable(const ModelFile& file, std::span<const IterationRecord> trace);

// All pictures that the inputs allow, as factors.png, slices.png, spheres.png, cloth.png and
// trace.png in an existing folder: cloth needs data at nodes, trace needs records. Of isotropic
// scattered samples spheres.png shows a table of them (TableOfSamples) where they are dense;
// without data, or where samples are few, it is of the fit alone. `sphere`: CompareAppearance's, if
// that is known. Returns their paths.
std::vector<std::string> DrawPictures(const ModelFile& file, const PictureData& measured,
                                      std::span<const IterationRecord> trace,
                                      const std::string& folder,
                                      const AppearanceOptions& appearance,
                                      const std::optional<SphereError>& sphere = {});

// Names of all of them.
inline constexpr const char* kPictureNames[] = {"factors.png", "slices.png", "spheres.png",
                                                "cloth.png", "trace.png"};

}  // namespace trilobe

#endif  // TRILOBE_IO_PICTURES_PLOTS_H_
