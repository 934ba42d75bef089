#include "runtime/console/line_editor.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace roomcal::console {
namespace {

// A terminal: feeds keys, keeps what is echoed, collects whole lines.
struct Terminal {
  Terminal() { editor.set_prompt("> "); }

  LineEvent type(std::string_view keys) {
    LineEvent last = LineEvent::kNone;
    for (const char key : keys) {
      char text[512];
      TextWriter out(text);
      const LineEvent event = editor.feed(key, out);
      echo.append(out.view());
      if (event != LineEvent::kNone) last = event;
      if (event == LineEvent::kLine) lines.emplace_back(editor.line());
    }
    return last;
  }

  LineEditor editor;
  std::string echo;
  std::vector<std::string> lines;
};

std::string line_of(std::string_view keys) {
  Terminal terminal;
  EXPECT_EQ(terminal.type(keys), LineEvent::kLine) << keys;
  return terminal.lines.empty() ? "" : terminal.lines.back();
}

TEST(LineEditor, PlainText_IsEchoedAndEndsWithAnyNewline) {
  Terminal terminal;
  terminal.type("one\rtwo\nthree\r\nfour\r");
  EXPECT_EQ(terminal.lines, (std::vector<std::string>{"one", "two", "three", "four"}));
  EXPECT_EQ(terminal.echo, "one\ntwo\nthree\nfour\n");
}

TEST(LineEditor, EditingKeys_DoWhatTheyDoElsewhere) {
  EXPECT_EQ(line_of("statsu\x7f\x7fus\r"), "status");
  EXPECT_EQ(line_of("\x08help\r"), "help");
  EXPECT_EQ(line_of("tatus\x01s\r"), "status");
  EXPECT_EQ(line_of("sttus\x02\x02\x02"
                    "a\x05!\r"),
            "status!");
  EXPECT_EQ(line_of("statusxx\x02\x02\x0b\r"), "status");
  EXPECT_EQ(line_of("xx status\x01\x06\x06\x06\x15\r"), "status");
  EXPECT_EQ(line_of("map verify now\x17\x17\r"), "map ");
  EXPECT_EQ(line_of("xstatus\x01\x04\r"), "status");
  EXPECT_EQ(line_of("gone\x03kept\r"), "kept");
}

TEST(LineEditor, ArrowHomeEndDelete_InEveryTerminalsSpelling) {
  EXPECT_EQ(line_of("sttus\x1b[D\x1b[D\x1b[Da\x1b[C\x1b[F!\r"), "status!");
  EXPECT_EQ(line_of("tatus\x1b[Hs\r"), "status");
  EXPECT_EQ(line_of("tatus\x1bOHs\x1bOF.\r"), "status.");
  EXPECT_EQ(line_of("tatus\x1b[1~s\x1b[4~.\r"), "status.");
  EXPECT_EQ(line_of("xstatus\x1b[7~\x1b[3~\x1b[8~.\r"), "status.");
  EXPECT_EQ(line_of("status\x1b[1;5C\x1b[15~\r"), "status");  // keys that we do not know
}

TEST(LineEditor, Redraw_PutsTheCursorBack) {
  Terminal terminal;
  terminal.type(
      "ab\x02"
      "c");
  EXPECT_EQ(terminal.echo, "ab\r> ab\x1b[K\x1b[1D\r> acb\x1b[K\x1b[1D");
}

TEST(LineEditor, RedrawAfterEnter_ShowsThePromptAlone) {
  const auto redrawn = [](std::string_view keys) {
    Terminal terminal;
    terminal.type(keys);
    char text[512];
    TextWriter out(text);
    terminal.editor.draw(out);
    return std::string(out.view());
  };
  EXPECT_EQ(redrawn("status\r"), "\r> \x1b[K");
  EXPECT_EQ(redrawn("status\x02\x02\r"), "\r> \x1b[K") << "nor is the cursor put anywhere";
  EXPECT_EQ(redrawn("status\x01\xe9\r"), "\r> \x1b[K") << "noise";
  EXPECT_EQ(redrawn("{\"cmd\":\"sta"), "\r> \x1b[K") << "a machine's line is not shown";
  EXPECT_EQ(redrawn("status\rma"), "\r> ma\x1b[K");
}

TEST(LineEditor, History_GoesBackAndForth) {
  EXPECT_EQ(line_of("one\rtwo\rtwo\r\x1b[A\x1b[A\r"), "one");
  EXPECT_EQ(line_of("one\rtwo\r\x10\x10\x0e\r"), "two");
  EXPECT_EQ(line_of("one\r\x1b[A\x1b[B"
                    "three\r"),
            "three");
  EXPECT_EQ(line_of("one\r\x1b[A\x1b[A\x1b[A!\r"), "one!");
  EXPECT_EQ(line_of("\x1b[Aone\r"), "one");
}

TEST(LineEditor, HistoryIsFull_OldestGoes) {
  Terminal terminal;
  for (int i = 0; i < 20; ++i) terminal.type(std::string("line").append(std::to_string(i)).append("\r"));
  for (int i = 0; i < 30; ++i) terminal.type("\x10");
  terminal.type("\r");
  EXPECT_EQ(terminal.lines.back(), "line4");
}

TEST(LineEditor, AnyByteThatNobodyTypes_MakesTheLineNoise) {
  for (int byte = 0x80; byte <= 0xFF; ++byte) {
    Terminal terminal;
    EXPECT_EQ(terminal.type(std::string("reb") + static_cast<char>(byte) + "oot\r"), LineEvent::kNoise) << byte;
    EXPECT_EQ(terminal.type("status\r"), LineEvent::kLine) << byte;
  }
  for (const char byte : {'\0', '\x07', '\x13', '\x1a', '\x1d'}) {
    Terminal terminal;
    EXPECT_EQ(terminal.type(std::string("reb") + byte + "oot\r"), LineEvent::kNoise) << static_cast<int>(byte);
  }
  Terminal terminal;
  EXPECT_EQ(terminal.type("re\x1b"
                          "boot\r"),
            LineEvent::kNoise);
}

TEST(LineEditor, BreakBeforeALine_IsIgnored) { EXPECT_EQ(line_of(std::string("\0\0\xff", 3) + "status\r"), "status"); }

TEST(LineEditor, AnySingleByte_EndsNoLineButNewlines) {
  for (int byte = 0; byte < 256; ++byte) {
    Terminal terminal;
    const std::string one(1, static_cast<char>(byte));
    const LineEvent event = terminal.type(one);
    EXPECT_EQ(event == LineEvent::kLine, byte == '\r' || byte == '\n') << byte;
    if (event == LineEvent::kLine) {
      EXPECT_EQ(terminal.lines.back(), "");
    }
  }
}

TEST(LineEditor, TooLongLine_IsDroppedWhole) {
  Terminal terminal;
  EXPECT_EQ(terminal.type(std::string(kMaxLine + 1, 'x') + "\r"), LineEvent::kTooLong);
  EXPECT_EQ(terminal.type(std::string(kMaxLine, 'x') + "\r"), LineEvent::kLine);
  EXPECT_EQ(terminal.type("{" + std::string(kMaxJsonLine, 'x') + "\r"), LineEvent::kTooLong);
}

TEST(LineEditor, JsonLine_IsTakenAsItIsWithoutEcho) {
  Terminal terminal;
  EXPECT_EQ(terminal.type("{\"cmd\":\"status\"}\n"), LineEvent::kLine);
  EXPECT_EQ(terminal.lines.back(), "{\"cmd\":\"status\"}");
  EXPECT_TRUE(terminal.editor.is_json());
  EXPECT_EQ(terminal.echo, "");
  EXPECT_EQ(terminal.type("{\"cmd\":\x7f\"status\"}\n"), LineEvent::kNoise);
  EXPECT_EQ(terminal.type("status {\r"), LineEvent::kLine);
  EXPECT_FALSE(terminal.editor.is_json());
}

}  // namespace
}  // namespace roomcal::console
