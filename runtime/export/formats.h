#pragma once

// One writer per format; export.h is the door. All append and leave overflow to the writer.

#include "runtime/base/text_writer.h"
#include "runtime/store/record.h"

namespace roomcal::exports {

void write_json(const store::Record& record, TextWriter& out);
void write_kalibr(const store::Record& record, TextWriter& out);
void write_urdf(const store::Record& record, TextWriter& out);
void write_ros_tf(const store::Record& record, TextWriter& out);
void write_ros_info(const store::Record& record, const store::SensorRecord& camera, TextWriter& out);
void write_autoware(const store::Record& record, TextWriter& out);
void write_opencv(const store::Record& record, TextWriter& out);

}  // namespace roomcal::exports
