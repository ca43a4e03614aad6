#include "formats/write_measurement.h"

#include "files/file.h"
#include "trilobe/brdf/measurement_stats.h"
#include "trilobe/formats/csv_file.h"
#include "trilobe/formats/merl_file.h"
#include "trilobe/formats/utia_file.h"

namespace trilobe {

std::string WriteMeasurement(const Measurement& measurement, const std::string& path,
                             int num_threads) {
  const auto counts_text = [](const BinCounts& counts, const std::string& what) {
    return std::to_string(counts.valid) + " of " + std::to_string(counts.total) + what;
  };
  const std::string ending = EndingOf(path);
  if (ending == ".csv") return "CSV, " + std::to_string(WriteCsv(measurement, path)) + " samples";
  if (ending == ".bin") {
    const Measurement at_nodes = AtNodes(measurement, kUtiaGrid, num_threads);
    WriteUtia(at_nodes, path);
    return "UTIA layout, " + counts_text(at_nodes.counts, " pairs of directions valid");
  }
  const BrdfTable& table = TableOf(measurement);
  WriteMerl(table, path);
  return "MERL layout, " + counts_text(CountBins(table), " bins valid");
}

}  // namespace trilobe
