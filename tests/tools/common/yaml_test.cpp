#include "tools/common/yaml.h"

#include <gtest/gtest.h>

#include "tests/tools/refusal.h"

namespace roomcal::tools {
namespace {

using test::contains;
using test::refusal;

std::string refusal_of(const std::string& text) {
  return refusal([&] { YamlText yaml("f.yaml", text); });
}

TEST(ParseFinite, NumbersInFull_AreTaken) {
  for (const auto& [text, expected] : std::vector<std::pair<std::string, double>>{
           {"1", 1}, {"-0.5", -0.5}, {"+2", 2}, {"1e-3", 1e-3}, {".5", 0.5}, {"0", 0}}) {
    double value = -1;
    EXPECT_TRUE(parse_finite(text, value)) << text;
    EXPECT_EQ(value, expected);
  }
}

TEST(ParseFinite, AnythingElse_IsRefusedAndLeavesTheValue) {
  for (const char* text :
       {"", "nan", "NaN", ".nan", "inf", "-inf", "1e999", "1.0m", " 1", "1 ", "1,5", "0x10", "++1"}) {
    double value = 7;
    EXPECT_FALSE(parse_finite(text, value)) << text;
    EXPECT_EQ(value, 7);
  }
}

TEST(YamlQuoted, EveryByteThatATextMayHold_ComesBack) {
  std::string all;
  for (int c = 1; c < 128; ++c) all += static_cast<char>(c);
  all += "\xC3\xA9";  // UTF-8 passes as it is
  for (const std::string& text : {std::string("plain"), std::string("a: [b, c] # d"), std::string("yes"), all}) {
    const YamlText yaml("f.yaml", "key: " + yaml_quoted(text) + "\n");
    EXPECT_EQ(yaml.text(yaml.root()["key"], "key"), text);
  }
}

TEST(YamlText, NotAMap_IsRefused) {
  EXPECT_TRUE(contains(refusal_of(""), "f.yaml: empty"));
  EXPECT_TRUE(contains(refusal_of("# only a comment\n"), "f.yaml: empty"));
  EXPECT_TRUE(contains(refusal_of("- 1\n"), "key: value"));
  EXPECT_TRUE(contains(refusal_of("text"), "key: value"));
  EXPECT_TRUE(contains(refusal_of(std::string("a: 1\0b", 6)), "not a text file"));
  EXPECT_TRUE(contains(refusal_of("a: 1\nb: [1, 2\n"), "f.yaml:"));
}

TEST(YamlText, DeepNesting_IsRefusedBeforeParsing) {
  constexpr std::size_t kDeep = 200000;
  std::string blocks;
  for (std::size_t i = 0; i < 200; ++i) blocks += std::string(i, ' ') + "a:\n";
  std::string compact;
  for (std::size_t i = 0; i < kDeep; ++i) compact += "- ";
  std::string keys;
  for (std::size_t i = 0; i < kDeep; ++i) keys += "? ";
  for (const std::string& text : {std::string(kDeep, '['), "a: " + std::string(kDeep, '{'), blocks, compact, keys}) {
    EXPECT_TRUE(contains(refusal_of(text), "nests too deeply")) << text.substr(0, 20);
  }
}

TEST(YamlText, LongRulesAndDashedComments_AreNoNesting) {
  EXPECT_EQ(
      refusal_of("# - - - - - - - - - - - - - - - - - - - - - - - - - - - - - - - - - - - -\na: 1 # [[[[[[[[[[[[[[["
                 "[[[[[[[[[[[[[[[[[[[[[[[[\n"),
      "");
}

TEST(YamlText, Messages_NameFileAndLine) {
  const YamlText yaml("f.yaml", "a: 1\nb: .nan\nc: [1, 2]\n");
  const YAML::Node b = yaml.field(yaml.root(), "b"), c = yaml.field(yaml.root(), "c");
  EXPECT_TRUE(contains(refusal([&] { static_cast<void>(yaml.number(b, "b")); }), "f.yaml:2: b: expected a finite"));
  EXPECT_TRUE(contains(refusal([&] { static_cast<void>(yaml.number(c, "c")); }), "f.yaml:3: c: expected a finite"));
  EXPECT_TRUE(
      contains(refusal([&] { static_cast<void>(yaml.numbers(c, 3, "c")); }), "f.yaml:3: c: expected a list of 3"));
  EXPECT_TRUE(contains(refusal([&] { static_cast<void>(yaml.field(yaml.root(), "d")); }), "`d` is missing"));
  EXPECT_TRUE(contains(refusal([&] { static_cast<void>(yaml.field(b, "d")); }), "f.yaml:2"));
}

TEST(YamlText, UnknownAndDoubledKeys_AreRefused) {
  const YamlText yaml("f.yaml", "a: 1\nb: 2\na: 3\n");
  EXPECT_TRUE(contains(refusal([&] {
                         yaml.allow_keys(yaml.root(), {"a", "c"}, "top");
                       }),
                       "f.yaml:2: top: unknown key `b`"));
  EXPECT_TRUE(contains(refusal([&] {
                         yaml.allow_keys(yaml.root(), {"a", "b"}, "top");
                       }),
                       "f.yaml:3: top: `a` stands twice"));
}

TEST(YamlText, Transform_MustBeRigid) {
  const auto refused = [](const std::string& rows) {
    const YamlText yaml("f.yaml", "T: " + rows);
    return refusal([&] { static_cast<void>(yaml.transform(yaml.root()["T"], "T")); });
  };
  EXPECT_EQ(refused("[[1,0,0,5],[0,1,0,6],[0,0,1,7],[0,0,0,1]]"), "");
  EXPECT_TRUE(contains(refused("[[1,0,0,5],[0,1,0,6],[0,0,1,7]]"), "four rows"));
  EXPECT_TRUE(contains(refused("[[1,0,0,5],[0,1,0,6],[0,0,1,7],[0,0,0,2]]"), "last row"));
  EXPECT_TRUE(contains(refused("[[1,0,0,5],[0,1,0,6],[0,0,-1,7],[0,0,0,1]]"), "not a rotation"));
  EXPECT_TRUE(contains(refused("[[1,0.01,0,5],[0,1,0,6],[0,0,1,7],[0,0,0,1]]"), "not a rotation"));
  EXPECT_TRUE(contains(refused("[[1e300,0,0,5],[0,1,0,6],[0,0,1,7],[0,0,0,1]]"), "not a rotation"));
  EXPECT_TRUE(contains(refused("[[1,0,0,nan],[0,1,0,6],[0,0,1,7],[0,0,0,1]]"), "finite"));
}

}  // namespace
}  // namespace roomcal::tools
