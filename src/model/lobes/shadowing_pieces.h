#ifndef TRILOBE_MODEL_LOBES_SHADOWING_PIECES_H_
#define TRILOBE_MODEL_LOBES_SHADOWING_PIECES_H_

#include <vector>

#include "trilobe/core/math/catmull_rom.h"
#include "trilobe/model/factor_model.h"

namespace trilobe {

// The cosines of the nodes in pieces: they go through the same spline as G.
std::vector<CatmullRom::Piece> CosinePieces(const CatmullRom& spline);

// The G tables of a model in pieces, [num_tables][interval].
std::vector<std::vector<CatmullRom::Piece>> ShadowingPieces(const FactorModel& model);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_LOBES_SHADOWING_PIECES_H_
