// The small parts: verbs, requests, replies, rights, the output queue.

#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "runtime/console/output_queue.h"
#include "runtime/console/reply.h"
#include "runtime/console/request.h"
#include "runtime/console/rights.h"
#include "runtime/console/verbs.h"

namespace roomcal::console {
namespace {

TEST(Verbs, TheTwentyOfTheDesign_AreThere) {
  std::string names;
  for (const Verb& verb : verbs()) names += std::string(verb.name) + " ";
  EXPECT_EQ(
      names,
      "help version status health sensors grab map verify calibrate result history diff undo restore-factory export "
      "selftest mem clock log reboot ");
}

TEST(Verbs, WhatChangesAnything_NeedsRights) {
  for (const char* name : {"undo", "restore-factory", "reboot"}) EXPECT_EQ(find_verb(name)->rights, Rights::kService);
  for (const char* name : {"calibrate", "verify", "grab", "selftest"})
    EXPECT_EQ(find_verb(name)->rights, Rights::kOperate);
}

TEST(Verbs, OnlyExactNames_AreFound) {
  EXPECT_NE(find_verb("reboot"), nullptr);
  for (const char* name : {"", "reboo", "Reboot", "reboot ", "rebootx", "r"}) EXPECT_EQ(find_verb(name), nullptr);
}

std::vector<std::string> completions(std::string_view line) {
  std::vector<std::string> words;
  complete(
      line,
      [](void* context, std::string_view word) { static_cast<std::vector<std::string>*>(context)->emplace_back(word); },
      &words);
  return words;
}

TEST(Complete, FirstAndSecondWord) {
  EXPECT_EQ(completions("re"), (std::vector<std::string>{"result", "restore-factory", "reboot"}));
  EXPECT_EQ(completions("").size(), kVerbCount);
  EXPECT_EQ(completions("export k"), (std::vector<std::string>{"kalibr"}));
  EXPECT_EQ(completions("export ").size(), 7U);
  EXPECT_EQ(completions("help un"), (std::vector<std::string>{"undo"}));
  EXPECT_TRUE(completions("export kalibr ").empty());
  EXPECT_TRUE(completions("nonsense k").empty());
}

TEST(ParseWords, SplitsAtSpaces) {
  Request request;
  ASSERT_TRUE(parse_words("  export   kalibr cam0 ", request).ok());
  EXPECT_EQ(request.verb.view(), "export");
  ASSERT_EQ(request.arguments.size(), 2U);
  EXPECT_EQ(request.arguments[1].view(), "cam0");
  ASSERT_TRUE(parse_words("   ", request).ok());
  EXPECT_TRUE(request.verb.empty());
  EXPECT_EQ(parse_words("a b c d e f", request).code(), StatusCode::kOutOfRange);
  EXPECT_EQ(parse_words(std::string(64, 'x'), request).code(), StatusCode::kOutOfRange);
}

TEST(ParseJson, TheWholeShape) {
  Request request;
  ASSERT_TRUE(parse_json(R"( {"id" : -7, "args":["kalibr","a\"b\\\/"],	"cmd":"export"} )", request).ok());
  EXPECT_EQ(request.verb.view(), "export");
  EXPECT_EQ(request.id, -7);
  EXPECT_TRUE(request.has_id);
  EXPECT_EQ(request.arguments[1].view(), "a\"b\\/");
  ASSERT_TRUE(parse_json(R"({"cmd":"status","args":[]})", request).ok());
  EXPECT_FALSE(request.has_id);
  EXPECT_TRUE(request.arguments.empty());
}

TEST(ParseJson, AnythingElse_IsRefused) {
  Request request;
  for (const char* line : {"",
                           "{",
                           "{}",
                           "[]",
                           "{\"cmd\"}",
                           "{\"cmd\":}",
                           "{\"cmd\":status}",
                           "{\"cmd\":\"status\"",
                           "{\"cmd\":\"status\"}}",
                           "{\"cmd\":\"status\",}",
                           "{,\"cmd\":\"status\"}",
                           "{\"cmd\":\"status\" \"id\":1}",
                           "{\"cmd\":\"a\",\"cmd\":\"b\"}",
                           "{\"cmd\":\"status\",\"force\":true}",
                           "{\"cmd\":[\"status\"]}",
                           "{\"cmd\":\"status\",\"args\":\"x\"}",
                           "{\"cmd\":\"status\",\"args\":[1]}",
                           "{\"cmd\":\"status\",\"args\":[\"x\",]}",
                           "{\"cmd\":\"status\",\"args\":[\"x\"}",
                           "{\"cmd\":\"status\",\"id\":1.5}",
                           "{\"cmd\":\"status\",\"id\":01}",
                           "{\"cmd\":\"status\",\"id\":-}",
                           "{\"cmd\":\"status\",\"id\":\"1\"}",
                           "{\"cmd\":\"status\",\"id\":99999999999999999999}",
                           "{\"cmd\":\"st\\u0061tus\"}",
                           "{\"cmd\":\"status\\",
                           "{'cmd':'status'}",
                           "{\"cmd\":\"status\"} reboot",
                           "{\"id\":1}",
                           "{\"args\":[]}"})
    EXPECT_FALSE(parse_json(line, request).ok()) << line;
}

TEST(ParseJson, RefusalAfterTheId_KeepsIt) {
  Request request;
  EXPECT_FALSE(parse_json("{\"id\":12,\"cmd\":5}", request).ok());
  EXPECT_TRUE(request.has_id);
  EXPECT_EQ(request.id, 12);
}

template <typename Fill>
std::string replied(bool json, const Fill& fill) {
  char text[1024];
  TextWriter out(text);
  Reply reply(out, json);
  fill(reply);
  return std::string(out.view());
}

const auto kFill = [](Reply& reply) {
  reply.text("state", "IDLE");
  reply.flag("calibrated", true);
  reply.open("store");
  reply.integer("generation", 7);
  reply.number("temperature", 23.456, 1, "degC");
  reply.open_list("slots");
  reply.text({}, "A");
  reply.text({}, "B \"x\"");
  reply.close_list();
  reply.close();
  reply.document("file", "a: 1\nb: 2\n");
};

TEST(Reply, ForAPerson_IndentedLines) {
  EXPECT_EQ(replied(false, kFill),
            "state: IDLE\ncalibrated: yes\nstore: \n  generation: 7\n  temperature: 23.5 degC\n  slots: \n    - A\n    "
            "- B \"x\"\na: 1\nb: 2\n");
}

TEST(Reply, ForAMachine_Json) {
  EXPECT_EQ(
      replied(true, kFill),
      R"("state":"IDLE","calibrated":true,"store":{"generation":7,"temperature":23.456,"slots":["A","B \"x\""]},"file":"a: 1\nb: 2\n")");
}

TEST(Reply, NotFiniteAndTooDeep_StayWellFormed) {
  EXPECT_EQ(replied(true, [](Reply& r) { r.number("x", std::numeric_limits<double>::quiet_NaN(), 1); }), "\"x\":null");
  const std::string deep = replied(true, [](Reply& r) {
    for (int i = 0; i < 10; ++i) r.open("a");
    r.integer("lost", 1);
    for (int i = 0; i < 10; ++i) r.close();
    r.integer("kept", 2);
  });
  EXPECT_EQ(deep, R"("a":{"a":{"a":{"a":{"a":{"a":{}}}}}},"kept":2)");
}

TEST(Rights, Lapse_AfterTheirTime) {
  RightsGate gate(100);
  EXPECT_EQ(gate.rights(), Rights::kObserve);
  gate.grant(Rights::kService, 1000);
  gate.grant(Rights::kOperate, 1050);  // never lowers, holds longer
  EXPECT_EQ(gate.rights(), Rights::kService);
  EXPECT_FALSE(gate.lapse(1149));
  EXPECT_TRUE(gate.lapse(1150));
  EXPECT_EQ(gate.rights(), Rights::kObserve);
  EXPECT_FALSE(gate.lapse(2000));
}

struct SlowSink final : ports::ByteSink {
  std::size_t write_some(std::span<const char> bytes) override {
    const std::size_t taken = std::min(room, bytes.size());
    text.append(bytes.data(), taken);
    room -= taken;
    return taken;
  }
  std::string text;
  std::size_t room = 0;
};

TEST(OutputQueue, SlowReader_GetsWholeMessagesInOrder) {
  std::vector<char> ring(16);
  OutputQueue queue(ring);
  SlowSink sink;
  std::string expected;
  uint64_t lost = 0;
  for (int i = 0; i < 200; ++i) {
    const std::string message = std::string("m").append(std::to_string(i)).append("\n");
    if (queue.push(message, "\r\n"))
      expected += message.substr(0, message.size() - 1) + "\r\n";
    else
      ++lost;
    sink.room = static_cast<std::size_t>(i % 7);
    queue.pump(sink);
  }
  sink.room = 1000;
  queue.pump(sink);
  EXPECT_EQ(sink.text, expected);
  EXPECT_GT(lost, 0U);
  EXPECT_EQ(queue.lost_messages(), lost);
  EXPECT_GT(queue.lost_bytes(), 3 * lost);
  EXPECT_EQ(queue.size(), 0U);
}

}  // namespace
}  // namespace roomcal::console
