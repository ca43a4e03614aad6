// Messages name files that are no readable measurement, and say what to do.
#include "io/formats/foreign_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <string>

#include "io/formats/databases/tensor_file.h"
#include "tests/error_of.h"
#include "trilobe/io/formats/source.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using namespace std::string_literals;

std::optional<Error> ErrorOfSource(const std::string& name, const std::string& bytes) {
  return ErrorOf([&] { Source(name, bytes).Read(); });
}

const std::string kAsCsv = "; save it as CSV, with the header theta_i,phi_i,theta_o,phi_o,r,g,b";

TEST(ForeignFile, IsNamedWithWhatToDo) {
  struct Case {
    std::string name, bytes, error;
  };
  const std::string zip = "PK\3\4\x14\0\6\0"s, hdf = "\x89HDF\r\n\x1a\n"s;
  const Case cases[] = {
      {"f.bsdf", "\n<!DOCTYPE html>\n<html>", "a web page; download the file itself"},
      {"f.csv", "\xEF\xBB\xBF<HTML><body>", "a web page; download the file itself"},
      {"f.binary", "version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 1\n",
       "a Git LFS pointer in the place of a file; get the file itself by `git lfs pull`"},
      {"f.xlsx", zip, "a workbook" + kAsCsv},
      {"f", zip + "[Content_Types].xml", "a workbook" + kAsCsv},
      {"f.ods", zip + "mimetypeapplication/vnd.oasis.opendocument.spreadsheet",
       "a workbook" + kAsCsv},
      {"f.xls", "\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1\0"s,
       "a workbook or a document of Office" + kAsCsv},
      {"f.npz", zip + "rho.npy",
       "an archive of NumPy arrays; in Python trilobe.Measurement takes their samples"},
      {"f.npy", "\x93NUMPY\1\0"s, "a NumPy array; in Python trilobe.Measurement takes its samples"},
      {"f.mat", "MATLAB 5.0 MAT-file",
       "a MATLAB file; write its samples by writematrix or writetable"},
      {"f.mat", hdf, "a MATLAB file; write its samples by writetable"},
      {"f.db", "SQLite format 3\0"s, "a SQLite database" + kAsCsv},
      {"f.parquet", "PAR1\x15\4", "a Parquet file" + kAsCsv},
      {"f.txt",
       "TracePro Surface Property Data\nTemperature\tWavelength\tIncAngle\tBRDF\n300\t1\t2\t3\n",
       "a TracePro surface property, whose format is not public; make its table (ScatterBeta, "
       "ScatterAzimuth, BRDF) one of theta_i, theta_o and phi_o: beta is the distance of the sines "
       "of the direction and of the mirror direction"},
      {"f.ies", "IESNA:LM-63-2002\n[TEST] 1\n",
       "an IES file of a luminaire, which is no material; give the measurement of a material"},
      {"f.axf", hdf,
       "an AxF file, whose format is not public; export the material as samples from the program "
       "that wrote it"},
      {"f.h5", hdf, "an HDF5 file" + kAsCsv},
      {"f.bsdf", "SCATFUN\1",
       "a SCATFUN .bsdf file of Fourier coefficients; evaluate it at pairs of directions, as "
       "layerlab does"},
      {"f.brdf", "analytic\n\n::begin parameters\n",
       "a BRDF Explorer .brdf script, which is a formula and no measurement; evaluate it at pairs "
       "of directions"},
      {"f.coated", "OPTIS - coated surface file v2.0\n",
       "an OPTIS/Speos text file, which is not read" + kAsCsv},
      {"f.xml", "<?xml version=\"1.0\"?>\n<a/>\n", "an XML file, which is not read" + kAsCsv},
      {"f.mdl", "// a paint\n/* by me */\nmdl 1.7;\nimport ::df::*;\n",
       "an MDL module, which describes a material and is no measurement; give the .mbsdf file that "
       "it names"}};
  for (const auto& [name, bytes, error] : cases) {
    EXPECT_EQ(ErrorOfSource(name, bytes)->what(), name + ": this is " + error);
  }
  EXPECT_EQ(ForeignFile("notes", "x.txt"), "");
  EXPECT_EQ(ForeignFile("", "x.xlsx"), "");
}

TEST(ForeignFile, ArchivesAreUnpacked) {
  EXPECT_THAT(
      ErrorOfSource("f.zip", "PK\3\4"),
      IsError(ErrorKind::kUnsupported, {.key = "content", .value = "a ZIP archive; unpack it"}));
  EXPECT_THAT(
      ErrorOfSource("f.gz", "\x1F\x8B\x08"),
      IsError(ErrorKind::kUnsupported, {.key = "content", .value = "a gzip file; unpack it"}));
  EXPECT_THAT(
      ErrorOfSource("f.xz", "\xFD\x37zXZ\0"s),
      IsError(ErrorKind::kUnsupported, {.key = "content", .value = "an xz file; unpack it"}));
  EXPECT_THAT(
      ErrorOfSource("f.7z", "7z\xBC\xAF\x27\x1C"),
      IsError(ErrorKind::kUnsupported, {.key = "content", .value = "a 7-Zip archive; unpack it"}));
}

TEST(ForeignFile, OtherMerlFiles) {
  std::string header("\x5a\0\0\0\x5a\0\0\0\xb4\0\0\0", 12);
  const auto error = [&](size_t size) {
    std::string bytes = header;
    bytes.resize(size);
    return ErrorOfSource("f.binary", bytes);
  };
  for (const size_t size : {17496000, 34992013}) {
    EXPECT_THAT(error(size), IsError(ErrorKind::kFormat, {.file = "f.binary", .key = "bytes"}));
  }
}

TEST(ForeignFile, PolarisedTensors) {
  TensorFileWriter writer;
  writer.AddFloat32("M", {1}, {1});
  writer.AddFloat32("theta_h", {1}, {0});
  EXPECT_THAT(ErrorOfSource("f.pbsdf", writer.Bytes()),
              IsError(ErrorKind::kUnsupported, {.file = "f.pbsdf", .key = "M"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
