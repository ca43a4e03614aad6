#include "app/fit_page.h"

#include <algorithm>
#include <iomanip>
#include <limits>
#include <locale>
#include <sstream>
#include <vector>

#include "reports/print.h"

namespace trilobe {
namespace {

constexpr const char* kStyle =
    "body{font:15px/1.4 'DejaVu Sans',Arial,sans-serif;color:#222;background:#fff;margin:2em}\n"
    "main{display:grid;grid-template-columns:repeat(auto-fill,minmax(260px,1fr));gap:1.2em}\n"
    "figure{margin:0}img{width:100%;border-radius:4px}\n"
    "figcaption b{display:block}.failed{color:#a00}a{color:inherit}";

// So that any name is text, and no markup.
std::string Escaped(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

// A name as part of an address: what is not a letter, a digit or one of -._~ as %XX (RFC 3986).
std::string Address(const std::string& name) {
  std::ostringstream address;
  address << std::hex << std::uppercase << std::setfill('0');
  for (const unsigned char c : name) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       std::string_view("-._~").find(static_cast<char>(c)) != std::string::npos;
    if (plain) {
      address << static_cast<char>(c);
    } else {
      address << '%' << std::setw(2) << static_cast<int>(c);
    }
  }
  return address.str();
}

// Quoted where it must be (RFC 4180).
std::string CsvField(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

std::string Figure(const FitOutcome& outcome) {
  const std::string folder = Address(outcome.name);
  std::ostringstream figure;
  figure << R"(<figure><a href=")" << folder << R"(/report.json"><img src=")" << folder
         << R"(/pair.png" loading="lazy" alt=")" << Escaped(outcome.name)
         << ": measured and fitted\"></a>\n<figcaption><b>" << Escaped(outcome.name) << "</b>"
         << Escaped(outcome.verdict) << "<br>PSNR " << Text(outcome.psnr_db, 3)
         << " dB, CIELAB difference " << Text(outcome.mean_delta_e, 2) << ", mean colour off by "
         << Text(100 * outcome.mean_color_error, 2) << " %</figcaption></figure>\n";
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
  csv << "name,source,state,verdict,psnr_db,mean_delta_e,mean_color_error,objective,numbers,"
         "seconds,error\n"
      << std::setprecision(std::numeric_limits<double>::max_digits10);
  for (const FitOutcome& outcome : outcomes) {
    csv << CsvField(outcome.name) << ',' << CsvField(outcome.source) << ','
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

std::string FitsPage(std::span<const FitOutcome> outcomes) {
  std::vector<FitOutcome> fits;
  std::ranges::copy_if(outcomes, std::back_inserter(fits), &FitOutcome::has_picture);
  std::ranges::stable_sort(fits, {}, &FitOutcome::psnr_db);
  std::ostringstream page;
  page << "<!DOCTYPE html>\n<html lang=\"en\"><meta charset=\"utf-8\"><title>Fits</title>\n<style>"
       << kStyle << "</style>\n<h1>" << fits.size() << " of " << outcomes.size()
       << " measurements in pictures</h1>\n<p>Measured (left) and fitted (right) on a sphere, the "
          "largest difference first. Numbers: <a href=\"fits.csv\">fits.csv</a>.</p>\n";
  for (const FitOutcome& outcome : outcomes) {
    if (outcome.has_picture) continue;
    page << "<p" << (outcome.has_model() ? "" : " class=\"failed\"") << "><b>"
         << Escaped(outcome.name) << "</b> " << StateName(outcome.state)
         << (outcome.verdict.empty() ? "" : ", " + Escaped(outcome.verdict))
         << (outcome.error.empty() ? "" : ": ") << Escaped(outcome.error) << "</p>\n";
  }
  page << "<main>\n";
  for (const FitOutcome& outcome : fits) page << Figure(outcome);
  page << "</main></html>\n";
  return page.str();
}

}  // namespace trilobe
