// Texels of known materials, for trilobe.fit_texels.

#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>

#include <algorithm>
#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "fit_module.h"
#include "named_values.h"
#include "owned_array.h"
#include "trilobe/core/system/parallel.h"
#include "trilobe/model/objective/weighting.h"
#include "trilobe/solvers/texel_solver.h"

namespace nb = nanobind;

namespace trilobe::python {
namespace {

using Directions = nb::ndarray<const double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using Texels = nb::ndarray<const double, nb::shape<-1, -1, 3>, nb::c_contig, nb::device::cpu>;

// Texels of known materials in known directions.
class SharedTexels {
 public:
  // `lobes`: values of each material, [materials][samples]. `wi` and `wo`: unit vectors.
  SharedTexels(const Texels& lobes, const Directions& wi, const Directions& wo,
               const NamedValues& options)
      : solver_(CosinesOf(wi, wo), ByMaterial(lobes),
                FindWeighting(OptionOf<std::string>(options, "weighting", "a name")),
                OptionOf<bool>(options, "coloured", "True or False")),
        threads_(ThreadsOf(options)) {}

  // Rows of d, s of each material, E, and E of the black texel.
  NumpyArray<double> Solve(const Texels& rho) const {
    const size_t count = rho.shape(0), colours = 1 + solver_.num_materials();
    const size_t width = 3 * colours + 2;
    std::vector<double> rows(count * width);
    ForTexels(rho, [&](size_t texel, std::span<const Rgb> values) {
      double* const row = &rows[texel * width];
      const TexelSolver::Fit fit = solver_.Solve(values, {reinterpret_cast<Rgb*>(row), colours});
      row[width - 2] = fit.objective;
      row[width - 1] = fit.measured_energy;
    });
    return OwnedArray(std::move(rows), {count, width});
  }

  // The weights of their samples.
  NumpyArray<double> Weigh(const Texels& rho) const {
    const size_t count = rho.shape(0), samples = rho.shape(1);
    std::vector<double> weights(count * samples * 3);
    ForTexels(rho, [&](size_t texel, std::span<const Rgb> values) {
      Rgb* const row = reinterpret_cast<Rgb*>(weights.data()) + texel * samples;
      solver_.Weigh(values, {row, samples});
    });
    return OwnedArray(std::move(weights), {count, samples, size_t{3}});
  }

 private:
  static std::vector<Cosines> CosinesOf(const Directions& wi, const Directions& wo) {
    if (wi.shape(0) != wo.shape(0)) {
      throw Error(ErrorKind::kMismatch, "wi and wo differ in length").About("wi, wo");
    }
    std::vector<Cosines> cosines(wi.shape(0));
    for (size_t j = 0; j < cosines.size(); ++j) {
      cosines[j] = {.i = std::min(wi(j, 2), 1.0), .o = std::min(wo(j, 2), 1.0)};
    }
    return cosines;
  }

  static std::vector<std::vector<Rgb>> ByMaterial(const Texels& lobes) {
    std::vector<std::vector<Rgb>> values;
    for (size_t b = 0; b < lobes.shape(0); ++b) {
      const std::span<const Rgb> of = ValuesOf(lobes, b);
      values.emplace_back(of.begin(), of.end());
    }
    return values;
  }

  // The samples of a texel, or of a material.
  static std::span<const Rgb> ValuesOf(const Texels& array, size_t row) {
    static_assert(sizeof(Rgb) == 3 * sizeof(double));
    const size_t samples = array.shape(1);
    return {reinterpret_cast<const Rgb*>(array.data()) + row * samples, samples};
  }

  // Calls work(texel, its values) for all.
  template <typename Work>
  void ForTexels(const Texels& rho, const Work& work) const {
    constexpr size_t kBlock = 256;
    const size_t count = rho.shape(0);
    const nb::gil_scoped_release released;
    ParallelFor(static_cast<int>((count + kBlock - 1) / kBlock), threads_, [&](int block) {
      const size_t begin = block * kBlock;
      for (size_t texel = begin; texel < std::min(begin + kBlock, count); ++texel) {
        work(texel, ValuesOf(rho, texel));
      }
    });
  }

  TexelSolver solver_;
  int threads_;
};

}  // namespace

void BindTexels(nb::module_* module) {
  module->attr("MAX_TEXEL_MATERIALS") = kMaxTexelMaterials;
  nb::class_<SharedTexels>(*module, "SharedTexels", "Texels of known materials.")
      .def(nb::init<const Texels&, const Directions&, const Directions&, const NamedValues&>(),
           nb::arg("lobes"), nb::arg("wi"), nb::arg("wo"), nb::arg("options"))
      .def("solve", &SharedTexels::Solve, nb::arg("rho"))
      .def("weigh", &SharedTexels::Weigh, nb::arg("rho"));
}

}  // namespace trilobe::python
