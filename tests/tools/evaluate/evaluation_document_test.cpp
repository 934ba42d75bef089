#include "tools/evaluate/evaluation_document.h"

#include <array>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

#include "tools/common/error.h"
#include "tools/common/files.h"
#include "tools/evaluate/built_from_commit.h"

namespace roomcal::tools {
namespace {

constexpr std::array<std::string_view, 2> kNames = {"paper", "shots"};

EvaluationSection section(const std::string& name, const std::string& body) {
  return {name, "The " + name, "roomcal evaluate " + name + " --seed 1", body};
}

std::string sample() {
  return with_section(with_section("", section("paper", "10 mm"), "0123abc"), section("shots", "0 wrong"),
                      "89abcdef01");
}

TEST(EvaluationDocument, New_HasHeadingThenSections) {
  EXPECT_TRUE(form_problems(sample(), kNames).empty());
  EXPECT_TRUE(sample().starts_with("# Evaluation\n"));
  EXPECT_TRUE(sample().ends_with(
      "\n<!-- begin shots -->\n## The shots\n`roomcal evaluate shots --seed 1` at commit `89abcdef01`\n\n0 wrong\n"
      "<!-- end shots -->\n"));
}

TEST(EvaluationDocument, SectionAgain_ReplacesItsOwnInPlace) {
  const std::string by_hand = sample() + "\nBy hand.\n";
  const std::string changed = with_section(by_hand, section("paper", "9 mm\n\n"), "fedcba9");
  EXPECT_EQ(changed.find("10 mm"), std::string::npos);
  EXPECT_EQ(changed.find("0123abc"), std::string::npos);
  EXPECT_LT(changed.find("9 mm"), changed.find("begin shots"));
  EXPECT_TRUE(changed.ends_with("<!-- end shots -->\n\nBy hand.\n"));
  EXPECT_EQ(with_section(changed, section("paper", "10 mm"), "0123abc"), by_hand);
}

TEST(EvaluationDocument, DamagedMarks_AreRefusedAndNamed) {
  for (const char* lost : {"<!-- begin paper -->\n", "<!-- end paper -->\n"}) {
    std::string damaged = sample();
    damaged.erase(damaged.find(lost), std::string(lost).size());
    EXPECT_EQ(form_problems(damaged, kNames).size(), 1U);
    EXPECT_THROW(with_section(damaged, section("paper", "9 mm"), "fedcba9"), ToolError);
    EXPECT_THROW(with_section(sample() + lost, section("paper", "9 mm"), "fedcba9"), ToolError);
  }
}

TEST(EvaluationDocument, EveryLackOfForm_IsOneProblem) {
  const auto problems = [](const std::string& commit, const std::string& body) {
    return form_problems(with_section(sample(), section("paper", body), commit), kNames).size();
  };
  EXPECT_EQ(problems("0123abc", "10 mm"), 0U);
  EXPECT_EQ(problems("0123abc+changes", "10 mm"), 1U);  // nobody can build that again
  EXPECT_EQ(problems("unknown", "10 mm"), 1U);
  EXPECT_EQ(problems("0123abc", ""), 1U);
  EXPECT_EQ(problems("0123abc", "10 mm\n<!-- end other -->"), 1U);
  EXPECT_EQ(form_problems(sample(), std::array<std::string_view, 1>{"paper"}).size(), 1U);
  EXPECT_EQ(form_problems(sample(), std::array<std::string_view, 3>{"paper", "shots", "third"}).size(), 1U);
  std::string without_command = sample();
  without_command.erase(without_command.find("`roomcal evaluate paper --seed 1` "), 34);
  EXPECT_EQ(form_problems(without_command, kNames).size(), 1U);
}

TEST(EvaluationDocument, File_IsMadeThenChangedAndNamedInErrors) {
  const std::filesystem::path folder =
      std::filesystem::path(testing::TempDir()) / ("roomcal_evaluation_" + std::to_string(getpid()));
  make_folder(folder);
  const std::filesystem::path file = folder / "EVALUATION.md";
  write_section(file, section("paper", "10 mm"));
  write_section(file, section("shots", "0 wrong"));
  write_section(file, section("paper", "9 mm"));
  const std::string text = read_text(file);
  EXPECT_NE(text.find("9 mm"), std::string::npos);
  EXPECT_NE(text.find("` at commit `" + built_from_commit() + "`"), std::string::npos);
  write_atomic(file, std::string("<!-- end paper -->\n"));
  try {
    write_section(file, section("paper", "9 mm"));
    FAIL() << "damaged marks were written over";
  } catch (const ToolError& error) {
    EXPECT_TRUE(std::string(error.what()).starts_with(file.string() + ": section paper")) << error.what();
  }
  EXPECT_EQ(read_text(file), "<!-- end paper -->\n");
  std::filesystem::remove_all(folder);
}

TEST(EvaluationDocument, Table_IsMarkdown) {
  const std::vector<std::vector<std::string>> rows = {{"kind", "wrong"}, {"mirror", "0"}};
  EXPECT_EQ(markdown_table(rows), "| kind | wrong |\n|---|---|\n| mirror | 0 |\n");
}

TEST(EvaluationDocument, Committed_HasEverySectionInForm) {
  const std::string document = read_text(ROOMCAL_SOURCE_DIR "/EVALUATION.md");
  EXPECT_TRUE(document.starts_with("# Evaluation\n"));
  for (const std::string& problem : form_problems(document, kCommittedSections)) ADD_FAILURE() << problem;
}

}  // namespace
}  // namespace roomcal::tools
