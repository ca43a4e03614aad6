#include "core/files/text_lines.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>
#include <system_error>

#include "core/base/text.h"

namespace trilobe {
namespace {

constexpr std::string_view kSpace = " \t\r";

// The first kLongest bytes of a cell, in quotes.
std::string Quoted(std::string_view cell) {
  constexpr size_t kLongest = 40;
  std::string quoted = "'";
  quoted += cell.substr(0, kLongest);
  return quoted + (cell.size() > kLongest ? "...'" : "'");
}

// The number that all of a cell is.
template <typename Number>
std::optional<Number> Whole(std::string_view cell) {
  Number number{};
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), number);
  if (error != std::errc() || end != cell.data() + cell.size()) return std::nullopt;
  return number;
}

}  // namespace

std::string_view Trimmed(std::string_view text) {
  const size_t begin = text.find_first_not_of(kSpace);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kSpace) + 1 - begin);
}

TextLines::TextLines(std::string_view text, const std::string& source)
    : rest_(text), source_(source) {
  if (rest_.starts_with(kByteOrderMark)) rest_.remove_prefix(kByteOrderMark.size());
  if (rest_.find('\n') == std::string_view::npos) end_ = '\r';
}

bool TextLines::Next(bool with_comment) {
  while (!rest_.empty()) {
    const size_t end = std::min(rest_.find(end_), rest_.size());
    whole_line_ = line_ = rest_.substr(0, end);
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    ++number_;
    line_ = Trimmed(with_comment ? line_ : line_.substr(0, line_.find('#')));
    if (!line_.empty()) return true;
  }
  return false;
}

bool TextLines::Next() { return Next(/*with_comment=*/false); }

bool TextLines::NextWithComment() { return Next(/*with_comment=*/true); }

void TextLines::Fail(const std::string& problem, ErrorKind kind, std::string_view key,
                     std::string_view value) const {
  throw Error(kind, source_ + ": line " + std::to_string(number_) + ": " + problem)
      .At(source_, number_)
      .About(key, value);
}

void TextLines::FailAt(size_t column, const std::string& name, const std::string& problem,
                       ErrorKind kind, std::string_view value) const {
  throw Error(kind, source_ + ": line " + std::to_string(number_) + ", column " +
                        std::to_string(column + 1) + " (" + name + "): " + problem)
      .At(source_, number_)
      .About(name, value);
}

std::vector<std::string_view> SplitCells(std::string_view line, char separator) {
  std::vector<std::string_view> cells;
  for (size_t begin = 0; begin <= line.size();) {
    const size_t end = std::min(line.find(separator, begin), line.size());
    cells.push_back(Trimmed(line.substr(begin, end - begin)));
    begin = end + 1;
  }
  return cells;
}

std::optional<std::vector<double>> ToNumbers(std::string_view line) {
  std::vector<double> numbers;
  if (line.empty()) return numbers;
  for (const std::string_view cell : SplitCells(line)) {
    const std::optional<double> number = ToNumber(cell);
    if (!number) return std::nullopt;
    numbers.push_back(*number);
  }
  return numbers;
}

std::vector<std::string_view> SplitWords(std::string_view line) {
  std::vector<std::string_view> words;
  for (size_t begin = line.find_first_not_of(kSpace); begin != std::string_view::npos;) {
    const size_t end = std::min(line.find_first_of(kSpace, begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    begin = line.find_first_not_of(kSpace, end);
  }
  return words;
}

std::optional<double> ToNumber(std::string_view cell) {
  if (cell.starts_with('+')) cell.remove_prefix(1);
  return Whole<double>(cell);
}

std::optional<int> ToInteger(std::string_view cell) { return Whole<int>(cell); }

std::vector<int> IntegersByX(std::string_view text) {
  std::vector<int> numbers;
  for (size_t begin = 0; begin <= text.size();) {
    const size_t end = std::min(text.find('x', begin), text.size());
    const std::optional<int> number = ToInteger(text.substr(begin, end - begin));
    if (!number) return {};
    numbers.push_back(*number);
    begin = end + 1;
  }
  return numbers;
}

double ReadNumber(const TextLines& lines, size_t column, const std::string& name,
                  std::string_view cell) {
  if (const std::optional<double> number = ToNumber(cell)) return *number;
  lines.FailAt(column, name, Quoted(cell) + " is no number", ErrorKind::kFormat, cell);
}

void ReadNumbers(const TextLines& lines, const std::vector<std::string_view>& cells,
                 const std::vector<std::string>& names, std::vector<double>* numbers) {
  if (cells.size() != names.size()) {
    lines.Fail(std::to_string(cells.size()) + (cells.size() == 1 ? " column" : " columns") +
                   "; expected " + std::to_string(names.size()) + ", from " + names.front() +
                   " to " + names.back(),
               ErrorKind::kFormat, "columns", std::to_string(cells.size()));
  }
  numbers->resize(cells.size());
  for (size_t k = 0; k < cells.size(); ++k) {
    (*numbers)[k] = ReadNumber(lines, k, names[k], cells[k]);
  }
}

double ReadAngle(const TextLines& lines, size_t column, const std::string& name, double number,
                 double unit, const AngleRange& range) {
  const double angle = number * unit;
  const double min = DegreesToRadians(range.min_deg), max = DegreesToRadians(range.max_deg);
  if (angle >= min - kAngleRounding && angle <= max + kAngleRounding) return angle;
  const bool degrees = unit < 1;
  std::ostringstream problem;
  problem << number << " is no such angle; expected "
          << (degrees ? "degrees from " : "radians from ") << (degrees ? range.min_deg : min)
          << " to " << (degrees ? range.max_deg : max);
  lines.FailAt(column, name, problem.str(), ErrorKind::kRange, FactText(number));
}

SphericalAngles ReadAngles(const TextLines& lines, const std::vector<std::string>& names,
                           const std::vector<double>& numbers, const AngleColumns& columns,
                           double unit) {
  const auto read = [&](size_t column, const AngleRange& range) {
    return ReadAngle(lines, column, names[column], numbers[column], unit, range);
  };
  constexpr AngleRange kTheta = {0, 180}, kPhi = {-360, 360};
  SphericalAngles angles;
  angles.theta_i = std::max(read(columns.theta_i, kTheta), 0.0);
  angles.phi_i = read(columns.phi_i, kPhi);
  angles.theta_o = std::max(read(columns.theta_o, kTheta), 0.0);
  angles.phi_o = read(columns.phi_o, kPhi);
  return angles;
}

}  // namespace trilobe
