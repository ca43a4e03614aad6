#include "app/man_page.h"

#include <sstream>
#include <string_view>

#include "app/command.h"
#include "app/help.h"

namespace trilobe {
namespace {

// Text whose characters roff prints as they are: without \- a hyphen is another character, which no
// shell takes for that of a flag, and quotes, carets and tildes are those of typesetters. What
// stands in `...` is bold, as commands are in man pages.
std::string Escaped(std::string_view text) {
  std::string roff;
  bool is_bold = false;
  for (const char c : text) {
    switch (c) {
      case '-':
        roff += "\\-";
        break;
      case '\\':
        roff += "\\e";
        break;
      case '\'':
        roff += "\\(aq";
        break;
      case '"':
        roff += "\\(dq";
        break;
      case '^':
        roff += "\\(ha";
        break;
      case '~':
        roff += "\\(ti";
        break;
      case '`':
        is_bold = !is_bold;
        roff += is_bold ? "\\fB" : "\\fR";
        break;
      default:
        roff += c;
    }
  }
  return roff;
}

// A line of text. At its begin a point would make a request of it.
std::string RoffLine(std::string_view text) {
  return (text.starts_with('.') ? "\\&" : "") + Escaped(text) + "\n";
}

std::string BoldLine(std::string_view text) { return "\\fB" + Escaped(text) + "\\fR\n"; }

// Lays help out (Wrapped): lines that begin with a space are entries of a list, each with a text
// after two spaces, or in lines that begin farther right. All others are joined into paragraphs,
// which empty lines end. The first paragraph goes on from what stands before.
std::string RoffOf(const std::string& help) {
  std::string roff;
  bool in_paragraph = true;
  size_t entry = 0;  // column of the entry that goes on; 0 where there is none
  bool has_text = false;
  std::string name;
  const auto end_entry = [&] {
    if (entry > 0 && !has_text) roff += ".IP\n" + RoffLine(name);
    entry = 0;
  };
  std::istringstream lines(help);
  for (std::string line; std::getline(lines, line);) {
    const size_t begin = line.find_first_not_of(' ');
    if (begin == std::string::npos || begin == 0) {
      end_entry();
      if (begin == 0) roff += (in_paragraph ? "" : ".PP\n") + RoffLine(line);
      in_paragraph = begin == 0;
      continue;
    }
    in_paragraph = false;
    std::string text = line.substr(begin);
    if (entry == 0 || begin <= entry) {
      end_entry();
      entry = begin;
      has_text = false;
      const size_t gap = text.find("  ");
      name = text.substr(0, gap);
      if (gap == std::string::npos) continue;
      text = text.substr(text.find_first_not_of(' ', gap));
    }
    if (!has_text) roff += ".TP\n" + BoldLine(name);
    has_text = true;
    roff += RoffLine(text);
  }
  end_entry();
  return roff;
}

constexpr std::string_view kSynopsis =
    ".SH SYNOPSIS\n"
    ".B trilobe\n.I COMMAND ARGUMENTS\n[\\fB\\-\\-\\fIFLAG\\fR=\\fIVALUE\\fR ...]\n.br\n"
    ".B trilobe help\n[\\fICOMMAND\\fR [\\fB\\-\\-all\\fR] | \\fB\\-\\-man\\fR]\n.br\n"
    ".B trilobe \\-\\-version\n";

constexpr std::string_view kDescription =
    "A model is a diffuse term and some lobes, each a product of tables for the distribution of "
    "normals D, the Fresnel factor F and the shadowing G. `trilobe fit` finds the one that is "
    "nearest to a measurement, and says what a person would see of the difference.\n\n"
    "`trilobe help COMMAND --all` has all flags of a command; here are the common ones, with their "
    "defaults. A file is overwritten or removed only where Trilobe has written it; --force does so "
    "whoever has.\n\n";

constexpr std::string_view kEnds =
    "  0  All is done.\n"
    "  1  It could not be done; a line on standard error says why, and what to do.\n"
    "  3  Some of several inputs failed.\n"
    "  128+n  The signal n, as Ctrl-C sends it, ended it; what was finished is kept.\n";

constexpr std::string_view kEnvironment =
    "  XDG_CACHE_HOME, HOME  Where the cache of fits of scenes lies.\n"
    "  NO_COLOR, TERM  With NO_COLOR, or where TERM is dumb, the line that says what goes on is "
    "not "
    "drawn over, but printed once for each stage that takes more than two seconds.\n"
    "  PATH  Where gnuplot is, which draws the pictures.\n";

constexpr std::string_view kFiles =
    "  out/NAME  What `trilobe fit` writes without --out, if there are pictures to write.\n"
    "  ~/.cache/trilobe  The cache of fits of scenes; in XDG_CACHE_HOME where that is set. It may "
    "be removed at any time.\n";

constexpr std::string_view kExamples =
    "  trilobe fit synth:plastic --noise=0.02 --out=out/plastic\n"
    "      Fits a synthetic measurement; out/plastic/view.html shows it.\n"
    "  trilobe fit a.binary --solver=awls --max_iterations=10 --noplots --out=out/a\n"
    "      Fits a measurement by another solver, without pictures.\n"
    "  trilobe study a.binary --solvers=awls,lm,auto --runs=2 --out=out/study\n"
    "      Compares solvers.\n"
    "  trilobe score out/a/model.json a.binary --verbose\n"
    "      Says how near a model is.\n"
    "  trilobe convert out/a/model.json --out=a.bsdf\n"
    "      Writes a model for Mitsuba and pbrt.\n";

std::string Section(std::string_view name, std::string_view help) {
  return ".SH " + std::string(name) + "\n" + RoffOf(std::string(help));
}

}  // namespace

std::string ManPage() {
  std::string page = ".TH TRILOBE 1 \"\" \"Trilobe " TRILOBE_VERSION
                     "\" \"User Commands\"\n"
                     ".nh\n.ad l\n" +
                     Section("NAME", "trilobe - " + std::string(kPurpose)) +
                     std::string(kSynopsis) +
                     Section("DESCRIPTION", std::string(kDescription) + std::string(kSourceHelp)) +
                     ".SH COMMANDS\n";
  for (const Command& command : Commands()) {
    page += ".SS " + Escaped(command.name) + "\n" + BoldLine(UsageOf(command)) +
            RoffOf("\n" + CommandText(command, /*all=*/false));
  }
  return page + Section("EXIT STATUS", kEnds) + Section("ENVIRONMENT", kEnvironment) +
         Section("FILES", kFiles) + Section("EXAMPLES", kExamples);
}

}  // namespace trilobe
