#include "io/pictures/gnuplot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <span>
#include <sstream>

#include "core/files/file.h"
#include "core/system/process.h"
#include "io/pictures/plots.h"
#include "io/pictures/words.h"
#include "tests/error_of.h"
#include "tests/paths.h"
#include "trilobe/core/base/error.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/model/measurement/synth.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

class GnuplotTest : public testing::Test {
 protected:
  GnuplotTest() {
    std::string name = testing::TempDir() + "trilobe_plot_XXXXXX";
    folder_ = mkdtemp(name.data());
  }
  ~GnuplotTest() override { std::filesystem::remove_all(folder_); }

  std::string Path(const std::string& name) const { return (folder_ / name).string(); }

  // Width and height, as the PNG header says.
  static std::pair<int, int> PngSize(const std::string& path) {
    const std::string bytes = ReadFile(path);
    EXPECT_THAT(bytes, testing::StartsWith("\x89PNG\r\n\x1a\n"));
    const auto number = [&](size_t at) {
      int value = 0;
      for (size_t i = at; i < at + 4; ++i) {
        value = value * 256 + static_cast<unsigned char>(bytes.at(i));
      }
      return value;
    };
    return {number(16), number(20)};
  }

  // A gnuplot of our own while it lives: a script that comes first on the PATH.
  class FakeGnuplot {
   public:
    FakeGnuplot(const std::filesystem::path& folder, const std::string& script)
        : folder_(folder / "bin"), path_(std::getenv("PATH")) {
      std::filesystem::create_directory(folder_);
      std::ofstream(folder_ / "gnuplot") << "#!/bin/sh\n" << script;
      std::filesystem::permissions(folder_ / "gnuplot", std::filesystem::perms::owner_all);
      setenv("PATH", (folder_.string() + ":" + path_).c_str(), 1);
    }
    FakeGnuplot(const FakeGnuplot&) = delete;
    FakeGnuplot& operator=(const FakeGnuplot&) = delete;
    ~FakeGnuplot() {
      setenv("PATH", path_.c_str(), 1);
      std::filesystem::remove_all(folder_);
    }

   private:
    const std::filesystem::path folder_;
    const std::string path_;
  };

  static AppearanceOptions Appearance(int num_threads) {
    return {.lights = 6, .size = 16, .num_threads = num_threads};
  }

  std::filesystem::path folder_;
};

TEST(GnuplotQuoteTest, EscapesWhatGnuplotWouldRead) {
  EXPECT_EQ(GnuplotQuote("plain µ"), "'plain µ'");
  EXPECT_EQ(GnuplotQuote("it's"), "'it’s'");
  EXPECT_EQ(GnuplotQuote("a\nb\tc\x7f"), "'a?b?c?'");
  EXPECT_EQ(GnuplotQuote("\xff_\xc3"), "'?_?'");
}

TEST(GnuplotTitleTest, FitsTheWidth) {
  EXPECT_EQ(GnuplotTitle("copper", 2000, 26), "'copper' noenhanced font ',26'");
  EXPECT_THAT(GnuplotTitle(std::string(98, 'm'), 2000, 26), testing::EndsWith("font ',22'"));
  const std::string cut = GnuplotTitle(std::string(400, 'm') + "µ", 1000, 26);
  EXPECT_THAT(cut, testing::EndsWith("…' noenhanced font ',12'"));
  EXPECT_LT(cut.size(), 130U);
}

TEST(LogTicsTest, AreAFewForAnyRange) {
  EXPECT_EQ(LogTics({0.2, 3}, 'x'), "set format x '%g'\nset xtics (0.1, 0.2, 0.5, 1, 2, 5)\n");
  EXPECT_EQ(LogTics({0.2, 300}, 'y'), "set format y '10^{%T}'\nset ytics autofreq\n");
}

TEST(GnuplotNumberTest, IsPlainOrAGap) {
  EXPECT_EQ(GnuplotNumber(0.125), "0.125");
  EXPECT_EQ(GnuplotNumber(std::nan("")), "NaN");
  EXPECT_EQ(GnuplotNumber(std::numeric_limits<double>::infinity()), "NaN");
}

TEST(GnuplotLogRangeTest, HoldsPositiveValuesWithinTheDecades) {
  const double values[] = {0, -1, std::nan(""), 1e-9, 1, 100};
  EXPECT_EQ(GnuplotLogRange(values, 4), "[0.0063095734:158.48932]");
  EXPECT_EQ(GnuplotLogRange({}, 4), "[0.8:1.25]");
}

// factors.png and the page show the same lobes.
TEST(PaletteTest, IsThatOfThePage) {
  const auto list = [](std::span<const char* const> colors) {
    std::string text;
    for (const char* color : colors)
      text += (text.empty() ? "['" : ", '") + std::string(color) + "'";
    return " = " + text + "];";
  };
  const std::string page = ReadFile(InRepository("web/plots.js"));
  EXPECT_THAT(page, testing::HasSubstr("LOBE_COLORS" + list(kLobeColors)));
  EXPECT_THAT(page, testing::HasSubstr("CHANNEL_COLORS" + list(kChannelColors)));
}

TEST_F(GnuplotTest, DrawsAPictureOfTheAskedSize) {
  const std::string nasty = "'; `touch " + Path("run") + "` @x %s {_^ \\";
  DrawPng(Path("a.png"), 400, 300, "plot sin(x) title " + GnuplotQuote(nasty) + " noenhanced\n");
  EXPECT_FALSE(std::filesystem::exists(Path("run")));
  EXPECT_EQ(PngSize(Path("a.png")), std::pair(400, 300));
}

TEST_F(GnuplotTest, ReportsABadScriptAndLeavesNoFile) {
  const auto error = ErrorOf([&] { DrawPng(Path("a.png"), 400, 300, "set nonsense\n"); });
  EXPECT_THAT(error, IsError(ErrorKind::kFile, {.key = "gnuplot", .value = "failed"}));
  EXPECT_THAT(error->what(), testing::HasSubstr("unrecognized option"));  // gnuplot's own words
  EXPECT_THAT(
      ErrorOf([&] { DrawPng(Path("a.png"), 400, 300, ""); }),
      IsError(ErrorKind::kFile, {.key = "gnuplot", .value = "no picture"}));  // draws nothing
  EXPECT_TRUE(std::filesystem::is_empty(folder_));
}

TEST_F(GnuplotTest, SaysWhichPackageIsMissing) {
  const std::string path = std::getenv("PATH");
  setenv("PATH", Path("empty").c_str(), 1);
  EXPECT_THAT(ErrorOf([&] { DrawPng(Path("a.png"), 400, 300, "plot x\n"); }),
              IsError(ErrorKind::kMissing, {.key = "gnuplot"}));
  setenv("PATH", path.c_str(), 1);
}

// Other folders may be full, or closed.
TEST_F(GnuplotTest, ReadsAndWritesBesideThePicture) {
  const FakeGnuplot fake(folder_, "ls -l /proc/$$/fd | sed -n 's/.* \\([012]\\) -> //p' >" +
                                      Path("files") + "\nexit 1\n");
  std::filesystem::create_directory(Path("out"));
  EXPECT_THAT(ErrorOf([&] { DrawPng(Path("out/a.png"), 400, 300, "plot x\n"); }),
              IsError(ErrorKind::kFile, {.key = "gnuplot", .value = "failed"}));
  std::istringstream files(ReadFile(Path("files")));
  int count = 0;
  for (std::string file; std::getline(files, file); ++count) {
    EXPECT_THAT(file, testing::StartsWith(Path("out/")));
    EXPECT_THAT(file, testing::EndsWith("(deleted)"));
  }
  EXPECT_EQ(count, 3);
  EXPECT_TRUE(std::filesystem::is_empty(Path("out")));
}

// Whether a process runs; one that was killed may stay as a zombie for a while.
bool Runs(const std::string& pid) {
  std::ifstream file("/proc/" + pid + "/stat");
  std::string number, name, state;
  file >> number >> name >> state;
  return !state.empty() && state != "Z" && state != "X";
}

TEST_F(GnuplotTest, EndsOneThatHangsAndWhatItStarted) {
  const FakeGnuplot fake(
      folder_, "sleep 1000 &\necho $! > " + Path("child") + "\ntrap '' TERM INT\nsleep 1000\n");
  // Signals all the time, which end every wait of the system's.
  struct sigaction action {
  }, before{};
  action.sa_handler = [](int) {};
  sigaction(SIGALRM, &action, &before);
  const itimerval often = {{0, 1000}, {0, 1000}}, never = {};
  setitimer(ITIMER_REAL, &often, nullptr);
  Stopwatch stopwatch;
  const auto error = ErrorOf([&] { DrawPng(Path("a.png"), 400, 300, "plot x\n", 0.5); });
  const double seconds = stopwatch.Lap();
  setitimer(ITIMER_REAL, &never, nullptr);
  sigaction(SIGALRM, &before, nullptr);
  EXPECT_THAT(error, IsError(ErrorKind::kLimit, {.key = "gnuplot", .value = "0.5"}));
  EXPECT_GE(seconds, 0.5);
  EXPECT_LT(seconds, 10);
  std::string child = ReadFile(Path("child"));
  child.pop_back();
  for (int wait = 0; wait < 1000 && Runs(child); ++wait) usleep(1000);
  EXPECT_FALSE(Runs(child)) << child;
  EXPECT_FALSE(std::filesystem::exists(Path("a.png")));
}

TEST_F(GnuplotTest, DoesNotBelieveHalfAPicture) {
  DrawPng(Path("whole.png"), 400, 300, "plot x\n");
  const std::string whole = ReadFile(Path("whole.png"));
  for (const size_t size : {size_t{8}, whole.size() / 2, whole.size() - 1}) {
    const FakeGnuplot fake(folder_,
                           "head -c " + std::to_string(size) + " " + Path("whole.png") + "\n");
    EXPECT_THAT(ErrorOf([&] { DrawPng(Path("half.png"), 400, 300, "plot x\n"); }),
                IsError(ErrorKind::kFile, {.key = "gnuplot", .value = "part of a picture"}))
        << size;
    EXPECT_FALSE(std::filesystem::exists(Path("half.png")));
  }
  const FakeGnuplot fake(folder_, "cat " + Path("whole.png") + "\n");
  DrawPng(Path("copy.png"), 400, 300, "plot x\n");
  EXPECT_EQ(ReadFile(Path("copy.png")), whole);
}

TEST_F(GnuplotTest, DrawsAllPicturesTheSameEachTime) {
  const MerlGrid grid = {.theta_h = 20, .theta_d = 20, .phi_d = 20};
  const BrdfTable measured = Synthesize(FindSynthMaterial("plastic"), 0.1, 1, grid);
  ModelFile file;
  file.model = FactorModel(ModelSpec::SharedFactors(3, grid));
  for (double& x : file.model.parameters()) x = 0.5;
  for (double& x : file.model.s(1)) x = 0;  // absent
  file.unobserved.assign(file.model.parameters().size(), false);
  file.unobserved.back() = true;
  file.fit.source = "a 'strange_name' {$x}\n";
  const IterationRecord trace[] = {
      {0, 0, 10, false}, {1, 0.5, 10, false, false}, {2, 0.75, 0, true}};  // E = 0 has no logarithm
  const std::vector<std::string> paths =
      DrawPictures(file, {.table = &measured}, trace, folder_.string(), Appearance(2));
  ASSERT_EQ(paths.size(), 4U);
  std::vector<std::string> bytes;
  for (const std::string& path : paths) {
    EXPECT_GE(PngSize(path).first, 1600);
    bytes.push_back(ReadFile(path));
  }
  DrawPictures(file, {.table = &measured}, trace, folder_.string(), Appearance(1));
  for (size_t i = 0; i < paths.size(); ++i) EXPECT_TRUE(ReadFile(paths[i]) == bytes[i]) << paths[i];
}

TEST_F(GnuplotTest, FactorsSayWhatALobeIsAndWhatIsLeftOut) {
  const MerlGrid grid = {.theta_h = 20, .theta_d = 20, .phi_d = 20};
  ModelFile file;
  file.model = FactorModel(ModelSpec::SharedFactors(2, grid));
  FactorModel& model = file.model;
  std::ranges::fill(model.parameters(), 1.0);
  for (const Factor factor : {Factor::kD, Factor::kG}) {
    const Axis& axis = model.spec().axis(factor);
    for (int i = 0; i < axis.size; ++i) {
      if (factor == Factor::kG) model.table(factor, 0)[i] = std::cos(axis.Theta(i));
      if (factor == Factor::kD) model.table(factor, 1)[i] = std::exp(-9 * axis.Theta(i));
    }
  }
  model.d()[0] = 1e-9;  // no bar
  file.unobserved.assign(model.parameters().size(), false);
  const size_t last = model.TableOffset(Factor::kF, 0) + grid.theta_d - 1;
  model.parameters()[last] = 40;
  file.unobserved[last] = true;
  const FakeGnuplot fake(folder_, "cat > " + Path("script") + "\nexit 1\n");
  EXPECT_THAT(ErrorOf([&] { DrawFactors(file, Path("factors.png")); }),
              IsError(ErrorKind::kFile, {.key = "gnuplot", .value = "failed"}));
  const std::string script = ReadFile(Path("script"));
  EXPECT_THAT(script, testing::HasSubstr("title 'lobe 1 (nearly diffuse)'"));
  EXPECT_THAT(script, testing::HasSubstr("title 'lobe 2'"));
  EXPECT_THAT(script, testing::HasSubstr(" %%\\nnearly diffuse\" 1"));
  EXPECT_THAT(script, testing::HasSubstr("title 'no data or light, up to 40'"));
  EXPECT_THAT(script, testing::HasSubstr("$2 > 0 ? '<0.0005'"));
}

// Slices that are hardly seen are pale, and dotted where nothing was measured.
TEST_F(GnuplotTest, SlicesSayWhatIsHardlySeenAndWhatWasNotMeasured) {
  const MerlGrid grid = {.theta_h = 20, .theta_d = 20, .phi_d = 20};
  BrdfTable measured = Synthesize(FindSynthMaterial("plastic"), 0, 1, grid);
  const BrdfTable fitted = measured;
  const FakeGnuplot fake(folder_, "cat > " + Path("script") + "\nexit 1\n");
  const auto script_of = [&] {
    EXPECT_THAT(ErrorOf([&] { DrawSlices(measured, fitted, Path("slices.png")); }),
                IsError(ErrorKind::kFile, {.key = "gnuplot", .value = "failed"}));
    return ReadFile(Path("script"));
  };
  const std::string whole = script_of();
  EXPECT_THAT(whole, testing::HasSubstr("'pale: together less than 0.3 % of the light"));
  EXPECT_THAT(whole, testing::Not(testing::HasSubstr("dotted: not measured")));
  LimitAngles(1, Unmeasured::kBeyondMaxAngle, &measured);
  EXPECT_THAT(script_of(), testing::HasSubstr("dotted: not measured'"));
}

// D and G over azimuths, with entries that have no data, four lobes, one of them absent.
TEST_F(GnuplotTest, DrawsAnisotropicPicturesTheSameEachTime) {
  const Measurement velvet = LoadMeasurement("synth:velvet@4x12");
  const PictureData measured = PictureDataOf(velvet);
  ModelFile file;
  ModelSpec spec = ModelSpec::Anisotropic(4);
  spec.d_axis = Axis::Polar({0, 10, 40, 80}, 12);
  file.model = FactorModel(spec);
  double x = 0.3;
  for (double& number : file.model.parameters()) number = x = 3.7 * x * (1 - x);
  for (double& s : file.model.s(3)) s = 0;
  for (double& d : file.model.table(Factor::kD, 2)) d = 0;
  file.unobserved.assign(file.model.parameters().size(), false);
  file.unobserved[file.model.TableOffset(Factor::kD, 0) + 20] = true;
  file.fit.source = "a 'strange_name' {$x}\n";
  const auto draw = [&](int threads) {
    return DrawPictures(file, measured, {}, folder_.string(), Appearance(threads));
  };
  const std::vector<std::string> paths = draw(2);
  ASSERT_EQ(paths.size(), 4U);
  std::vector<std::string> bytes;
  for (const std::string& path : paths) {
    EXPECT_GE(PngSize(path).first, 1600);
    bytes.push_back(ReadFile(path));
  }
  draw(1);
  for (size_t i = 0; i < paths.size(); ++i) EXPECT_TRUE(ReadFile(paths[i]) == bytes[i]) << paths[i];

  AppearanceOptions options = Appearance(1);
  options.size = 30;
  WriteSpherePair(measured, MaterialOf(file.model), Path("pair.png"), options);
  EXPECT_EQ(PngSize(Path("pair.png")), std::pair(144, 96));

  // No azimuths in a table: told before anything is drawn.
  const BrdfTable table = Synthesize(FindSynthMaterial("plastic"), 0, 1, {20, 20, 20});
  std::filesystem::remove(paths[0]);
  EXPECT_THAT(
      ErrorOf([&] { DrawPictures(file, {.table = &table}, {}, folder_.string(), options); }),
      IsError(ErrorKind::kUnsupported, {.key = "anisotropic"}));
  EXPECT_FALSE(std::filesystem::exists(paths[0]));
}

TEST_F(GnuplotTest, DrawsWhatWasMeasured) {
  const MerlGrid grid = {.theta_h = 20, .theta_d = 20, .phi_d = 20};
  BrdfTable table = Synthesize(FindSynthMaterial("plastic"), 0.1, 1, grid);
  table.source = "/a/b/'strange_name' %d {$x}";
  DrawMeasured(table, Path("whole.png"));
  LimitAngles(1, Unmeasured::kBeyondMaxAngle, &table);
  DrawMeasured(table, Path("part.png"));
  EXPECT_EQ(PngSize(Path("part.png")), std::pair(1200, 1080));
  EXPECT_NE(ReadFile(Path("part.png")), ReadFile(Path("whole.png")));
  DrawMeasured(MakeInvalidTable("nothing", grid), Path("nothing.png"));
  EXPECT_EQ(PngSize(Path("nothing.png")), std::pair(1200, 1080));
}

// Nothing to scale an axis by: no lobe, a black material, a single record.
TEST_F(GnuplotTest, DrawsDegenerateInput) {
  const MerlGrid grid = {.theta_h = 8, .theta_d = 8, .phi_d = 8};
  BrdfTable black = MakeInvalidTable("black", grid);
  for (auto& plane : black.stored) plane.assign(plane.size(), 0);
  ModelFile file;
  file.unobserved.assign(file.model.parameters().size(), false);
  const IterationRecord trace[] = {{0, 0, 1, false}};
  EXPECT_EQ(DrawPictures(file, {.table = &black}, trace, folder_.string(), Appearance(1)).size(),
            4U);
  file.model = FactorModel(ModelSpec::IndependentG(grid));
  file.unobserved.assign(file.model.parameters().size(), true);
  EXPECT_EQ(DrawPictures(file, {}, {}, folder_.string(), Appearance(1)).size(),
            2U);  // and a sphere
  EXPECT_THAT(ErrorOf([&] { DrawTrace({}, "", Path("none.png")); }),
              IsError(ErrorKind::kMissing, {.key = "trace"}));
}

TEST_F(GnuplotTest, WritesTwoSpheresSideBySide) {
  const MerlGrid grid = {.theta_h = 20, .theta_d = 20, .phi_d = 20};
  const BrdfTable measured = Synthesize(FindSynthMaterial("plastic"), 0, 1, grid);
  const AngularBrdf fitted = [](const HalfDiffAngles& /*angles*/, const Cosines& /*cosines*/) {
    return Rgb{0.1, 0.1, 0.1};
  };
  AppearanceOptions options = Appearance(2);
  options.size = 40;
  WriteSpherePair(measured, fitted, Path("pair.png"), options);
  EXPECT_EQ(PngSize(Path("pair.png")), std::pair(2 * 92, 92 + 24));
  // Each says which it is.
  WriteSpherePair(measured, fitted, Path("other.png"), options, {.left = Word::kFitted});
  EXPECT_NE(ReadFile(Path("other.png")), ReadFile(Path("pair.png")));
  // A black measurement has no exposure; the fit is seen all the same.
  BrdfTable black = measured;
  for (auto& plane : black.stored) plane.assign(plane.size(), 0);
  WriteSpherePair(black, fitted, Path("grey.png"), options);
  WriteSpherePair(
      black, [](const HalfDiffAngles&, const Cosines&) { return Rgb{}; }, Path("black.png"),
      options);
  EXPECT_GT(ReadFile(Path("grey.png")).size(), ReadFile(Path("black.png")).size());
}

// Scattered samples in the plane of incidence are drawn against the fit, too.
TEST_F(GnuplotTest, DrawsScatteredSamplesAgainstTheFit) {
  SampleCollector collector("few.csv", "test");
  for (int i = 10; i < 80; i += 20) {
    for (int o = 0; o < 80; o += 5) {
      collector.Add({DegreesToRadians(i), 0, DegreesToRadians(o), kPi}, {0.1, 0.2, 0.3});
    }
  }
  const Measurement few = collector.Take();
  const SphericalBrdf fitted = [](const SphericalAngles& /*at*/) { return Rgb{0.1, 0.2, 0.2}; };
  EXPECT_TRUE(HasSlices(few));
  DrawSlices(few, fitted, Path("slices.png"));
  EXPECT_EQ(PngSize(Path("slices.png")), std::pair(2000, 1000));
  Measurement none = few;
  for (SphericalAngles& at : none.samples.directions) at.phi_o = 1;
  std::erase_if(none.samples.directions, [](const SphericalAngles& at) { return at.theta_o == 0; });
  EXPECT_FALSE(HasSlices(none));
}

// Unmeasured parts are shown, and left out of the difference.
TEST_F(GnuplotTest, DrawsSpheresThatWereMeasuredInPart) {
  const MerlGrid grid = {.theta_h = 20, .theta_d = 20, .phi_d = 20};
  BrdfTable measured = Synthesize(FindSynthMaterial("plastic"), 0, 1, grid);
  const AngularBrdf fitted = [](const HalfDiffAngles& /*angles*/, const Cosines& /*cosines*/) {
    return Rgb{0.1, 0.1, 0.1};
  };
  DrawSpheres(measured, fitted, Path("all.png"), Appearance(1));
  measured.unmeasured.assign(grid.size(), Unmeasured::kNo);
  for (int bin = 0; bin < grid.size(); ++bin) {
    if (grid.Center(bin).theta_d > 0.5) measured.unmeasured[bin] = Unmeasured::kExtrapolated;
  }
  DrawSpheres(measured, fitted, Path("part.png"), Appearance(1));
  EXPECT_EQ(PngSize(Path("part.png")), PngSize(Path("all.png")));
  EXPECT_NE(ReadFile(Path("part.png")), ReadFile(Path("all.png")));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
