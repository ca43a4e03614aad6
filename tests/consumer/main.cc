#include <trilobe/fit/fit.h>
#include <trilobe/io/formats/model_file.h>
#include <trilobe/io/formats/source.h>

#include <iostream>

int main() {
  using namespace trilobe;
  const Measurement measured = LoadMeasurement("synth:plastic", {.noise = 0.02});
  const FitResult fit = Fit(measured);
  WriteModel(fit.file, "plastic.json");
  std::cout << "CIELAB difference " << fit.appearance->sphere.mean_delta_e << "\n";
}
