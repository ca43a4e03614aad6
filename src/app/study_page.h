#ifndef TRILOBE_APP_STUDY_PAGE_H_
#define TRILOBE_APP_STUDY_PAGE_H_

#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "fit/reports/draw_study.h"
#include "fit/reports/study.h"

namespace trilobe {

// Contents of the page of a study besides its runs.
struct StudyPageContents {
  // How it was made: program, command, limits, threads, machine, date; each with its name.
  std::vector<std::pair<std::string, std::string>> setting;
  std::vector<std::string> tables;           // names of the CSV files beside it
  std::vector<const StudyFigure*> profiles;  // of all problems, NAME.svg and .pdf, if drawn
  // Figures that have been drawn, by problem; FOLDER/NAME.svg and .pdf.
  std::map<std::string, std::vector<const StudyFigure*>> figures;
  std::map<std::string, std::string> folder_of;  // of each problem
};

// HTML page: the verdict; for each problem the tables of methods, the figures, and links to the
// runs; what the columns say; and how it was made.
std::string StudyPage(std::span<const StudyRun> runs, const StudyPageContents& contents);

// The tables of the methods of one problem, for a terminal.
std::string MethodsText(std::span<const MethodSummary> summaries);

// A table of how soon methods come within 1 % of the lowest E on each of several problems.
std::string TimesTextOf(std::span<const StudyRun> runs);

}  // namespace trilobe

#endif  // TRILOBE_APP_STUDY_PAGE_H_
