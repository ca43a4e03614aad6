#ifndef TRILOBE_MODEL_MEASUREMENT_NOTE_SYMPTOMS_H_
#define TRILOBE_MODEL_MEASUREMENT_NOTE_SYMPTOMS_H_

#include "trilobe/model/measurement/measurement.h"

namespace trilobe {

// Adds the symptoms of faults of a table (symptoms.h) or of scattered samples (sample_symptoms.h)
// to the notes of a measurement.
void NoteSymptoms(int num_threads, Measurement* measurement);

// Whether no sample has a value other than 0, as directions that are read alone.
bool AllAreZero(const BrdfSamples& samples);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MEASUREMENT_NOTE_SYMPTOMS_H_
