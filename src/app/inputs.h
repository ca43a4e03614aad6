#ifndef TRILOBE_APP_INPUTS_H_
#define TRILOBE_APP_INPUTS_H_

#include <string>

#include "trilobe/io/formats/source.h"
#include "trilobe/io/model_files/model_file.h"
#include "trilobe/model/measurement/measurement.h"

namespace trilobe {

// True of material:NAME, and if the file can be read and begins like a JSON object, as model files
// do and no measurement does.
bool IsModelFile(const std::string& path);

// The model that an argument MODEL stands for: LoadModel, and of a file that holds something else
// the Error says what that is.
ModelFile ModelOfSource(const std::string& path);

// Throws Error for material:NAME, which is a model where a measurement is asked for.
void RefuseMaterial(const std::string& source);

// The measurement that an argument SOURCE stands for. Throws Error.
Measurement MeasurementOfSource(const std::string& source, const SourceOptions& options);

// --out, or an Error that says what it is for: "trilobe synth needs --out=FILE".
std::string RequiredOut(const std::string& command, const std::string& what);

// Throws Error where --out ends as no PNG picture does.
void CheckPictureOut();

// The same for a command that writes a measurement, as WriteMeasurement does; also an Error where
// the name ends otherwise, as "felt.bsdf" does.
std::string RequiredMeasurementOut(const std::string& command);

}  // namespace trilobe

#endif  // TRILOBE_APP_INPUTS_H_
