#include <charconv>

#include "runtime/export/export.h"
#include "runtime/export/summary.h"
#include "runtime/face/answers.h"
#include "runtime/store/diff.h"

namespace roomcal::face {

using console::Reply;
using console::Word;

namespace {

/// A generation as a person types it. @return kInvalidArgument.
Status to_generation(const Word& word, uint64_t& generation) {
  const std::string_view text = word.view();
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), generation);
  if (error != std::errc() || end != text.data() + text.size())
    return {StatusCode::kInvalidArgument, "a generation is a whole number: see `history`"};
  return ok_status();
}

void tell_entry(const store::HistoryEntry& entry, Reply& reply) {
  reply.open({});
  reply.integer("generation", static_cast<int64_t>(entry.generation));
  reply.integer("content_generation", static_cast<int64_t>(entry.content_generation));
  reply.text("slot", to_string(entry.slot));
  reply.text("action", to_string(entry.action));
  reply.text("verdict", to_string(entry.verdict));
  reply.integer("measured_unix_s", entry.measured_unix_s);
  reply.integer("written_unix_s", entry.written_unix_s);
  reply.text("map_id", entry.map_id.view());
  reply.flag("in_force", entry.in_force);
  reply.close();
}

}  // namespace

Status Answers::history(Reply& reply) {
  ROOMCAL_TRY(store_is_free());
  known_.store->list(history_);
  reply.text("store", to_string(known_.store->state()));
  reply.open_list("records");
  for (const store::HistoryEntry& entry : history_) tell_entry(entry, reply);
  reply.close_list();
  return ok_status();
}

// Without generations: the record in force against the one before it.
Status Answers::diff(Arguments arguments, Reply& reply) {
  ROOMCAL_TRY(store_is_free());
  const store::Record* now = known_.store->current();
  if (now == nullptr) return {StatusCode::kNotFound, "UNCALIBRATED: there is no record to compare"};
  uint64_t before = now->previous_content == store::kNothingBefore ? store::kFactoryContent : now->previous_content;
  if (!arguments.empty()) ROOMCAL_TRY(to_generation(arguments[0], before));
  ROOMCAL_TRY(known_.store->read_generation(before, first_));
  if (arguments.size() > 1) {
    uint64_t after = 0;
    ROOMCAL_TRY(to_generation(arguments[1], after));
    ROOMCAL_TRY(known_.store->read_generation(after, second_));
    now = &second_;
  }
  const store::RecordDiff difference = store::diff(first_, *now);
  reply.integer("from_generation", static_cast<int64_t>(first_.generation));
  reply.integer("to_generation", static_cast<int64_t>(now->generation));
  if (!reply.json()) {
    TextWriter out(text_);
    exports::write_summary(difference, out);
    reply.document("diff", out.view());
    return ok_status();
  }
  reply.flag("same_reference", difference.same_reference);
  reply.flag("same_map", difference.same_map);
  reply.open_list("sensors");
  for (const store::SensorDiff& sensor : difference.sensors) {
    reply.open({});
    reply.text("name", sensor.name.view());
    reply.flag("in_first", sensor.in_a);
    reply.flag("in_second", sensor.in_b);
    reply.number("distance_m", sensor.distance_m, 6);
    reply.number("angle_rad", sensor.angle_rad, 6);
    if (sensor.has_chi2) reply.number("chi2", sensor.chi2, 2);
    reply.close();
  }
  reply.close_list();
  return ok_status();
}

Status Answers::undo(Reply& reply) {
  ROOMCAL_TRY(store_is_free());
  ROOMCAL_TRY(known_.store->undo(desk_.unix_s()));
  return tell_in_force(reply);
}

Status Answers::restore_factory(Reply& reply) {
  ROOMCAL_TRY(store_is_free());
  ROOMCAL_TRY(known_.store->restore_factory(desk_.unix_s()));
  return tell_in_force(reply);
}

Status Answers::export_record(Arguments arguments, Reply& reply) {
  ROOMCAL_TRY(store_is_free());
  const store::Record* record = known_.store->current();
  if (record == nullptr) return {StatusCode::kNotFound, "UNCALIBRATED: there is no record to export"};
  const Result<exports::Format> format = exports::parse_format(arguments[0].view());
  ROOMCAL_TRY(format.status());
  TextWriter out(text_);
  const std::string_view camera = arguments.size() > 1 ? arguments[1].view() : std::string_view();
  ROOMCAL_TRY(exports::write(*record, format.value(), camera, out));
  reply.document("document", out.view());
  return ok_status();
}

}  // namespace roomcal::face
