#ifndef TRILOBE_MODEL_MEASUREMENT_CORRUPTION_KINDS_H_
#define TRILOBE_MODEL_MEASUREMENT_CORRUPTION_KINDS_H_

#include <cstdint>

#include "model/measurement/corrupted_readings.h"

// The kinds of corruption; CorruptionKinds() has their formulas.

namespace trilobe {

// Faults of single readings.
void AddNoise(double strength, uint64_t seed, Readings* readings);
void AddDarkNoise(double strength, uint64_t seed, Readings* readings);
void AddPhotonNoise(double strength, uint64_t seed, Readings* readings);
void AddOutliers(double strength, uint64_t seed, Readings* readings);
void AddSpikes(double strength, uint64_t seed, Readings* readings);
void AddZeros(double strength, uint64_t seed, Readings* readings);
void Clip(double strength, uint64_t seed, Readings* readings);
void Quantize(double strength, uint64_t seed, Readings* readings);
void QuantizeInBrackets(double strength, uint64_t seed, Readings* readings);
void MixChannels(double strength, uint64_t seed, Readings* readings);
void AddStrayLight(double strength, uint64_t seed, Readings* readings);
void AddFlare(double strength, uint64_t seed, Readings* readings);
void MultiplyByCosine(double strength, uint64_t seed, Readings* readings);
void MultiplyByOutgoingCosine(double strength, uint64_t seed, Readings* readings);
void Multiply(double strength, uint64_t seed, Readings* readings);
void BreakReciprocity(double strength, uint64_t seed, Readings* readings);
void CastShadow(double strength, uint64_t seed, Readings* readings);

// Missing data.
void LoseAtRandom(double strength, uint64_t seed, Readings* readings);
void LoseCone(double strength, uint64_t seed, Readings* readings);
void LoseBeyond(double strength, uint64_t seed, Readings* readings);
void LoseSide(double strength, uint64_t seed, Readings* readings);

// Readings at other directions than recorded.
void Tilt(double strength, uint64_t seed, Readings* readings);
void ShiftOrigin(double strength, uint64_t seed, Readings* readings);
void BlurByAperture(double strength, uint64_t seed, Readings* readings);
void RepeatBeyond(double strength, uint64_t seed, Readings* readings);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MEASUREMENT_CORRUPTION_KINDS_H_
