#include "tools/sheets/sheets_command.h"

#include <memory>
#include <string>

#include <fmt/format.h>

#include "runtime/map/format.h"
#include "tools/common/error.h"
#include "tools/sheets/ring_ratios.h"
#include "tools/sheets/sheet_pdf.h"

namespace roomcal::tools {

namespace {

struct Arguments {
  int count = 40;
  int first = 0;
  std::string paper = "a4";
  std::string ratios = fmt::format("id{}", kBestRingsId);
  double radius_mm = 0;
  std::string out;
};

void print_sheets(const Arguments& arguments) {
  constexpr int kMost = static_cast<int>(map::kMaxMarkers);
  if (arguments.count < 1 || arguments.count > kMost) {
    throw ToolError(fmt::format("--count {}: 1 to {}; a map holds no more", arguments.count, kMost));
  }
  if (arguments.first < 0 || arguments.first > 1000000) {
    throw ToolError(fmt::format("--first {}: 0 to 1000000", arguments.first));
  }
  const SheetPage page =
      layout_sheet(paper_named(arguments.paper), arguments.radius_mm, parse_ratios(arguments.ratios));
  write_sheets(page, arguments.first, arguments.count, arguments.out);
  fmt::print("{}: sheets {} to {} on {}, outer radius {:g} mm; print at 100 % and measure the bar: {:g} mm\n",
             arguments.out, arguments.first, arguments.first + arguments.count - 1, page.paper.name, page.radius_mm,
             kBar_mm);
}

}  // namespace

void add_sheets_command(CLI::App& app) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("sheets", "Print the ring markers: a vector PDF, one sheet a page");
  command->add_option("--count", arguments->count, "How many sheets")->capture_default_str();
  command->add_option("--first", arguments->first, "Number on the first one; for people only")->capture_default_str();
  command->add_option("--paper", arguments->paper, "a4, a3 or letter")->capture_default_str();
  command->add_option("--radius", arguments->radius_mm, "Outer radius, mm; default: as large as the paper allows");
  command
      ->add_option("--ratios", arguments->ratios,
                   "Inner circles in percent of the outer radius, falling, or id0 .. id31 for CCTag-3's own; the "
                   "default is what the detector sees best (roomcal evaluate rings)")
      ->capture_default_str();
  command->add_option("-o,--out", arguments->out, "The PDF to write")->required();
  command->callback([arguments] { print_sheets(*arguments); });
}

}  // namespace roomcal::tools
