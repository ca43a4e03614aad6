#include "app/study_page.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "core/base/text.h"
#include "io/page/document.h"
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

std::string SecondsText(double seconds) {
  return std::isfinite(seconds) ? Text(seconds, 2) + " s" : "never";
}

std::string ShareText(const Share& share) {
  return share.of == 0 ? "" : std::to_string(share.count) + " of " + std::to_string(share.of);
}

std::string Optional(const std::optional<double>& value, int digits) {
  return value ? Text(*value, digits) : "";
}

// The columns of the table of methods, for the terminal and for the page.
struct Column {
  const char* title;
  std::string (*text)(const MethodSummary& of);
};

constexpr Column kColumns[] = {
    {"within 1 %", [](const MethodSummary& of) { return ShareText(of.as_good); }},
    {"E above lowest", [](const MethodSummary& of) { return ExcessText(of.median); }},
    {"at most", [](const MethodSummary& of) { return ExcessText(of.highest); }},
    {"seconds", [](const MethodSummary& of) { return SecondsText(of.seconds); }},
    {"to 1 %", [](const MethodSummary& of) { return SecondsText(of.seconds_to_as_good); }},
    {"by restarts", [](const MethodSummary& of) { return SecondsText(of.expected_seconds); }},
    {"iterations", [](const MethodSummary& of) { return Text(of.iterations); }},
    {"E rose",
     [](const MethodSummary& of) {
       return std::to_string(of.raised) + " of " + std::to_string(of.all_iterations);
     }},
    {"same lobes", [](const MethodSummary& of) { return ShareText(of.same_lobes); }},
    {"again", [](const MethodSummary& of) { return ShareText(of.same_again); }},
    {"agreement", [](const MethodSummary& of) { return Optional(of.agreement, 2); }},
    {"sphere, dB", [](const MethodSummary& of) { return Optional(of.psnr_db, 3); }},
};

std::string MethodsTable(const std::vector<MethodSummary>& summaries) {
  std::string html = "<div class=\"scroll\"><table><thead><tr><th>method</th>";
  for (const Column& column : kColumns) html += "<th>" + std::string(column.title) + "</th>";
  html += "</tr></thead><tbody>\n";
  for (const MethodSummary& of : summaries) {
    html += "<tr><th scope=\"row\">" + EscapedMarkup(Printable(of.method)) + "</th>";
    for (const Column& column : kColumns) html += "<td>" + column.text(of) + "</td>";
    html += "</tr>\n";
  }
  return html + "</tbody></table></div>\n";
}

std::string Paragraph(const std::vector<std::string>& sentences) {
  std::string html = "<ul class=\"verdict\">\n";
  for (const std::string& sentence : sentences) {
    html += "<li>" + EscapedMarkup(Printable(sentence)) + "</li>\n";
  }
  return html + "</ul>\n";
}

std::string FiguresOf(const std::string& folder, const std::vector<const StudyFigure*>& figures) {
  std::string html = "<div class=\"figures\">\n";
  for (const StudyFigure* figure : figures) {
    const std::string path = folder + "/" + figure->name;
    html += "<figure><img src=\"" + path + ".svg\" alt=\"" + figure->caption + "\"><figcaption>" +
            figure->caption + " <a href=\"" + path + ".svg\">SVG</a>, <a href=\"" + path +
            ".pdf\">PDF</a></figcaption></figure>\n";
  }
  return html + "</div>\n";
}

// The runs of a problem: each start's E, with a link to its report.
std::string RunsTable(const std::vector<StudyRun>& runs) {
  std::string html =
      "<details><summary>Every run</summary><div class=\"scroll\"><table><thead><tr>"
      "<th>method</th><th>start</th><th>E</th><th>above lowest</th>"
      "<th>iterations</th><th>seconds</th><th>agreement</th><th></th></tr></thead>"
      "<tbody>\n";
  for (const StudyRun& run : runs) {
    html += "<tr><th scope=\"row\">" + EscapedMarkup(Printable(run.method)) + "</th><td>" +
            std::to_string(run.start) + "</td>";
    if (run.failed()) {
      html += "<td colspan=\"6\">failed: " + EscapedMarkup(Printable(run.error)) + "</td></tr>\n";
      continue;
    }
    html += "<td>" + Text(run.objective(), 5) + "</td><td>" + ExcessText(run.excess()) +
            "</td><td>" + std::to_string(run.iterations()) + "</td><td>" + Text(run.seconds, 3) +
            "</td><td>" + (run.lobes ? Text(run.lobes->agreement, 2) : "") + "</td><td><a href=\"" +
            EncodeAddress(run.folder) + "/report.json\">report</a></td></tr>\n";
  }
  return html + "</tbody></table></div></details>\n";
}

}  // namespace

std::string MethodsText(std::span<const MethodSummary> summaries) {
  std::vector<std::vector<std::string>> rows = {{"method"}};
  for (const Column& column : kColumns) rows[0].emplace_back(column.title);
  for (const MethodSummary& of : summaries) {
    std::vector<std::string>& row = rows.emplace_back();
    row.push_back(Printable(of.method));
    for (const Column& column : kColumns) row.push_back(column.text(of));
  }
  std::vector<size_t> widths(rows[0].size());
  for (const std::vector<std::string>& row : rows) {
    for (size_t k = 0; k < row.size(); ++k) widths[k] = std::max(widths[k], row[k].size());
  }
  std::string text;
  for (const std::vector<std::string>& row : rows) {
    text += row[0] + std::string(widths[0] - row[0].size(), ' ');
    for (size_t k = 1; k < row.size(); ++k) {
      text += "  " + std::string(widths[k] - row[k].size(), ' ') + row[k];
    }
    text += "\n";
  }
  return text;
}

std::string StudyPage(std::span<const StudyRun> runs, const StudyPageContents& contents) {
  const std::vector<std::string> problems = ProblemsOf(runs), methods = MethodsOf(runs);
  std::string names;
  for (const std::string& method : methods) names += (names.empty() ? "" : ", ") + method;
  std::string body = "<h1>Study of " +
                     (problems.size() == 1 ? EscapedMarkup(Printable(problems.front()))
                                           : std::to_string(problems.size()) + " problems") +
                     "</h1>\n<p>" + EscapedMarkup(Printable(names)) + ": " +
                     std::to_string(runs.size()) + (runs.size() == 1 ? " run on " : " runs on ") +
                     (problems.size() == 1 ? EscapedMarkup(Printable(problems.front()))
                                           : std::to_string(problems.size()) + " problems") +
                     ". E is what the solvers minimise; the first start is the given one, the "
                     "others are random.</p>\n" +
                     Paragraph(VerdictOn(runs)) + "<p><code>" +
                     EscapedMarkup(Printable(contents.command)) + "</code></p>\n<p>Tables: ";
  for (size_t k = 0; k < contents.tables.size(); ++k) {
    body += (k > 0 ? ", <a href=\"" : "<a href=\"") + contents.tables[k] + "\">" +
            contents.tables[k] + "</a>";
  }
  body += "</p>\n";
  for (const std::string& problem : problems) {
    const std::vector<StudyRun> own = RunsOn(problem, runs);
    body += "<section><h2>" + EscapedMarkup(Printable(problem)) + "</h2>\n";
    if (problems.size() > 1) body += Paragraph(VerdictOn(own));
    body += MethodsTable(SummariesOf(own));
    if (const auto drawn = contents.figures.find(problem); drawn != contents.figures.end()) {
      body += FiguresOf(EncodeAddress(contents.folder_of.at(problem)), drawn->second);
    }
    body += RunsTable(own) + "</section>\n";
  }
  return FormatDocument("study.html", "Study: " + names, "{}", body);
}

}  // namespace trilobe
