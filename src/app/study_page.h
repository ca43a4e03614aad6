#ifndef TRILOBE_APP_STUDY_PAGE_H_
#define TRILOBE_APP_STUDY_PAGE_H_

#include <map>
#include <span>
#include <string>
#include <vector>

#include "fit/study/draw_study.h"
#include "fit/study/study.h"

namespace trilobe {

// What the page of a study shows besides its runs.
struct StudyPageContents {
  std::string command;              // that makes it again
  std::vector<std::string> tables;  // names of the CSV files beside it
  // Figures that have been drawn, by problem; FOLDER/NAME.svg and .pdf.
  std::map<std::string, std::vector<const StudyFigure*>> figures;
  std::map<std::string, std::string> folder_of;  // of each problem
};

// HTML page: the verdict, and for each problem a table of methods, the figures, and links to the
// runs.
std::string StudyPage(std::span<const StudyRun> runs, const StudyPageContents& contents);

// A table of the methods of one problem, for a terminal.
std::string MethodsText(std::span<const MethodSummary> summaries);

}  // namespace trilobe

#endif  // TRILOBE_APP_STUDY_PAGE_H_
