#ifndef TRILOBE_MODEL_CORRUPTION_KINDS_H_
#define TRILOBE_MODEL_CORRUPTION_KINDS_H_

#include <cstdint>

#include "model/corruption/readings.h"

// Each kind of corruption, by what CorruptionKinds() has for its formula.

namespace trilobe {

// Of single readings.
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
void BreakReciprocity(double strength, uint64_t seed, Readings* readings);
void CastShadow(double strength, uint64_t seed, Readings* readings);

// What is not measured.
void LoseAtRandom(double strength, uint64_t seed, Readings* readings);
void LoseCone(double strength, uint64_t seed, Readings* readings);
void LoseBeyond(double strength, uint64_t seed, Readings* readings);
void LoseSide(double strength, uint64_t seed, Readings* readings);

// Readings of other directions than they are said to be.
void Tilt(double strength, uint64_t seed, Readings* readings);
void ShiftOrigin(double strength, uint64_t seed, Readings* readings);
void BlurByAperture(double strength, uint64_t seed, Readings* readings);
void RepeatBeyond(double strength, uint64_t seed, Readings* readings);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_CORRUPTION_KINDS_H_
