#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "tests/app/run_program.h"

namespace trilobe {
namespace {

using testing::HasSubstr;
using testing::Not;

class View : public testing::Test {
 protected:
  void SetUp() override {
    const ProgramResult fit =
        RunProgram({"fit", "synth:felt@30x30x60", "--solver=awls", "--max_iterations=1",
                    "--lobes=1", "--out=" + (folder_ / "out")});
    ASSERT_EQ(fit.status, 0) << fit.err;
  }
  std::string model() const { return folder_ / "out/model.json"; }

  TemporaryFolder folder_;
};

TEST_F(View, WritesOneFileWithTheModelAndTheMeasurement) {
  const std::string page = folder_ / "x.html", alone = folder_ / "alone.html";
  const ProgramResult both = RunProgram({"view", model(), "synth:felt@30x30x60", "--out=" + page});
  ASSERT_EQ(both.status, 0) << both.err;
  EXPECT_THAT(both.out, HasSubstr("wrote " + page));
  const std::string text = Contents(page);
  EXPECT_THAT(text, HasSubstr("\"kind\":\"table\",\"shape\":[30,30,60]"));
  EXPECT_THAT(text, HasSubstr("trilobe-model"));
  EXPECT_THAT(text, Not(HasSubstr("<!-- ")));
  EXPECT_THAT(text, Not(HasSubstr("import {")));
  ASSERT_EQ(RunProgram({"view", model(), "--out=" + alone}).status, 0);
  EXPECT_THAT(Contents(alone), Not(HasSubstr("\"kind\":\"table\"")));
  EXPECT_LT(Contents(alone).size(), 300000U);
}

TEST_F(View, HoldsScatteredSamplesAndWhatIsSaidOfTheFit) {
  const std::string file = folder_ / "few.csv", page = folder_ / "x.html";
  std::ofstream csv(file);
  csv << "theta_i,phi_i,theta_o,phi_o,r,g,b\n";
  for (int i = 5; i <= 45; i += 10) {
    for (int o = 0; o <= 45; o += 5)
      csv << i << ",0," << o << ",180,0.1,0.2," << (7 * i + o) % 10 + 1 << "\n";
  }
  csv.close();
  const ProgramResult result = RunProgram({"view", model(), file, "--out=" + page});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, Not(HasSubstr("is not on it")));
  const std::string text = Contents(page);
  EXPECT_THAT(text, HasSubstr(R"("kind":"samples","shape":[50],"samples":50)"));
  EXPECT_THAT(text, HasSubstr(R"("of_sphere":false)"));
  EXPECT_THAT(text, HasSubstr(R"("reach":)"));
  EXPECT_LT(text.size(), 300000U);
  // A fit also says its advice.
  const ProgramResult fit = RunProgram({"fit", file, "--lobes=1", "--solver=awls", "--plots",
                                        "--max_iterations=1", "--out=" + (folder_ / "few")});
  ASSERT_EQ(fit.status, 0) << fit.err;
  const size_t at = fit.out.find("advice       ");
  ASSERT_NE(at, std::string::npos) << fit.out;
  const std::string advice = fit.out.substr(at + 13, fit.out.find('\n', at) - at - 13);
  EXPECT_THAT(Contents(folder_ / "few/view.html"), HasSubstr("\"" + advice + "\""));
}

TEST_F(View, SaysInOneLineWhatIsWrong) {
  const auto refusal = [](const std::vector<std::string>& command, const std::string& part) {
    const ProgramResult result = RunProgram(command);
    EXPECT_EQ(result.status, 1);
    EXPECT_THAT(result.err, HasSubstr(part));
    EXPECT_EQ(std::ranges::count(result.err, '\n'), 1) << result.err;
  };
  refusal({"view", model()}, "--out=FILE.html");
  refusal({"view", model(), "--out=" + (folder_ / "x.png")}, "end the name in .html");
  refusal({"view", model(), "--noise=0.1", "--out=" + (folder_ / "x.html")}, "--noise");
  refusal({"view", folder_ / "none.json", "--out=" + (folder_ / "x.html")}, "none.json");
  refusal({"view", model(), "--out=" + (folder_ / "none/x.html")}, "x.html");
}

TEST_F(View, OfAFolderShowsAllFitsInIt) {
  const std::string all = folder_ / "";
  const ProgramResult result = RunProgram({"view", all});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("a page of 1 fit,"));
  EXPECT_THAT(Contents(folder_ / "index.html"), HasSubstr("<b>out</b> fitted, "));
  EXPECT_EQ(RunProgram({"view", all, "--out=" + (folder_ / "out/x.html")}).status, 1);
  EXPECT_THAT(RunProgram({"view", folder_ / "out"}).err,  // no fits in it, but a model
              HasSubstr("to look at one model, give '" + model() + "'"));
}

TEST_F(View, TakesNamesAsText) {
  const std::string odd = folder_ / "<script>alert(1)<!--.json", page = folder_ / "x.html";
  std::string text = Contents(model());
  const size_t at = text.find("synth:felt");
  ASSERT_NE(at, std::string::npos);
  text.replace(at, std::string("synth:felt@30x30x60").size(), "</script><b>");
  std::ofstream(odd) << text;
  ASSERT_EQ(RunProgram({"view", odd, "--out=" + page}).status, 0);
  EXPECT_THAT(Contents(page), Not(HasSubstr("</script><b>")));
}

TEST_F(View, ShadersAreWrittenOfModelsAlone) {
  const std::string shader = folder_ / "x.glsl";
  ASSERT_EQ(RunProgram({"convert", model(), "--out=" + shader}).status, 0);
  EXPECT_THAT(Contents(shader), HasSubstr("vec3 trilobe_eval(vec3 wi, vec3 wo)"));
  const ProgramResult result = RunProgram({"convert", "synth:felt", "--out=" + shader});
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.err, HasSubstr("of models; fit it first"));
}

}  // namespace
}  // namespace trilobe
