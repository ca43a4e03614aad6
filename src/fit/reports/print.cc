#include "fit/reports/print.h"

#include <iostream>
#include <nlohmann/json.hpp>

#include "core/base/json_text.h"
#include "trilobe/core/base/printable.h"

namespace trilobe {

double PsnrFall(double before, double after) { return before == after ? 0 : before - after; }

std::string Text(const Rgb& rgb) {
  return Text(rgb[0]) + ", " + Text(rgb[1]) + ", " + Text(rgb[2]);
}

std::string AlignRight(const std::string& text, int width) {
  const int length = static_cast<int>(text.size());
  return std::string(length < width ? width - length : 2, ' ') + text;
}

void PrintLine(const std::string& text) { std::cout << Printable(text) << "\n"; }

void PrintLine(const std::string& label, const std::string& value) {
  PrintLine(label + std::string(label.size() < 26 ? 26 - label.size() : 1, ' ') + value);
}

void PrintNotes(const Measurement& measurement) {
  for (const std::string& note : measurement.notes) {
    std::cerr << "trilobe: " << Printable(measurement.source + ": " + note) << "\n";
  }
}

void PrintJson(const nlohmann::ordered_json& json) { std::cout << JsonText(json, 2) << "\n"; }

}  // namespace trilobe
