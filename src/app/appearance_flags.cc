#include "app/appearance_flags.h"

#include <gflags/gflags.h>

#include "app/flags.h"
#include "io/pictures/image_file.h"

DEFINE_string(
    probe, "",
    "light probe for the spheres, a lat-long Radiance .hdr file; without it a built-in sky "
    "with a sun and area lights");

namespace trilobe {

AppearanceOptions AppearanceOptionsFromFlags() {
  static const Environment probe =
      FLAGS_probe.empty() ? StudioEnvironment() : ReadProbe(FLAGS_probe);
  // For tests, which would spend most of their time under its lights.
  const int lights = google::Int32FromEnv("TRILOBE_TEST_LIGHTS", AppearanceOptions().lights);
  return {.environment = &probe, .lights = lights, .num_threads = ThreadsFromFlags()};
}

}  // namespace trilobe
