#include "trilobe/io/formats/trace_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <system_error>

#include "core/files/file.h"
#include "trilobe/core/base/error.h"

namespace trilobe {
namespace {

constexpr std::string_view kHeader =
    "iteration,seconds,objective,filtered,accepted,step,optimality";
// Columns after these, which older programs did not write; and, for a fit with a prior, the former
// name.
constexpr std::string_view kProcessor = ",processor_seconds";
constexpr std::string_view kWithPrior = ",objective_with_prior";
constexpr std::string_view kGuided = ",guided_objective";

template <typename T>
void Append(T value, std::string* text) {
  std::array<char, 32> buffer;  // the longest double has 24 characters
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
  text->append(buffer.data(), end);
}

// Cuts the text up to the next `separator` from its front, and the separator with it.
std::string_view TakeUntil(char separator, std::string_view* text) {
  const size_t end = text->find(separator);
  const std::string_view head = text->substr(0, end);
  text->remove_prefix(end == std::string_view::npos ? text->size() : end + 1);
  return head;
}

// Cuts `ending` off, if there is one.
bool TakeEnding(std::string_view ending, std::string_view* text) {
  if (!text->ends_with(ending)) return false;
  text->remove_suffix(ending.size());
  return true;
}

int CountCells(std::string_view row) { return static_cast<int>(std::ranges::count(row, ',')) + 1; }

Error TraceError(const std::string& source, int line, const std::string& problem) {
  return Error(ErrorKind::kFormat, source + ": line " + std::to_string(line) + ": " + problem)
      .At(source, line);
}

// One row, read from left to right.
class Row {
 public:
  // Throws Error unless there are as many cells as columns.
  Row(std::string_view text, int columns, const std::string& source, int line)
      : rest_(text), source_(source), line_(line) {
    const int cells = CountCells(text);
    if (cells != columns) {
      throw TraceError(
          source, line,
          std::to_string(cells) + " columns; this trace has " + std::to_string(columns))
          .About("columns", cells);
    }
  }

  template <typename T>
  T Take(const char* column) {
    const std::string_view cell = TakeUntil(',', &rest_);
    T value{};
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    if (error != std::errc() || end != cell.data() + cell.size() || !(value >= T{0}) ||
        !std::isfinite(static_cast<double>(value))) {
      throw TraceError(source_, line_, std::string(column) + " must be a finite number >= 0")
          .About(column, cell);
    }
    return value;
  }

  bool TakeBool(const char* column) {
    const std::string_view cell = TakeUntil(',', &rest_);
    if (cell != "0" && cell != "1") {
      throw TraceError(source_, line_, std::string(column) + " must be 0 or 1").About(column, cell);
    }
    return cell == "1";
  }

  std::optional<double> TakeOptional(const char* column) {
    if (rest_.empty() || rest_.front() == ',') {
      TakeUntil(',', &rest_);
      return std::nullopt;
    }
    return Take<double>(column);
  }

 private:
  std::string_view rest_;
  const std::string& source_;
  int line_;
};

}  // namespace

std::string FormatTrace(std::span<const IterationRecord> records) {
  std::string text(kHeader);
  const bool with_prior = !records.empty() && records.front().objective_with_prior;
  const bool with_processor = !records.empty() && records.front().processor_seconds;
  if (with_processor) text += kProcessor;
  if (with_prior) text += kWithPrior;
  text += '\n';
  for (const IterationRecord& record : records) {
    Append(record.iteration, &text);
    text += ',';
    Append(record.seconds, &text);
    text += ',';
    Append(record.objective, &text);
    text += record.filtered ? ",1" : ",0";
    text += record.accepted ? ",1," : ",0,";
    Append(record.step, &text);
    text += ',';
    if (record.optimality) Append(*record.optimality, &text);
    if (with_processor) {
      text += ',';
      Append(record.processor_seconds.value_or(0), &text);
    }
    if (with_prior) {
      text += ',';
      Append(record.minimised(), &text);
    }
    text += '\n';
  }
  return text;
}

std::vector<IterationRecord> ParseTrace(std::string_view text, const std::string& source) {
  std::vector<IterationRecord> records;
  bool with_prior = false, with_processor = false;
  for (int line = 1; line == 1 || !text.empty(); ++line) {
    std::string_view content = TakeUntil('\n', &text);
    if (content.ends_with('\r')) content.remove_suffix(1);  // saved by a spreadsheet
    if (line == 1) {
      with_prior = TakeEnding(kWithPrior, &content) || TakeEnding(kGuided, &content);
      with_processor = TakeEnding(kProcessor, &content);
      if (content == kHeader) continue;
      throw TraceError(source, line, "not a trace; the first line must be " + std::string(kHeader))
          .About("header");
    }
    Row row(content, CountCells(kHeader) + int{with_processor} + int{with_prior}, source, line);
    IterationRecord record;
    record.iteration = row.Take<int>("iteration");
    record.seconds = row.Take<double>("seconds");
    record.objective = row.Take<double>("objective");
    record.filtered = row.TakeBool("filtered");
    record.accepted = row.TakeBool("accepted");
    record.step = row.Take<double>("step");
    record.optimality = row.TakeOptional("optimality");
    if (with_processor) record.processor_seconds = row.Take<double>("processor_seconds");
    if (with_prior) record.objective_with_prior = row.Take<double>("objective_with_prior");
    records.push_back(record);
  }
  return records;
}

void WriteTrace(const std::string& path, std::span<const IterationRecord> records) {
  WriteFile(path, [&](std::ostream& out) { out << FormatTrace(records); });
}

std::vector<IterationRecord> ReadTrace(const std::string& path) {
  return ParseTrace(ReadFile(path), path);
}

}  // namespace trilobe
