#ifndef TRILOBE_APP_HELP_H_
#define TRILOBE_APP_HELP_H_

#include <string>
#include <string_view>

#include "app/command.h"

namespace trilobe {

// What the program is for, and what a SOURCE is that its commands read.
inline constexpr std::string_view kPurpose =
    "fits multi-lobe non-parametric microfacet models to measured BRDFs";
inline constexpr std::string_view kSourceHelp =
    "A SOURCE is a MERL .binary file, an RGL *_rgb.bsdf file, a UTIA .bin file or another of "
    "docs/file-formats.md, or synth:NAME (`trilobe synth` lists the names). --quiet prints no line "
    "that says what goes on.";

// The text of `trilobe help`, for the width of the terminal.
std::string HelpText();

// The text of `trilobe help COMMAND`: the flags that most people want, and with `all` the others,
// too, of which there are only the names otherwise.
std::string HelpText(const Command& command, bool all);

// Its line of usage, "trilobe fit SOURCE... [--FLAG=VALUE ...]", and the rest, not wrapped.
std::string UsageOf(const Command& command);
std::string CommandText(const Command& command, bool all);

// "  --lobes=3" with its default, and a line on what it does.
std::string FlagHelp(const std::string& flag);

// Text in lines of at most `width` characters, unless a word is longer. Lines that begin with a
// space stay lines of their own, whose further lines begin below their text: below the second
// column where two spaces set it off. All others are joined into paragraphs, which empty lines end.
std::string Wrapped(const std::string& text, int width);

// Columns of the terminal that standard output is, from 40 to 100; else 100.
int OutputWidth();

}  // namespace trilobe

#endif  // TRILOBE_APP_HELP_H_
