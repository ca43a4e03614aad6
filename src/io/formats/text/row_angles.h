#ifndef TRILOBE_IO_FORMATS_TEXT_ROW_ANGLES_H_
#define TRILOBE_IO_FORMATS_TEXT_ROW_ANGLES_H_

#include <optional>

#include "core/files/text_lines.h"
#include "io/formats/text/column_layout.h"
#include "io/formats/text/given_angles.h"
#include "io/formats/text/table_row.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/io/formats/measurement_format.h"

namespace trilobe {

// The directions of the rows of a text table, by their columns, by lines between the rows, and by
// flags.
class RowAngles {
 public:
  enum Angle { kThetaI, kPhiI, kThetaO, kPhiO };  // as ColumnLayout::angles

  // `above` are the angles that lines above the rows give. `layout` and `options` must stay.
  RowAngles(const ColumnLayout& layout, const SourceOptions& options, const AnglesInText& above);

  // Begins with the first row, once more.
  void Begin();
  // Takes the angles that a line between the rows gives. Throws Error if a flag says otherwise.
  void TakeGiven(const TextLines& lines, const AnglesInText& given);
  // The directions of a row; phi_o is `turned` by 180 degrees. Throws Error for what is no angle.
  SphericalAngles Of(const TextLines& lines, bool turned, TableRow* row);

  // Of the last row, with their signs [rad].
  double theta_i() const { return theta_i_; }
  double theta_o() const { return theta_o_; }

  // Of all rows so far: whether they lie in the plane of incidence, and have one phi_i and thetas
  // below 0.
  bool in_plane() const { return in_plane_; }
  bool one_phi_i() const { return one_phi_i_; }
  bool has_signs() const { return signed_; }

  // Whether the phase gives azimuths, too.
  bool HasAzimuths() const { return layout_.angles[kPhiO] || layout_.phase; }

  // For a note: "theta_i = 30 deg", "phi_i by lines between the rows"; "" if columns have them.
  std::string ThetaINote() const;
  std::string PhiINote() const;
  // That the flag, and not a line above the rows, gives theta_i; else "".
  std::string NoteOnFlag() const;

 private:
  bool IsByFlag(double theta_i) const;
  double AngleOf(const TextLines& lines, Angle angle, const AngleRange& range, double missing,
                 TableRow* row) const;
  bool HasNoAzimuth(Angle angle, const TextLines& lines, TableRow* row) const;
  double AzimuthByPhase(const TextLines& lines, TableRow* row) const;

  const ColumnLayout& layout_;
  const SourceOptions& options_;
  AnglesInText above_;
  bool adds_phi_i_;                             // phi_o is the difference to a given phi_i
  double given_theta_o_;                        // [rad] by a flag
  double block_theta_i_ = 0, block_phi_i_ = 0;  // [rad] of rows that do not have them
  bool has_blocks_ = false, has_phi_blocks_ = false, has_rows_ = false;
  double theta_i_ = 0, theta_o_ = 0;
  std::optional<double> phi_i_;  // of the first row
  bool in_plane_ = true, signed_ = false, one_phi_i_ = true;
};

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_TEXT_ROW_ANGLES_H_
