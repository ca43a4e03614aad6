#ifndef TRILOBE_FIT_REPORTS_DRAW_STUDY_H_
#define TRILOBE_FIT_REPORTS_DRAW_STUDY_H_

#include <span>
#include <string>

#include "fit/reports/study.h"

namespace trilobe {

// A figure of the runs of one problem, or of all. The same runs give the same SVG.
struct StudyFigure {
  const char* name;     // of its files, without extension
  const char* caption;  // what it shows
  struct Drawing {
    int width = 0, height = 0;  // in pixels
    std::string script;         // for gnuplot; "" if there is nothing to draw
  };
  Drawing (*draw)(std::span<const StudyRun> runs);
};

// Figures of one problem: error against time; convergence; final errors; lobes.
std::span<const StudyFigure> StudyFigures();
// Figures of all problems: performance and data profiles (Profile).
std::span<const StudyFigure> ProfileFigures();

// Draws a figure as NAME.svg and NAME.pdf into an existing folder. Returns whether there was
// something to draw. Throws Error as DrawVectors does.
bool DrawStudyFigure(const StudyFigure& figure, std::span<const StudyRun> runs,
                     const std::string& folder);

}  // namespace trilobe

#endif  // TRILOBE_FIT_REPORTS_DRAW_STUDY_H_
