#ifndef TRILOBE_MODEL_OBJECTIVE_SHADOWING_PIECES_H_
#define TRILOBE_MODEL_OBJECTIVE_SHADOWING_PIECES_H_

#include <vector>

#include "trilobe/core/base/catmull_rom.h"
#include "trilobe/model/factor_model.h"

namespace trilobe {

// The spline pieces of the cosines at the nodes of G.
std::vector<CatmullRom::Piece> CosinePieces(const CatmullRom& spline);

// The spline pieces of a model's G tables. [num_tables][interval]
std::vector<std::vector<CatmullRom::Piece>> ShadowingPieces(const FactorModel& model);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_OBJECTIVE_SHADOWING_PIECES_H_
