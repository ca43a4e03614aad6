#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <pugixml.hpp>
#include <string>
#include <vector>

#include "core/base/text.h"
#include "core/files/text_lines.h"
#include "io/formats/optical/klems_basis.h"
#include "io/formats/optical/tensor_tree.h"
#include "io/formats/spectrum.h"
#include "io/formats/text/same_name.h"
#include "trilobe/core/base/error.h"
#include "trilobe/io/formats/measurement_format.h"

namespace trilobe {
namespace {

// A document, with the line of what is wrong in it.
class RadianceXml {
 public:
  RadianceXml(std::string_view bytes, const std::string& source) : bytes_(bytes), source_(source) {
    const pugi::xml_parse_result result = document_.load_buffer(bytes.data(), bytes.size());
    if (!result) {
      FailAt(result.offset, std::string("this is no XML: ") + result.description(),
             ErrorKind::kFormat, "xml", result.description());
    }
  }

  pugi::xml_node root() const { return document_; }
  const std::string& source() const { return source_; }

  [[noreturn]] void Fail(const pugi::xml_node& node, const std::string& problem, ErrorKind kind,
                         std::string_view key, std::string_view value = "") const {
    FailAt(node.offset_debug(), problem, kind, key, value);
  }

  pugi::xml_node Child(const pugi::xml_node& node, const char* name) const {
    if (const pugi::xml_node child = node.child(name)) return child;
    std::string problem = "the file";
    if (node.name()[0] != '\0') problem = std::string("<").append(node.name()).append(">");
    Fail(node,
         problem.append(" has no <")
             .append(name)
             .append(">, which a BSDF of Radiance or WINDOW needs; export it with its values"),
         ErrorKind::kMissing, name);
  }

  // Text of a child without the white space around it.
  std::string_view Text(const pugi::xml_node& node, const char* name) const {
    return Trimmed(Child(node, name).child_value());
  }

  double Number(const pugi::xml_node& node, const char* name) const {
    const std::string_view text = Text(node, name);
    if (const std::optional<double> number = ToNumber(text)) return *number;
    Fail(node.child(name), "<" + std::string(name) + "> is no number", ErrorKind::kFormat, name,
         text);
  }

 private:
  [[noreturn]] void FailAt(ptrdiff_t offset, const std::string& problem, ErrorKind kind,
                           std::string_view key, std::string_view value) const {
    const auto end = static_cast<size_t>(std::max<ptrdiff_t>(offset, 0));
    const auto line = static_cast<int>(std::ranges::count(bytes_.substr(0, end), '\n') + 1);
    throw Error(kind, source_ + ": line " + std::to_string(line) + ": " + problem)
        .At(source_, line)
        .About(key, value);
  }

  std::string_view bytes_;
  std::string source_;
  pugi::xml_document document_;
};

// --- Klems bases ---------------------------------------------------------------------------------

// Reads a basis that a file defines.
KlemsBasis ReadBasis(const RadianceXml& xml, const pugi::xml_node& node) {
  constexpr int kMostPatches = 1 << 14;
  KlemsBasis basis = {.name = std::string(xml.Text(node, "AngleBasisName")), .rings = {}};
  int patches = 0;
  for (const pugi::xml_node& block : node.children("AngleBasisBlock")) {
    const pugi::xml_node bounds = xml.Child(block, "ThetaBounds");
    const double begin = xml.Number(bounds, "LowerTheta"), end = xml.Number(bounds, "UpperTheta");
    const double count = xml.Number(block, "nPhis");
    if (!(begin >= 0 && begin < end && end <= 90)) {
      xml.Fail(bounds, "these bounds of theta are none", ErrorKind::kRange, "ThetaBounds");
    }
    if (!(count >= 1 && count <= kMostPatches - patches) || count != std::floor(count)) {
      xml.Fail(block, "<nPhis> must be a whole number from 1, and all no more than 16384",
               ErrorKind::kRange, "nPhis");
    }
    patches += static_cast<int>(count);
    basis.rings.push_back({begin, end, static_cast<int>(count)});
  }
  return basis;
}

std::vector<PolarAngles> FindPatches(const RadianceXml& xml, const pugi::xml_node& layer,
                                     const pugi::xml_node& block, const char* which) {
  const std::string_view name = xml.Text(block, which);
  for (const KlemsBasis& basis : KlemsBases()) {
    if (SameName(basis.name, name)) return PatchesOf(basis);
  }
  for (const pugi::xml_node& node : layer.child("DataDefinition").children("AngleBasis")) {
    const KlemsBasis basis = ReadBasis(xml, node);
    if (SameName(basis.name, name)) return PatchesOf(basis);
  }
  xml.Fail(block,
           "the basis '" + Printable(name.substr(0, 40)) +
               "' is unknown; Klems full, half and quarter are known, and those that the "
               "file defines",
           ErrorKind::kUnknown, which, name);
}

std::vector<double> ReadMatrix(const RadianceXml& xml, const pugi::xml_node& block, size_t size) {
  std::vector<double> values;
  const pugi::xml_node data = xml.Child(block, "ScatteringData");
  std::string_view rest = data.child_value();
  constexpr std::string_view kBetween = " \t\r\n,";
  for (;;) {
    rest.remove_prefix(std::min(rest.find_first_not_of(kBetween), rest.size()));
    if (rest.empty()) break;
    const std::string_view word = rest.substr(0, rest.find_first_of(kBetween));
    const std::optional<double> value = ToNumber(word);
    if (!value) {
      xml.Fail(data, "'" + Printable(word.substr(0, 40)) + "' is no number", ErrorKind::kFormat,
               "ScatteringData", word);
    }
    values.push_back(*value);
    rest.remove_prefix(word.size());
  }
  if (values.size() != size) {
    xml.Fail(data,
             std::to_string(values.size()) + " values; expected " + std::to_string(size) +
                 ", one per pair of patches",
             ErrorKind::kMismatch, "ScatteringData", std::to_string(values.size()));
  }
  return values;
}

// --- Blocks of data ------------------------------------------------------------------------------

// Blocks of one side, by wavelength ("Visible").
struct ReflectionBlocks {
  const char* side = nullptr;
  std::map<std::string, pugi::xml_node> blocks = {};
};

ReflectionBlocks FindReflection(const RadianceXml& xml, const pugi::xml_node& layer) {
  xml.Child(layer, "WavelengthData");
  for (const char* const side : {"Reflection Front", "Reflection Back"}) {
    ReflectionBlocks found = {.side = side};
    for (const pugi::xml_node& data : layer.children("WavelengthData")) {
      for (const pugi::xml_node& block : data.children("WavelengthDataBlock")) {
        if (!SameName(xml.Text(block, "WavelengthDataDirection"), side)) continue;
        found.blocks.emplace(xml.Text(data, "Wavelength"), block);
      }
    }
    if (!found.blocks.empty()) return found;
  }
  xml.Fail(layer, "it has neither Reflection Front nor Reflection Back, only transmission",
           ErrorKind::kUnsupported, "WavelengthData");
}

// Blocks of the colour: X, Y, Z, or one for all channels; and their kind in words.
struct ColorBlocks {
  std::vector<pugi::xml_node> blocks;
  std::string name;
};

ColorBlocks ChooseColor(const ReflectionBlocks& reflection, bool may_be_xyz) {
  const auto& blocks = reflection.blocks;
  const auto visible = blocks.find("Visible"), x = blocks.find("CIE-X"), z = blocks.find("CIE-Z");
  const auto none = blocks.end();
  if (may_be_xyz && visible != none && x != none && z != none) {
    return {{x->second, visible->second, z->second}, "X, Y, Z relative to white"};
  }
  const auto& [name, block] = *(visible == none ? blocks.begin() : visible);
  return {{block}, name};
}

// Light that comes from the patch of a column (or row) goes opposite, so that the azimuth of the
// light is that of its patch + 180 degrees.
void AddMatrix(const RadianceXml& xml, const pugi::xml_node& layer, const ColorBlocks& color,
               bool is_by_columns, SampleCollector* collector) {
  const auto in = FindPatches(xml, layer, color.blocks[0], "ColumnAngleBasis");
  const auto out = FindPatches(xml, layer, color.blocks[0], "RowAngleBasis");
  std::vector<std::vector<double>> values;
  for (const pugi::xml_node& block : color.blocks) {
    values.push_back(ReadMatrix(xml, block, in.size() * out.size()));
  }
  for (size_t i = 0; i < in.size(); ++i) {
    for (size_t o = 0; o < out.size(); ++o) {
      const SphericalAngles at = {in[i].theta, in[i].phi + kPi, out[o].theta, out[o].phi};
      const size_t k = is_by_columns ? o * in.size() + i : i * out.size() + o;
      if (values.size() == 1) {
        collector->Add(at, {values[0][k], values[0][k], values[0][k]});
      } else {
        AddTristimulus(at, {values[0][k], values[1][k], values[2][k]}, collector);
      }
    }
  }
}

void AddTree(const RadianceXml& xml, const pugi::xml_node& block, int rank,
             SampleCollector* collector) {
  const pugi::xml_node data = xml.Child(block, "ScatteringData");
  if (!SameName(xml.Text(block, "AngleBasis"), "LBNL/Shirley-Chiu")) {
    xml.Fail(block, "<AngleBasis> of a tensor tree must be LBNL/Shirley-Chiu",
             ErrorKind::kUnsupported, "AngleBasis");
  }
  ReadTensorTree(
      data.child_value(), rank,
      [&](const std::string& problem, std::string_view value) {
        xml.Fail(data, problem, ErrorKind::kFormat, "ScatteringData", value);
      },
      [&](const SphericalAngles& at, double value) {
        collector->Add(at, {value, value, value});
      });
}

// A BSDF in the XML format of Radiance and of LBNL's WINDOW (docs/file-formats.md): a matrix over
// pairs of patches of Klems bases, or a tensor tree; the front reflection, or that of the back if
// there is no other. Throws Error, with the line, on anything else.
Measurement ParseRadiance(std::string_view bytes, const std::string& source) {
  const RadianceXml xml(bytes, source);
  const pugi::xml_node layer =
      xml.Child(xml.Child(xml.Child(xml.root(), "WindowElement"), "Optical"), "Layer");
  const pugi::xml_node definition = xml.Child(layer, "DataDefinition");
  const std::string_view structure = xml.Text(definition, "IncidentDataStructure");
  const ReflectionBlocks reflection = FindReflection(xml, layer);
  const bool is_by_columns = SameName(structure, "Columns");
  const bool is_matrix = is_by_columns || SameName(structure, "Rows");
  const bool has_azimuths = is_matrix || SameName(structure, "TensorTree4");
  const ColorBlocks color = ChooseColor(reflection, is_matrix);
  SampleCollector collector(source, "Radiance BSDF file of scattered samples");
  if (is_matrix) {
    AddMatrix(xml, layer, color, is_by_columns, &collector);
  } else if (has_azimuths || SameName(structure, "TensorTree3")) {
    AddTree(xml, color.blocks[0], has_azimuths ? 4 : 3, &collector);
  } else {
    xml.Fail(definition,
             "IncidentDataStructure is " + Printable(structure.substr(0, 40)) +
                 "; only Columns, Rows, TensorTree3 and TensorTree4 can be read",
             ErrorKind::kUnsupported, "IncidentDataStructure", structure);
  }
  Measurement measurement = has_azimuths ? collector.TakeByAzimuths() : collector.Take();
  measurement.notes.push_back(std::string("read as: ") + reflection.side + ", " +
                              Printable(color.name));
  return measurement;
}

bool LooksLikeRadiance(std::string_view text) {
  constexpr size_t kLongestProlog = 1 << 12;
  return text.substr(0, kLongestProlog).find("<WindowElement") != std::string_view::npos;
}

}  // namespace

MeasurementFormat RadianceFormat() {
  return {.name = "radiance",
          .description = "a Radiance BSDF .xml file",
          .ending = ".xml",
          .is_text = true,
          .recognise = LooksLikeRadiance,
          .read = ReadBy<ParseRadiance>};
}

}  // namespace trilobe
