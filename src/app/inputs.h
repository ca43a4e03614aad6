#ifndef TRILOBE_APP_INPUTS_H_
#define TRILOBE_APP_INPUTS_H_

#include <string>

#include "trilobe/io/formats/model_file.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/model/measurement/measurement.h"

namespace trilobe {

// Whether the name is material:NAME or a readable file that begins like a JSON object, as only
// model files do.
bool IsModelFile(const std::string& path);

// Loads the model of an argument MODEL (LoadModel). Throws Error, which names the format if the
// file is not a model.
ModelFile ModelOfSource(const std::string& path);

// Throws Error for material:NAME, a model where a measurement is needed.
void RefuseMaterial(const std::string& source);

// Loads the measurement of an argument SOURCE. Throws Error.
Measurement MeasurementOfSource(const std::string& source, const SourceOptions& options);

// --out. Throws Error without it: "trilobe synth needs --out=FILE, ...".
std::string RequiredOut(const std::string& command, const std::string& what);

// Throws Error if --out has an extension other than .png.
void CheckPictureOut();

// --out of a command that calls WriteMeasurement. Throws Error without it, and if its extension is
// not that of a format that can be written, as in "felt.bsdf".
std::string RequiredMeasurementOut(const std::string& command);

}  // namespace trilobe

#endif  // TRILOBE_APP_INPUTS_H_
