#include <gflags/gflags.h>

#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "app/command.h"
#include "app/flags.h"
#include "app/inputs.h"
#include "app/result_folder.h"
#include "app/view_page.h"
#include "files/file.h"
#include "reports/appearance_report.h"
#include "reports/print.h"
#include "trilobe/base/error.h"
#include "trilobe/formats/source.h"
#include "trilobe/results/model_file.h"
#include "trilobe/results/trace_file.h"

DECLARE_string(trace);
DECLARE_string(probe);

namespace trilobe {
namespace {

int RunView(std::span<const std::string> arguments) {
  const std::string path = RequiredOut("view", "FILE.html");
  if (!path.ends_with(".html")) throw Error("--out=" + path + ": end the name in .html");
  std::vector<std::string> read(arguments.begin(), arguments.end());
  for (const std::string& file : {FLAGS_trace, FLAGS_probe}) read.push_back(file);
  Inputs(read).CheckOutput(path);
  if (arguments.size() == 1) RefuseForModel(arguments[0], MeasurementFlags());
  const ModelFile model = ReadModel(arguments[0]);
  std::vector<IterationRecord> trace;
  if (!FLAGS_trace.empty()) trace = ReadTrace(FLAGS_trace);
  std::optional<Measurement> measured;
  if (arguments.size() > 1) {
    measured = LoadMeasurement(arguments[1], SourceOptionsFromFlags());
    TellNotes(*measured);
  }
  const AppearanceOptions appearance = AppearanceOptionsFromFlags();
  const std::string page = ViewPage(model, arguments[0], measured ? &*measured : nullptr,
                                    std::nullopt, trace, appearance);
  WriteFile(path, [&](std::ostream& out) { out << page; });
  PrintLine("wrote " + path + ": a page of " + Text(static_cast<double>(page.size()) / 1e6, 2) +
            " MB; open it in a browser");
  return 0;
}

}  // namespace

Command ViewCommand() {
  return {.name = "view",
          .summary = "write a page that shows a model beside its measurement",
          .arguments = "MODEL [SOURCE]",
          .min_arguments = 1,
          .max_arguments = 2,
          .details =
              "Writes one file of HTML to --out, which a browser opens without a server or a "
              "network: the material on\na sphere, a knot, a cloth or a flat sample, under an "
              "environment or a lamp; with SOURCE the measurement\nbeside it, and where the two "
              "differ; its factors, to be looked at and edited; with --trace the\ncourse of the "
              "fit. --probe lights it by your own light probe.",
          .flags = WithSourceFlags({"out", "trace", "probe"}),
          .run = RunView};
}

}  // namespace trilobe
