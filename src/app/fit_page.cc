#include "app/fit_page.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <limits>
#include <locale>
#include <nlohmann/json.hpp>
#include <sstream>
#include <vector>

#include "core/base/file_names.h"
#include "core/base/json_text.h"
#include "core/base/text.h"
#include "fit/reports/print.h"
#include "io/pictures/document.h"
#include "trilobe/core/base/printable.h"
#include "trilobe/io/formats/source.h"

namespace trilobe {
namespace {

using Json = nlohmann::ordered_json;

// Most models that a page holds, some 30 kB each; a page of more fits compares pictures alone.
constexpr size_t kMostModels = 200;

// Tables need no more digits for a picture.
void RoundNumbers(Json* value) {
  if (value->is_number_float()) *value = std::stod(Text(value->get<double>(), 5));
  if (!value->is_structured()) return;
  for (Json& inner : *value) RoundNumbers(&inner);
}

// The part of a model file that a picture needs, null if there is no file.
Json ModelToDraw(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  Json model = Json::parse(file, nullptr, false);
  if (!model.is_object()) return nullptr;
  for (const char* unseen : {"fit", "unobserved", "dead"}) model.erase(unseen);
  RoundNumbers(&model);
  return model;
}

std::string FormatFigure(const FitOutcome& outcome) {
  const std::string folder = EncodeAddress(outcome.name);
  std::ostringstream figure;
  figure << R"(<figure><a href=")" << folder << '/' << outcome.page << R"("><img src=")" << folder
         << '/' << outcome.picture << R"(" loading="lazy" alt=")"
         << EscapedMarkup(Printable(outcome.name))
         << ": measured and fitted\"></a>\n<figcaption><b>"
         << EscapedMarkup(Printable(outcome.name)) << "</b><span class=\""
         << EscapedMarkup(outcome.visibility) << "\">" << EscapedMarkup(outcome.verdict)
         << "</span><br>PSNR " << Text(outcome.psnr_db, 3) << " dB, CIELAB difference "
         << Text(outcome.mean_delta_e, 2) << ", mean colour off by "
         << Text(100 * outcome.mean_color_error, 2) << " %, " << outcome.num_parameters
         << " parameters</figcaption></figure>\n";
  return figure.str();
}

}  // namespace

std::string StateName(FitOutcome::State state) {
  switch (state) {
    case FitOutcome::State::kMissing:
      return "missing";
    case FitOutcome::State::kFitted:
      return "fitted";
    case FitOutcome::State::kKept:
      return "kept";
    case FitOutcome::State::kInterrupted:
      return "interrupted";
    case FitOutcome::State::kFailed:
      return "failed";
  }
  return "";
}

std::string FitsCsv(std::span<const FitOutcome> outcomes) {
  std::ostringstream csv;
  csv.imbue(std::locale::classic());
  csv << "name,source,state,verdict,psnr_db,mean_delta_e,mean_color_error,objective,parameters,"
         "seconds,error\n"
      << std::setprecision(std::numeric_limits<double>::max_digits10);
  for (const FitOutcome& outcome : outcomes) {
    csv << CsvField(outcome.name) << ',' << CsvField(FileNameOf(outcome.source)) << ','
        << StateName(outcome.state) << ',' << CsvField(outcome.verdict) << ',';
    if (outcome.has_picture) {
      csv << outcome.psnr_db << ',' << outcome.mean_delta_e << ',' << outcome.mean_color_error
          << ',';
    } else {
      csv << ",,,";
    }
    if (outcome.has_model()) {
      csv << outcome.objective << ',' << outcome.num_parameters << ',' << outcome.seconds;
    } else {
      csv << ",,";
    }
    csv << ',' << CsvField(outcome.error) << '\n';
  }
  return csv.str();
}

std::string FitsPage(std::span<const FitOutcome> outcomes, const std::string& folder,
                     const std::string& table) {
  std::vector<FitOutcome> fits;
  std::ranges::copy_if(outcomes, std::back_inserter(fits), &FitOutcome::has_picture);
  std::ranges::stable_sort(fits, {}, &FitOutcome::psnr_db);
  const bool has_models = fits.size() <= kMostModels;
  Json json = Json::array();
  for (const FitOutcome& outcome : fits) {
    const std::string model = folder + "/" + outcome.name + "/model.json";
    json.push_back({{"name", Printable(outcome.name)},
                    {"psnr_db", std::min(outcome.psnr_db, 1e3)},
                    {"delta_e", outcome.mean_delta_e},
                    {"parameters", outcome.num_parameters},
                    {"seconds", outcome.seconds},
                    {"anisotropic", outcome.anisotropic ? 1 : 0},
                    {"model", has_models ? ModelToDraw(model) : Json()}});
  }
  std::ostringstream body;
  body << "<h1>" << fits.size() << " of " << outcomes.size()
       << " measurements in pictures</h1>\n<p>Measured and fitted, on a sphere.";
  if (!table.empty()) body << " Numbers: <a href=\"" << table << "\">" << table << "</a>.";
  body << "</p>\n";
  for (const FitOutcome& outcome : outcomes) {
    if (outcome.has_picture) continue;
    body << "<p" << (outcome.has_model() ? "" : " class=\"failed\"") << "><b>"
         << EscapedMarkup(Printable(outcome.name)) << "</b> " << StateName(outcome.state)
         << (outcome.verdict.empty() ? "" : ", " + EscapedMarkup(outcome.verdict))
         << (outcome.error.empty() ? "" : ": ") << EscapedMarkup(outcome.error) << "</p>\n";
  }
  body << "<main>\n";
  for (const FitOutcome& outcome : fits) body << FormatFigure(outcome);
  body << "</main>";
  return FormatDocument("catalogue.html", "Fits", JsonText(json), body.str());
}

std::string FitNameOf(const std::string& source) {
  if (IsSynthetic(source)) return SynthSourceOf(source).material.name;
  const std::filesystem::path file = std::filesystem::path(source).filename();
  const std::string name = file.stem().string();
  // "." is the stem of "..csv", for example: then the whole name will do.
  const bool taken = name == "." || name == ".." || name == kTableName || name == kPageName;
  return taken ? file.string() : name;
}

}  // namespace trilobe
