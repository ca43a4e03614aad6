#include "model/measurement/note_symptoms.h"

#include <algorithm>
#include <iterator>
#include <string>
#include <vector>

#include "model/measurement/sample_symptoms.h"
#include "model/measurement/symptoms.h"

namespace trilobe {

void NoteSymptoms(int num_threads, Measurement* measurement) {
  const std::vector<std::string> told = measurement->table
                                            ? SymptomsOf(*measurement->table, num_threads)
                                            : SymptomsOfSamples(*measurement);
  std::ranges::copy(told, std::back_inserter(measurement->notes));
}

}  // namespace trilobe
