// ParseUtia on arbitrary bytes, and on a file of the right size that repeats them, with the
// radiometry that the first byte says, on a grid of few nodes (files of UTIA's own have 2 MB); what
// it accepts must be scattered samples that keep their promises.

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "check_measurement.h"
#include "io/formats/utia_file.h"
#include "trilobe/core/base/error.h"
#include "trilobe/core/files/content.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size < 2) return 0;
  const trilobe::HemisphereGrid grid = data[0] % 2 == 0
                                           ? trilobe::HemisphereGrid{.thetas = 2, .phis = 4}
                                           : trilobe::HemisphereGrid{.thetas = 3, .phis = 2};
  const auto& radiometries = trilobe::UtiaRadiometries();
  const std::string& radiometry = radiometries[data[0] / 2 % radiometries.size()].name;
  const std::string_view given(reinterpret_cast<const char*>(data) + 1, size - 1);
  try {
    trilobe::ParseUtia(given, "fuzz", radiometry, grid);
  } catch (const trilobe::Error&) {
  }
  const size_t needed =
      sizeof(double) * trilobe::kChannels * static_cast<size_t>(grid.nodes() * grid.nodes());
  std::string bytes;
  while (bytes.size() < needed) bytes += given;
  bytes.resize(needed);
  trilobe::CheckScattered(trilobe::ParseUtia(bytes, "fuzz", radiometry, grid));
  return 0;
}
