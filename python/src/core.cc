// The module trilobe._core: model files and their evaluation. It needs trilobe::evaluate alone, so
// that it holds no GPL code. The Python above it (trilobe/brdf.py) checks and broadcasts arrays;
// what comes here is already [n][3] beside each other in memory, or one row that counts for all.

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "direction_rows.h"
#include "error_translator.h"
#include "named_values.h"
#include "owned_array.h"
#include "trilobe/core/base/error.h"
#include "trilobe/model/bsdf.h"
#include "trilobe/model/load_model.h"
#include "trilobe/model/read_model.h"

namespace nb = nanobind;

namespace trilobe::python {
namespace {

template <typename Real>
using Output = nb::ndarray<Real, nb::ndim<2>, nb::c_contig, nb::device::cpu>;

template <typename Real>
void CheckWidth(const Output<Real>& out, size_t width) {
  if (out.shape(1) != width) {
    throw Error(ErrorKind::kMismatch, "an array of results has the wrong width")
        .About("out", out.shape(1));
  }
}

// A model file, and what evaluates it, made when it is first asked for.
class Material {
 public:
  Material(const nb::bytes& text, const std::string& source)
      : file_(ParseModel({text.c_str(), text.size()}, source)) {
    CheckParameters(file_.model);
  }
  Material(const Material&) = delete;
  Material& operator=(const Material&) = delete;

  const ModelFile& file() const { return file_; }
  const ModelSpec& spec() const { return file_.model.spec(); }

  template <typename Real>
  const Bsdf<Real>& Of() const {
    auto& made = [this]() -> auto& {
      if constexpr (std::is_same_v<Real, float>) {
        return single_;
      } else {
        return double_;
      }
    }
    ();
    std::call_once(made.once, [&] { made.bsdf = std::make_unique<Bsdf<Real>>(file_.model); });
    return *made.bsdf;
  }

 private:
  template <typename Real>
  struct Made {
    std::once_flag once;
    std::unique_ptr<const Bsdf<Real>> bsdf;
  };

  ModelFile file_;
  mutable Made<float> single_;
  mutable Made<double> double_;
};

// Calls what(begin, size) for blocks of the rows, which are small enough to stay near.
constexpr size_t kBlock = 256;
template <typename What>
void ForBlocks(size_t count, const What& what) {
  for (size_t begin = 0; begin < count; begin += kBlock) {
    what(begin, std::min(kBlock, count - begin));
  }
}

// Some rows as they lie side by side.
template <typename Row>
using Block = std::array<Row, kBlock>;
template <typename From, typename Row>
std::span<const Row> Gather(const From& rows, size_t begin, size_t size, Block<Row>* block) {
  for (size_t k = 0; k < size; ++k) (*block)[k] = rows[begin + k];
  return {block->data(), size};
}

template <typename Real>
void Eval(const Material& material, const Input<Real>& wi, const Input<Real>& wo,
          const Output<Real>& out, bool cosine) {
  const size_t count = out.shape(0);
  CheckWidth(out, kChannels);
  const Directions<Real> in(wi, count, "wi"), away(wo, count, "wo");
  Real* next = out.data();
  const nb::gil_scoped_release released;
  const Bsdf<Real>& bsdf = material.Of<Real>();
  Block<std::array<Real, 3>> incident, outgoing;
  Block<typename Bsdf<Real>::Colour> values;
  ForBlocks(count, [&](size_t begin, size_t size) {
    bsdf.Values(Gather(in, begin, size, &incident), Gather(away, begin, size, &outgoing),
                {values.data(), size});
    for (size_t k = 0; k < size; ++k) {
      const Real scale = cosine ? std::max(outgoing[k][2], Real{0}) : Real{1};
      const Real none = NoneOf(incident[k], outgoing[k]);
      for (const Real f : values[k]) *next++ = f * scale + none;
    }
  });
}

// Evaluates a spectral model: each row of `out` has a value for each wavelength.
void Spectrum(const Material& material, const Input<double>& wi, const Input<double>& wo,
              const Output<double>& out) {
  if (!material.file().spectral) {
    throw Error(ErrorKind::kUnsupported, "the model has no wavelengths; eval gives its colour")
        .About("spectral");
  }
  const SpectralModel& model = *material.file().spectral;
  const size_t count = out.shape(0);
  CheckWidth(out, model.wavelengths().size());
  const Directions<double> in(wi, count, "wi"), away(wo, count, "wo");
  double* next = out.data();
  const nb::gil_scoped_release released;
  for (size_t k = 0; k < count; ++k) {
    const auto i = in[k], o = away[k];
    const double none = NoneOf(i, o);
    if (std::isnan(none)) {
      next = std::fill_n(next, model.wavelengths().size(), none);
    } else {
      next = std::ranges::copy(Evaluate(model, {i, o}), next).out;
    }
  }
}

// Rows of (1 + lobes) colours: the diffuse term, then each lobe.
template <typename Real>
void EvalComponents(const Material& material, const Input<Real>& wi, const Input<Real>& wo,
                    const Output<Real>& out) {
  const size_t count = out.shape(0);
  const int lobes = material.spec().lobes;
  CheckWidth(out, static_cast<size_t>((1 + lobes) * kChannels));
  const Directions<Real> in(wi, count, "wi"), away(wo, count, "wo");
  Real* next = out.data();
  const nb::gil_scoped_release released;
  const Bsdf<Real>& bsdf = material.Of<Real>();
  std::array<typename Bsdf<Real>::Colour, kMaxLobes> values{};
  for (size_t k = 0; k < count; ++k) {
    const auto i = in[k], o = away[k];
    const bool above = i[2] > 0 && o[2] > 0;
    const Real none = NoneOf(i, o);
    bsdf.LobeValues(i, o, values.data());
    for (const Real d : bsdf.diffuse()) *next++ = (above ? d : Real{0}) + none;
    for (int m = 0; m < lobes; ++m) {
      for (const Real f : values[m]) *next++ = f + none;
    }
  }
}

template <typename Real>
void Pdf(const Material& material, const Input<Real>& wi, const Input<Real>& wo,
         const Output<Real>& out) {
  const size_t count = out.shape(0);
  CheckWidth(out, 1);
  const Directions<Real> in(wi, count, "wi"), away(wo, count, "wo");
  const nb::gil_scoped_release released;
  const Bsdf<Real>& bsdf = material.Of<Real>();
  Block<std::array<Real, 3>> incident, outgoing;
  ForBlocks(count, [&](size_t begin, size_t size) {
    Real* const pdfs = out.data() + begin;
    bsdf.Pdfs(Gather(in, begin, size, &incident), Gather(away, begin, size, &outgoing),
              {pdfs, size});
    for (size_t k = 0; k < size; ++k) pdfs[k] += NoneOf(incident[k], outgoing[k]);
  });
}

// Rows of wo, pdf and weight: 7 numbers.
template <typename Real>
void Sample(const Material& material, const Input<Real>& wi, const Input<Real>& u,
            const Output<Real>& out) {
  const size_t count = out.shape(0);
  CheckWidth(out, 7);
  const Directions<Real> in(wi, count, "wi");
  const Rows<Real, 2> numbers(u, count, "u");
  CheckRandom(u);
  Real* next = out.data();
  const nb::gil_scoped_release released;
  const Bsdf<Real>& bsdf = material.Of<Real>();
  Block<std::array<Real, 3>> incident;
  Block<std::array<Real, 2>> pairs;
  Block<typename Bsdf<Real>::Sample> samples;
  ForBlocks(count, [&](size_t begin, size_t size) {
    bsdf.SamplesOfWo(Gather(in, begin, size, &incident), Gather(numbers, begin, size, &pairs),
                     {samples.data(), size});
    for (size_t k = 0; k < size; ++k) {
      const Real none = NoneOf(incident[k]);
      for (const Real x : samples[k].wo) *next++ = x + none;
      *next++ = samples[k].pdf + none;
      for (const Real x : samples[k].weight) *next++ = x + none;
    }
  });
}

template <typename Real>
void Albedo(const Material& material, const Input<Real>& wi, const Output<Real>& out) {
  const size_t count = out.shape(0);
  CheckWidth(out, kChannels);
  const Directions<Real> in(wi, count, "wi");
  Real* next = out.data();
  const nb::gil_scoped_release released;
  const Bsdf<Real>& bsdf = material.Of<Real>();
  for (size_t k = 0; k < count; ++k) {
    const auto w = in[k];
    const Real none = NoneOf(w);
    for (const Real a : bsdf.Albedo(w)) *next++ = a + none;
  }
}

// Bsdf::half_vectors(): what it draws by, for renderers that draw by tables of their own.
NamedValues HalfVectorsOf(const Material& material) {
  const auto& bsdf = [&]() -> const Bsdf<double>& {
    const nb::gil_scoped_release released;
    return material.Of<double>();
  }();
  const HalfVectorTable<double>& table = bsdf.half_vectors();
  const size_t rings = table.theta_i().size(), phis = table.num_phi_i(), rows = table.y().size();
  const size_t columns = table.num_s();
  NamedValues dict;
  dict["theta_i"] = OwnedArray(std::vector<double>(table.theta_i()), {rings});
  dict["y"] = OwnedArray(std::vector<double>(table.y()), {rows});
  dict["values"] = OwnedArray(std::vector<float>(table.values()), {rings, phis, rows, columns});
  dict["of_row"] = OwnedArray(std::vector<double>(table.of_row()), {rings, phis, rows});
  dict["cumulated"] = OwnedArray(std::vector<double>(table.cumulated()), {rings, phis, rows});
  return dict;
}

Factor FactorOf(const std::string& name) {
  for (const Factor factor : kFactors) {
    if (name == FactorName(factor)) return factor;
  }
  throw Error(ErrorKind::kUnknown, "there is no factor '" + name + "'; there are D, F and G")
      .About("factor", name);
}

const char* RuleName(Axis::Rule rule) {
  switch (rule) {
    case Axis::Rule::kRootTheta:
      return "root_theta";
    case Axis::Rule::kTheta:
      return "theta";
    case Axis::Rule::kSpline:
      return "spline";
    case Axis::Rule::kPolar:
      break;
  }
  return "polar";
}

NamedValues AxisOf(const Material& material, const std::string& factor) {
  const ModelSpec& spec = material.spec();
  const Axis& axis = spec.axis(FactorOf(factor));
  const TableSharing& sharing = spec.sharing(FactorOf(factor));
  NamedValues dict;
  dict["rule"] = RuleName(axis.rule);
  dict["size"] = axis.size;
  dict["per_lobe"] = sharing.per_lobe;
  dict["per_channel"] = sharing.per_channel;
  if (axis.polar()) {
    dict["theta_nodes"] = axis.theta;
    dict["phi_nodes"] = axis.phi_nodes;
  } else {
    std::vector<double> theta;
    for (int entry = 0; entry < axis.size; ++entry) theta.push_back(axis.Theta(entry));
    dict["theta"] = theta;
  }
  return dict;
}

NumpyArray<double> TablesOf(const Material& material, const std::string& name) {
  const FactorModel& model = material.file().model;
  const Factor factor = FactorOf(name);
  std::vector<double> values;
  const size_t tables = model.spec().lobes > 0 ? model.spec().num_tables(factor) : 0;
  const size_t size = model.spec().table_size(factor);
  for (size_t k = 0; k < tables; ++k) {
    const auto table = model.table(factor, static_cast<int>(k));
    values.insert(values.end(), table.begin(), table.end());
  }
  return OwnedArray(std::move(values), {tables, size});
}

NumpyArray<uint8_t> UnobservedOf(const Material& material, const std::string& name) {
  const FactorModel& model = material.file().model;
  const Factor factor = FactorOf(name);
  const size_t tables = model.spec().lobes > 0 ? model.spec().num_tables(factor) : 0;
  const size_t size = model.spec().table_size(factor);
  std::vector<bool> all = material.file().unobserved;
  all.resize(model.parameters().size(), false);
  std::vector<uint8_t> marks;
  for (size_t k = 0; k < tables; ++k) {
    const auto begin = all.begin() + model.TableOffset(factor, static_cast<int>(k));
    marks.insert(marks.end(), begin, begin + static_cast<std::ptrdiff_t>(size));
  }
  return OwnedArray(std::move(marks), {tables, size});
}

template <typename Real>
void BindEvaluation(nb::class_<Material>* material) {
  const auto released = nb::arg().noconvert();
  material->def("eval", &Eval<Real>, released, released, released, nb::arg())
      .def("eval_components", &EvalComponents<Real>, released, released, released)
      .def("pdf", &Pdf<Real>, released, released, released)
      .def("sample", &Sample<Real>, released, released, released)
      .def("albedo", &Albedo<Real>, released, released);
}

}  // namespace

NB_MODULE(_core, m) {            // NOLINT(performance-unnecessary-value-param): nanobind's
  nb::set_leak_warnings(false);  // objects may live when the interpreter ends
  TranslateErrors();
  nb::class_<Material> material(m, "Material", "A model file, prepared for evaluation.");
  material.def(nb::init<const nb::bytes&, const std::string&>(), nb::arg("text"), nb::arg("source"))
      .def("half_vectors", &HalfVectorsOf)
      .def_prop_ro("lobes", [](const Material& self) { return self.spec().lobes; })
      .def_prop_ro("anisotropic", [](const Material& self) { return self.spec().anisotropic(); })
      .def("d",
           [](const Material& self) {
             const auto d = self.file().model.d();
             return OwnedArray(std::vector<double>(d.begin(), d.end()), {d.size()});
           })
      .def("s",
           [](const Material& self) {
             std::vector<double> values;
             const size_t lobes = self.spec().lobes;
             for (size_t m = 0; m < lobes; ++m) {
               const auto s = self.file().model.s(static_cast<int>(m));
               values.insert(values.end(), s.begin(), s.end());
             }
             return OwnedArray(std::move(values), {lobes, size_t{kChannels}});
           })
      .def_prop_ro("stretch",
                   [](const Material& self) {
                     std::vector<std::pair<double, double>> of_lobes;
                     for (int m = 0; m < self.spec().lobes; ++m) {
                       const Stretch& stretch = self.spec().stretches.of(m);
                       of_lobes.emplace_back(stretch.along, stretch.across);
                     }
                     return of_lobes;
                   })
      .def_prop_ro("wavelengths",
                   [](const Material& self) {
                     const auto& spectral = self.file().spectral;
                     return spectral ? spectral->wavelengths() : std::vector<double>();
                   })
      .def("spectrum", &Spectrum)
      .def("axis", &AxisOf, nb::arg("factor"))
      .def("tables", &TablesOf, nb::arg("factor"))
      .def("unobserved", &UnobservedOf, nb::arg("factor"));
  m.def("material_names", [] {
    std::vector<std::string> names;
    for (const std::string_view name : MaterialNames()) names.emplace_back(name);
    return names;
  });
  m.def(
      "material_text", [](const std::string& path) { return std::string(MaterialText(path)); },
      nb::arg("path"));
  BindEvaluation<float>(&material);
  BindEvaluation<double>(&material);
}

}  // namespace trilobe::python
