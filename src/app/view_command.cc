#include <gflags/gflags.h>

#include <filesystem>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "app/command.h"
#include "app/fit_many.h"
#include "app/fit_page.h"
#include "app/flags.h"
#include "app/inputs.h"
#include "app/result_folder.h"
#include "app/view_page.h"
#include "core/files/file.h"
#include "fit/reports/print.h"
#include "trilobe/core/base/error.h"
#include "trilobe/io/formats/model_file.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/io/formats/trace_file.h"

DECLARE_string(trace);

namespace trilobe {
namespace {

void Write(const std::string& path, const std::string& page, const std::string& what) {
  WriteFile(path, [&](std::ostream& out) { out << page; });
  PrintLine("wrote " + path + ": " + what + " of " +
            Text(static_cast<double>(page.size()) / 1e6, 2) + " MB; open it in a browser");
}

// A page of all fits in a folder, in that folder, since it shows pictures that lie there.
int ViewFolder(const std::string& folder) {
  for (const std::string& flag : WithSourceFlags({"trace", "probe"})) {
    if (!IsDefault(flag)) {
      throw Error(ErrorKind::kConflict,
                  "--" + flag + " is for the page of one model, not of a folder")
          .About(flag);
    }
  }
  const std::string path = FLAGS_out.empty() ? folder + "/index.html" : FLAGS_out;
  std::error_code ignored;
  const std::filesystem::path parent = std::filesystem::absolute(path).parent_path();
  if (!path.ends_with(".html") || !std::filesystem::equivalent(parent, folder, ignored)) {
    throw Error(ErrorKind::kUnsupported,
                "--out=" + path +
                    ": the page of a folder is a .html file in it, as it shows the "
                    "pictures that lie there")
        .About("out", path);
  }
  const std::vector<FitOutcome> fits = ReadFitsIn(folder);
  Inputs().CheckOutput(path);
  const bool table = std::filesystem::exists(folder + "/fits.csv", ignored);
  Write(path, FitsPage(fits, folder, table ? "fits.csv" : ""),
        "a page of " + std::to_string(fits.size()) + (fits.size() == 1 ? " fit," : " fits,"));
  return 0;
}

int RunView(std::span<const std::string> arguments) {
  std::error_code ignored;
  if (arguments.size() == 1 && std::filesystem::is_directory(arguments[0], ignored)) {
    return ViewFolder(arguments[0]);
  }
  const std::string path = RequiredOut("view", "FILE.html");
  if (!path.ends_with(".html")) {
    throw Error(ErrorKind::kUnsupported, "--out=" + path + ": end the name in .html")
        .About("out", path);
  }
  std::vector<std::string> read(arguments.begin(), arguments.end());
  for (const std::string& file : {FLAGS_trace, FLAGS_probe}) read.push_back(file);
  Inputs(read).CheckOutput(path);
  if (arguments.size() == 1) RefuseForModel(arguments[0], MeasurementFlags());
  const ModelFile model = ModelOfSource(arguments[0]);
  std::vector<IterationRecord> trace;
  if (!FLAGS_trace.empty()) trace = ReadTrace(FLAGS_trace);
  std::optional<Measurement> measured;
  if (arguments.size() > 1) {
    measured = MeasurementOfSource(arguments[1], SourceOptionsFromFlags());
    PrintNotes(*measured);
  }
  const AppearanceOptions appearance = AppearanceOptionsFromFlags();
  const ViewedPage page =
      ViewPage(model, arguments[0], measured ? &*measured : nullptr, Compared(), trace, appearance);
  const bool missing = measured && !page.has_measured;
  Write(path, page.text, missing ? "a page of the model alone" : "a page");
  if (missing) {
    PrintLine("note: " + arguments[1] +
              " is not on it: a table knows no azimuths, which an anisotropic model needs");
  }
  return 0;
}

}  // namespace

Command ViewCommand() {
  return {
      .name = "view",
      .summary = "write a page that shows a model beside its measurement",
      .arguments = "MODEL [SOURCE] | FOLDER",
      .doing = "making the page",
      .min_arguments = 1,
      .max_arguments = 2,
      .details =
          "Writes one file of HTML to --out, which a browser opens without a server or a "
          "network: the material on\na sphere, a knot, a cloth or a flat sample, under an "
          "environment or a lamp; with SOURCE the measurement\nbeside it, and where the two "
          "differ; its factors, to be looked at and edited; with --trace the\niterations of the "
          "fit. --probe lights it by your own light probe.\n\nOf a FOLDER of fits it writes "
          "FOLDER/index.html, a page of their pictures to sort, filter and compare.",
      .flags = WithSourceFlags({"out", "trace", "probe"}),
      .run = RunView};
}

}  // namespace trilobe
