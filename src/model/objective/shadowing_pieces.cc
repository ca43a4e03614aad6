#include "model/objective/shadowing_pieces.h"

#include <cmath>

namespace trilobe {

std::vector<CatmullRom::Piece> CosinePieces(const CatmullRom& spline) {
  std::vector<double> cosines(spline.nodes());
  for (int k = 0; k < spline.nodes(); ++k) cosines[k] = std::cos(spline.NodeAngle(k));
  return spline.Pieces(cosines);
}

std::vector<std::vector<CatmullRom::Piece>> ShadowingPieces(const FactorModel& model) {
  const ModelSpec& spec = model.spec();
  const CatmullRom spline(spec.g_axis.size);
  std::vector<std::vector<CatmullRom::Piece>> pieces;
  for (int t = 0; t < spec.num_tables(Factor::kG); ++t) {
    pieces.push_back(spline.Pieces(model.table(Factor::kG, t)));
  }
  return pieces;
}

}  // namespace trilobe
