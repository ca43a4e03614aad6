#ifndef TRILOBE_APP_HELP_H_
#define TRILOBE_APP_HELP_H_

#include <string>

#include "app/command.h"

namespace trilobe {

// The text of `trilobe help`, for the width of the terminal.
std::string HelpText();

// The text of `trilobe help COMMAND`: the flags that most people want, and with `all` the others,
// too, of which there are only the names otherwise.
std::string HelpText(const Command& command, bool all);

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
