#ifndef TRILOBE_IO_FORMATS_TEXT_COLUMN_ROLE_H_
#define TRILOBE_IO_FORMATS_TEXT_COLUMN_ROLE_H_

namespace trilobe {

// Meaning of a column of a text table. The angles come first, as in ColumnLayout::angles.
enum class ColumnRole {
  kThetaI,
  kPhiI,
  kThetaO,
  kPhiO,
  kRed,
  kGreen,
  kBlue,
  kValue,       // for all channels
  kPolarised,   // f of one polarisation: half the sum of such columns is f
  kBand,        // the value at a wavelength
  kWavelength,  // of the row
  kTheta,       // of a direction that the name does not say
  kFromMirror,  // of wo from the mirror direction; in the plane of incidence > 0 beyond it
  kPhi,
  kPhase,  // angle between the two directions
  kOther
};

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_TEXT_COLUMN_ROLE_H_
