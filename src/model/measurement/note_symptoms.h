#ifndef TRILOBE_MODEL_MEASUREMENT_NOTE_SYMPTOMS_H_
#define TRILOBE_MODEL_MEASUREMENT_NOTE_SYMPTOMS_H_

#include "trilobe/model/measurement/measurement.h"

namespace trilobe {

// Adds the symptoms of faults of a table (symptoms.h) or of scattered samples (sample_symptoms.h)
// to the notes of a measurement.
void NoteSymptoms(int num_threads, Measurement* measurement);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MEASUREMENT_NOTE_SYMPTOMS_H_
