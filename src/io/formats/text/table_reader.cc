#include "io/formats/text/table_reader.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "core/base/text.h"
#include "core/files/text_lines.h"
#include "io/formats/spectrum_bands.h"
#include "io/formats/text/brighter_side.h"
#include "io/formats/text/column_advice.h"
#include "io/formats/text/column_layout.h"
#include "io/formats/text/first_rows.h"
#include "io/formats/text/given_angles.h"
#include "io/formats/text/kind_columns.h"
#include "io/formats/text/matrix_table.h"
#include "io/formats/text/phase_column.h"
#include "io/formats/text/repeated_rows.h"
#include "io/formats/text/row_angles.h"
#include "io/formats/text/row_choice.h"
#include "io/formats/text/spectra_of_rows.h"
#include "io/formats/text/table_columns.h"
#include "io/formats/text/table_head.h"
#include "io/formats/text/table_lines.h"
#include "io/formats/text/table_row.h"
#include "io/formats/text/text_table.h"
#include "model/measurement/sample_symptoms.h"
#include "trilobe/core/base/error.h"

namespace trilobe {
namespace {

class TableReader {
 public:
  TableReader(std::string_view text, const std::string& source, const SourceOptions& options)
      : source_(source),
        options_(options),
        above_(AnglesBeforeRows(text)),
        given_{.theta_i = options.theta_i_deg != -1 || above_.theta_i,
               .theta_o = options.theta_o_deg != -1,
               .values = options.may_lack_values},
        head_(HeadOf(text, source, options.columns, given_.theta_i || given_.theta_o)),
        header_(head_.lines),
        layout_(Layout()),
        angles_(layout_, options, above_),
        row_(head_.separator, layout_),
        choice_(options.rows, head_.names, header_),
        kinds_(layout_, choice_.columns()) {
    numbers_.resize(layout_.is_polarised ? 1 : layout_.values.size());
  }

  Measurement Read() {
    // Whether phi_o is that of the signs, turned by 180 degrees.
    bool turned = !angles_.HasAzimuths();
    FindApart(turned);
    Measurement measurement = ReadRows(turned);
    by_brightness_ =
        angles_.in_plane() && angles_.has_signs() && brighter_.both() && !layout_.from_mirror;
    if (by_brightness_ && brighter_.same() != turned) {
      turned = brighter_.same();
      measurement = ReadRows(turned);
    }
    if (options_.scale == 0 && MayBeFactor(layout_)) {
      header_.Fail(AdviceOnFactor(layout_.columns[layout_.values[0]].name,
                                  MedianReflected(measurement.samples)),
                   ErrorKind::kMissing, "scale", layout_.columns[layout_.values[0]].name);
    }
    if (bands_) measurement.bands = bands_->all();
    if (!IsUsual()) measurement.notes.push_back(Note(turned));
    if (repeated_.IsRepeated()) measurement.notes.push_back(NoteOnRepeated());
    for (std::string& note : kinds_.Notes()) measurement.notes.push_back(std::move(note));
    const auto note_unread = [&](double given, RowAngles::Angle angle, const std::string& name) {
      if (given == -1 || !layout_.angles[angle]) return;
      measurement.notes.push_back("--" + name + " is of tables without a column " + name +
                                  ", and changes nothing here");
    };
    if (const std::string note = angles_.NoteOnFlag(); !note.empty()) {
      measurement.notes.push_back(note);
    }
    note_unread(options_.theta_i_deg, RowAngles::kThetaI, "theta_i");
    note_unread(options_.theta_o_deg, RowAngles::kThetaO, "theta_o");
    return measurement;
  }

 private:
  ColumnLayout Layout() {
    first_names_ = head_.names;
    GoToRows(&head_);
    std::vector<TableColumn> columns = ColumnsOf(head_, header_, options_.columns);
    const FirstRows rows(head_);
    MarkPhase(rows, &columns);
    if (const std::string advice = AdviceOn(columns, given_, rows); !advice.empty()) {
      header_.Fail(advice, ErrorKind::kUnsupported, "columns");
    }
    CheckNames(options_.columns);
    return LayoutOf(header_, columns, given_, rows,
                    /*prefers_bands=*/!options_.bands.empty());
  }

  // Looks for what tells rows of the same directions apart.
  void FindApart(bool turned) {
    angles_.Begin();
    for (TextLines lines = head_.lines; kinds_.MayTell() && lines.NextWithComment();) {
      if (!row_.Take(lines)) {
        IsBetween(lines);
        continue;
      }
      if (!choice_.Takes(lines, &row_)) continue;
      const SphericalAngles at = angles_.Of(lines, turned, &row_);
      if (!Values(lines)) continue;
      kinds_.Add(lines, at, layout_.wavelength ? WavelengthOf(lines) : 0, &row_);
    }
    apart_ = kinds_.Found(header_);
  }

  Measurement ReadRows(bool turned) {
    SampleCollector collector(source_, "CSV file of scattered samples");
    if (!layout_.wavelengths.empty()) bands_.emplace(layout_.wavelengths, options_.bands, source_);
    // One value of a wavelength that the row has, too.
    std::optional<SpectraOfRows> by_rows;
    if (layout_.wavelength && numbers_.size() == 1 && !bands_) by_rows.emplace();
    brighter_ = {};
    angles_.Begin();
    lines_after_ = 0;
    repeated_ = {};
    std::optional<TextLines> first_after;
    const auto add = [&](const TextLines& lines, const SphericalAngles& at, double wavelength) {
      if (by_rows) {
        AddToRows(lines, at, wavelength, &*by_rows);
      } else if (bands_) {
        bands_->Add(at, numbers_, &collector);
      } else {
        collector.Add(at, Channels());
      }
    };
    for (TextLines lines = head_.lines; lines.NextWithComment();) {
      if (!row_.Take(lines)) {
        if (IsBetween(lines)) continue;
        if (!first_after) first_after = lines;
        ++lines_after_;
        continue;
      }
      if (first_after) row_.FailAsRow(*first_after);  // it stands between rows
      if (!choice_.Takes(lines, &row_)) continue;
      const SphericalAngles angles = angles_.Of(lines, turned, &row_);
      if (!Values(lines)) {
        if (!by_rows && apart_.empty()) collector.LeaveOut(&BinCounts::missing);
        continue;
      }
      if (angles_.in_plane()) brighter_.Add(angles_.theta_i(), angles_.theta_o(), Channels());
      const double wavelength = CheckedWavelength(lines, by_rows.has_value());
      if (!apart_.empty()) {
        repeated_.Add(KindColumns::KindOf(lines, apart_, &row_), {angles, wavelength, numbers_});
      } else {
        add(lines, angles, wavelength);
      }
    }
    choice_.CheckTaken();
    for (const RepeatedRows::Row& row : repeated_.Means()) {
      numbers_ = row.values;
      add(header_, row.at, row.wavelength);
    }
    for (int k = 0; repeated_.IsRepeated() && k < repeated_.incomplete(); ++k) {
      collector.LeaveOut(&BinCounts::missing);
    }
    if (by_rows && !by_rows->wavelengths().empty()) {
      bands_.emplace(by_rows->wavelengths(), options_.bands, source_);
      by_rows->AddTo(&*bands_, &collector);
    }
    // Light from both sides of one plane shows nothing of a grain.
    return angles_.one_phi_i() ? collector.Take() : collector.TakeByAzimuths();
  }

  // The values of a row: one counts for all channels, and of a spectrum the first three.
  Rgb Channels() const {
    if (numbers_.empty()) return {0, 0, 0};
    const size_t last = numbers_.size() - 1;
    return {numbers_[0], numbers_[std::min<size_t>(1, last)], numbers_[std::min<size_t>(2, last)]};
  }

  // Whether a line may stand between rows: a comment, the header once more, or one that gives
  // theta_i or phi_i to the rows below.
  bool IsBetween(const TextLines& lines) {
    const std::string_view line = lines.line();
    if (const AnglesInText given = AnglesInLine(line)) {
      angles_.TakeGiven(lines, given);
      return true;
    }
    if (line.starts_with('[') && line.ends_with(']')) return true;  // the name of a section
    if (WithoutComment(line).empty() || IsRule(line) || IsEmptyRow(line)) return true;
    std::vector<std::string_view> cells;
    SplitRow(line, head_.separator, &cells);
    if (cells.size() > head_.names.size() && cells.back().empty()) cells.pop_back();
    return std::ranges::equal(cells, first_names_);
  }

  // Takes the values of the row; false where none was measured.
  bool Values(const TextLines& lines) {
    const auto is_gap = [&](size_t column) { return row_.IsGapAt(column); };
    if (layout_.values.empty()) return true;
    if (is_gap(layout_.values[0]) && std::ranges::all_of(layout_.values, is_gap)) return false;
    double sum = 0;
    for (size_t k = 0; k < layout_.values.size(); ++k) {
      const size_t column = layout_.values[k];
      const double value = Linear(layout_.columns[column].scale, row_.Number(lines, column));
      sum += value;
      if (!layout_.is_polarised) numbers_[k] = value;
    }
    // Of light and detector, f_ss + f_sp is of light s, and f the mean over s and p; of light or
    // detector alone, f is the mean of two.
    if (layout_.is_polarised) numbers_[0] = sum / 2;
    return true;
  }

  static double Linear(ValueScale scale, double number) {
    switch (scale) {
      case ValueScale::kLinear:
        return number;
      case ValueScale::kDecibels:
        return std::pow(10, number / 10);
      case ValueScale::kLog10:
        return std::pow(10, number);
      default:
        return std::exp(number);
    }
  }

  // [nm], of a row.
  double WavelengthOf(const TextLines& lines) {
    constexpr double kShortest = 0.2, kLongest = 20;  // [um]
    const size_t column = *layout_.wavelength;
    const std::string& unit = layout_.columns[column].unit;
    const double number = row_.Number(lines, column);
    if (unit == "m") return 1e9 * number;
    const bool micrometres = unit == "um" || unit.starts_with("micron") ||
                             (unit.empty() && number >= kShortest && number <= kLongest);
    return micrometres ? 1000 * number : number;
  }

  // [nm], of a row; 0 without. A spectrum may be `by_rows`; else all have the same.
  double CheckedWavelength(const TextLines& lines, bool by_rows) {
    if (!layout_.wavelength) return 0;
    const size_t column = *layout_.wavelength;
    const std::string& name = layout_.columns[column].name;
    const double wavelength = WavelengthOf(lines);
    if (by_rows) {
      if (wavelength > 0 && std::isfinite(wavelength)) return wavelength;
      lines.FailAt(column, name, "expected a wavelength in nm", ErrorKind::kRange,
                   FactText(wavelength));
    }
    if (!wavelength_) wavelength_ = wavelength;
    if (bands_ || wavelength == *wavelength_) return wavelength;
    lines.FailAt(column, name,
                 Text(wavelength) + " comes after " + Text(*wavelength_) +
                     "; make a column of each wavelength, as 550nm, or a file of each",
                 ErrorKind::kUnsupported, FactText(wavelength));
  }

  void AddToRows(const TextLines& lines, const SphericalAngles& angles, double wavelength,
                 SpectraOfRows* by_rows) {
    if (by_rows->Add(angles, wavelength, numbers_[0])) return;
    lines.Fail("this is one wavelength more than the " +
                   std::to_string(SpectraOfRows::kMostWavelengths) + " of a spectrum",
               ErrorKind::kLimit, "wavelength");
  }

  // Whether the table has the layout that this library writes, once the only one that it read.
  bool IsUsual() const {
    return head_.separator == ',' && !head_.in_comment && head_.lines_before == 0 &&
           lines_after_ == 0 && options_.columns.empty() && !angles_.has_signs() &&
           !row_.decimal_commas() && layout_.HasAllAngles() &&
           std::ranges::all_of(layout_.columns, &TableColumn::is_usual_name);
  }

  std::string Note(bool turned) const;

  std::string NoteOnRepeated() const {
    std::string names, flag = "--rows=";
    for (const size_t k : apart_) {
      const std::string& name = layout_.columns[k].name;
      names += (names.empty() ? "'" : "' and '") + name;
      flag += (flag.ends_with('=') ? "" : ",") + name + "=CELL";
    }
    const bool is_one = apart_.size() == 1;
    const int lack = repeated_.incomplete();
    return std::string(is_one ? "column " : "columns ") + names + "' (" + repeated_.Kinds() +
           (is_one ? ") tells" : ") tell") + " rows of the same directions apart: " +
           (repeated_.IsCrossed() ? "half their sum" : "their mean") + " is taken" +
           (lack > 0 ? ", " + std::to_string(lack) + " directions that lack one are left out"
                     : "") +
           "; " + flag + " reads one alone";
  }

  const std::string& source_;
  const SourceOptions& options_;
  AnglesInText above_;  // the rows, by lines of text
  GivenAngles given_;
  std::vector<std::string> first_names_;  // of the header, without units
  TableHead head_;
  TextLines header_;  // at its line
  ColumnLayout layout_;
  RowAngles angles_;
  TableRow row_;
  RowChoice choice_;
  KindColumns kinds_;
  std::vector<size_t> apart_;  // the columns of the kinds of repeated rows
  RepeatedRows repeated_;
  std::vector<double> numbers_;         // the values of a row
  std::optional<double> wavelength_;    // of the first row
  std::optional<SpectrumBands> bands_;  // of spectra
  bool by_brightness_ = false;
  int lines_after_ = 0;  // of text, behind the rows
  BrighterSide brighter_;
};

std::string Lines(int count) { return std::to_string(count) + (count == 1 ? " line" : " lines"); }

std::string TableReader::Note(bool turned) const {
  std::string note;
  const auto say = [&](bool is_so, const std::string& what) {
    if (is_so) note += (note.empty() ? "read as: " : ", ") + what;
  };
  say(head_.lines_before > 0, Lines(head_.lines_before) + " before the header");
  say(head_.in_comment, "a header in a comment");
  say(!options_.columns.empty(), "columns by --columns");
  say(head_.separator == ';', "semicolons");
  say(head_.separator == '\t', "tabs");
  say(head_.separator == '|', "bars");
  say(head_.separator == ' ', "blanks");
  say(row_.decimal_commas(), "decimal commas");
  for (const std::string& renamed : RenamedColumns(layout_)) say(true, renamed);
  say(layout_.HasAnglesIn(kPi / 180), "degrees");
  say(layout_.HasAnglesIn(1), "radians");
  say(layout_.HasAnglesIn(kPi / 200), "gon");
  say(!angles_.ThetaINote().empty(), angles_.ThetaINote());
  say(!layout_.angles[RowAngles::kThetaO], "theta_o = " + Text(options_.theta_o_deg) + " deg");
  say(!angles_.PhiINote().empty(), angles_.PhiINote());
  const std::string side = turned ? "theta_o > 0 on the side of the mirror direction"
                                  : "theta_o > 0 on the side of the light";
  const bool by_side = (!angles_.HasAzimuths() && !layout_.from_mirror) || by_brightness_;
  say(layout_.phase.has_value(), "azimuths by the angle between the directions");
  say(layout_.from_mirror && !angles_.HasAzimuths(),
      "theta_o as theta_i and that angle, > 0 from the mirror direction away from the normal");
  say(layout_.from_mirror && angles_.HasAzimuths(),
      "theta_o as the angle from the mirror direction, and phi_o as the azimuth about it, 0 "
      "towards "
      "the normal");
  say(by_side, side + (by_brightness_ ? ", as its samples say" : ""));
  say(angles_.has_signs() && !by_side, "theta < 0 as phi + 180 deg");
  const bool is_one = bands_ ? bands_->read().size() == 1 : numbers_.size() == 1;
  say(is_one, "one value for all channels");
  const ValueScale scale =
      layout_.values.empty() ? ValueScale::kLinear : layout_.columns[layout_.values[0]].scale;
  say(scale == ValueScale::kDecibels, "decibels as 10^(dB/10)");
  say(scale == ValueScale::kLog10, "logarithms as 10^x");
  say(scale == ValueScale::kLn, "logarithms as e^x");
  say(bands_.has_value() && layout_.wavelength, "a row a wavelength");
  if (bands_) say(true, bands_->Note());
  say(!options_.rows.empty(), "rows of " + options_.rows);
  say(lines_after_ > 0, Lines(lines_after_) + " after the table");
  say(true, "f in 1/sr");
  if (!layout_.left_out.empty()) note += "; left out: " + LeftOutColumns(layout_);
  return note;
}

}  // namespace

Measurement ReadTextTable(std::string_view text, const std::string& source,
                          const SourceOptions& options) {
  CheckLines(text, source);
  if (HasOddSigns(text)) {
    const std::string plain = WithPlainSigns(text);
    if (plain != text) return ReadTextTable(plain, source, options);
  }
  const bool named = NamesAxes(options.columns);
  if (!named && (!options.columns.empty() || !HasAxes(text))) {
    return TableReader(text, source, options).Read();
  }
  const std::string rows = RowsOfMatrices(text, source, options.columns);
  if (rows.empty()) {
    throw ErrorIn(ErrorKind::kMissing, source, "no matrix of numbers for --columns")
        .About("columns");
  }
  SourceOptions of_rows = options;
  of_rows.columns.clear();
  Measurement measurement = TableReader(rows, source, of_rows).Read();
  for (std::string& note : measurement.notes) {  // the rows are ours
    constexpr std::string_view kSeparator = "semicolons";
    if (const size_t at = note.find(kSeparator); at != std::string::npos) {
      note.replace(at, kSeparator.size(), "a matrix");
    }
  }
  return measurement;
}

}  // namespace trilobe
