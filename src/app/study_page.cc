#include "app/study_page.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "core/base/text.h"
#include "io/pictures/document.h"
#include "trilobe/core/base/printable.h"

namespace trilobe {
namespace {

// "0", "<0.01 %", "3.2 %" above the lowest E, or "12 times" it.
std::string ExcessText(double excess) {
  if (!std::isfinite(excess)) return "failed";
  if (excess <= 0) return "0";
  if (excess < 1e-4) return "<0.01 %";
  if (excess < 9) return Text(100 * excess, 2) + " %";
  return Text(1 + excess, 2) + " times";
}

// Time as text. If a limit stopped runs, more time might have led to that E.
std::string SecondsText(double seconds, const MethodSummary& of) {
  if (std::isfinite(seconds)) return Text(seconds, 2) + " s";
  if (of.failed == of.runs) return "";
  return of.short_of_limit ? "not in the limit" : "never";
}

// Letters of a text as UTF-8.
size_t LettersIn(const std::string& text) {
  return static_cast<size_t>(
      std::ranges::count_if(text, [](char c) { return (c & '\xC0') != '\x80'; }));
}

std::string ShareText(const Share& share) {
  return share.of == 0 ? "" : std::to_string(share.count) + " of " + std::to_string(share.of);
}

std::string Optional(const std::optional<double>& value, int digits) {
  return value ? Text(*value, digits) : "";
}

std::string Percent(const std::optional<double>& share) {
  return share ? Text(100 * *share, 3) + " %" : "";
}

// A column of a table of methods, for the terminal and for the page.
struct Column {
  const char* title;
  const char* meaning;
  std::string (*text)(const MethodSummary& of);
};

constexpr Column kSearch[] = {
    {"within 1 %", "runs whose E is within 1 % of the lowest of all runs on this problem",
     [](const MethodSummary& of) { return ShareText(of.as_good); }},
    {"E above lowest", "how far the median run is above the lowest E",
     [](const MethodSummary& of) { return ExcessText(of.median); }},
    {"at most", "the same of the worst run",
     [](const MethodSummary& of) { return ExcessText(of.highest); }},
    {"seconds", "of the median run, from preparing the data to the end of the solver",
     [](const MethodSummary& of) { return SecondsText(of.seconds, of); }},
    {"to 1 %", "seconds until the median run is within 1 % of the lowest E",
     [](const MethodSummary& of) { return SecondsText(of.seconds_to_as_good, of); }},
    {"by restarts",
     "seconds until repeated runs have got there, in expectation: the mean seconds of a run over "
     "the share of runs that do",
     [](const MethodSummary& of) { return SecondsText(of.expected_seconds, of); }},
    {"iterations", "of the median run; one of AWLS is a sweep",
     [](const MethodSummary& of) { return Text(of.iterations); }},
    {"E rose", "iterations that raised E, of those of all runs",
     [](const MethodSummary& of) {
       return std::to_string(of.raised) + " of " + std::to_string(of.all_iterations);
     }},
    {"ended", "why the runs ended; E of those that a limit stopped might fall further",
     [](const MethodSummary& of) { return EndingsText(of); }},
};

constexpr Column kFound[] = {
    {"parameters", "numbers that the model stores",
     [](const MethodSummary& of) {
       return of.parameters > 0 ? std::to_string(of.parameters) : std::string();
     }},
    {"E, % of black", "E of the data over that of a black model, of the median run",
     [](const MethodSummary& of) { return Percent(of.relative_E); }},
    {"held-out E",
     "the same at directions that a repeated fit did not see: how well the model predicts",
     [](const MethodSummary& of) { return Percent(of.held_out_E); }},
    {"held-out ΔE", "the mean CIELAB difference there",
     [](const MethodSummary& of) { return Optional(of.held_out_delta_e, 2); }},
    {"ΔE",
     "the mean CIELAB difference to the measurement, of a sphere or, where the samples form none, "
     "of the samples; below 1 it is not seen",
     [](const MethodSummary& of) { return Optional(of.mean_delta_e, 2); }},
    {"PSNR, dB", "of the same", [](const MethodSummary& of) { return Optional(of.psnr_db, 3); }},
    {"gradient", "the largest scaled gradient at which a run ended: 0 at a minimum, at most 1",
     [](const MethodSummary& of) { return Optional(of.optimality, 2); }},
    {"lobes as lowest", "other runs that found the lobes of the lowest run",
     [](const MethodSummary& of) { return ShareText(of.same_lobes); }},
    {"lobes as own lowest", "other runs that found the lobes of the lowest run of the same method",
     [](const MethodSummary& of) { return ShareText(of.same_as_own); }},
    {"agreement",
     "how alike the lobes are to those of the lowest run, of the median run: 1 if equal",
     [](const MethodSummary& of) { return Optional(of.agreement, 2); }},
};

// The columns in which something is said.
std::vector<Column> Told(std::span<const Column> columns,
                         std::span<const MethodSummary> summaries) {
  std::vector<Column> told;
  std::ranges::copy_if(columns, std::back_inserter(told), [&](const Column& column) {
    return std::ranges::any_of(summaries,
                               [&](const MethodSummary& of) { return !column.text(of).empty(); });
  });
  return told;
}

// The beginning of a table, which is moved sideways, by keys too, where it is wider than the page.
constexpr char kTable[] =
    R"(<div class="scroll" tabindex="0" role="region" aria-label="Table"><table>)";

// A number stays on its line.
std::string TableCell(const std::string& text) {
  constexpr size_t kShort = 12;
  return (LettersIn(text) <= kShort ? "<td class=\"short\">" : "<td>") + text + "</td>";
}

std::string MethodsTable(std::span<const Column> all, std::span<const MethodSummary> summaries) {
  const std::vector<Column> columns = Told(all, summaries);
  std::string html = std::string(kTable) + "<thead><tr><th>method</th>";
  for (const Column& column : columns) {
    html += "<th title=\"" + std::string(column.meaning) + "\">" + column.title + "</th>";
  }
  html += "</tr></thead><tbody>\n";
  for (const MethodSummary& of : summaries) {
    html += "<tr><th scope=\"row\">" + EscapedMarkup(Printable(of.method)) + "</th>";
    for (const Column& column : columns) html += TableCell(column.text(of));
    html += "</tr>\n";
  }
  return html + "</tbody></table></div>\n";
}

// The seconds until the median run of each method is within 1 % of the lowest E, on each problem,
// and their geometric mean. Rows of cells; first the titles.
std::vector<std::vector<std::string>> TimesRows(std::span<const StudyRun> runs) {
  const std::vector<MethodSummary> summaries = SummariesOf(runs);
  const std::vector<std::string> problems = ProblemsOf(runs);
  std::vector<std::vector<std::string>> rows = {{"seconds to 1 %"}};
  for (const std::string& problem : problems) rows[0].push_back(Printable(problem));
  rows[0].emplace_back("geometric mean");
  for (const std::string& method : MethodsOf(runs)) {
    std::vector<std::string>& row = rows.emplace_back();
    row.push_back(Printable(method));
    for (const std::string& problem : problems) {
      const auto own = std::ranges::find_if(summaries, [&](const MethodSummary& of) {
        return of.problem == problem && of.method == method;
      });
      row.push_back(own == summaries.end() ? "" : SecondsText(own->seconds_to_as_good, *own));
    }
    const Times times = TimesOf(summaries, method);
    std::string mean = times.reached > 0 ? Text(times.geometric_mean, 2) + " s" : "";
    if (times.reached > 0 && times.reached < times.of) {
      mean += " on " + std::to_string(times.reached) + " of " + std::to_string(times.of);
    }
    row.push_back(mean);
  }
  return rows;
}

std::string HtmlOf(const std::vector<std::vector<std::string>>& rows) {
  std::string html = std::string(kTable) + "<thead><tr>";
  for (const std::string& title : rows[0]) html += "<th>" + EscapedMarkup(title) + "</th>";
  html += "</tr></thead><tbody>\n";
  for (size_t k = 1; k < rows.size(); ++k) {
    html += "<tr><th scope=\"row\">" + EscapedMarkup(rows[k][0]) + "</th>";
    for (size_t c = 1; c < rows[k].size(); ++c) html += TableCell(rows[k][c]);
    html += "</tr>\n";
  }
  return html + "</tbody></table></div>\n";
}

std::string Definitions(const std::vector<std::pair<std::string, std::string>>& terms) {
  std::string html = "<dl>\n";
  for (const auto& [term, meaning] : terms) {
    html += "<dt>" + EscapedMarkup(Printable(term)) + "</dt><dd>" +
            EscapedMarkup(Printable(meaning)) + "</dd>\n";
  }
  return html + "</dl>\n";
}

// Tells what the columns of the tables say.
std::string Legend(std::span<const MethodSummary> summaries) {
  std::vector<std::pair<std::string, std::string>> terms;
  for (const std::span<const Column> columns :
       {std::span<const Column>(kSearch), std::span<const Column>(kFound)}) {
    for (const Column& column : Told(columns, summaries)) {
      terms.emplace_back(column.title, column.meaning);
    }
  }
  return "<section><h2>What the columns say</h2>\n" + Definitions(terms) + "</section>\n";
}

std::string Paragraph(const std::vector<std::string>& sentences) {
  std::string html = "<ul class=\"verdict\">\n";
  for (const std::string& sentence : sentences) {
    html += "<li>" + EscapedMarkup(Printable(sentence)) + "</li>\n";
  }
  return html + "</ul>\n";
}

// `folder`: their place beside the page, with a / at its end, or nothing.
std::string FiguresOf(const std::string& folder, const std::vector<const StudyFigure*>& figures) {
  std::string html = "<div class=\"figures\">\n";
  for (const StudyFigure* figure : figures) {
    const std::string path = folder + figure->name;
    html += "<figure><img src=\"" + path + ".svg\" alt=\"" + figure->caption + "\"><figcaption>" +
            figure->caption + " <a href=\"" + path + ".svg\">SVG</a>, <a href=\"" + path +
            ".pdf\">PDF</a></figcaption></figure>\n";
  }
  return html + "</div>\n";
}

// The runs of a problem: each start's E, with a link to its report.
std::string RunsTable(const std::vector<StudyRun>& runs) {
  constexpr const char* kTitles[] = {
      "start",   "E",          "above lowest", "gradient",  "ended", "iterations",
      "seconds", "held-out E", "ΔE",           "agreement", ""};
  std::string html =
      "<details><summary>Every run</summary>" + std::string(kTable) + "<thead><tr><th>method</th>";
  for (const char* const title : kTitles) html += "<th>" + std::string(title) + "</th>";
  html += "</tr></thead><tbody>\n";
  for (const StudyRun& run : runs) {
    html += "<tr><th scope=\"row\">" + EscapedMarkup(Printable(run.method)) + "</th><td>" +
            std::to_string(run.start) + "</td>";
    if (run.failed()) {
      html += "<td colspan=\"" + std::to_string(std::size(kTitles) - 1) +
              "\">failed: " + EscapedMarkup(Printable(run.error)) + "</td></tr>\n";
      continue;
    }
    for (const std::string& cell :
         {Text(run.objective(), 5), ExcessText(run.excess()), Optional(run.optimality, 2),
          EndingWords(run.stop_reason), std::to_string(run.iterations()), Text(run.seconds, 3),
          Percent(run.held_out_E), Optional(run.mean_delta_e, 2), Optional(run.agreement(), 2)}) {
      html += TableCell(cell);
    }
    html += "<td><a href=\"" + EncodeAddress(run.folder) + "/report.json\">report</a></td></tr>\n";
  }
  return html + "</tbody></table></div></details>\n";
}

// "1166400 samples, weighting log, 822 parameters", of the runs of a problem that have a model.
std::string ProblemText(const std::vector<StudyRun>& runs) {
  int fewest = 0, most = 0;
  const StudyRun* first = nullptr;
  for (const StudyRun& run : runs) {
    if (run.failed()) continue;
    fewest = first == nullptr ? run.parameters : std::min(fewest, run.parameters);
    most = std::max(most, run.parameters);
    if (first == nullptr) first = &run;
  }
  if (first == nullptr) return "";
  return std::to_string(first->samples) + " samples, weighting " + first->weighting + ", " +
         std::to_string(fewest) + (most > fewest ? " to " + std::to_string(most) : "") +
         " parameters";
}

// Columns side by side, the first one to the left.
std::string Aligned(const std::vector<std::vector<std::string>>& rows) {
  std::vector<size_t> widths(rows[0].size());
  for (const std::vector<std::string>& row : rows) {
    for (size_t k = 0; k < row.size(); ++k) widths[k] = std::max(widths[k], LettersIn(row[k]));
  }
  std::string text;
  for (const std::vector<std::string>& row : rows) {
    text += row[0] + std::string(widths[0] - LettersIn(row[0]), ' ');
    for (size_t k = 1; k < row.size(); ++k) {
      text += "  " + std::string(widths[k] - LettersIn(row[k]), ' ') + row[k];
    }
    text += "\n";
  }
  return text;
}

std::string TableText(std::span<const Column> all, std::span<const MethodSummary> summaries) {
  const std::vector<Column> columns = Told(all, summaries);
  std::vector<std::vector<std::string>> rows = {{"method"}};
  for (const Column& column : columns) rows[0].emplace_back(column.title);
  for (const MethodSummary& of : summaries) {
    std::vector<std::string>& row = rows.emplace_back();
    row.push_back(Printable(of.method));
    for (const Column& column : columns) row.push_back(column.text(of));
  }
  return Aligned(rows);
}

}  // namespace

std::string MethodsText(std::span<const MethodSummary> summaries) {
  return TableText(kSearch, summaries) + "\n" + TableText(kFound, summaries);
}

std::string TimesTextOf(std::span<const StudyRun> runs) { return Aligned(TimesRows(runs)); }

std::string StudyPage(std::span<const StudyRun> runs, const StudyPageContents& contents) {
  const std::vector<std::string> problems = ProblemsOf(runs), methods = MethodsOf(runs);
  const std::string on = problems.size() == 1 ? EscapedMarkup(Printable(problems.front()))
                                              : std::to_string(problems.size()) + " problems";
  std::string names;
  for (const std::string& method : methods) names += (names.empty() ? "" : ", ") + method;
  std::string body = "<h1>Study of " + on + "</h1>\n<p>" + EscapedMarkup(Printable(names)) + ": " +
                     std::to_string(runs.size()) + (runs.size() == 1 ? " run on " : " runs on ") +
                     on +
                     ". E is what the solvers minimise; the first start is the given one, the "
                     "others are random.</p>\n" +
                     Paragraph(VerdictOn(runs));
  if (problems.size() > 1) {
    body += "<section><h2>All problems</h2>\n" + HtmlOf(TimesRows(runs)) +
            FiguresOf("", contents.profiles) + "</section>\n";
  }
  for (const std::string& problem : problems) {
    const std::vector<StudyRun> own = RunsOn(problem, runs);
    const std::vector<MethodSummary> summaries = SummariesOf(own);
    body += "<section><h2>" + EscapedMarkup(Printable(problem)) + "</h2>\n<p>" +
            EscapedMarkup(ProblemText(own)) + "</p>\n";
    if (problems.size() > 1) body += Paragraph(VerdictOn(own));
    body += MethodsTable(kSearch, summaries) + MethodsTable(kFound, summaries);
    if (const auto drawn = contents.figures.find(problem); drawn != contents.figures.end()) {
      body += FiguresOf(EncodeAddress(contents.folder_of.at(problem)) + "/", drawn->second);
    }
    body += RunsTable(own) + "</section>\n";
  }
  body += Legend(SummariesOf(runs)) + "<section><h2>How it was made</h2>\n" +
          Definitions(contents.setting) + "<p>Tables: ";
  for (size_t k = 0; k < contents.tables.size(); ++k) {
    body += (k > 0 ? ", <a href=\"" : "<a href=\"") + contents.tables[k] + "\">" +
            contents.tables[k] + "</a>";
  }
  body += "</p></section>\n";
  return FormatDocument("study.html", "Study: " + names, "{}", body);
}

}  // namespace trilobe
