#ifndef TRILOBE_SUMS_SAMPLE_SUMS_H_
#define TRILOBE_SUMS_SAMPLE_SUMS_H_

#include "objective/sample_reader.h"
#include "sums/sample_layout.h"
#include "trilobe/objective/quadratic_model.h"

namespace trilobe {

// Adds the samples [begin, end) to sums; returns their part of E.
//
// A sample moves with its readings: in each channel with d, s and what it reads from the tables of
// D, F and, twice, G. Products of two readings are summed over the channels first; then each goes,
// by the weights of both stencils, to the pairs of entries that were read. Products of two entries
// of one reading go to one of the pair's two places, those of an entry with itself by half: who
// reads them adds both places. For Hessian::kNewton, second derivatives are added to the products
// of readings, and squared lengths are summed apart.
double AddSampleSums(const SampleReader& reader, const SampleLayout& layout, Hessian hessian,
                     int begin, int end, double* sums);

}  // namespace trilobe

#endif  // TRILOBE_SUMS_SAMPLE_SUMS_H_
